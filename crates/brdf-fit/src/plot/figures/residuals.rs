//! Residuals: measured value minus theory over the signed view angle.

use super::theory::draw_mirror_direction;
use crate::plot::axis::Axis;
use crate::plot::canvas::Canvas;
use crate::plot::figure::Figure;
use crate::plot::frame::Frame;
use crate::plot::legend::{Key, Legend};
use crate::plot::style::INK;
use crate::plot::styled::{Curves, Styled};
use crate::plot::svg::Paint;
use crate::plot::title::Title;
use crate::plot::view::View;

/// The name of the axis of residuals.
pub(super) const RESIDUAL: &str = "measured - theory / (1/sr)";

/// The figure of the residuals.
pub(super) fn figure(title: &Title, curves: &Curves) -> Figure {
    let frame = Frame::over_theta(axis(curves));
    Figure {
        name: "residuals".to_owned(),
        caption: format!(
            "Residuals: measured less theory ({}) over the view angle in the plane of incidence. \
             Dashed: mirror directions.{}",
            title.theory, curves.left_out
        ),
        svg: title.render(|canvas| {
            frame.draw(canvas, &curves.view.theta_name(), RESIDUAL);
            let all: Vec<&Styled> = curves.all.iter().collect();
            draw_residuals(canvas, &frame, &all, &curves.view);
            legend(curves).draw(canvas);
        }),
    }
}

/// The axis of the residuals with their error bars.
pub(super) fn axis(curves: &Curves) -> Axis {
    Axis::linear(curves.readings().flat_map(|reading| {
        let (residual, sigma) = (reading.residual(), reading.sigma.unwrap_or(0.0));
        [residual - sigma, residual + sigma]
    }))
}

fn legend(curves: &Curves) -> Legend {
    let mut legend = Legend::default();
    legend.add_curves(&curves.all, true);
    if curves.has_error_bars() {
        legend.add(Key::ErrorBar, "1 sigma of a reading");
    }
    legend.add(Key::Dashes(INK), "mirror direction");
    legend
}

/// The residuals within the axes.
pub(super) fn draw_residuals(canvas: &mut Canvas, frame: &Frame, curves: &[&Styled], view: &View) {
    frame.horizontal(canvas, 0.0, INK);
    for styled in curves {
        draw_mirror_direction(canvas, frame, styled, view);
        let readings = &styled.curve.readings;
        let line = readings.iter().map(|r| (r.theta_deg, r.residual()));
        let faint = Paint::translucent(styled.colour, 0.5);
        frame.line(canvas, line, faint, 1.0);
        for reading in readings {
            let (theta, residual) = (reading.theta_deg, reading.residual());
            if let Some(sigma) = reading.sigma {
                let ends = (residual - sigma, residual + sigma);
                frame.error_bar(canvas, theta, ends, styled.colour);
            }
            if frame.contains((theta, residual)) {
                let point = frame.point((theta, residual));
                canvas.mark(point, styled.mark, styled.colour);
            }
        }
    }
}
