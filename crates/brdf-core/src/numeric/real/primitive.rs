//! The constants and operations that differ between `f64` and `f32`.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// An element of an array: `f64` or `f32`.
pub trait Primitive:
    Copy
    + Debug
    + Default
    + PartialOrd
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// 1.5 times the smallest number above which all numbers are integers.
    const ROUNDING_SHIFT: Self;

    /// Whether the precision is that of `f32`, for which a series needs fewer terms.
    const SINGLE: bool;

    /// The nearest number to pi/2, and the difference of pi/2 to it.
    const FRAC_PI_2: [f64; 2];

    /// ln 2 as the sum of two numbers. The last bits of the first are 0, so that small multiples of it
    /// are exact.
    const LN_2: [f64; 2];

    /// The logarithm of the smallest normal number, rounded up to an integer.
    const LN_SMALLEST: f64;

    /// The nearest number to an `f64`.
    fn narrow(value: f64) -> Self;

    /// The number as `f64`.
    fn widen(self) -> f64;

    /// The square root.
    fn square_root(self) -> Self;

    /// The absolute value.
    fn magnitude(self) -> Self;

    /// self a + b, rounded once.
    fn fused_mul_add(self, a: Self, b: Self) -> Self;

    /// 2^k for an integer k within the exponents of normal numbers.
    fn power_of_two(k: Self) -> Self;

    /// (m, k) with self = m 2^k and m in [sqrt(1/2), sqrt(2)), for a positive normal number.
    fn mantissa_exponent(self) -> (Self, Self);
}

impl Primitive for f64 {
    const ROUNDING_SHIFT: Self = 6_755_399_441_055_744.0;
    const SINGLE: bool = false;
    const FRAC_PI_2: [f64; 2] = [std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17];
    const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];
    const LN_SMALLEST: f64 = -708.0;

    #[inline(always)]
    fn narrow(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn widen(self) -> f64 {
        self
    }

    #[inline(always)]
    fn square_root(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn fused_mul_add(self, a: Self, b: Self) -> Self {
        self.mul_add(a, b)
    }

    #[inline(always)]
    fn power_of_two(k: Self) -> Self {
        // The last bits of k + shift are those of k, and 1023 is the exponent of 1.
        let bits = (k + (Self::ROUNDING_SHIFT + 1023.0)).to_bits();
        Self::from_bits(bits << 52)
    }

    #[inline(always)]
    fn mantissa_exponent(self) -> (Self, Self) {
        // Relative to sqrt(1/2), the exponent bits are the integer part of the binary logarithm.
        const ROOT_HALF: u64 = std::f64::consts::FRAC_1_SQRT_2.to_bits();
        let offset = self.to_bits().wrapping_sub(ROOT_HALF);
        let mantissa = Self::from_bits((offset & 0x000f_ffff_ffff_ffff).wrapping_add(ROOT_HALF));
        // The exponent, -1022 to 1023, becomes the last bits of a number next to the shift.
        let biased = (offset >> 52).wrapping_add(1023) & 0xfff;
        let exponent = Self::from_bits(Self::ROUNDING_SHIFT.to_bits() + biased)
            - (Self::ROUNDING_SHIFT + 1023.0);
        (mantissa, exponent)
    }
}

impl Primitive for f32 {
    const ROUNDING_SHIFT: Self = 12_582_912.0;
    const SINGLE: bool = true;
    const FRAC_PI_2: [f64; 2] = [1.570_796_370_506_286_6, -4.371_139_000_186_243e-8];
    const LN_2: [f64; 2] = [0.693_145_751_953_125, 1.428_606_820_309_417_2e-6];
    const LN_SMALLEST: f64 = -87.0;

    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "rounds to the nearest `f32`"
    )]
    fn narrow(value: f64) -> Self {
        value as Self
    }

    #[inline(always)]
    fn widen(self) -> f64 {
        f64::from(self)
    }

    #[inline(always)]
    fn square_root(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn fused_mul_add(self, a: Self, b: Self) -> Self {
        self.mul_add(a, b)
    }

    #[inline(always)]
    fn power_of_two(k: Self) -> Self {
        let bits = (k + (Self::ROUNDING_SHIFT + 127.0)).to_bits();
        Self::from_bits(bits << 23)
    }

    #[inline(always)]
    fn mantissa_exponent(self) -> (Self, Self) {
        const ROOT_HALF: u32 = std::f32::consts::FRAC_1_SQRT_2.to_bits();
        let offset = self.to_bits().wrapping_sub(ROOT_HALF);
        let mantissa = Self::from_bits((offset & 0x007f_ffff).wrapping_add(ROOT_HALF));
        let biased = (offset >> 23).wrapping_add(127) & 0x1ff;
        let exponent = Self::from_bits(Self::ROUNDING_SHIFT.to_bits() + biased)
            - (Self::ROUNDING_SHIFT + 127.0);
        (mantissa, exponent)
    }
}
