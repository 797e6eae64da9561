//! Theory against experiment: f_r over the signed view angle, for each incidence.

use plotters::style::Color;

use crate::plot::axis::Axis;
use crate::plot::canvas::Canvas;
use crate::plot::curves::{Curves, DECADES, Styled, lower_ends, values};
use crate::plot::error::PlotError;
use crate::plot::figure::Figure;
use crate::plot::frame::{Frame, Key, Legend, draw_title, drawn_with_samples};
use crate::plot::style::{INK, ink};
use crate::plot::title::Title;
use crate::plot::view::{Scale, View};
use crate::words::counted;

/// On a linear axis.
pub(super) fn linear(title: &Title, curves: &Curves) -> Result<Figure, PlotError> {
    let axis = linear_axis(curves);
    Ok(Figure {
        name: "theory-linear".to_owned(),
        caption: caption(title, curves, "linear", ""),
        svg: svg(title, curves, axis, None)?,
    })
}

/// On a logarithmic axis; `None` where nothing is positive.
pub(super) fn logarithmic(title: &Title, curves: &Curves) -> Result<Option<Figure>, PlotError> {
    let Some(axis) = Axis::logarithmic(values(curves.plain()), DECADES) else {
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
    svg(title, curves, axis(curves, Scale::Logarithmic), Some(note))
}

fn linear_axis(curves: &Curves) -> Axis {
    Axis::linear(values(curves.plain()).chain(lower_ends(curves.plain())))
}

/// The axis of a scale; a linear one where a logarithmic one has nothing to show.
pub(super) fn axis(curves: &Curves, scale: Scale) -> Axis {
    let logarithmic = match scale {
        Scale::Linear => None,
        Scale::Logarithmic => Axis::logarithmic(values(curves.plain()), DECADES),
    };
    logarithmic.unwrap_or_else(|| linear_axis(curves))
}

fn svg(title: &Title, curves: &Curves, y: Axis, note: Option<&str>) -> Result<String, PlotError> {
    let frame = Frame::over_theta(y);
    drawn_with_samples(title, |canvas| draw(canvas, &frame, title, curves, note))
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
pub(super) fn note_on_lost(curves: &Curves, axis: &Axis) -> Option<String> {
    let values = curves.readings().map(|reading| reading.value);
    let below = values.filter(|value| *value > 0.0 && *value < axis.low());
    let notes = [
        (curves.not_positive, "<= 0"),
        (below.count(), "below the axis"),
    ]
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
    let names = (curves.view.theta_name(), curves.view.quantity.axis_name());
    frame.draw(canvas, &names.0, names.1)?;
    let all: Vec<&Styled> = curves.all.iter().collect();
    draw_curves(canvas, frame, &all, &curves.view)?;
    legend(curves, note).draw(canvas)
}

/// Mirror directions, bands, readings and theory within the axes.
pub(super) fn draw_curves(
    canvas: &mut Canvas,
    frame: &Frame,
    curves: &[&Styled],
    view: &View,
) -> Result<(), PlotError> {
    for styled in curves {
        draw_mirror(canvas, frame, styled, view)?;
        for band in styled.curve.bands() {
            frame.band(canvas, &band, ink(styled.colour))?;
        }
    }
    for styled in curves {
        draw_readings(canvas, frame, styled)?;
    }
    // Above the readings, which may be so dense that they would hide the lines.
    for styled in curves {
        let line = styled.curve.theory.iter().map(|t| (t.theta_deg, t.value));
        frame.line(canvas, line, &ink(styled.colour), 1.8)?;
    }
    Ok(())
}

/// The mirror direction of a curve, where the view has it.
pub(super) fn draw_mirror(
    canvas: &mut Canvas,
    frame: &Frame,
    styled: &Styled,
    view: &View,
) -> Result<(), PlotError> {
    match view.mirror_deg(styled.curve.psi) {
        Some(mirror) => frame.upright_dashes(canvas, mirror, &ink(styled.colour).mix(0.6)),
        None => Ok(()),
    }
}

fn draw_readings(canvas: &mut Canvas, frame: &Frame, styled: &Styled) -> Result<(), PlotError> {
    let colour = ink(styled.colour);
    for reading in &styled.curve.readings {
        let (theta, value) = (reading.theta_deg, reading.value);
        if let Some(sigma) = reading.sigma {
            frame.error_bar(canvas, theta, (value - sigma, value + sigma), colour)?;
        }
        if frame.contains((theta, value)) {
            canvas.mark(frame.place((theta, value)), styled.mark, colour)?;
        }
    }
    Ok(())
}

/// The legend of the figures of readings and theory.
pub(super) fn legend(curves: &Curves, note: Option<&str>) -> Legend {
    let mut legend = Legend::default();
    legend.add_curves(&curves.all, curves.measured());
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
    if curves.view.in_plane() {
        legend.add(Key::Dashes(INK), "mirror direction");
    }
    if let Some(note) = note {
        legend.add(Key::Note, note);
    }
    legend
}
