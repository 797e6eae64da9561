//! The trait of all distributions of facet normals.

use crate::direction_pair::HalfVector;
use crate::numeric::{Ratio, Real};

/// A distribution of facet normals over their tilt alpha.
///
/// It is a function of tan^2 alpha and sec alpha, both of which a [`Geometry`](crate::Geometry)
/// provides without cancellation.
pub trait FacetDistribution: Copy + Send + Sync {
    /// The width k1 > 0, dimensionless.
    fn k1(&self) -> f64;

    /// f(alpha)/f(0), dimensionless, which is 1 at alpha = 0.
    fn ratio<R: Real>(&self, half: &HalfVector<R>) -> Ratio<R>;

    /// f(alpha)/f(0) at one tilt, dimensionless.
    #[inline]
    fn relative(&self, tan2_alpha: f64, sec_alpha: f64) -> f64 {
        let half = HalfVector::from_tilt(tan2_alpha, sec_alpha);
        self.ratio(&half).value()
    }

    /// The derivative of f(alpha)/f(0) with respect to k1.
    fn derivative_k1(&self, tan2_alpha: f64, sec_alpha: f64) -> f64;

    /// The derivative of f(alpha)/f(0) with respect to the exponent p; 0 for a distribution without
    /// one.
    fn derivative_p(&self, _tan2_alpha: f64, _sec_alpha: f64) -> f64 {
        0.0
    }

    /// The exponent p; 1 for a distribution without one.
    fn p(&self) -> f64 {
        1.0
    }

    /// f(0) in 1/sr, from the normalisation: the integral of f(alpha) cos alpha over the
    /// hemisphere of facet normals is 1.
    fn peak_density(&self) -> f64;

    /// Draws tan^2 alpha of a facet normal for [sampling](crate::sampling) from u in [0, 1).
    ///
    /// This is the inverse of the cumulative distribution function of
    /// [`sampling_density`](Self::sampling_density). It is 0 at u = 0 and increases with u:
    ///
    /// ```text
    /// u = integral of pi p(alpha) / (1 + t)^(3/2) dt over t = tan^2 alpha from 0 to the value
    /// ```
    ///
    /// since sin alpha d alpha = 1/2 dt / (1 + t)^(3/2).
    fn sample_tan2_alpha(&self, u: f64) -> f64;

    /// The density p(alpha) of the facet normals that are drawn, in 1/sr.
    ///
    /// It is proportional to f(alpha), or to f(alpha) cos alpha if only that has a closed inverse.
    /// Its integral over the hemisphere of facet normals is 1.
    fn sampling_density(&self, tan2_alpha: f64, sec_alpha: f64) -> f64;
}
