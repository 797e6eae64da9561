//! Theory against experiment: f_r over the signed view angle, for each incidence.

use plotters::style::Color;

use super::axis::Axis;
use super::canvas::{Canvas, drawn};
use super::curves::{Curve, Curves};
use super::frame::{Frame, Key, Legend, draw_title};
use super::style::{INK, colour, mark};
use super::title::Title;
use super::{Figure, PlotError};
use crate::words::counted;

/// The name of the axis of view angles.
pub(super) const THETA: &str = "view angle theta / deg (source side positive)";

/// The name of the axis of f_r.
pub(super) const BRDF: &str = "BRDF / (1/sr)";

/// A logarithmic axis has at the most so many decades: a single reading of next to nothing shall
/// not squeeze the others.
const DECADES: i32 = 6;

/// On a linear axis.
pub(super) fn linear(title: &Title, curves: &Curves) -> Result<Figure, PlotError> {
    let axis = Axis::linear(curves.values().chain(curves.lower_ends()));
    Ok(Figure {
        name: "theory-linear".to_owned(),
        caption: caption(title, curves, "linear", ""),
        svg: svg(title, curves, axis, None)?,
    })
}

/// On a logarithmic axis; `None` where nothing is positive.
pub(super) fn logarithmic(title: &Title, curves: &Curves) -> Result<Option<Figure>, PlotError> {
    let Some(axis) = Axis::logarithmic(curves.values(), DECADES) else {
        return Ok(None);
    };
    let note = note_on_lost(curves, &axis);
    let sentence = note
        .as_ref()
        .map_or_else(String::new, |note| format!(" {note}."));
    Ok(Some(Figure {
        name: "theory-log".to_owned(),
        caption: caption(title, curves, "logarithmic", &sentence),
        svg: svg(title, curves, axis, note.as_deref())?,
    }))
}

/// The drawing of the theory alone on a logarithmic axis.
pub(super) fn of_theory(title: &Title, curves: &Curves, note: &str) -> Result<String, PlotError> {
    let axis = Axis::logarithmic(curves.values(), DECADES);
    let axis = axis.unwrap_or_else(|| Axis::linear(curves.values()));
    svg(title, curves, axis, Some(note))
}

fn svg(title: &Title, curves: &Curves, y: Axis, note: Option<&str>) -> Result<String, PlotError> {
    let frame = Frame::over_theta(y);
    drawn(|canvas| draw(canvas, &frame, title, curves, note))
}

fn caption(title: &Title, curves: &Curves, axis: &str, more: &str) -> String {
    let error_bars = if curves.error_bars() {
        " with their standard deviation"
    } else {
        ""
    };
    let bands = if curves.bands() {
        ", with a band of one standard error to both sides"
    } else {
        ""
    };
    format!(
        "Theory against experiment: BRDF over the view angle in the plane of incidence, {axis} \
         axis. Marks: readings{error_bars}. Lines: {}{bands}. Dashed: mirror directions.{}{more}",
        title.theory, curves.left_out
    )
}

/// What of the readings a logarithmic axis cannot show.
fn note_on_lost(curves: &Curves, axis: &Axis) -> Option<String> {
    let count = |lost: &dyn Fn(f64) -> bool| curves.readings().filter(|r| lost(r.brdf)).count();
    let not_positive = count(&|brdf| brdf <= 0.0);
    let below = count(&|brdf| brdf > 0.0 && brdf < axis.low());
    let notes = [(not_positive, "<= 0"), (below, "below the axis")]
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| format!("{} {what} not shown", counted(count, "reading")));
    let notes: Vec<String> = notes.collect();
    (!notes.is_empty()).then(|| notes.join(", "))
}

fn draw(
    canvas: &mut Canvas,
    frame: &Frame,
    title: &Title,
    curves: &Curves,
    note: Option<&str>,
) -> Result<(), PlotError> {
    draw_title(canvas, title)?;
    frame.draw(canvas, THETA, BRDF)?;
    for (i, curve) in curves.curves.iter().enumerate() {
        frame.upright_dashes(canvas, -curve.psi_deg, &colour(i).mix(0.6))?;
        for band in curve.bands() {
            frame.band(canvas, &band, colour(i))?;
        }
    }
    for (i, curve) in curves.curves.iter().enumerate() {
        draw_readings(canvas, frame, curve, i)?;
    }
    // Above the readings, which may be so dense that they would hide the lines.
    for (i, curve) in curves.curves.iter().enumerate() {
        let line = curve.theory.iter().map(|t| (t.theta_deg, t.brdf));
        frame.line(canvas, line, &colour(i), 1.8)?;
    }
    legend(curves, note).draw(canvas)
}

fn draw_readings(
    canvas: &mut Canvas,
    frame: &Frame,
    curve: &Curve,
    i: usize,
) -> Result<(), PlotError> {
    for reading in &curve.readings {
        let (theta, brdf) = (reading.theta_deg, reading.brdf);
        if let Some(sigma) = reading.sigma {
            frame.error_bar(canvas, theta, (brdf - sigma, brdf + sigma), colour(i))?;
        }
        if frame.contains((theta, brdf)) {
            canvas.mark(frame.place((theta, brdf)), mark(i), colour(i))?;
        }
    }
    Ok(())
}

/// The legend of the figures of readings and theory.
pub(super) fn legend(curves: &Curves, note: Option<&str>) -> Legend {
    let mut legend = Legend::default();
    for (i, curve) in curves.curves.iter().enumerate() {
        legend.add(Key::Curve(i, curves.measured()), &curve.name());
    }
    if curves.measured() {
        legend.add(Key::Mark(INK), "reading");
        legend.add(Key::Line(INK), "theory");
    }
    if curves.error_bars() {
        legend.add(Key::ErrorBar, "1 sigma of a reading");
    }
    if curves.bands() {
        legend.add(Key::Band, "1 sigma of theory");
    }
    legend.add(Key::Dashes(INK), "mirror direction");
    if let Some(note) = note {
        legend.add(Key::Note, note);
    }
    legend
}
