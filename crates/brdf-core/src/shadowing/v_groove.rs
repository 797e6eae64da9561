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
/// It is evaluated as
///
/// ```text
/// G / (cos psi cos theta) = 1 / max(cos psi cos theta,
///                                   sec alpha cos gamma max(cos psi, cos theta) / 2)
/// ```
///
/// so that sec alpha and its rounding error cancel in the product with the paper's facet distribution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VGroove;

impl Shadowing for VGroove {
    const DEPENDS_ON_WIDTH: bool = false;

    #[inline]
    fn ratio<R: Real>(
        &self,
        cos_psi: R,
        cos_theta: R,
        cos_gamma: R,
        half: &HalfVector<R>,
    ) -> Ratio<R> {
        let open = half.along * (cos_psi * cos_theta);
        let blocked = half.length * (R::of(0.5) * cos_gamma * cos_psi.max(cos_theta));
        Ratio {
            numerator: half.along,
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
