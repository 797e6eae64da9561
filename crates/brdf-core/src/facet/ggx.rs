//! The GGX distribution of facet normals.

use std::f64::consts::FRAC_1_PI;

use super::distribution::FacetDistribution;
use crate::direction_pair::HalfVector;
use crate::numeric::{Ratio, Real};

/// The distribution of Trowbridge and Reitz (1975), called GGX by Walter et al. (EGSR 2007, eq. 33).
/// The width k1 is its roughness alpha_g:
///
/// ```text
/// f(alpha) / f(0) = (k1^2 / (sin^2 alpha + k1^2 cos^2 alpha))^2
///                 = (k1^2 sec^2 alpha / (tan^2 alpha + k1^2))^2,   f(0) = 1 / (pi k1^2)
/// ```
///
/// The paper's eq. (2) differs from it by the first power and the factor cos alpha.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ggx {
    k1: f64,
    k1_squared: f64,
}

impl Ggx {
    /// The distribution of width k1 > 0, which is not checked.
    pub fn new(k1: f64) -> Self {
        Self {
            k1,
            k1_squared: k1 * k1,
        }
    }
}

impl FacetDistribution for Ggx {
    fn k1(&self) -> f64 {
        self.k1
    }

    #[inline]
    fn ratio<R: Real>(&self, half: &HalfVector<R>) -> Ratio<R> {
        let k1_squared = R::of(self.k1_squared);
        let along2 = half.along * half.along;
        let above = k1_squared * half.length2;
        let below = k1_squared.mul_add(along2, half.across2);
        Ratio {
            numerator: above * above,
            denominator: below * below,
        }
    }

    /// 4 tan^2 alpha / (k1 (tan^2 alpha + k1^2)) times the value.
    #[inline]
    fn derivative_k1(&self, tan2_alpha: f64, sec_alpha: f64) -> f64 {
        let slope = tan2_alpha / (tan2_alpha + self.k1_squared);
        4.0 * slope * self.relative(tan2_alpha, sec_alpha) / self.k1
    }

    fn peak_density(&self) -> f64 {
        FRAC_1_PI / self.k1_squared
    }

    /// k1^2 u/(1-u) (Walter et al., EGSR 2007, eq. 35).
    fn sample_tan2_alpha(&self, u: f64) -> f64 {
        self.k1_squared * (u / (1.0 - u))
    }

    /// p(alpha) = f(alpha) cos alpha.
    fn sampling_density(&self, tan2_alpha: f64, sec_alpha: f64) -> f64 {
        self.peak_density() * self.relative(tan2_alpha, sec_alpha) / sec_alpha
    }
}
