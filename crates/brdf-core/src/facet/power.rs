//! The paper's distribution with a free exponent.

use std::f64::consts::{PI, TAU};

use super::distribution::FacetDistribution;
use crate::direction_pair::HalfVector;
use crate::numeric::{Elementary as _, Ratio, Real, integrate};

/// Eq. (2) with the exponent p:
///
/// ```text
/// f(alpha) / f(0) = cos alpha (k1^2 / (sin^2 alpha + k1^2 cos^2 alpha))^p
/// ```
///
/// p = 1 is the paper's distribution and p = 2 is GGX times cos alpha. For p to infinity with
/// k1^2 = p m^2 the limit is exp(-tan^2 alpha / m^2) at small tilts. A larger p has a shorter tail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Power {
    k1: f64,
    k1_squared: f64,
    p: f64,
}

impl Power {
    /// The distribution of width k1 > 0 and exponent p > 0, which are not checked.
    pub fn new(k1: f64, p: f64) -> Self {
        Self {
            k1,
            k1_squared: k1 * k1,
            p,
        }
    }

    /// ln(k1^2 / (sin^2 alpha + k1^2 cos^2 alpha)), accurate also next to the peak, where the
    /// fraction is evaluated as 1 + (k1^2 - 1) tan^2 alpha / (tan^2 alpha + k1^2).
    #[inline]
    fn logarithm<R: Real>(&self, half: &HalfVector<R>) -> R {
        let k1_squared = R::of(self.k1_squared);
        let denominator = k1_squared.mul_add(half.along * half.along, half.across2);
        let excess = R::of(self.k1_squared - 1.0) * (half.across2 / denominator);
        let fraction = k1_squared * half.length2 / denominator;
        let next_to_the_peak = excess.abs() < R::of(0.5);
        let (zero, one) = (R::of(0.0), R::of(1.0));
        let fraction = R::select(next_to_the_peak, one + excess, fraction);
        // The rounding error of 1 + excess.
        let rest = (excess - (fraction - one)) / fraction;
        fraction.ln() + R::select(next_to_the_peak, rest, zero)
    }
}

impl FacetDistribution for Power {
    fn k1(&self) -> f64 {
        self.k1
    }

    fn p(&self) -> f64 {
        self.p
    }

    #[inline]
    fn ratio<R: Real>(&self, half: &HalfVector<R>) -> Ratio<R> {
        Ratio {
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
        let half = HalfVector::from_tilt(tan2_alpha, sec_alpha);
        self.logarithm(&half) * self.ratio(&half).value()
    }

    /// The normalisation integral, 2 pi times that of f(alpha)/f(0) cos alpha sin alpha d alpha, by
    /// quadrature in u with tan alpha = w sinh u. w is min(k1, 1), or less if a large p narrows the
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

    /// With L = ln k1^2, s = 1 - p and t = tan^2 alpha, the fraction
    /// q = (k1^2 + t)/(k1^2 (1 + t)) goes from 1 to 1/k1^2. dq is proportional to dt / (1 + t)^2 and
    /// the density of t to q^(-p) / (1 + t)^2, so that u is linear in q^s:
    ///
    /// ```text
    /// q^s = 1 + u (e^(-s L) - 1),   q^s k1^(2s) = 1 + (1 - u)(e^(s L) - 1)
    /// tan^2 alpha = k1^2 (q - 1) / (1 - k1^2 q),   u/(1-u) at k1 = 1
    /// ```
    ///
    /// and ln q = -u L for p = 1. Each difference is evaluated from its own logarithm: ln q, and
    /// ln(k1^2 q), which is small for u next to 1.
    fn sample_tan2_alpha(&self, u: f64) -> f64 {
        let logarithm = self.k1_squared.ln();
        if logarithm == 0.0 {
            return u / (1.0 - u);
        }
        let s = 1.0 - self.p;
        let fraction = ln_1p_over(s, u * exp_m1_over(s, -logarithm));
        let rest = ln_1p_over(s, (1.0 - u) * exp_m1_over(s, logarithm));
        self.k1_squared * (fraction.exp_m1() / -rest.exp_m1())
    }

    /// f(alpha)/f(0) divided by its integral N over the hemisphere,
    ///
    /// ```text
    /// p(alpha) = f(alpha)/f(0) / N,   N = pi k1^(2p) (1 - k1^(2(1-p))) / ((1 - k1^2)(1 - p))
    /// ```
    ///
    /// with the limits N = pi k1^2 ln(k1^2) / (k1^2 - 1) at p = 1 and N = pi at k1 = 1.
    fn sampling_density(&self, tan2_alpha: f64, sec_alpha: f64) -> f64 {
        let logarithm = self.k1_squared.ln();
        let total = if logarithm == 0.0 {
            PI
        } else {
            let mean_power = exp_m1_over(1.0 - self.p, logarithm) / (self.k1_squared - 1.0);
            PI * (self.p * logarithm).exp() * mean_power
        };
        self.relative(tan2_alpha, sec_alpha) / total
    }
}

/// (e^(s x) - 1)/s, the integral of e^(s y) over y from 0 to x, which is x at s = 0.
fn exp_m1_over(s: f64, x: f64) -> f64 {
    if s == 0.0 { x } else { (s * x).exp_m1() / s }
}

/// ln(1 + s x)/s, the inverse of [`exp_m1_over`], which is x at s = 0.
fn ln_1p_over(s: f64, x: f64) -> f64 {
    if s == 0.0 { x } else { (s * x).ln_1p() / s }
}
