//! What the theory leaves: measured less theory over the signed view angle.

use plotters::style::Color;

use super::axis::Axis;
use super::canvas::{Canvas, drawn};
use super::curves::Curves;
use super::frame::{Frame, Key, Legend, draw_title};
use super::style::{INK, colour, mark};
use super::theory::THETA;
use super::title::Title;
use super::{Figure, PlotError};

/// The residuals.
pub(super) fn figure(title: &Title, curves: &Curves) -> Result<Figure, PlotError> {
    let values = curves.readings().flat_map(|reading| {
        let sigma = reading.sigma.unwrap_or(0.0);
        [reading.residual - sigma, reading.residual + sigma]
    });
    let frame = Frame::over_theta(Axis::linear(values));
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

fn draw(
    canvas: &mut Canvas,
    frame: &Frame,
    title: &Title,
    curves: &Curves,
) -> Result<(), PlotError> {
    draw_title(canvas, title)?;
    frame.draw(canvas, THETA, "measured - theory / (1/sr)")?;
    frame.level(canvas, 0.0, &INK)?;
    let mut legend = Legend::default();
    for (i, curve) in curves.curves.iter().enumerate() {
        frame.upright_dashes(canvas, -curve.psi_deg, &colour(i).mix(0.6))?;
        let line = curve.readings.iter().map(|r| (r.theta_deg, r.residual));
        frame.line(canvas, line, &colour(i).mix(0.5), 1.0)?;
        for reading in &curve.readings {
            let (theta, residual) = (reading.theta_deg, reading.residual);
            if let Some(sigma) = reading.sigma {
                let ends = (residual - sigma, residual + sigma);
                frame.error_bar(canvas, theta, ends, colour(i))?;
            }
            if frame.contains((theta, residual)) {
                canvas.mark(frame.place((theta, residual)), mark(i), colour(i))?;
            }
        }
        legend.add(Key::Curve(i, true), &curve.name());
    }
    if curves.error_bars() {
        legend.add(Key::ErrorBar, "1 sigma of a reading");
    }
    legend.add(Key::Dashes(INK), "mirror direction");
    legend.draw(canvas)
}
