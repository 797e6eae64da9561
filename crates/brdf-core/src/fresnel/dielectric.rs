//! The Fresnel equations of a dielectric facet.

use super::factor::FresnelFactor;
use crate::geometry::Geometry;
use crate::numeric::{Carried, Ratio, Real};

/// The unpolarised Fresnel reflectance of a facet with the real refractive index n relative to air.
///
/// With c = cos gamma and g = sqrt((n-1)(n+1) + c^2) the Fresnel equations are
///
/// ```text
/// R(gamma)  = 1/2 ((g - c)/(g + c))^2 (1 + b^2),   b = (c (g + c) - 1) / (c (g - c) + 1)
/// R0(gamma) = R(gamma) / R(0) = 1/2 ((n + 1)/(g + c))^4 (1 + b^2)
/// ```
///
/// where (g - c)/(g + c) = (n^2-1)/(g + c)^2 is divided by (n-1)/(n+1). No term cancels, and n = 1
/// gives the limit instead of 0/0. R0 is 1 at gamma = 0 and approaches 1/R(0) at grazing.
///
/// Because the fourth power multiplies rounding errors by four, (g + c)^2 is evaluated as
/// n^2 - 1 + 2 c (g + c), which has fewer of them, and n^2 - 1 is rounded once. For one geometry the
/// same function is evaluated from c^2 and c g, with
///
/// ```text
/// R0(gamma) = N ((n + 1)^2/D)^2,   N = c^2 g^2 + (1 - c^2)^2,   D = (g + c)^2 (1 + c g - c^2)
/// ```
///
/// in which the rounding errors of D are carried. Next to n = 1, where R0 falls as 1/c^4, this has
/// half of the error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dielectric {
    n: f64,
    n2_minus_1: f64,
    /// (n + 1)^4 / 2.
    half_fourth_power: f64,
}

impl Dielectric {
    /// A facet of refractive index n >= 1, which is not checked.
    ///
    /// [`ThreeParameterBrdf::new`](crate::ThreeParameterBrdf::new) checks it.
    pub fn new(n: f64) -> Self {
        Self {
            n,
            n2_minus_1: n.mul_add(n, -1.0),
            half_fourth_power: 0.5 * fourth_power_of_successor(n),
        }
    }

    /// The refractive index n.
    pub fn n(&self) -> f64 {
        self.n
    }

    /// R(0) = ((n-1)/(n+1))^2, the reflectance at normal incidence on the facet, dimensionless.
    pub fn normal_reflectance(&self) -> f64 {
        ((self.n - 1.0) / (self.n + 1.0)).powi(2)
    }

    /// R(gamma) in [0, 1] for cos gamma in (0, 1], dimensionless.
    pub fn reflectance(&self, cos_gamma: f64) -> f64 {
        let terms = self.terms(cos_gamma, cos_gamma * cos_gamma);
        let ratio = self.n2_minus_1 / terms.square;
        0.5 * ratio * ratio * (1.0 + (terms.numerator / terms.denominator).powi(2))
    }

    /// R0(gamma) = R(gamma)/R(0) for cos gamma in (0, 1], dimensionless.
    #[inline]
    pub fn relative(&self, cos_gamma: f64) -> f64 {
        self.ratio(cos_gamma, cos_gamma * cos_gamma).value()
    }

    /// R0(gamma) of a geometry, which contains the square of the cosine too. The rounding errors in D,
    /// which the square doubles, are carried.
    #[inline]
    pub fn ratio_at(&self, geometry: &Geometry) -> Ratio<f64> {
        let cos2 = geometry.cos2_gamma;
        let product2 = cos2 * (self.n2_minus_1 + cos2);
        let product = product2.sqrt();
        let square = Carried::sum(cos2, product).doubled() + self.n2_minus_1;
        let above_one = Carried::sum(product, -cos2);
        let sin2 = 1.0 - cos2;
        Ratio {
            numerator: 2.0 * self.half_fourth_power * (sin2 * sin2 + product2),
            denominator: (square * (above_one + 1.0)).squared(),
        }
    }

    /// The derivative of R0(gamma) with respect to n, for cos gamma in (0, 1] and its sin^2 gamma.
    ///
    /// R0 is 1 at gamma = 0 for any n, so that the derivative has the factor sin^2 gamma, which
    /// cos gamma alone does not determine accurately.
    #[inline]
    pub fn relative_derivative_n(&self, cos_gamma: f64, sin2_gamma: f64) -> f64 {
        let (n, c) = (self.n, cos_gamma);
        let Terms {
            sum,
            square,
            numerator,
            denominator,
        } = self.terms(c, c * c);
        let g = sum - c;
        let ratio4 = 2.0 * self.half_fourth_power / (square * square);
        let b = numerator / denominator;
        // d ln((n+1)/(g+c)) / dn, with n - g c = sin^2 gamma (n^2 + c^2)/(n + g c).
        let ratio_log_slope =
            -sin2_gamma * (1.0 + (n * n + c * c) / (n + g * c)) / ((n + 1.0) * g * sum);
        let b_slope = 2.0 * c * n * sin2_gamma * (sum / denominator) * (sum / denominator) / g;
        ratio4 * (2.0 * ratio_log_slope * (1.0 + b * b) + b * b_slope)
    }

