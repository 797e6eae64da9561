//! Hemispherical reflectance over the incidence angle, and from where on it exceeds 1.

use brdf_core::AnyBrdf;

use crate::fit::Fit;
use crate::plot::axis::Axis;
use crate::plot::canvas::Canvas;
use crate::plot::error::PlotError;
use crate::plot::figure::Figure;
use crate::plot::frame::{Frame, WHOLE};
use crate::plot::legend::{Key, Legend};
use crate::plot::style::{EMPHASIS, INK, MAIN};
use crate::plot::text::four_digits;
use crate::plot::title::Title;

/// The last incidence angle in degrees, as in the energy check.
const LAST_DEG: u32 = 89;

/// Relative tolerance of the reflectances: far less than the width of the line.
const TOLERANCE: f64 = 1e-3;

/// Where the largest reflectance is less than this, an axis up to 1 would squeeze the curve.
const ONE_SHOWN_FROM: f64 = 0.3;

/// What the figure shows.
struct Reflectance {
    /// psi in degrees and rho.
    rho: Vec<(f64, f64)>,
    kd: f64,
    /// The incidence angle in degrees from which rho exceeds 1.
    violation_deg: Option<f64>,
    frame: Frame,
}

/// The hemispherical reflectance of a fit.
///
/// # Errors
///
/// Where brdf-core rejects an incidence angle.
pub(super) fn figure(title: &Title, brdf: &AnyBrdf, fit: &Fit) -> Result<Figure, PlotError> {
    let reflectance = Reflectance::of(brdf, fit)?;
    Ok(Figure {
        name: "reflectance".to_owned(),
        caption: reflectance.caption(title),
        svg: title.render(|canvas| reflectance.draw(canvas)),
    })
}

impl Reflectance {
    fn of(brdf: &AnyBrdf, fit: &Fit) -> Result<Self, PlotError> {
        let rho = (0..=LAST_DEG)
            .map(|psi_deg| {
                let psi_deg = f64::from(psi_deg);
                let rho = brdf.hemispherical_reflectance(psi_deg.to_radians(), TOLERANCE)?;
                Ok((psi_deg, rho))
            })
            .collect::<Result<Vec<_>, PlotError>>()?;
        let kd = fit.parameters.kd;
        let largest = rho.iter().map(|(_, rho)| *rho).fold(kd, f64::max);
        let one = (largest > ONE_SHOWN_FROM).then_some(1.0);
        Ok(Self {
            rho,
            kd,
            violation_deg: brdf.energy_violation_angle().map(f64::to_degrees),
            frame: Frame {
                x: Axis::fixed(0, 90, 10),
                y: Axis::linear([largest].into_iter().chain(one)),
                area: WHOLE,
            },
        })
    }

    fn caption(&self, title: &Title) -> String {
        let energy = self.violation_deg.map_or_else(
            || format!("It is not above 1 up to {LAST_DEG} deg."),
            |deg| {
                format!(
                    "From {} deg on it is above 1, which no real surface can do.",
                    tenths(deg)
                )
            },
        );
        format!(
            "Hemispherical reflectance rho over the incidence angle psi ({}), and its Lambertian part \
             kD. {energy}",
            title.theory
        )
    }

    fn draw(&self, canvas: &mut Canvas) {
        let frame = &self.frame;
        frame.draw(
            canvas,
            "incidence angle psi / deg",
            "hemispherical reflectance rho",
        );
        let mut legend = Legend::default();
        legend.add(Key::Line(MAIN), "rho(psi)");
        legend.add(Key::Dashes(INK), &format!("kD = {}", four_digits(self.kd)));
        frame.dashed_horizontal(canvas, self.kd, INK);
        if frame.y.high() >= 1.0 {
            frame.horizontal(canvas, 1.0, EMPHASIS);
            legend.add(Key::Line(EMPHASIS), "rho = 1");
        } else {
            legend.add(Key::Note, "rho = 1 is above the axis");
        }
        if let Some(deg) = self.violation_deg {
            frame.dashed_vertical(canvas, deg, EMPHASIS);
            let text = format!("rho > 1 from {} deg", tenths(deg));
            legend.add(Key::Dashes(EMPHASIS), &text);
        }
        frame.line(canvas, self.rho.iter().copied(), MAIN, 1.8);
        legend.draw(canvas);
    }
}

fn tenths(deg: f64) -> f64 {
    (10.0 * deg).round() / 10.0
}
