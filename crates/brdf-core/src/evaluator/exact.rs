//! The model itself, in `f64`.

use super::vector::{Formula, evaluate, grid, native, rounded};
use super::{Evaluator, LengthError, Points, Precision};
use crate::AnyBrdf;
use crate::brdf::MicrofacetBrdf;
use crate::facet::FacetDistribution;
use crate::family::each;
use crate::fresnel::FresnelFactor;
use crate::pair::Pair;
use crate::real::Real;
use crate::shadowing::Shadowing;

/// The model as it is, in `f64`, at many points: the formula of
/// [`MicrofacetBrdf::value`](crate::MicrofacetBrdf::value), with another order of roundings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exact {
    brdf: AnyBrdf,
}

impl Exact {
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

/// Checks the lengths of the arrays of a grid.
pub(super) fn check_grid(
    psi: usize,
    theta: usize,
    phi: usize,
    out: usize,
) -> Result<(), LengthError> {
    let lengths = [(theta, phi), (psi * theta, out)];
    match lengths
        .into_iter()
        .find(|(expected, found)| expected != found)
    {
        Some((expected, found)) => Err(LengthError { expected, found }),
        None => Ok(()),
    }
}

impl Evaluator for Exact {
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

impl<F: FacetDistribution, S: Shadowing> Formula for MicrofacetBrdf<F, S> {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "as all that is vector code")]
    fn at<R: Real>(&self, pair: &Pair<R>) -> [R; 1] {
        let half = &pair.half;
        let fresnel = self.fresnel().quotient(half.length, half.length2);
        let value = self.with_fresnel(fresnel, pair.cos_psi, pair.cos_theta, half);
        [pair.if_above_surface(value)]
    }
}
