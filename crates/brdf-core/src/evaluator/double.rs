//! The model in `f64`.

use super::interface::{Evaluator, Precision};
use super::points::{LengthError, Points, check_grid};
use super::vector::{evaluate, grid, native, rounded};
use crate::family::{AnyBrdf, each};

/// The model as it is, in `f64`, at many points: the formula of
/// [`MicrofacetBrdf::value`](crate::MicrofacetBrdf::value), with another order of roundings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Double {
    brdf: AnyBrdf,
}

impl Double {
    /// An evaluator of the BRDF.
    pub fn new(brdf: AnyBrdf) -> Self {
        Self { brdf }
    }

    /// f_r at every view for each incidence, angles in radians, theta signed, phi one for each theta:
    /// out has all views of the first incidence, then all of the second. Costs less than as many
    /// single points, since the sines and cosines are worked out once.
    ///
    /// Errors: theta and phi of different lengths, or out not of the length of psi times theirs.
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
        "exact"
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
