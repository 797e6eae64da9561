//! Formulas of a pair of directions that are evaluated at many points.

use crate::brdf::MicrofacetBrdf;
use crate::direction_pair::DirectionPair;
use crate::facet::FacetDistribution;
use crate::fresnel::FresnelFactor as _;
use crate::numeric::Real;
use crate::shadowing::Shadowing;

/// A formula of a pair of directions.
///
/// It is copied into the loop, because values behind a reference would be loaded at each point.
pub(super) trait Formula: Copy + Send + Sync {
    /// The value in any kind of number.
    fn at<R: Real>(&self, pair: &DirectionPair<R>) -> R;
}

impl<F: FacetDistribution, S: Shadowing> Formula for MicrofacetBrdf<F, S> {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "it is part of vector code")]
    fn at<R: Real>(&self, pair: &DirectionPair<R>) -> R {
        let half = &pair.half;
        let fresnel = self.fresnel().ratio(half.length, half.length2);
        let (psi, theta) = (pair.cos_psi, pair.cos_theta);
        let value = self.with_fresnel(fresnel, psi, theta, half.length, half);
        pair.if_above_surface(value)
    }
}
