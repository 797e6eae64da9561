//! Sine and cosine over the ranges that a geometry needs, without branches.
//!
//! A library's functions serve any angle and choose their way by its size, which costs more than
//! the polynomial where the angles come in no order. Here the ranges are known: zenith angles in
//! [0, pi/2], half of their difference in [-pi/4, pi/4]; there seven terms of Taylor's series leave
//! less than 1e-17 of the result.

#![expect(
    clippy::inline_always,
    reason = "a call costs as much as a third of the polynomial"
)]

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::hint::select_unpredictable;

/// What the `f64` nearest to pi/2 lacks to it; half of what that nearest to pi lacks.
const FRAC_PI_2_REST: f64 = 6.123_233_995_736_766e-17;

/// sin x for |x| <= pi/4, to 1 ulp.
#[inline(always)]
pub(crate) fn sin_eighth(x: f64) -> f64 {
    let z = x * x;
    let series = [
        -1.0 / 6.0,
        1.0 / 120.0,
        -1.0 / 5_040.0,
        1.0 / 362_880.0,
        -1.0 / 39_916_800.0,
        1.0 / 6_227_020_800.0,
        // The next term as it is near the end of the range, where alone it matters.
        -1.0 / 1_307_674_368_000.0 + 0.58 / 355_687_428_096_000.0,
    ];
    x + x * z * polynomial(z, series)
}

/// cos x for |x| <= pi/4, to 1 ulp.
#[inline(always)]
fn cos_eighth(x: f64) -> f64 {
    let z = x * x;
    let series = [
        1.0 / 24.0,
        -1.0 / 720.0,
        1.0 / 40_320.0,
        -1.0 / 3_628_800.0,
        1.0 / 479_001_600.0,
        -1.0 / 87_178_291_200.0,
        1.0 / 20_922_789_888_000.0,
    ];
    let half = 0.5 * z;
    let leading = 1.0 - half;
    // The rounding of 1 - z/2 is carried into the small terms.
    leading + ((1.0 - leading - half) + z * z * polynomial(z, series))
}

/// Estrin's scheme: pairs, and pairs of pairs, so that the terms do not wait for each other.
#[inline(always)]
fn polynomial(z: f64, [c0, c1, c2, c3, c4, c5, c6]: [f64; 7]) -> f64 {
    let z2 = z * z;
    let low = (c0 + c1 * z) + (c2 + c3 * z) * z2;
    let high = (c4 + c5 * z) + c6 * z2;
    low + high * (z2 * z2)
}

/// (sin x, cos x) for x in [0, pi/2], each to 1 ulp of itself: beyond pi/4 they are the cosine and
/// sine of pi/2 - x, a difference that is exact but for the rest of pi/2.
#[inline(always)]
pub(crate) fn sin_cos_quarter(x: f64) -> (f64, f64) {
    let beyond = x > FRAC_PI_4;
    let y = select_unpredictable(beyond, (FRAC_PI_2 - x) + FRAC_PI_2_REST, x);
    let (sin, cos) = (sin_eighth(y), cos_eighth(y));
    exchanged_if(beyond, sin, cos)
}

/// (b, a) or (a, b), without a branch.
#[inline(always)]
pub(crate) fn exchanged_if(exchange: bool, a: f64, b: f64) -> (f64, f64) {
    (
        select_unpredictable(exchange, b, a),
        select_unpredictable(exchange, a, b),
    )
}

/// (sin^2(phi/2), cos^2(phi/2)) for any finite phi.
#[inline(always)]
pub(crate) fn sin2_cos2_of_half(phi: f64) -> (f64, f64) {
    let half = 0.5 * phi.abs();
    if half > PI {
        let (sin, cos) = libm::sincos(half);
        return (sin * sin, cos * cos);
    }
    // The distance to the nearest of 0, pi/2 and pi, in which the squares are symmetric.
    let about_right_angle = half > FRAC_PI_4 && half <= 3.0 * FRAC_PI_4;
    let from_right_angle = (half - FRAC_PI_2) - FRAC_PI_2_REST;
    let from_straight = (half - PI) - 2.0 * FRAC_PI_2_REST;
    let outside = select_unpredictable(half > FRAC_PI_2, from_straight, half);
    let y = select_unpredictable(about_right_angle, from_right_angle, outside);
    let sin = sin_eighth(y);
    let sin2 = sin * sin;
    // At most 1/2, so that 1 - sin^2 loses nothing.
    exchanged_if(about_right_angle, sin2, 1.0 - sin2)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Distance in units of the last place of the expected value.
    fn ulps(value: f64, expected: f64) -> f64 {
        let ulp = expected.abs().next_up() - expected.abs();
        (value - expected).abs() / ulp
    }

    #[test]
    fn the_ends_of_the_ranges_are_right() {
        assert_eq!(sin_cos_quarter(0.0), (0.0, 1.0));
        assert_eq!(sin_cos_quarter(FRAC_PI_2), (1.0, FRAC_PI_2_REST));
        assert_eq!(sin2_cos2_of_half(0.0), (0.0, 1.0));
        assert_eq!(sin2_cos2_of_half(PI).0, 1.0);
        assert!(ulps(sin2_cos2_of_half(PI).1, FRAC_PI_2_REST.powi(2)) <= 1.0);
        assert!(
            ulps(
                sin2_cos2_of_half(2.0 * PI).0,
                (2.0 * FRAC_PI_2_REST).powi(2)
            ) <= 1.0
        );
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
            let (sin2, cos2) = sin2_cos2_of_half(phi);
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
            let (sin2, cos2) = sin2_cos2_of_half(phi);
            let (sin, cos) = libm::sincos(0.5 * phi);
            prop_assert!(ulps(sin2, sin * sin) <= 4.0, "sin {}", phi);
            prop_assert!(ulps(cos2, cos * cos) <= 4.0, "cos {}", phi);
        }
    }
}
