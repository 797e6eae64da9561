//! The separable Smith shadowing for the GGX distribution.

use super::factor::Shadowing;
use crate::direction_pair::HalfVector;
use crate::numeric::{Ratio, Real};

/// The separable Smith factor, in which source and view are independent, with the form for GGX (Walter
/// et al., EGSR 2007, eq. 34). Its roughness is the width k1 of the facet distribution:
///
/// ```text
/// G = G1(psi) G1(theta),   G1(x) = 2 / (1 + sqrt(1 + k1^2 tan^2 x))
/// G1(x) / cos x = 2 / (cos x + sqrt(cos^2 x + k1^2 sin^2 x))
/// ```
///
/// sin^2 x is computed from cos x. Where that loses digits, cos^2 x dominates the sum, and the
/// relative error is k1^2 2^-53.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smith {
    k1: f64,
    k1_squared: f64,
}

impl Smith {
    /// The factor for a width k1 > 0, which is not checked.
    pub fn new(k1: f64) -> Self {
        Self {
            k1,
            k1_squared: k1 * k1,
        }
    }

    /// k1^2 sin^2 x and sqrt(cos^2 x + k1^2 sin^2 x).
    #[inline]
    fn rough_and_root<R: Real>(&self, cosine: R) -> (R, R) {
        let one = R::of(1.0);
        let rough = R::of(self.k1_squared) * ((one - cosine) * (one + cosine));
        (rough, cosine.mul_add(cosine, rough).sqrt())
    }
}

impl Shadowing for Smith {
    const DEPENDS_ON_WIDTH: bool = true;

    #[inline]
    fn ratio<R: Real>(&self, cos_psi: R, cos_theta: R, _: R, _: &HalfVector<R>) -> Ratio<R> {
        let (_, source) = self.rough_and_root(cos_psi);
        let (_, view) = self.rough_and_root(cos_theta);
        Ratio {
            numerator: R::of(4.0),
            denominator: (cos_psi + source) * (cos_theta + view),
        }
    }

    #[inline]
    fn over_cosines_derivative_k1(&self, cos_psi: f64, cos_theta: f64, tan2_alpha: f64) -> f64 {
        // d ln(cos + root) / d ln k1 = rough / (root (cos + root)).
        let slope = |cosine: f64| {
            let (rough, root) = self.rough_and_root(cosine);
            rough / (root * (cosine + root))
        };
        let value = self.over_cosines(cos_psi, cos_theta, tan2_alpha);
        -(slope(cos_psi) + slope(cos_theta)) * value / self.k1
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn equals_the_textbook_formula(psi in 0.0..1.5_f64, theta in 0.0..1.5_f64, k1 in 0.01..10.0_f64) {
            let g1 = |x: f64| 2.0 / (1.0 + (1.0 + (k1 * x.tan()).powi(2)).sqrt());
            let expected = g1(psi) * g1(theta) / (psi.cos() * theta.cos());
            let value = Smith::new(k1).over_cosines(psi.cos(), theta.cos(), 0.0);
            prop_assert!((value / expected - 1.0).abs() < 1e-12);
        }

        #[test]
        fn derivative_is_that_of_the_value(
            psi in 0.0..1.5_f64, theta in 0.0..1.5_f64, log_k1 in -4.0..3.0_f64,
        ) {
            let k1 = log_k1.exp();
            let at = |k1| Smith::new(k1).over_cosines(psi.cos(), theta.cos(), 0.0);
            let step = 1e-5 * k1;
            let difference = (at(k1 + step) - at(k1 - step)) / (2.0 * step);
            let derivative = Smith::new(k1).over_cosines_derivative_k1(psi.cos(), theta.cos(), 0.0);
            prop_assert!((derivative - difference).abs() < 1e-7 * (at(k1) / k1).max(derivative.abs()));
        }
    }
}
