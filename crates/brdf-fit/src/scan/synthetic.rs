//! Scans that are computed from the model, for examples and tests.

use brdf_core::{Geometry, Parameters, ThreeParameterBrdf};

use crate::scan::{Measurement, Measurements};

/// The incidence angles of a computed scan in degrees.
pub const PSI_DEG: [i32; 8] = [0, 10, 20, 30, 40, 50, 60, 70];

/// The smallest angle between view and source in degrees: closer, a detector blocks the light.
const BLOCKED_DEG: i32 = 5;

/// A noise-free scan of the model in the plane of incidence: psi = 0, 10, ... 70 deg,
/// theta = -80, -75, ... 80 deg, no reading within 5 deg of the source.
///
/// The scan is empty if the parameters or n are outside the domain of the model.
pub fn scan(parameters: Parameters, n: f64) -> Measurements {
    let Ok(brdf) = ThreeParameterBrdf::new(parameters, n) else {
        return Measurements::default();
    };
    let angles = PSI_DEG.into_iter().flat_map(|psi_deg| {
        let away = move |theta_deg: &i32| (theta_deg - psi_deg).abs() >= BLOCKED_DEG;
        (-80..=80)
            .step_by(5)
            .filter(away)
            .map(move |theta_deg| (psi_deg, theta_deg))
    });
    let readings = angles.filter_map(|(psi_deg, theta_deg)| {
        let psi = f64::from(psi_deg).to_radians();
        let theta = f64::from(theta_deg).to_radians();
        let brdf = brdf.value(&Geometry::in_plane(psi, theta).ok()?);
        Some(Measurement {
            wavelength_um: None,
            psi,
            theta,
            phi: 0.0,
            brdf,
            sigma: None,
        })
    });
    Measurements {
        source: "computed from the model".to_owned(),
        readings: readings.collect(),
        ..Measurements::default()
    }
}