    #[inline]
    fn terms<R: Real>(&self, cos_gamma: R, cos2_gamma: R) -> Terms<R> {
        let n2_minus_1 = R::of(self.n2_minus_1);
        let sum = (n2_minus_1 + cos2_gamma).sqrt() + cos_gamma;
        let square = (cos_gamma + cos_gamma).mul_add(sum, n2_minus_1);
        Terms {
            sum,
            square,
            numerator: cos_gamma.mul_add(square, -sum),
            denominator: cos_gamma.mul_add(n2_minus_1, sum),
        }
    }
}

impl FresnelFactor for Dielectric {
    #[inline]
    fn ratio<R: Real>(&self, cos_gamma: R, cos2_gamma: R) -> Ratio<R> {
        let Terms {
            square,
            numerator,
            denominator,
            ..
        } = self.terms(cos_gamma, cos2_gamma);
        let below = square * denominator;
        Ratio {
            numerator: R::of(self.half_fourth_power)
                * numerator.mul_add(numerator, denominator * denominator),
            denominator: below * below,
        }
    }
}

/// The terms of the formula of [`Dielectric`], with c = cos gamma.
struct Terms<R> {
    /// g + c.
    sum: R,
    /// (g + c)^2 = n^2 - 1 + 2 c (g + c).
    square: R,
    /// The numerator of b multiplied by g + c: c (g + c)^2 - (g + c).
    numerator: R,
    /// The denominator of b multiplied by g + c: c (n^2 - 1) + g + c.
    denominator: R,
}

/// (n + 1)^4, rounded once: the rounding errors of n + 1 and of its square are carried.
fn fourth_power_of_successor(n: f64) -> f64 {
    let sum = n + 1.0;
    let square = sum * sum;
    let rest = sum.mul_add(sum, -square) + 2.0 * sum * ((n - sum) + 1.0);
    let fourth = square * square;
    fourth + (square.mul_add(square, -fourth) + 2.0 * square * rest)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The two polarisations by Snell's law, as in a textbook.
    fn textbook(n: f64, gamma: f64) -> f64 {
        let (c, t) = (gamma.cos(), (gamma.sin() / n).asin().cos());
        let s = (c - n * t) / (c + n * t);
        let p = (n * c - t) / (n * c + t);
        0.5 * (s * s + p * p)
    }

    #[test]
    fn equals_the_textbook_formula_where_that_is_accurate() {
        for n in [1.2, 1.5, 4.0] {
            for gamma in [0.0, 0.5, 1.0, 1.5_f64] {
                let value = Dielectric::new(n).reflectance(gamma.cos());
                assert!((value / textbook(n, gamma) - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn limits_at_normal_and_grazing_incidence() {
        for n in [1.0, 1.0 + 1e-14, 1.5, 1e5] {
            assert!((Dielectric::new(n).relative(1.0) - 1.0).abs() < 1e-15);
        }
        let glass = Dielectric::new(1.5);
        assert!((glass.normal_reflectance() - 0.04).abs() < 1e-16);
        assert!((glass.reflectance(1e-12) - 1.0).abs() < 1e-10);
        assert!((glass.relative(1e-12) - 25.0).abs() < 1e-8);
    }

    #[test]
    fn index_one_has_its_finite_limit() {
        for gamma in [0.0, 0.3, 1.0, 1.5_f64] {
            let exact = Dielectric::new(1.0).relative(gamma.cos());
            let near = Dielectric::new(1.0 + 1e-9).relative(gamma.cos());
            assert!(exact.is_finite());
            assert!((exact / near - 1.0).abs() < 1e-5, "{gamma}: {exact} {near}");
        }
    }

    #[test]
    fn one_polarisation_is_left_at_the_brewster_angle() {
        let n = 1.5_f64;
        let gamma = n.atan();
        let s = (n * n - 1.0) / (n * n + 1.0);
        let value = Dielectric::new(n).reflectance(gamma.cos());
        assert!((value - 0.5 * s * s).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn reflectance_is_a_fraction(n in 1.0..10.0, cos_gamma in 1e-6..1.0) {
            let value = Dielectric::new(n).reflectance(cos_gamma);
            prop_assert!((0.0..=1.0 + 1e-14).contains(&value));
        }

        #[test]
        fn derivative_is_that_of_the_value(n in 1.01..8.0, gamma in 0.0..1.5_f64) {
            let step = 1e-6 * n;
            let at = |n| Dielectric::new(n).relative(gamma.cos());
            let difference = (at(n + step) - at(n - step)) / (2.0 * step);
            let derivative =
                Dielectric::new(n).relative_derivative_n(gamma.cos(), gamma.sin().powi(2));
            prop_assert!((derivative - difference).abs() < 1e-7 * (1.0 + at(n) + derivative.abs()));
        }
    }
}
