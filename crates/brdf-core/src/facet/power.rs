//! The paper's distribution with its exponent set free.

use std::f64::consts::TAU;

use super::FacetDistribution;
use crate::pair::HalfVector;
use crate::quadrature::integrate;
use crate::quotient::Quotient;
use crate::real::Real;

/// The smallest and the largest exponent p. At the larger, the widest distribution, which rises
/// like k1^(2 p) towards grazing tilts, still is within the range of numbers.
pub const P_DOMAIN: (f64, f64) = (0.1, 16.0);

/// Eq. (2) with an exponent p on its denominator:
///
/// ```text
/// f(alpha) / f(0) = cos alpha (k1^2 / (sin^2 alpha + k1^2 cos^2 alpha))^p
/// ```
///
/// p = 1 is the paper's distribution, p = 2 is GGX times cos alpha, and p to infinity with
/// k1^2 = p m^2 goes to exp(-tan^2 alpha / m^2) for small tilts. The larger p, the shorter the tail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Power {
    k1: f64,
    k1_squared: f64,
    p: f64,
}

impl Power {
    /// The distribution of width k1 > 0 and exponent p > 0, which are not checked here.
    pub fn new(k1: f64, p: f64) -> Self {
        Self {
            k1,
            k1_squared: k1 * k1,
            p,
        }
    }

    /// The exponent p.
    pub fn p(&self) -> f64 {
        self.p
    }

    /// ln(k1^2 / (sin^2 alpha + k1^2 cos^2 alpha)), without a loss of digits next to the peak:
    /// the fraction is 1 + (k1^2 - 1) tan^2 alpha / (tan^2 alpha + k1^2).
    #[inline]
    fn logarithm<R: Real>(&self, half: &HalfVector<R>) -> R {
        let k1_squared = R::of(self.k1_squared);
        let denominator = k1_squared.mul_add(half.along * half.along, half.across2);
        let excess = R::of(self.k1_squared - 1.0) * (half.across2 / denominator);
        let fraction = k1_squared * half.length2 / denominator;
        let next_to_the_peak = excess.abs() < R::of(0.5);
        R::select(next_to_the_peak, excess.ln_1p(), fraction.ln())
    }
}

impl FacetDistribution for Power {
    fn k1(&self) -> f64 {
        self.k1
    }

    #[inline]
    fn quotient<R: Real>(&self, half: &HalfVector<R>) -> Quotient<R> {
        Quotient {
            numerator: (R::of(self.p) * self.logarithm(half)).exp() * half.along,
            denominator: half.length,
        }
    }

    /// 2 p tan^2 alpha / (k1 (tan^2 alpha + k1^2)) times the value.
    #[inline]
    fn derivative_k1(&self, tan2_alpha: f64, sec_alpha: f64) -> f64 {
        let slope = tan2_alpha / (tan2_alpha + self.k1_squared);
        2.0 * self.p * slope * self.relative(tan2_alpha, sec_alpha) / self.k1
    }

    /// The logarithm of the fraction times the value.
    #[inline]
    fn derivative_p(&self, tan2_alpha: f64, sec_alpha: f64) -> f64 {
        let half = HalfVector::of_tilt(tan2_alpha, sec_alpha);
        self.logarithm(&half) * self.quotient(&half).value()
    }

    /// The normalisation integral, 2 pi times that of f(alpha)/f(0) cos alpha sin alpha d alpha, by
    /// quadrature in u, tan alpha = w sinh u: w is min(k1, 1), or less where a large p narrows the
    /// peak.
    fn peak_density(&self) -> f64 {
        let width = (self.k1 / self.p.max(1.0).sqrt()).min(1.0);
        let ring = |u: f64| {
            let (sinh, cosh) = (u.sinh(), u.cosh());
            let t = (width * sinh).powi(2);
            let sec = (1.0 + t).sqrt();
            // cos alpha sin alpha d alpha = 1/2 dt / (1 + t)^2.
            self.relative(t, sec) * width * width * sinh * cosh / (1.0 + t).powi(2)
        };
        let end = (1e6 * self.k1.max(1.0) / width).asinh();
        let breaks = std::array::from_fn::<f64, 9, _>(|i| end * (i as f64 / 8.0));
        1.0 / (TAU * integrate(&ring, breaks, 1e-10))
    }
}
