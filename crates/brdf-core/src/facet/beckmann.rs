//! Beckmann's distribution of facet normals.

use std::f64::consts::FRAC_1_PI;

use super::distribution::FacetDistribution;
use crate::direction_pair::HalfVector;
use crate::numeric::{Elementary as _, Ratio, Real};

/// The distribution of a surface with normally distributed slopes (Beckmann and Spizzichino 1963;
/// Cook and Torrance 1982, eq. 3). The width k1 is sqrt(2) times the root mean square slope:
///
/// ```text
/// f(alpha) / f(0) = exp(-tan^2 alpha / k1^2) / cos^4 alpha,   f(0) = 1 / (pi k1^2)
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beckmann {
    k1: f64,
    reciprocal_k1_squared: f64,
}

impl Beckmann {
    /// The distribution of width k1 > 0, which is not checked.
    pub fn new(k1: f64) -> Self {
        Self {
            k1,
            reciprocal_k1_squared: 1.0 / (k1 * k1),
        }
    }
}

impl FacetDistribution for Beckmann {
    fn k1(&self) -> f64 {
        self.k1
    }

    #[inline]
    fn ratio<R: Real>(&self, half: &HalfVector<R>) -> Ratio<R> {
        let along2 = half.along * half.along;
        let exponent = -half.tan2_alpha() * R::of(self.reciprocal_k1_squared);
        Ratio {
            numerator: exponent.exp() * (half.length2 * half.length2),
            denominator: along2 * along2,
        }
    }

    /// 2 tan^2 alpha / k1^3 times the value.
    #[inline]
    fn derivative_k1(&self, tan2_alpha: f64, sec_alpha: f64) -> f64 {
        let slope = 2.0 * tan2_alpha * self.reciprocal_k1_squared;
        slope * self.relative(tan2_alpha, sec_alpha) / self.k1
    }

    fn peak_density(&self) -> f64 {
        FRAC_1_PI * self.reciprocal_k1_squared
    }

    /// -k1^2 ln(1 - u) (Walter et al., EGSR 2007, eq. 28).
    fn sample_tan2_alpha(&self, u: f64) -> f64 {
        -(self.k1 * self.k1) * (-u).ln_1p()
    }

    /// p(alpha) = f(alpha) cos alpha.
    fn sampling_density(&self, tan2_alpha: f64, sec_alpha: f64) -> f64 {
        self.peak_density() * self.relative(tan2_alpha, sec_alpha) / sec_alpha
    }
}
