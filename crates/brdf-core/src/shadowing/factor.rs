//! The trait of all shadowing functions.

use crate::direction_pair::HalfVector;
use crate::geometry::Geometry;
use crate::numeric::{Ratio, Real};

/// The fraction G in [0, 1] of a facet that is visible from both the source and the viewer.
pub trait Shadowing: Copy + Send + Sync {
    /// Whether G depends on the width k1 of the facet distribution.
    const DEPENDS_ON_WIDTH: bool;

    /// G / (cos psi cos theta), which stays finite as one of the two angles approaches 90 deg.
    fn ratio<R: Real>(
        &self,
        cos_psi: R,
        cos_theta: R,
        cos_gamma: R,
        half: &HalfVector<R>,
    ) -> Ratio<R>;

    /// G / (cos psi cos theta) for one pair of directions.
    #[inline]
    fn over_cosines(&self, cos_psi: f64, cos_theta: f64, tan2_alpha: f64) -> f64 {
        let half = HalfVector::from_tilt(tan2_alpha, (1.0 + tan2_alpha).sqrt());
        let cos_gamma = 0.5 * (cos_psi + cos_theta) * half.length;
        self.ratio(cos_psi, cos_theta, cos_gamma, &half).value()
    }

    /// The derivative of G / (cos psi cos theta) with respect to k1.
    fn over_cosines_derivative_k1(&self, _cos_psi: f64, _cos_theta: f64, _tan2_alpha: f64) -> f64 {
        0.0
    }

    /// [`over_cosines`](Self::over_cosines) for a geometry.
    #[inline]
    fn over_cosines_at(&self, geometry: &Geometry) -> f64 {
        let (psi, theta) = (geometry.cos_psi, geometry.cos_theta);
        self.ratio(psi, theta, geometry.cos_gamma, &geometry.half())
            .value()
    }

    /// G for a geometry.
    fn factor(&self, geometry: &Geometry) -> f64 {
        self.over_cosines_at(geometry) * (geometry.cos_psi * geometry.cos_theta)
    }
}
