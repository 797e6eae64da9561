//! The squares of the sine and cosine of half angles, for single points in `f64`, with their rounding
//! errors carried.

#![expect(
    clippy::inline_always,
    reason = "a call costs as much as a third of the polynomial"
)]

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use super::carried::Carried;
use super::real::Primitive;
use super::trigonometry::exchanged_if;

/// The difference of pi/2 to its nearest `f64`.
const REST: f64 = f64::FRAC_PI_2[1];

/// The azimuth from which on the library reduces it. Below, turns are counted without an error.
const FAR: f64 = 1e9;

/// The coefficients of x^4, x^6, ... in sin^2 x.
const SQUARED_SINE: [f64; 10] = [
    -1.0 / 3.0,
    2.0 / 45.0,
    -1.0 / 315.0,
    2.0 / 14_175.0,
    -2.0 / 467_775.0,
    4.0 / 42_567_525.0,
    -1.0 / 638_512_875.0,
    2.0 / 97_692_469_875.0,
    -2.0 / 9_280_784_638_125.0,
    4.0 / 2_143_861_251_406_875.0,
];

/// sin^2 and cos^2 of half an angle, of which neither is a difference of nearly equal numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfAngle {
    pub(crate) sin2: Carried,
    pub(crate) cos2: Carried,
}

impl HalfAngle {
    /// Of the difference of two zenith angles in [0, pi/2].
    #[inline(always)]
    pub(crate) fn of_difference(psi: f64, theta: f64) -> Self {
        let sin2 = squared_sine(Carried::sum(psi, -theta).halved());
        Self {
            sin2,
            cos2: sin2.complement(),
        }
    }

    /// Of the sum of two zenith angles in [0, pi/2].
    #[inline(always)]
    pub(crate) fn of_sum(psi: f64, theta: f64) -> Self {
        let half = Carried::sum(psi, theta).halved();
        let beyond = half.value() > FRAC_PI_4;
        Self::shifted(half, f64::from(u8::from(beyond)), beyond)
    }

    /// Of an azimuth, whose half is in [0, pi]. `backward` adds pi to the azimuth.
    #[inline(always)]
    pub(crate) fn of_azimuth(half: Carried, backward: bool) -> Self {
        let beyond = [FRAC_PI_4, 3.0 * FRAC_PI_4].map(|limit| half.value() > limit);
        let quarters = beyond.map(|beyond| f64::from(u8::from(beyond)));
        let exchanged = beyond[0] ^ beyond[1] ^ backward;
        Self::shifted(half, quarters[0] + quarters[1], exchanged)
    }

    /// Of twice an angle within pi/4 of a multiple of pi/2.
    #[inline(always)]
    fn shifted(angle: Carried, multiple: f64, exchanged: bool) -> Self {
        // The first difference is exact.
        let shifted = angle.value() - multiple * FRAC_PI_2;
        let square = squared_sine(Carried::sum(shifted, angle.rest() - multiple * REST));
        let other = square.complement();
        let (sin2, cos2) = exchanged_carried(exchanged, square, other);
        Self { sin2, cos2 }
    }
}

#[inline(always)]
fn exchanged_carried(exchange: bool, a: Carried, b: Carried) -> (Carried, Carried) {
    let (a_value, b_value) = exchanged_if(exchange, a.value(), b.value());
    let (a_rest, b_rest) = exchanged_if(exchange, a.rest(), b.rest());
    (
        Carried::from_parts(a_value, a_rest),
        Carried::from_parts(b_value, b_rest),
    )
}

/// Half of the azimuth's magnitude.
#[inline(always)]
pub(crate) fn half_of_azimuth(phi: f64) -> Carried {
    if phi.abs() <= TAU {
        return Carried::from_parts(0.5 * phi.abs(), 0.0);
    }
    half_of_far_azimuth(phi.abs())
}

/// Half of an azimuth beyond a turn, with the same squares of sine and cosine.
#[cold]
#[inline(never)]
fn half_of_far_azimuth(phi: f64) -> Carried {
    if phi > FAR {
        let (sin, cos) = libm::sincos(0.5 * phi);
        return Carried::from_parts(libm::atan2(sin.abs(), cos.abs()), 0.0);
    }
    // A remainder has no error. Each turn lacks four times the rest of pi/2.
    let remainder = phi % TAU;
    let turns = ((phi - remainder) / TAU).round();
    let half = Carried::sum(0.5 * remainder, -2.0 * turns * REST);
    let sign = 1.0_f64.copysign(half.value());
    Carried::from_parts(sign * half.value(), sign * half.rest())
}

/// sin^2 x for |x| <= pi/4.
#[inline(always)]
fn squared_sine(x: Carried) -> Carried {
    let square = Carried::product(x.value(), x.value());
    let z = square.value();
    // d sin^2 x = sin 2x dx. The rest of x is so small that two terms of sin 2x suffice.
    let shift = 2.0 * x.value() * x.rest() * (1.0 - 0.6 * z);
    Carried::new(z, (z * z) * series(z) + (square.rest() + shift))
}

/// The polynomial of [`SQUARED_SINE`] by Estrin's scheme, whose terms do not depend on each other.
#[inline(always)]
fn series(z: f64) -> f64 {
    let [c0, c1, c2, c3, c4, c5, c6, c7, c8, c9] = SQUARED_SINE;
    let z2 = z * z;
    let z4 = z2 * z2;
    let low = (c0 + c1 * z) + (c2 + c3 * z) * z2;
    let middle = (c4 + c5 * z) + (c6 + c7 * z) * z2;
    low + (middle + (c8 + c9 * z) * z4) * z4
}
