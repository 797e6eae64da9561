//! How sharply the readings determine k1: the lowest E over all other parameters at each k1 of the
//! global check.

use crate::fit::Fit;
use crate::plot::axis::Axis;
use crate::plot::canvas::Canvas;
use crate::plot::figure::Figure;
use crate::plot::frame::{Frame, WHOLE};
use crate::plot::legend::{Key, Legend};
use crate::plot::palette::MarkShape;
use crate::plot::style::{EMPHASIS, MAIN};
use crate::plot::text::four_digits;
use crate::plot::title::Title;

/// The most decades of E, which decreases to the rounding error for a noise-free scan.
const DECADES: i32 = 10;

/// More than all decades of k1.
const K1_DECADES: i32 = 20;

/// The profile over k1; `None` where the fit has none, or no specular part with a width.
pub(super) fn figure(title: &Title, fit: &Fit) -> Option<Figure> {
    let points = points(fit)?;
    let k1 = points.iter().map(|point| point.0);
    let errors = points.iter().map(|point| point.1).chain([fit.e_percent]);
    let frame = Frame {
        x: Axis::logarithmic(k1, K1_DECADES)?,
        y: Axis::logarithmic(errors, DECADES)?,
        area: WHOLE,
    };
    Some(Figure {
        name: "profile-k1".to_owned(),
        caption: format!(
            "The lowest E over all other parameters at each k1 of the global check ({}). Mark: the \
             fit.",
            title.theory
        ),
        svg: title.render(|canvas| draw(canvas, &frame, &points, fit)),
    })
}

/// k1 and E in percent, in ascending order of k1.
fn points(fit: &Fit) -> Option<Vec<(f64, f64)>> {
    let mut points: Vec<(f64, f64)> = fit
        .global_check
        .iter()
        .flat_map(|check| &check.profile)
        .map(|point| (point.parameters.k1, 100.0 * point.error))
        .filter(|(k1, _)| *k1 > 0.0)
        .collect();
    if points.len() < 2 || fit.parameters.k2 == 0.0 {
        return None;
    }
    // The steps of the check are wide beside the minimum: the line passes through the fit, unless the
    // fit is no minimum of E, as with constrained energy or another loss function.
    if points.iter().all(|(_, error)| fit.e_percent <= *error) {
        points.push((fit.parameters.k1, fit.e_percent));
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    Some(points)
}

fn draw(canvas: &mut Canvas, frame: &Frame, points: &[(f64, f64)], fit: &Fit) {
    frame.draw(canvas, "width k1 of the facet distribution", "lowest E / %");
    let (k1, error) = (fit.parameters.k1, fit.e_percent);
    if frame.x.contains(k1) {
        frame.dashed_vertical(canvas, k1, EMPHASIS);
    }
    frame.line(canvas, points.iter().copied(), MAIN, 1.8);
    if frame.contains((k1, error)) {
        canvas.mark(frame.point((k1, error)), MarkShape::Circle, EMPHASIS);
    }
    let mut legend = Legend::default();
    legend.add(Key::Line(MAIN), "lowest E at k1");
    legend.add(
        Key::Mark(EMPHASIS),
        &format!("fit: k1 = {}", four_digits(k1)),
    );
    legend.draw(canvas);
}
