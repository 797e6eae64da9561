//! Whether a fitted model is physically possible.

use brdf_core::fresnel::Dielectric;
use brdf_core::{AnyBrdf, ModelParameters, ParameterError};
use serde::{Deserialize, Serialize};

use crate::model::Model;

/// Incidence angles at which the reflectance is listed, in degrees.
const PSI_DEG: [f64; 8] = [0.0, 15.0, 30.0, 45.0, 60.0, 70.0, 80.0, 85.0];

/// Relative tolerance of the listed reflectances.
const TOLERANCE: f64 = 1e-4;

/// Energy balance and facet reflectance of a fitted model.
///
/// The directional-hemispherical reflectance is rho(psi) = integral of f_r cos theta over the
/// hemisphere of views; a passive surface has rho <= 1 at every incidence. k2 = (pi/4) f(0) R(0)
/// implies the facet reflectance R(0) = 4 k2/(pi f(0)), where f(0) follows from the normalisation
/// of the facet distribution; a dielectric facet has R(0) = ((n - 1)/(n + 1))^2. (Eqs. 2 to 4 of Li,
/// Yan and Wu 2002.)
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Physics {
    /// rho at a list of incidence angles.
    pub reflectance: Vec<Reflectance>,
    /// The smallest incidence angle at which rho exceeds 1, in degrees; `None` where it does not up
    /// to 89 deg.
    pub violation_deg: Option<f64>,
    /// R(0) that k2 implies.
    pub implied_facet_reflectance: f64,
    /// R(0) that the refractive index implies.
    pub fresnel_reflectance: f64,
}

/// The reflectance at one incidence angle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reflectance {
    /// Incidence angle in degrees.
    pub psi_deg: f64,
    /// rho(psi).
    pub rho: f64,
}

impl Physics {
    /// The physics of a model with the given parameters.
    ///
    /// # Errors
    ///
    /// A parameter is outside of the domain of the model.
    pub fn of(model: Model, at: &ModelParameters) -> Result<Self, ParameterError> {
        let brdf = AnyBrdf::new(model.family(), at)?;
        let reflectance = PSI_DEG.into_iter().filter_map(|psi_deg| {
            let rho = brdf.hemispherical_reflectance(psi_deg.to_radians(), TOLERANCE);
            Some(Reflectance {
                psi_deg,
                rho: rho.ok()?,
            })
        });
        Ok(Self {
            reflectance: reflectance.collect(),
            violation_deg: violation_deg(&brdf),
            implied_facet_reflectance: brdf.implied_facet_reflectance(),
            fresnel_reflectance: Dielectric::new(at.n).normal_reflectance(),
        })
    }
}

/// The smallest incidence angle at which rho exceeds 1, in degrees; `None` where it does not up to
/// 89 deg.
pub(super) fn violation_deg(brdf: &AnyBrdf) -> Option<f64> {
    brdf.energy_violation_angle().map(f64::to_degrees)
}

#[cfg(test)]
mod tests {
    use brdf_core::Parameters;

    use super::*;

    /// Samples of the paper's Table 1, with values computed independently of this program.
    #[test]
    fn reflectances_of_published_samples_are_those_of_an_independent_computation() {
        let at = |k2, kd, k1, n| ModelParameters::three(Parameters::new(k2, kd, k1).unwrap(), n);
        let bright = Physics::of(Model::Three, &at(0.156, 0.584, 1.338, 1.56)).unwrap();
        for (psi_deg, expected) in [(0.0, 0.82), (60.0, 1.11), (70.0, 1.34), (80.0, 1.87)] {
            let mut all = bright.reflectance.iter();
            let rho = all.find(|r| r.psi_deg == psi_deg).unwrap().rho;
            assert!((rho - expected).abs() < 0.005, "{psi_deg}: {rho}");
        }
        assert!((45.0..60.0).contains(&bright.violation_deg.unwrap()));
        let dark = Physics::of(Model::Three, &at(1.211, 0.521, 0.071, 1.60)).unwrap();
        assert!((dark.implied_facet_reflectance - 0.1151).abs() < 5e-5);
        assert!((dark.fresnel_reflectance - 0.0533).abs() < 5e-5);
    }

    #[test]
    fn parameters_outside_of_the_domain_are_an_error() {
        let at = ModelParameters {
            k2: 0.1,
            kd: 0.1,
            k1: -1.0,
            n: 1.5,
            p: 1.0,
        };
        assert!(Physics::of(Model::Three, &at).is_err());
    }
}
