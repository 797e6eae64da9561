//! Shadowing and masking of facets by their neighbours.

mod smith;
mod v_groove;

pub use smith::Smith;
pub use v_groove::VGroove;

use crate::Geometry;
use crate::pair::HalfVector;
use crate::quotient::Quotient;
use crate::real::Real;

/// The fraction of a facet that both source and view see, G in [0, 1].
pub trait Shadowing: Copy + Send + Sync {
    /// Whether G depends on the width k1 of the facet distribution.
    const DEPENDS_ON_WIDTH: bool;

    /// G / (cos psi cos theta), which stays finite where one of the two angles goes to 90 deg.
    fn quotient<R: Real>(&self, cos_psi: R, cos_theta: R, half: &HalfVector<R>) -> Quotient<R>;

    /// G / (cos psi cos theta) of one pair of directions.
    #[inline]
    fn over_cosines(&self, cos_psi: f64, cos_theta: f64, tan2_alpha: f64) -> f64 {
        // The length itself is not needed.
        let half = HalfVector::of_tilt(tan2_alpha, f64::NAN);
        self.quotient(cos_psi, cos_theta, &half).value()
    }

    /// The derivative of G / (cos psi cos theta) by k1.
    fn over_cosines_derivative_k1(&self, _cos_psi: f64, _cos_theta: f64, _tan2_alpha: f64) -> f64 {
        0.0
    }

    /// [`over_cosines`](Self::over_cosines) of a geometry.
    #[inline]
    fn over_cosines_at(&self, geometry: &Geometry) -> f64 {
        self.over_cosines(geometry.cos_psi, geometry.cos_theta, geometry.tan2_alpha)
    }

    /// G of a geometry.
    fn factor(&self, geometry: &Geometry) -> f64 {
        self.over_cosines_at(geometry) * (geometry.cos_psi * geometry.cos_theta)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn stays_finite_at_grazing() {
        fn check(shadowing: impl Shadowing) {
            let geometry = Geometry::in_plane(0.3, FRAC_PI_2).unwrap();
            let value = shadowing.over_cosines_at(&geometry);
            assert!(value.is_finite() && value > 0.0);
            assert!(shadowing.factor(&geometry) < 1e-15);
        }
        check(VGroove);
        check(Smith::new(0.3));
    }

    proptest! {
        #[test]
        fn is_a_fraction(
            psi in 0.0..FRAC_PI_2, theta in 0.0..FRAC_PI_2, phi in 0.0..6.3_f64,
            log_k1 in -18.0..18.0_f64,
        ) {
            let geometry = Geometry::new(psi, theta, phi).unwrap();
            let unity = 0.0..=1.0 + 1e-15;
            prop_assert!(unity.contains(&VGroove.factor(&geometry)));
            prop_assert!(unity.contains(&Smith::new(log_k1.exp()).factor(&geometry)));
        }
    }
}
