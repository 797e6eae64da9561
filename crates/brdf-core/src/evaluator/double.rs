//! The model in `f64`.

use super::interface::{Evaluator, Precision};
use super::points::{LengthError, Points, check_grid};
use super::vector::{evaluate, grid, native, rounded};
use crate::family::{AnyBrdf, each};

/// The model in `f64` at many points.
///
/// It is the formula of [`MicrofacetBrdf::value`](crate::MicrofacetBrdf::value) with another order of
/// roundings, from which it differs by a few units of the last place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Double {
    brdf: AnyBrdf,
}

impl Double {
    /// An evaluator of the BRDF.
    pub fn new(brdf: AnyBrdf) -> Self {
        Self { brdf }
    }

    /// f_r in 1/sr at every view for each incidence, with the incidences psi, the signed view angles
    /// theta and one azimuth phi for each theta, all in radians.
    ///
    /// `out` has the length of psi times that of theta and contains all views of the first incidence,
    /// then all of the second. Its values are NaN outside the domain. A grid takes less time than as
    /// many single points, because the sines and cosines are computed once.
    ///
    /// # Errors
    ///
    /// [`LengthError`] if theta and phi, or `out` and the grid, have different lengths.
    pub fn grid(
        &self,
        psi: &[f64],
        theta: &[f64],
        phi: &[f64],
        out: &mut [f64],
    ) -> Result<(), LengthError> {
        check_grid(psi.len(), theta.len(), phi.len(), out.len())?;
        each!(&self.brdf, brdf => grid(*brdf, psi, theta, phi, out));
        Ok(())
    }
}

impl Evaluator for Double {
    fn name(&self) -> &'static str {
        "f64"
    }

    fn precision(&self) -> Precision {
        Precision::Double
    }

    fn values(&self, points: &Points<f64>, out: &mut [f64]) -> Result<(), LengthError> {
        each!(&self.brdf, brdf => native(points, out, |points, out| evaluate(*brdf, points, out)))
    }

    fn values_f32(&self, points: &Points<f32>, out: &mut [f32]) -> Result<(), LengthError> {
        each!(&self.brdf, brdf => {
            rounded(points, out, |points: &Points<f64>, out| evaluate(*brdf, points, out))
        })
    }
}
