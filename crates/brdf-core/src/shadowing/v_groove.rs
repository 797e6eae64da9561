//! The V-groove factor of Torrance and Sparrow.

use super::factor::Shadowing;
use crate::direction_pair::HalfVector;
use crate::numeric::{Ratio, Real};

/// The V-groove factor of Torrance and Sparrow (JOSA 57, 1105, 1967), which the paper uses:
///
/// ```text
/// G = min(1, 2 cos alpha cos theta / cos gamma, 2 cos alpha cos psi / cos gamma)
/// ```
///
/// With the sum h of the two unit vectors, 2 cos alpha / cos gamma = `h_z` / cos^2 gamma and
/// cos^2 gamma = (`h_z` / (2 cos alpha))^2, so that
///
/// ```text
/// G / (cos psi cos theta) = 1 / max(cos psi cos theta,
///                                   h_z sec^2 alpha max(cos psi, cos theta) / 4)
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VGroove;

impl Shadowing for VGroove {
    const DEPENDS_ON_WIDTH: bool = false;

    #[inline]
    fn ratio<R: Real>(&self, cos_psi: R, cos_theta: R, half: &HalfVector<R>) -> Ratio<R> {
        let h_z = cos_psi + cos_theta;
        let along2 = half.along * half.along;
        let open = along2 * (cos_psi * cos_theta);
        let blocked = R::of(0.25) * h_z * half.length2 * cos_psi.max(cos_theta);
        Ratio {
            numerator: along2,
            denominator: open.max(blocked),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::Geometry;

    #[test]
    fn facets_are_unshadowed_in_the_mirror_direction() {
        for psi in [0.0, 0.6, 1.5] {
            let geometry = Geometry::in_plane(psi, -psi).unwrap();
            assert!((VGroove.factor(&geometry) - 1.0).abs() < 1e-15);
        }
    }

    proptest! {
        #[test]
        fn equals_the_piecewise_expression(
            psi in 0.0..1.5, theta in 0.0..1.5, phi in 0.0..6.3_f64,
        ) {
            let g = Geometry::new(psi, theta, phi).unwrap();
            let common = 2.0 / (g.sec_alpha() * g.cos_gamma());
            let expected = 1.0_f64.min(common * g.cos_theta()).min(common * g.cos_psi());
            prop_assert!((VGroove.factor(&g) - expected).abs() < 1e-12);
        }
    }
}
