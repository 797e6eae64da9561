//! The form of the paper's figures: the BRDF as radius at the view angle from the surface normal.

use super::theory::legend;
use crate::format::counted;
use crate::plot::axis::Axis;
use crate::plot::canvas::{Canvas, Point};
use crate::plot::clip::clip;
use crate::plot::curves::values;
use crate::plot::figure::Figure;
use crate::plot::style::{BAND, FINE_GRID, GRID, INK, TEXT};
use crate::plot::styled::{Curves, Styled};
use crate::plot::svg::{Anchor, Paint};
use crate::plot::title::Title;
use crate::plot::view::View;
use crate::scan::Side;

/// The position of the surface element, and the length of the axis from there.
const CENTRE: Point = (400.0, 478.0);
const RADIUS: f64 = 340.0;

/// The figure of readings and theory.
pub(super) fn figure(title: &Title, curves: &Curves) -> Figure {
    let note = note_on_missing(curves);
    let sentence = note
        .as_deref()
        .map_or_else(String::new, |n| format!(" {n}."));
    Figure {
        name: "polar".to_owned(),
        caption: format!(
            "BRDF in 1/sr as radius at the view angle from the surface normal, in the plane of \
             incidence, the source's side to the right. Marks: readings. Lines: {}. Dashed: mirror \
             directions.{}{sentence}",
            title.theory, curves.left_out
        ),
        svg: svg(title, curves, note.as_deref()),
    }
}

/// A note on the readings that cannot be a radius, if there are any.
pub(super) fn note_on_missing(curves: &Curves) -> Option<String> {
    let negative = curves.negative;
    (negative > 0).then(|| format!("{} < 0 not shown", counted(negative, "reading")))
}

/// The drawing.
pub(super) fn svg(title: &Title, curves: &Curves, note: Option<&str>) -> String {
    let radii = Axis::linear(values(curves.plain()).filter(|value| *value > 0.0));
    title.render(|canvas| {
        draw_angles(canvas);
        draw_radii(canvas, &radii);
        draw_names(canvas, &curves.view);
        draw_curves(canvas, &radii, curves);
        legend(curves, note).draw(canvas);
    })
}

/// The point at a view angle in degrees and a fraction of the outer radius.
fn at(theta_deg: f64, radius: f64) -> Point {
    let (sin, cos) = theta_deg.to_radians().sin_cos();
    (
        CENTRE.0 + RADIUS * radius * sin,
        CENTRE.1 - RADIUS * radius * cos,
    )
}

/// The grid lines of the view angle.
fn draw_angles(canvas: &mut Canvas) {
    for step in -6..=6 {
        let theta_deg = 15.0 * f64::from(step);
        let line = [at(theta_deg, 0.0), at(theta_deg, 1.0)];
        if step % 2 == 0 {
            canvas.line(&line, GRID, 1.0);
            let label = format!("{theta_deg:.0}");
            let point = at(theta_deg, 1.0 + 17.0 / RADIUS);
            canvas.text(&label, point, TEXT, Anchor::Middle);
        } else {
            canvas.line(&line, FINE_GRID, 1.0);
        }
    }
}

/// The grid lines of the radius, and the surface.
fn draw_radii(canvas: &mut Canvas, radii: &Axis) {
    let below = CENTRE.1 + 14.0;
    for tick in radii.ticks().iter().filter(|tick| tick.value > 0.0) {
        let radius = radii.fraction(tick.value);
        let semicircle: Vec<Point> = (-90..=90).map(|deg| at(f64::from(deg), radius)).collect();
        canvas.line(&semicircle, GRID, 1.0);
        for side in [-90.0, 90.0] {
            let (x, _) = at(side, radius);
            canvas.text(&tick.label, (x, below), TEXT, Anchor::Middle);
        }
    }
    canvas.text("0", (CENTRE.0, below), TEXT, Anchor::Middle);
    canvas.line(&[at(-90.0, 1.0), at(90.0, 1.0)], INK, 1.0);
}

/// The names of both sides, of the quantity and of the view angle.
fn draw_names(canvas: &mut Canvas, view: &View) {
    let below = CENTRE.1 + 40.0;
    let (left, right) = match view.theta_positive {
        _ if !view.in_plane() => ("", ""),
        Side::Source => ("forward side", "source side"),
        Side::Forward => ("source side", "forward side"),
    };
    let quantity = view.quantity.axis_name();
    for (name, radius) in [(left, -0.5), (quantity, 0.0), (right, 0.5)] {
        let point = (CENTRE.0 + radius * RADIUS, below);
        canvas.text(name, point, TEXT + 1.0, Anchor::Middle);
    }
    let point = (CENTRE.0, below + 24.0);
    canvas.text(&view.theta_name(), point, TEXT + 1.0, Anchor::Middle);
}

fn draw_curves(canvas: &mut Canvas, radii: &Axis, curves: &Curves) {
    for styled in &curves.all {
        if let Some(mirror_deg) = curves.view.mirror_deg(styled.curve.psi) {
            let faint = Paint::translucent(styled.colour, 0.6);
            canvas.dashed_line(at(mirror_deg, 0.0), at(mirror_deg, 1.0), faint, 1.0);
        }
        draw_bands(canvas, radii, styled);
    }
    for styled in &curves.all {
        draw_readings(canvas, radii, styled);
    }
    for styled in &curves.all {
        let line = styled.curve.theory.iter().map(|t| (t.theta_deg, t.value));
        draw_line(canvas, radii, line, styled, 1.8);
    }
}

fn draw_bands(canvas: &mut Canvas, radii: &Axis, styled: &Styled) {
    for band in styled.curve.bands() {
        let edge = |i: usize| {
            let point = move |&(theta, ends): &(f64, [f64; 2])| {
                at(theta, radii.fraction(ends[i]).clamp(0.0, 1.0))
            };
            band.iter().map(point)
        };
        let outline: Vec<Point> = edge(0).chain(edge(1).rev()).collect();
        canvas.area(&outline, Paint::translucent(styled.colour, BAND));
    }
}

fn draw_readings(canvas: &mut Canvas, radii: &Axis, styled: &Styled) {
    for reading in &styled.curve.readings {
        let (theta, value) = (reading.theta_deg, reading.value);
        if let Some(sigma) = reading.sigma {
            let bar = [(theta, value - sigma), (theta, value + sigma)];
            draw_line(canvas, radii, bar.into_iter(), styled, 1.0);
        }
        if radii.contains(value) {
            let point = at(theta, radii.fraction(value));
            canvas.mark(point, styled.mark, styled.colour);
        }
    }
}

/// A line through view angles and values, clipped to the axis.
fn draw_line(
    canvas: &mut Canvas,
    radii: &Axis,
    values: impl Iterator<Item = (f64, f64)>,
    styled: &Styled,
    width: f64,
) {
    let fractions = values.map(|(theta, value)| (theta, radii.fraction(value)));
    let fractions: Vec<(f64, f64)> = fractions.collect();
    for piece in clip(&fractions) {
        let points: Vec<Point> = piece.into_iter().map(|(t, r)| at(t, r)).collect();
        canvas.line(&points, styled.colour, width);
    }
}
