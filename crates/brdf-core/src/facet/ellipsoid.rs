//! The paper's distribution of facet normals, eq. (2).

use std::f64::consts::{PI, TAU};

use super::distribution::FacetDistribution;
use crate::direction_pair::HalfVector;
use crate::numeric::{Ratio, Real};

/// The paper's facet distribution, eq. (2) of Li, Yan and Wu (2002): in polar coordinates an
/// ellipsoid of revolution that touches the surface at the origin, where k1 is the ratio of its
/// transverse axis to its axis along the normal.
///
/// ```text
/// f(alpha) / f(0) = k1^2 cos alpha / (1 + (k1^2 - 1) cos^2 alpha)
///                 = sec alpha / (tan^2 alpha / k1^2 + 1)
/// ```
///
/// A small k1 is a narrow lobe, and k1 = 1 is the sphere cos alpha. The second form, which has no
/// difference, is the one that is evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid {
    k1: f64,
    k1_squared: f64,
    reciprocal_k1_squared: f64,
}

impl Ellipsoid {
    /// The distribution of width k1 > 0, which is not checked.
    ///
    /// [`Parameters`](crate::Parameters) checks it.
    pub fn new(k1: f64) -> Self {
        Self {
            k1,
            k1_squared: k1 * k1,
            reciprocal_k1_squared: reciprocal_square(k1),
        }
    }
}

/// 1/x^2, rounded once: the rounding errors of 1/x and of its square are carried.
fn reciprocal_square(x: f64) -> f64 {
    let reciprocal = 1.0 / x;
    let square = reciprocal * reciprocal;
    let missing = (-x).mul_add(reciprocal, 1.0);
    square + (reciprocal.mul_add(reciprocal, -square) + 2.0 * square * missing)
}

impl FacetDistribution for Ellipsoid {
    fn k1(&self) -> f64 {
        self.k1
    }

    #[inline]
    fn ratio<R: Real>(&self, half: &HalfVector<R>) -> Ratio<R> {
        let along2 = half.along * half.along;
        Ratio {
            numerator: half.along * half.length,
            denominator: half
                .across2
                .mul_add(R::of(self.reciprocal_k1_squared), along2),
        }
    }

    /// 2 k1 sec alpha tan^2 alpha / (tan^2 alpha + k1^2)^2.
    #[inline]
    fn derivative_k1(&self, tan2_alpha: f64, sec_alpha: f64) -> f64 {
        let denominator = tan2_alpha + self.k1_squared;
        2.0 * self.k1 * sec_alpha * (tan2_alpha / denominator) / denominator
    }

    /// With x = cos alpha the integral of x^2 k1^2 / (1 + (k1^2 - 1) x^2) over [0, 1] has a closed
    /// form. For |1 - k1^2| < 0.1, where the closed form loses digits, it is a series in 1 - k1^2.
    fn peak_density(&self) -> f64 {
        let deviation = 1.0 - self.k1_squared;
        let integral = if deviation.abs() < 0.1 {
            // The sum of k1^2 deviation^m / (2m + 3); 16 terms are exact to 1e-17.
            self.k1_squared
                * (0..16)
                    .rev()
                    .fold(0.0, |sum, m| sum * deviation + 1.0 / f64::from(2 * m + 3))
        } else if deviation > 0.0 {
            let root = deviation.sqrt();
            // artanh(root) = ln((1 + root)/k1), which avoids 1 - root.
            self.k1_squared / deviation * (((1.0 + root) / self.k1).ln() / root - 1.0)
        } else {
            let root = (-deviation).sqrt();
            self.k1_squared / -deviation * (1.0 - root.atan() / root)
        };
        1.0 / (TAU * integral)
    }

    /// With L = ln k1^2,
    ///
    /// ```text
    /// tan^2 alpha = k1^2 (1 - e^(-u L)) / (e^((1-u) L) - 1),   u/(1-u) at k1 = 1
    /// ```
    ///
    /// because the density of t = tan^2 alpha is proportional to 1/((1 + t)(k1^2 + t)), so that
    /// u L = ln(k1^2 (1 + t)/(k1^2 + t)).
    fn sample_tan2_alpha(&self, u: f64) -> f64 {
        let logarithm = self.k1_squared.ln();
        if logarithm == 0.0 {
            return u / (1.0 - u);
        }
        let above = -(-u * logarithm).exp_m1();
        self.k1_squared * above / ((1.0 - u) * logarithm).exp_m1()
    }

    /// f(alpha)/f(0) divided by its integral N over the hemisphere,
    ///
    /// ```text
    /// p(alpha) = f(alpha)/f(0) / N,   N = pi k1^2 ln(k1^2) / (k1^2 - 1),   pi at k1 = 1
    /// ```
    fn sampling_density(&self, tan2_alpha: f64, sec_alpha: f64) -> f64 {
        // The difference is exact next to k1 = 1, and the logarithm is that of the same number.
        let deviation = self.k1_squared - 1.0;
        let mean_logarithm = if deviation == 0.0 {
            1.0
        } else {
            self.k1_squared.ln() / deviation
        };
        let total = PI * self.k1_squared * mean_logarithm;
        self.relative(tan2_alpha, sec_alpha) / total
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn relative(k1: f64, alpha: f64) -> f64 {
        Ellipsoid::new(k1).relative(alpha.tan().powi(2), 1.0 / alpha.cos())
    }

    #[test]
    fn equals_the_printed_formula() {
        for k1 in [0.05_f64, 0.5, 1.0, 1.338, 7.0] {
            for alpha in [0.0_f64, 0.1, 0.8, 1.5] {
                let c = alpha.cos();
                let printed = k1 * k1 * c / (1.0 + (k1 * k1 - 1.0) * c * c);
                let value = relative(k1, alpha);
                assert!(
                    (value / printed - 1.0).abs() < 1e-12,
                    "{k1} {alpha}: {value} {printed}"
                );
            }
        }
    }

    #[test]
    fn k1_of_one_is_the_cosine() {
        for alpha in [0.0_f64, 0.4, 1.2] {
            assert!((relative(1.0, alpha) - alpha.cos()).abs() < 1e-15);
        }
    }

    #[test]
    fn the_peak_density_is_continuous_between_its_forms() {
        for deviation in [0.1_f64, -0.1] {
            let k1 = (1.0 - deviation).sqrt();
            let below = Ellipsoid::new(k1 * (1.0 - 1e-9)).peak_density();
            let above = Ellipsoid::new(k1 * (1.0 + 1e-9)).peak_density();
            assert!((below / above - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn published_samples_have_the_known_peak_density() {
        assert!((Ellipsoid::new(0.071).peak_density() - 13.393).abs() < 5e-4);
        assert!((Ellipsoid::new(0.166).peak_density() - 3.703).abs() < 5e-4);
    }

    proptest! {
        #[test]
        fn falls_with_the_tilt_for_narrow_lobes(k1 in 1e-3..1.0, alpha in 0.0..1.5, step in 1e-3..0.05) {
            prop_assert!(relative(k1, alpha + step) < relative(k1, alpha));
        }
    }
}
