//! Theory against experiment: the BRDF over the signed view angle, for each incidence.

use crate::format::counted;
use crate::plot::axis::Axis;
use crate::plot::canvas::Canvas;
use crate::plot::curves::{DECADES, lower_ends, values};
use crate::plot::figure::Figure;
use crate::plot::frame::Frame;
use crate::plot::legend::{Key, Legend};
use crate::plot::style::INK;
use crate::plot::styled::{Curves, Styled};
use crate::plot::svg::Paint;
use crate::plot::title::Title;
use crate::plot::view::{Scale, View};

/// The figure with a linear axis.
pub(super) fn linear(title: &Title, curves: &Curves) -> Figure {
    let axis = linear_axis(curves);
    Figure {
        name: "theory-linear".to_owned(),
        caption: caption(title, curves, "linear", ""),
        svg: svg(title, curves, axis, None),
    }
}

/// The figure with a logarithmic axis; `None` where no value is positive.
pub(super) fn logarithmic(title: &Title, curves: &Curves) -> Option<Figure> {
    let axis = Axis::logarithmic(values(curves.plain()), DECADES)?;
    let note = note_on_missing(curves, &axis);
    let sentence = note
        .as_ref()
        .map_or_else(String::new, |note| format!(" {note}."));
    Some(Figure {
        name: "theory-log".to_owned(),
        caption: caption(title, curves, "logarithmic", &sentence),
        svg: svg(title, curves, axis, note.as_deref()),
    })
}

/// The drawing of the theory without readings on a logarithmic axis.
pub(super) fn svg_of_theory(title: &Title, curves: &Curves, note: &str) -> String {
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

fn svg(title: &Title, curves: &Curves, y: Axis, note: Option<&str>) -> String {
    let frame = Frame::over_theta(y);
    let view = &curves.view;
    title.render(|canvas| {
        frame.draw(canvas, &view.theta_name(), view.quantity.axis_name());
        let all: Vec<&Styled> = curves.all.iter().collect();
        draw_curves(canvas, &frame, &all, view);
        legend(curves, note).draw(canvas);
    })
}

fn caption(title: &Title, curves: &Curves, axis: &str, more: &str) -> String {
    let error_bars = if curves.has_error_bars() {
        " with their standard deviation"
    } else {
        ""
    };
    let bands = if curves.has_bands() {
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

/// A note on the readings that a logarithmic axis cannot show, if there are any.
pub(super) fn note_on_missing(curves: &Curves, axis: &Axis) -> Option<String> {
    let values = curves.readings().map(|reading| reading.value);
    let below = values.filter(|value| *value > 0.0 && *value < axis.low());
    let notes = [
        (curves.not_positive, "<= 0"),
        (below.count(), "below the axis"),
    ]
    .into_iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, which)| format!("{} {which} not shown", counted(count, "reading")));
    let notes: Vec<String> = notes.collect();
    (!notes.is_empty()).then(|| notes.join(", "))
}

/// Mirror directions, error bands, readings and theory within the axes.
pub(super) fn draw_curves(canvas: &mut Canvas, frame: &Frame, curves: &[&Styled], view: &View) {
    for styled in curves {
        draw_mirror_direction(canvas, frame, styled, view);
        for band in styled.curve.bands() {
            frame.band(canvas, &band, styled.colour);
        }
    }
    for styled in curves {
        draw_readings(canvas, frame, styled);
    }
    // Last, because dense readings would hide the lines.
    for styled in curves {
        let line = styled.curve.theory.iter().map(|t| (t.theta_deg, t.value));
        frame.line(canvas, line, styled.colour, 1.8);
    }
}

/// The mirror direction of a curve, where it lies in the plane of the view.
pub(super) fn draw_mirror_direction(
    canvas: &mut Canvas,
    frame: &Frame,
    styled: &Styled,
    view: &View,
) {
    if let Some(mirror_deg) = view.mirror_deg(styled.curve.psi) {
        let paint = Paint::translucent(styled.colour, 0.6);
        frame.dashed_vertical(canvas, mirror_deg, paint);
    }
}

fn draw_readings(canvas: &mut Canvas, frame: &Frame, styled: &Styled) {
    for reading in &styled.curve.readings {
        let (theta, value) = (reading.theta_deg, reading.value);
        if let Some(sigma) = reading.sigma {
            let ends = (value - sigma, value + sigma);
            frame.error_bar(canvas, theta, ends, styled.colour);
        }
        if frame.contains((theta, value)) {
            let point = frame.point((theta, value));
            canvas.mark(point, styled.mark, styled.colour);
        }
    }
}

/// The legend of the figures of readings and theory.
pub(super) fn legend(curves: &Curves, note: Option<&str>) -> Legend {
    let mut legend = Legend::default();
    let has_readings = curves.has_readings();
    legend.add_curves(&curves.all, has_readings);
    if has_readings {
        legend.add(Key::Mark(INK), "reading");
        legend.add(Key::Line(INK), "theory");
    }
    if curves.has_error_bars() {
        legend.add(Key::ErrorBar, "1 sigma of a reading");
    }
    if curves.has_bands() {
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
