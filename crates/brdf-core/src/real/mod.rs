//! The numbers that a formula is evaluated in.
//!
//! Every term of the model is written once, over [`Real`], and serves one point in `f64` and many
//! points at once in `f64` and `f32`: a loop over plain arithmetic, without a call or a branch,
//! becomes vector code. Users meet `f64` and `f32` only.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined does not become vector code"
)]

mod elementary;
mod fused;
mod primitive;

pub use fused::Fused;
pub use primitive::Primitive;

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number that the terms of the model are evaluated in: `f64`, `f32`, or one of them with multiply
/// and add in one rounding ([`Fused`]).
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// What stands in arrays: `f64` or `f32`.
    type Stored: Primitive;

    /// From an array.
    fn load(stored: Self::Stored) -> Self;

    /// Into an array.
    fn store(self) -> Self::Stored;

    /// self a + b, in one rounding where the number is made for that.
    fn mul_add(self, a: Self, b: Self) -> Self;

    /// The nearest number to a constant.
    #[inline(always)]
    fn of(constant: f64) -> Self {
        Self::load(Self::Stored::narrow(constant))
    }

    /// The square root.
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::load(self.store().square_root())
    }

    /// The absolute value.
    #[inline(always)]
    fn abs(self) -> Self {
        Self::load(self.store().magnitude())
    }

    /// The larger of two numbers, neither of them NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    /// The smaller of two numbers, neither of them NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    /// One of two numbers, without a branch.
    #[inline(always)]
    fn select(condition: bool, then: Self, otherwise: Self) -> Self {
        std::hint::select_unpredictable(condition, then, otherwise)
    }

    /// The whole number nearest to this one, which is below 2^21 in magnitude.
    #[inline(always)]
    fn round(self) -> Self {
        // Adding 1.5 times the first number without a fraction rounds the fraction off.
        let shift = Self::load(Self::Stored::ROUNDING_SHIFT);
        (self + shift) - shift
    }

    /// e^self; 0 below the range of normal numbers.
    #[inline(always)]
    fn exp(self) -> Self {
        elementary::exp(self)
    }

    /// The natural logarithm of a positive normal number.
    #[inline(always)]
    fn ln(self) -> Self {
        elementary::ln(self)
    }
}

impl<T: Primitive> Real for T {
    type Stored = T;

    #[inline(always)]
    fn load(stored: T) -> Self {
        stored
    }

    #[inline(always)]
    fn store(self) -> T {
        self
    }

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }
}

/// The polynomial of the coefficients, lowest first, by Horner's scheme. There is at least one.
#[inline(always)]
pub(crate) fn horner<R: Real>(x: R, coefficients: &[f64]) -> R {
    let highest = R::of(coefficients[coefficients.len() - 1]);
    let others = coefficients[..coefficients.len() - 1].iter().rev();
    others.fold(highest, |sum, &c| sum.mul_add(x, R::of(c)))
}
