//! The exponential function and the logarithm, without a branch or a call, and with the same digits
//! on every machine.

use std::f64::consts::LOG2_E;

use super::number::{Real, horner};
use super::primitive::Primitive;

/// The exponential function and the logarithm of any [`Real`].
pub trait Elementary: Real {
    /// e^self, to 1 ulp; 0 below the range of normal numbers and infinity above it.
    #[inline(always)]
    fn exp(self) -> Self {
        exp(self)
    }

    /// The natural logarithm of a positive normal number, to 1 ulp.
    #[inline(always)]
    fn ln(self) -> Self {
        ln(self)
    }
}

impl<R: Real> Elementary for R {}

/// The coefficients 1/k! of e^x, k from 0.
const EXPONENTIAL: [f64; 14] = [
    1.0,
    1.0,
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];

/// The coefficients 2/(2k + 3) of 2 artanh s - 2 s, k from 0.
const LOGARITHM: [f64; 11] = [
    2.0 / 3.0,
    2.0 / 5.0,
    2.0 / 7.0,
    2.0 / 9.0,
    2.0 / 11.0,
    2.0 / 13.0,
    2.0 / 15.0,
    2.0 / 17.0,
    2.0 / 19.0,
    2.0 / 21.0,
    2.0 / 23.0,
];

/// e^x = 2^k e^r with |r| <= ln(2)/2.
#[inline(always)]
fn exp<R: Real>(x: R) -> R {
    let limit = R::of(R::Stored::LN_SMALLEST);
    let inside = x.max(limit).min(-limit);
    let k = (inside * R::of(LOG2_E)).round();
    let [high, low] = R::Stored::LN_2;
    let r = k.mul_add(R::of(-low), k.mul_add(R::of(-high), inside));
    let terms = if R::Stored::SINGLE { 8 } else { 14 };
    let power = R::load(R::Stored::power_of_two(k.store()));
    let value = horner(r, &EXPONENTIAL[..terms]) * power;
    let above = R::select(x > -limit, R::of(f64::INFINITY), value);
    R::select(x < limit, R::of(0.0), above)
}

/// ln x = k ln 2 + ln(1 + f) with x = 2^k (1 + f). With s = f/(2 + f), ln(1 + f) = 2 artanh s, whose
/// first term is 2 s = f - s f.
#[inline(always)]
fn ln<R: Real>(x: R) -> R {
    let (mantissa, exponent) = x.store().mantissa_exponent();
    let (m, k) = (R::load(mantissa), R::load(exponent));
    let f = m - R::of(1.0);
    let s = f / (R::of(2.0) + f);
    let z = s * s;
    let terms = if R::Stored::SINGLE { 5 } else { 11 };
    let rest = z * horner(z, &LOGARITHM[..terms]);
    let [high, low] = R::Stored::LN_2;
    let small = k.mul_add(R::of(low), s * (rest - f));
    k.mul_add(R::of(high), f + small)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::numeric::Fused;

    /// Relative error in units of the last place.
    fn error<R: Real>(value: R, exact: f64) -> f64 {
        let epsilon = if R::Stored::SINGLE {
            f64::from(f32::EPSILON)
        } else {
            f64::EPSILON
        };
        (value.store().widen() - exact).abs() / (exact.abs() * epsilon).max(f64::MIN_POSITIVE)
    }

    fn check<R: Real>(x: f64, limit: f64) {
        let argument = R::of(x);
        let x = argument.store().widen();
        assert!(error(exp(argument), libm::exp(x)) <= limit, "exp {x}");
        let positive = R::of(x.abs() + 1e-3);
        let y = positive.store().widen();
        assert!(error(ln(positive), libm::log(y)) <= limit, "ln {y}");
    }

    #[test]
    fn the_ends_are_right() {
        assert_eq!(exp(0.0_f64), 1.0);
        assert_eq!(exp(-1e4_f64), 0.0);
        assert_eq!(exp(1e4_f64), f64::INFINITY);
        assert_eq!(exp(-1e3_f32), 0.0);
        assert_eq!(ln(1.0_f64), 0.0);
        assert_eq!(ln(1.0_f32), 0.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn agrees_with_the_library(x in -86.0..86.0_f64, large in -700.0..700.0_f64) {
            check::<f64>(x, 1.5);
            check::<f64>(large, 1.5);
            check::<Fused<f64>>(large, 1.5);
            check::<f32>(x, 1.5);
            check::<Fused<f32>>(x, 1.5);
        }

        #[test]
        fn logarithms_next_to_one_keep_their_digits(log_x in -36.0..-0.7_f64) {
            for x in [log_x.exp(), -log_x.exp()] {
                prop_assert!(error(ln(1.0 + x), libm::log(1.0 + x)) <= 1.5, "{}", x);
            }
        }

        #[test]
        fn rounding_is_to_the_nearest(x in -1e6..1e6_f64) {
            prop_assert_eq!(Real::round(x), x.round_ties_even());
        }
    }
}
