//! Shadowing and masking of facets by their neighbours.

use crate::Geometry;

/// The V-groove factor of Torrance and Sparrow (JOSA 57, 1105, 1967), in [0, 1]:
///
/// ```text
/// G = min(1, 2 cos alpha cos theta / cos gamma, 2 cos alpha cos psi / cos gamma)
/// ```
pub fn v_groove(geometry: &Geometry) -> f64 {
    v_groove_over_cosines(geometry) * (geometry.cos_psi * geometry.cos_theta)
}

/// G / (cos psi cos theta), which stays finite where one of the two angles goes to 90 deg.
///
/// With h the sum of the two unit vectors, 2 cos alpha / cos gamma = `h_z` / cos^2 gamma, and
/// cos^2 gamma = (`h_z` / (2 cos alpha))^2, so that
///
/// ```text
/// G / (cos psi cos theta) = 1 / max(cos psi cos theta,
///                                   h_z sec^2 alpha max(cos psi, cos theta) / 4)
/// ```
#[inline]
pub fn v_groove_over_cosines(geometry: &Geometry) -> f64 {
    let (cos_psi, cos_theta) = (geometry.cos_psi, geometry.cos_theta);
    let h_z = cos_psi + cos_theta;
    let blocked = 0.25 * h_z * (1.0 + geometry.tan2_alpha) * cos_psi.max(cos_theta);
    1.0 / (cos_psi * cos_theta).max(blocked)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn nothing_is_hidden_in_the_mirror_direction() {
        for psi in [0.0, 0.6, 1.5] {
            let geometry = Geometry::in_plane(psi, -psi).unwrap();
            assert!((v_groove(&geometry) - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn stays_finite_at_grazing() {
        let geometry = Geometry::in_plane(0.3, FRAC_PI_2).unwrap();
        let value = v_groove_over_cosines(&geometry);
        assert!(value.is_finite() && value > 0.0);
        assert!(v_groove(&geometry) < 1e-15);
    }

    proptest! {
        #[test]
        fn equals_the_piecewise_expression(
            psi in 0.0..1.5, theta in 0.0..1.5, phi in 0.0..6.3_f64,
        ) {
            let g = Geometry::new(psi, theta, phi).unwrap();
            let common = 2.0 / (g.sec_alpha() * g.cos_gamma());
            let expected = 1.0_f64.min(common * g.cos_theta()).min(common * g.cos_psi());
            prop_assert!((v_groove(&g) - expected).abs() < 1e-12);
        }

        #[test]
        fn is_a_fraction(
            psi in 0.0..FRAC_PI_2, theta in 0.0..FRAC_PI_2, phi in 0.0..6.3_f64,
        ) {
            let value = v_groove(&Geometry::new(psi, theta, phi).unwrap());
            prop_assert!((0.0..=1.0 + 1e-15).contains(&value));
        }
    }
}
