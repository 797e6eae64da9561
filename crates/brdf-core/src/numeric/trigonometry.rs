//! Sine and cosine over the ranges that a geometry needs, without branches.
//!
//! The functions of a library accept any angle and branch on its magnitude, which costs more than
//! the polynomial if the angles are unordered. Here the ranges are known: zenith angles are in
//! [0, pi/2] and half of their difference is in [-pi/4, pi/4], where seven terms of the Taylor
//! series have a relative error below 1e-17.

#![expect(
    clippy::inline_always,
    reason = "a call costs as much as a third of the polynomial"
)]

use std::f64::consts::{FRAC_PI_4, TAU};

use super::real::{Primitive, Real, horner};

/// The coefficients of x^3, x^5, ... in sin x.
const SINE: [f64; 7] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    // Includes the next term as it is near the end of the range, the only place where it matters.
    -1.0 / 1_307_674_368_000.0 + 0.58 / 355_687_428_096_000.0,
];

/// The coefficients of x^4, x^6, ... in cos x.
const COSINE: [f64; 7] = [
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

/// sin x for |x| <= pi/4, to 1 ulp.
#[inline(always)]
pub(crate) fn sin_eighth<R: Real>(x: R) -> R {
    let z = x * x;
    (x * z).mul_add(series(z, SINE), x)
}

/// cos x for |x| <= pi/4, to 1 ulp.
#[inline(always)]
fn cos_eighth<R: Real>(x: R) -> R {
    let z = x * x;
    let one = R::of(1.0);
    let half = R::of(0.5) * z;
    let leading = one - half;
    // The rounding error of 1 - z/2 is added to the small terms.
    leading + (z * z).mul_add(series(z, COSINE), (one - leading) - half)
}

/// The polynomial by Estrin's scheme, whose terms do not depend on each other. Single precision
/// needs four of the terms.
#[inline(always)]
fn series<R: Real>(z: R, coefficients: [f64; 7]) -> R {
    if R::Stored::SINGLE {
        return horner(z, &coefficients[..4]);
    }
    let [c0, c1, c2, c3, c4, c5, c6] = coefficients.map(R::of);
    let z2 = z * z;
    let low = c3.mul_add(z, c2).mul_add(z2, c1.mul_add(z, c0));
    let high = c6.mul_add(z2, c5.mul_add(z, c4));
    high.mul_add(z2 * z2, low)
}

/// (sin x, cos x) for x in [0, pi/2], each to 1 ulp.
///
/// Beyond pi/4 they are the cosine and the sine of pi/2 - x. That difference is exact, apart from
/// the part of pi/2 that its nearest number lacks and that is added.
#[inline(always)]
pub(crate) fn sin_cos_quarter<R: Real>(x: R) -> (R, R) {
    let [right_angle, rest] = R::Stored::FRAC_PI_2.map(R::of);
    let beyond = x > R::of(FRAC_PI_4);
    let y = R::select(beyond, (right_angle - x) + rest, x);
    exchanged_if(beyond, sin_eighth(y), cos_eighth(y))
}

/// cos x for x in [0, pi/2], with a smaller error than that of [`sin_cos_quarter`].
#[inline(always)]
pub(crate) fn cos_quarter(x: f64) -> f64 {
    let [right_angle, rest] = f64::FRAC_PI_2;
    // Beyond pi/4 the difference is exact, and the rest is added to the small terms.
    let y = right_angle - x;
    let z = y * y;
    let from_sine = y + ((y * z) * series(z, SINE) + rest);
    f64::select(x > FRAC_PI_4, from_sine, cos_eighth(x))
}

/// (b, a) if `exchange` is true and (a, b) if not, without a branch.
#[inline(always)]
pub(crate) fn exchanged_if<R: Real>(exchange: bool, a: R, b: R) -> (R, R) {
    (R::select(exchange, b, a), R::select(exchange, a, b))
}

/// (sin^2(phi/2), cos^2(phi/2)) for phi in [-2 pi, 2 pi].
#[inline(always)]
pub(crate) fn sin2_cos2_of_half<R: Real>(phi: R) -> (R, R) {
    let half = R::of(0.5) * phi.abs();
    let [right_angle, rest] = R::Stored::FRAC_PI_2.map(R::of);
    // The squares are symmetric in the distance to the nearest of 0, pi/2 and pi.
    let about_right_angle = (half > R::of(FRAC_PI_4)) & (half <= R::of(3.0 * FRAC_PI_4));
    let from_right_angle = (half - right_angle) - rest;
    let from_straight = (half - (right_angle + right_angle)) - (rest + rest);
    let outside = R::select(half > right_angle, from_straight, half);
    let sin = sin_eighth(R::select(about_right_angle, from_right_angle, outside));
    let sin2 = sin * sin;
    // sin^2 is at most 1/2, so that 1 - sin^2 is accurate.
    exchanged_if(about_right_angle, sin2, R::of(1.0) - sin2)
}

/// [`sin2_cos2_of_half`] for any finite phi.
#[inline(always)]
pub(crate) fn sin2_cos2_of_any_half(phi: f64) -> (f64, f64) {
    if phi.abs() <= TAU {
        return sin2_cos2_of_half(phi);
    }
    let (sin, cos) = libm::sincos(0.5 * phi.abs());
    (sin * sin, cos * cos)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use proptest::prelude::*;

    use super::*;

    /// The difference of pi/2 to the nearest `f64`, half of the difference of pi to its nearest.
    const REST: f64 = f64::FRAC_PI_2[1];

    /// The error in units of the last place of the expected value.
    fn ulps(value: f64, expected: f64) -> f64 {
        let ulp = expected.abs().next_up() - expected.abs();
        (value - expected).abs() / ulp
    }

    #[test]
    fn the_ends_of_the_ranges_are_right() {
        assert_eq!(sin_cos_quarter(0.0_f64), (0.0, 1.0));
        assert_eq!(sin_cos_quarter(FRAC_PI_2), (1.0, REST));
        assert_eq!(sin2_cos2_of_any_half(0.0), (0.0, 1.0));
        assert_eq!(sin2_cos2_of_any_half(PI).0, 1.0);
        assert!(ulps(sin2_cos2_of_any_half(PI).1, REST.powi(2)) <= 1.0);
        assert!(ulps(sin2_cos2_of_any_half(2.0 * PI).0, (2.0 * REST).powi(2)) <= 1.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn agrees_with_the_library(x in 0.0..=FRAC_PI_2) {
            let (sin, cos) = sin_cos_quarter(x);
            prop_assert!(ulps(sin, libm::sin(x)) <= 1.0, "sin {}", x);
            prop_assert!(ulps(cos, libm::cos(x)) <= 1.0, "cos {}", x);
        }

        #[test]
        fn squares_agree_with_the_library_at_any_azimuth(phi in -20.0..20.0_f64) {
            let (sin2, cos2) = sin2_cos2_of_any_half(phi);
            let (sin, cos) = libm::sincos(0.5 * phi);
            prop_assert!(ulps(sin2, sin * sin) <= 4.0, "sin {}", phi);
            prop_assert!(ulps(cos2, cos * cos) <= 4.0, "cos {}", phi);
        }

        #[test]
        fn squares_agree_with_the_library_next_to_their_zeros(
            quarters in 0..3_u8, log_offset in -40.0..0.0_f64, sign in prop::bool::ANY,
        ) {
            let offset = if sign { log_offset.exp() } else { -log_offset.exp() };
            let phi = f64::from(quarters) * PI + offset;
            let (sin2, cos2) = sin2_cos2_of_any_half(phi);
            let (sin, cos) = libm::sincos(0.5 * phi);
            prop_assert!(ulps(sin2, sin * sin) <= 4.0, "sin {}", phi);
            prop_assert!(ulps(cos2, cos * cos) <= 4.0, "cos {}", phi);
        }
    }
}
