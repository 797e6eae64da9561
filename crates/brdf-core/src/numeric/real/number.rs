//! The trait of all numbers that the terms of the model are evaluated in.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::primitive::Primitive;

/// A number that the terms of the model are evaluated in: `f64`, `f32`, or [`Fused`](super::Fused)
/// of one of them, whose multiplication and addition are rounded once.
///
/// [`Elementary`](super::Elementary) adds the exponential function and the logarithm.
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The number's form in an array: `f64` or `f32`.
    type Stored: Primitive;

    /// The number of an array's element.
    fn load(stored: Self::Stored) -> Self;

    /// The number as an array's element.
    fn store(self) -> Self::Stored;

    /// self a + b, rounded once in [`Fused`](super::Fused) numbers and twice elsewhere.
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

    /// `then` if the condition is true and `otherwise` if not, without a branch.
    #[inline(always)]
    fn select(condition: bool, then: Self, otherwise: Self) -> Self {
        std::hint::select_unpredictable(condition, then, otherwise)
    }

    /// The nearest integer, for numbers below 2^21 in magnitude; ties go to the even integer.
    #[inline(always)]
    fn round(self) -> Self {
        // Adding 1.5 times the smallest number without a fraction rounds the fraction off.
        let shift = Self::load(Self::Stored::ROUNDING_SHIFT);
        (self + shift) - shift
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

/// The polynomial of at least one coefficient, the lowest power first, by Horner's scheme.
#[inline(always)]
pub(crate) fn horner<R: Real>(x: R, coefficients: &[f64]) -> R {
    let highest = R::of(coefficients[coefficients.len() - 1]);
    let others = coefficients[..coefficients.len() - 1].iter().rev();
    others.fold(highest, |sum, &c| sum.mul_add(x, R::of(c)))
}
