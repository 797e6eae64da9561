//! How sharply E tells k1: the lowest E over all other parameters at each k1 of the global check.

use crate::plot::axis::Axis;
use crate::plot::canvas::{Canvas, drawn};
use crate::plot::error::PlotError;
use crate::plot::figure::Figure;
use crate::plot::frame::{Frame, Key, Legend, WHOLE, draw_title};
use crate::plot::palette::MarkShape;
use crate::plot::style::{MAIN, POINTED_OUT};
use crate::plot::title::{Title, short};
use crate::stages::Fit;

/// E of a noise-free scan goes down to rounding: its axis ends so many decades below the top.
const DECADES: i32 = 10;

/// All decades of k1 and more.
const K1_DECADES: i32 = 20;

/// The profile over k1; `None` where there is none, or nothing that k1 were the width of.
pub(super) fn figure(title: &Title, fit: &Fit) -> Result<Option<Figure>, PlotError> {
    let mut points: Vec<(f64, f64)> = fit
        .global_check
        .iter()
        .flat_map(|check| &check.profile)
        .map(|point| (point.parameters.k1, 100.0 * point.error))
        .filter(|(k1, _)| *k1 > 0.0)
        .collect();
    if points.len() < 2 || fit.parameters.k2 == 0.0 {
        return Ok(None);
    }
    // The steps of the check are wide beside the minimum: the line goes through the fit, unless that
    // is no minimum of E, as where the energy is limited or the loss is another.
    if points.iter().all(|(_, error)| fit.e_percent <= *error) {
        points.push((fit.parameters.k1, fit.e_percent));
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    let k1 = Axis::logarithmic(points.iter().map(|point| point.0), K1_DECADES);
    let errors = points.iter().map(|point| point.1).chain([fit.e_percent]);
    let error = Axis::logarithmic(errors, DECADES);
    let (Some(x), Some(y)) = (k1, error) else {
        return Ok(None);
    };
    let frame = Frame { x, y, area: WHOLE };
    Ok(Some(Figure {
        name: "profile-k1".to_owned(),
        caption: format!(
            "The lowest E over all other parameters at each k1 of the global check ({}). Mark: the \
             fit.",
            title.theory
        ),
        svg: drawn(|canvas| draw(canvas, &frame, title, &points, fit))?,
    }))
}

fn draw(
    canvas: &mut Canvas,
    frame: &Frame,
    title: &Title,
    points: &[(f64, f64)],
    fit: &Fit,
) -> Result<(), PlotError> {
    draw_title(canvas, title)?;
    frame.draw(canvas, "width k1 of the facet distribution", "lowest E / %")?;
    let (k1, error) = (fit.parameters.k1, fit.e_percent);
    if frame.x.contains(k1) {
        frame.upright_dashes(canvas, k1, &POINTED_OUT)?;
    }
    frame.line(canvas, points.iter().copied(), &MAIN, 1.8)?;
    if frame.contains((k1, error)) {
        canvas.mark(frame.place((k1, error)), MarkShape::Circle, POINTED_OUT)?;
    }
    let mut legend = Legend::default();
    legend.add(Key::Line(MAIN), "lowest E at k1");
    legend.add(Key::Mark(POINTED_OUT), &format!("fit: k1 = {}", short(k1)));
    legend.draw(canvas)
}
