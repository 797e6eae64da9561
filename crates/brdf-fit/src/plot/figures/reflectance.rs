//! Hemispherical reflectance over the incidence angle, and where it is more than there is light.

use brdf_core::AnyBrdf;

use crate::plot::axis::Axis;
use crate::plot::canvas::{Canvas, drawn};
use crate::plot::error::PlotError;
use crate::plot::figure::Figure;
use crate::plot::frame::{Frame, Key, Legend, WHOLE, draw_title};
use crate::plot::style::{INK, MAIN, POINTED_OUT};
use crate::plot::title::{Title, short};
use crate::stages::Fit;

/// The figure ends here, in degrees, as the energy check does.
const LAST_DEG: u32 = 89;

/// Relative tolerance of the reflectances: far less than the width of the line.
const TOLERANCE: f64 = 1e-3;

/// Below this the level 1 would squeeze the curve to the foot of the figure.
const ONE_IN_SIGHT: f64 = 0.3;

/// What the figure shows.
struct Shown {
    /// psi in degrees and rho.
    rho: Vec<(f64, f64)>,
    kd: f64,
    /// Where rho passes 1, in degrees.
    violation_deg: Option<f64>,
    frame: Frame,
}

/// The hemispherical reflectance of a fit.
pub(super) fn figure(title: &Title, brdf: &AnyBrdf, fit: &Fit) -> Result<Figure, PlotError> {
    let rho = (0..=LAST_DEG)
        .map(|psi_deg| {
            let psi_deg = f64::from(psi_deg);
            let rho = brdf.hemispherical_reflectance(psi_deg.to_radians(), TOLERANCE)?;
            Ok((psi_deg, rho))
        })
        .collect::<Result<Vec<_>, PlotError>>()?;
    let kd = fit.parameters.kd;
    let largest = rho.iter().map(|(_, rho)| *rho).fold(kd, f64::max);
    let one = (largest > ONE_IN_SIGHT).then_some(1.0);
    let y = Axis::linear([largest].into_iter().chain(one));
    let shown = Shown {
        rho,
        kd,
        violation_deg: brdf.energy_violation_angle().map(f64::to_degrees),
        frame: Frame {
            x: Axis::fixed(0, 90, 10),
            y,
            area: WHOLE,
        },
    };
    Ok(Figure {
        name: "reflectance".to_owned(),
        caption: caption(title, &shown),
        svg: drawn(|canvas| draw(canvas, title, &shown))?,
    })
}

fn caption(title: &Title, shown: &Shown) -> String {
    let energy = shown.violation_deg.map_or_else(
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

fn tenths(deg: f64) -> f64 {
    (10.0 * deg).round() / 10.0
}

fn draw(canvas: &mut Canvas, title: &Title, shown: &Shown) -> Result<(), PlotError> {
    let frame = &shown.frame;
    draw_title(canvas, title)?;
    frame.draw(
        canvas,
        "incidence angle psi / deg",
        "hemispherical reflectance rho",
    )?;
    let mut legend = Legend::default();
    legend.add(Key::Line(MAIN), "rho(psi)");
    legend.add(Key::Dashes(INK), &format!("kD = {}", short(shown.kd)));
    frame.level_dashes(canvas, shown.kd, &INK)?;
    if frame.y.high() >= 1.0 {
        frame.level(canvas, 1.0, &POINTED_OUT)?;
        legend.add(Key::Line(POINTED_OUT), "rho = 1");
    } else {
        legend.add(Key::Note, "rho = 1 is above the axis");
    }
    if let Some(deg) = shown.violation_deg {
        frame.upright_dashes(canvas, deg, &POINTED_OUT)?;
        legend.add(
            Key::Dashes(POINTED_OUT),
            &format!("rho > 1 from {} deg", tenths(deg)),
        );
    }
    frame.line(canvas, shown.rho.iter().copied(), &MAIN, 1.8)?;
    legend.draw(canvas)
}
