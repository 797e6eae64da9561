//! What the theory leaves: measured less theory over the signed view angle.

use plotters::style::Color;

use super::theory::draw_mirror;
use crate::plot::axis::Axis;
use crate::plot::canvas::{Canvas, drawn};
use crate::plot::curves::{Curves, Styled};
use crate::plot::error::PlotError;
use crate::plot::figure::Figure;
use crate::plot::frame::{Frame, Key, Legend, draw_title};
use crate::plot::style::{INK, ink};
use crate::plot::title::Title;
use crate::plot::view::View;

/// The name of the axis of residuals.
pub(super) const RESIDUAL: &str = "measured - theory / (1/sr)";

/// The residuals.
pub(super) fn figure(title: &Title, curves: &Curves) -> Result<Figure, PlotError> {
    let frame = Frame::over_theta(axis(curves));
    Ok(Figure {
        name: "residuals".to_owned(),
        caption: format!(
            "Residuals: measured less theory ({}) over the view angle in the plane of incidence. \
             Dashed: mirror directions.{}",
            title.theory, curves.left_out
        ),
        svg: drawn(|canvas| draw(canvas, &frame, title, curves))?,
    })
}

/// The axis of the residuals with their error bars.
pub(super) fn axis(curves: &Curves) -> Axis {
    Axis::linear(curves.readings().flat_map(|reading| {
        let (residual, sigma) = (reading.residual(), reading.sigma.unwrap_or(0.0));
        [residual - sigma, residual + sigma]
    }))
}

fn draw(
    canvas: &mut Canvas,
    frame: &Frame,
    title: &Title,
    curves: &Curves,
) -> Result<(), PlotError> {
    draw_title(canvas, title)?;
    frame.draw(canvas, &curves.view.theta_name(), RESIDUAL)?;
    let all: Vec<&Styled> = curves.all.iter().collect();
    draw_residuals(canvas, frame, &all, &curves.view)?;
    let mut legend = Legend::default();
    legend.add_curves(&curves.all, true);
    if curves.error_bars() {
        legend.add(Key::ErrorBar, "1 sigma of a reading");
    }
    legend.add(Key::Dashes(INK), "mirror direction");
    legend.draw(canvas)
}

/// The residuals within the axes.
pub(super) fn draw_residuals(
    canvas: &mut Canvas,
    frame: &Frame,
    curves: &[&Styled],
    view: &View,
) -> Result<(), PlotError> {
    frame.level(canvas, 0.0, &INK)?;
    for styled in curves {
        let colour = ink(styled.colour);
        draw_mirror(canvas, frame, styled, view)?;
        let readings = &styled.curve.readings;
        let line = readings.iter().map(|r| (r.theta_deg, r.residual()));
        frame.line(canvas, line, &colour.mix(0.5), 1.0)?;
        for reading in readings {
            let (theta, residual) = (reading.theta_deg, reading.residual());
            if let Some(sigma) = reading.sigma {
                let ends = (residual - sigma, residual + sigma);
                frame.error_bar(canvas, theta, ends, colour)?;
            }
            if frame.contains((theta, residual)) {
                canvas.mark(frame.place((theta, residual)), styled.mark, colour)?;
            }
        }
    }
    Ok(())
}
