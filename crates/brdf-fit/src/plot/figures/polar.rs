//! The form of the paper's figures: f_r as radius at the view angle from the normal.

use plotters::style::Color;

use super::theory::legend;
use crate::plot::axis::Axis;
use crate::plot::canvas::{Canvas, Place, Stands};
use crate::plot::clip::within;
use crate::plot::curves::{Curves, Styled, values};
use crate::plot::error::PlotError;
use crate::plot::figure::Figure;
use crate::plot::frame::{draw_title, drawn_with_samples};
use crate::plot::style::{BAND, FINE_GRID, GRID, INK, TEXT, ink};
use crate::plot::title::Title;
use crate::plot::view::View;
use crate::read::Side;
use crate::words::counted;

/// Where the surface element lies, and how far from it the axis ends.
const CENTRE: Place = (400.0, 478.0);
const RADIUS: f64 = 340.0;

/// The figure of readings and theory.
pub(super) fn figure(title: &Title, curves: &Curves) -> Result<Figure, PlotError> {
    let note = note_on_lost(curves);
    let sentence = note
        .as_deref()
        .map_or_else(String::new, |n| format!(" {n}."));
    Ok(Figure {
        name: "polar".to_owned(),
        caption: format!(
            "BRDF in 1/sr as radius at the view angle from the surface normal, in the plane of \
             incidence, the source's side to the right. Marks: readings. Lines: {}. Dashed: mirror \
             directions.{}{sentence}",
            title.theory, curves.left_out
        ),
        svg: svg(title, curves, note.as_deref())?,
    })
}

/// What of the readings has no radius.
pub(super) fn note_on_lost(curves: &Curves) -> Option<String> {
    let negative = curves.negative;
    (negative > 0).then(|| format!("{} < 0 not shown", counted(negative, "reading")))
}

/// The drawing.
pub(super) fn svg(title: &Title, curves: &Curves, note: Option<&str>) -> Result<String, PlotError> {
    let radii = Axis::linear(values(curves.plain()).filter(|value| *value > 0.0));
    drawn_with_samples(title, |canvas| {
        draw_title(canvas, title)?;
        draw_grid(canvas, &radii, &curves.view)?;
        draw_curves(canvas, &radii, curves)?;
        legend(curves, note).draw(canvas)
    })
}

/// Where a fraction of the outer radius lies at a view angle in degrees.
fn place(theta_deg: f64, radius: f64) -> Place {
    let (sin, cos) = theta_deg.to_radians().sin_cos();
    (
        CENTRE.0 + RADIUS * radius * sin,
        CENTRE.1 - RADIUS * radius * cos,
    )
}

fn draw_grid(canvas: &mut Canvas, radii: &Axis, view: &View) -> Result<(), PlotError> {
    for step in -6..=6 {
        let theta_deg = 15.0 * f64::from(step);
        let line = [place(theta_deg, 0.0), place(theta_deg, 1.0)];
        if step % 2 == 0 {
            canvas.line(&line, &GRID, 1.0)?;
            let label = format!("{theta_deg:.0}");
            let at = place(theta_deg, 1.0 + 17.0 / RADIUS);
            canvas.text(&label, at, TEXT, Stands::Centred)?;
        } else {
            canvas.line(&line, &FINE_GRID, 1.0)?;
        }
    }
    for tick in radii.ticks.iter().filter(|tick| tick.value > 0.0) {
        let radius = radii.height(tick.value);
        let circle: Vec<Place> = (-90..=90)
            .map(|deg| place(f64::from(deg), radius))
            .collect();
        canvas.line(&circle, &GRID, 1.0)?;
        for side in [-90.0, 90.0] {
            let (x, _) = place(side, radius);
            canvas.text(&tick.label, (x, CENTRE.1 + 14.0), TEXT, Stands::Centred)?;
        }
    }
    canvas.text("0", (CENTRE.0, CENTRE.1 + 14.0), TEXT, Stands::Centred)?;
    canvas.line(&[place(-90.0, 1.0), place(90.0, 1.0)], &INK, 1.0)?;
    let below = CENTRE.1 + 40.0;
    let (left, right) = match view.theta_positive {
        Side::Source => ("forward side", "source side"),
        Side::Forward => ("source side", "forward side"),
    };
    let sides = if view.in_plane() {
        (left, right)
    } else {
        ("", "")
    };
    let quantity = view.quantity.axis_name();
    for (text, x) in [(sides.0, -0.5), (quantity, 0.0), (sides.1, 0.5)] {
        canvas.text(
            text,
            (CENTRE.0 + x * RADIUS, below),
            TEXT + 1.0,
            Stands::Centred,
        )?;
    }
    canvas.text(
        &view.theta_name(),
        (CENTRE.0, below + 24.0),
        TEXT + 1.0,
        Stands::Centred,
    )
}

fn draw_curves(canvas: &mut Canvas, radii: &Axis, curves: &Curves) -> Result<(), PlotError> {
    for styled in &curves.all {
        let colour = ink(styled.colour);
        if let Some(mirror) = curves.view.mirror_deg(styled.curve.psi) {
            canvas.dashes(
                place(mirror, 0.0),
                place(mirror, 1.0),
                &colour.mix(0.6),
                1.0,
            )?;
        }
        for band in styled.curve.bands() {
            let edge = |i: usize| {
                let place = move |&(theta, ends): &(f64, [f64; 2])| {
                    place(theta, radii.height(ends[i]).clamp(0.0, 1.0))
                };
                band.iter().map(place)
            };
            let outline: Vec<Place> = edge(0).chain(edge(1).rev()).collect();
            canvas.area(&outline, &colour.mix(BAND))?;
        }
    }
    for styled in &curves.all {
        draw_readings(canvas, radii, styled)?;
    }
    for styled in &curves.all {
        let line = styled.curve.theory.iter().map(|t| (t.theta_deg, t.value));
        draw_line(canvas, radii, line, styled, 1.8)?;
    }
    Ok(())
}

fn draw_readings(canvas: &mut Canvas, radii: &Axis, styled: &Styled) -> Result<(), PlotError> {
    for reading in &styled.curve.readings {
        let (theta, value) = (reading.theta_deg, reading.value);
        if let Some(sigma) = reading.sigma {
            let bar = [(theta, value - sigma), (theta, value + sigma)];
            draw_line(canvas, radii, bar.into_iter(), styled, 1.0)?;
        }
        if radii.contains(value) {
            let at = place(theta, radii.height(value));
            canvas.mark(at, styled.mark, ink(styled.colour))?;
        }
    }
    Ok(())
}

/// A line through points of view angle and value, cut at the axis.
fn draw_line(
    canvas: &mut Canvas,
    radii: &Axis,
    points: impl Iterator<Item = (f64, f64)>,
    of: &Styled,
    width: f64,
) -> Result<(), PlotError> {
    let line: Vec<(f64, f64)> = points.map(|(t, value)| (t, radii.height(value))).collect();
    for piece in within(&line) {
        let places: Vec<Place> = piece.into_iter().map(|(t, r)| place(t, r)).collect();
        canvas.line(&places, &ink(of.colour), width)?;
    }
    Ok(())
}
