//! A polynomial approximation of the Fresnel factor.

use std::f64::consts::PI;

use super::dielectric::Dielectric;
use super::factor::FresnelFactor;
use crate::numeric::{Ratio, Real, horner};

/// The number of terms of the Chebyshev series that are computed. A polynomial uses the first of them.
const TERMS: usize = 64;

/// The contribution of the rounding errors in the series to the bound.
const ROUNDING: f64 = 1e-10;

/// An approximation of R0(gamma) by a polynomial in 1 - cos gamma over a square, which needs no root
/// and no division of its own.
///
/// ```text
/// R0(gamma) ~ P(1 - c) / (c + 1/sqrt(n^2 + 1))^2,   c = cos gamma
/// ```
///
/// The square removes the pole of R0 at negative c, because of which a polynomial alone would need
/// twice as many terms. P is the start of the Chebyshev series over c in [least cos gamma, 1]. Its
/// error is at most the sum of the magnitudes of the other terms, which are computed too, so that the
/// [bound](Self::error_bound) of the relative error is computed and not estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FresnelPolynomial<const N: usize> {
    coefficients: [f64; N],
    from_pole: f64,
    error_bound: f64,
}

impl<const N: usize> FresnelPolynomial<N> {
    /// The polynomial with N coefficients for cos gamma in [`least_cos_gamma`, 1], where
    /// 0 <= `least_cos_gamma` < 1.
    pub fn new(fresnel: &Dielectric, least_cos_gamma: f64) -> Self {
        let range = 1.0 - least_cos_gamma;
        let from_pole = 1.0 / fresnel.n().hypot(1.0);
        let nodes: [f64; TERMS] = std::array::from_fn(|j| {
            let node = (PI * (j as f64 + 0.5) / TERMS as f64).cos();
            let c = 1.0 - 0.5 * range * (1.0 + node);
            fresnel.relative(c) * (c + from_pole).powi(2)
        });
        let series: [f64; TERMS] = std::array::from_fn(|k| {
            let term = |(j, value): (usize, &f64)| {
                value * (PI * k as f64 * (j as f64 + 0.5) / TERMS as f64).cos()
            };
            let sum: f64 = nodes.iter().enumerate().map(term).sum();
            sum * if k == 0 { 1.0 } else { 2.0 } / TERMS as f64
        });
        Self {
            coefficients: powers(&series, range),
            from_pole,
            error_bound: Self::bound(&series, &nodes),
        }
    }

    /// The sum of the magnitudes of the terms beyond the polynomial, relative to the least value.
    fn bound(series: &[f64; TERMS], nodes: &[f64; TERMS]) -> f64 {
        let left_out: f64 = series[N..].iter().map(|term| term.abs()).sum();
        // There is no bound if the series does not converge within the terms.
        let last: f64 = series[TERMS - 4..].iter().map(|term| term.abs()).sum();
        if last > 1e-3 * left_out.max(ROUNDING) {
            return f64::INFINITY;
        }
        let least = nodes.iter().copied().fold(f64::INFINITY, f64::min);
        left_out / (least - left_out).max(0.0) + ROUNDING
    }

    /// A bound of the relative error over the range of cos gamma; infinite if none is known.
    pub fn error_bound(&self) -> f64 {
        self.error_bound
    }
}

/// The first N terms of a Chebyshev series over [0, range] as coefficients of powers.
fn powers<const N: usize>(series: &[f64], range: f64) -> [f64; N] {
    let (mut before, mut current) = ([0.0; N], [0.0; N]);
    current[0] = 1.0;
    let mut sum = [0.0; N];
    for (k, term) in series[..N].iter().enumerate() {
        for (sum, coefficient) in sum.iter_mut().zip(current) {
            *sum += term * coefficient;
        }
        // T_(k+1) = 2 y T_k - T_(k-1), T_1 = y, with y = 2 x/range - 1.
        let factor = if k == 0 { 1.0 } else { 2.0 };
        let next = std::array::from_fn(|i| {
            let lower = if i == 0 { 0.0 } else { current[i - 1] };
            factor * (2.0 / range * lower - current[i]) - before[i]
        });
        (before, current) = (current, next);
    }
    sum
}

impl<const N: usize> FresnelFactor for FresnelPolynomial<N> {
    #[inline]
    fn ratio<R: Real>(&self, cos_gamma: R, _cos2_gamma: R) -> Ratio<R> {
        let from_pole = cos_gamma + R::of(self.from_pole);
        Ratio {
            numerator: horner(R::of(1.0) - cos_gamma, &self.coefficients),
            denominator: from_pole * from_pole,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn check<const N: usize>(n: f64, least: f64) -> f64 {
        let fresnel = Dielectric::new(n);
        let polynomial = FresnelPolynomial::<N>::new(&fresnel, least);
        let bound = polynomial.error_bound();
        for i in 0..=1000 {
            let c = least + (1.0 - least) * f64::from(i) / 1000.0;
            let c = c.max(1e-9);
            let exact = fresnel.relative(c);
            let error = (polynomial.ratio(c, c * c).value() / exact - 1.0).abs();
            assert!(error <= bound, "{n} {c}: {error} > {bound}");
        }
        bound
    }

    #[test]
    fn more_coefficients_have_a_smaller_error() {
        for n in [1.3, 1.5, 1.7, 4.0] {
            let bounds = [check::<5>(n, 0.0), check::<7>(n, 0.0), check::<11>(n, 0.0)];
            assert!(bounds.is_sorted_by(|a, b| a > b), "{n}: {bounds:?}");
        }
        println!("{:e} {:e}", check::<7>(1.5, 0.0), check::<11>(1.5, 0.0));
    }

    #[test]
    fn an_index_near_one_has_no_good_polynomial() {
        assert!(check::<11>(1.001, 0.0) > 0.1);
        assert!(check::<11>(1.0, 0.0) > 0.1);
    }

    proptest! {
        #[test]
        fn the_bound_holds(n in 1.0..6.0, least in 0.0..0.9) {
            check::<7>(n, least);
            check::<11>(n, least);
        }
    }
}
