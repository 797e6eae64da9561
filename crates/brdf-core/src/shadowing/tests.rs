//! Tests that all shadowing functions share.

use std::f64::consts::FRAC_PI_2;

use proptest::prelude::*;

use super::*;
use crate::Geometry;

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
