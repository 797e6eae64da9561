//! Quotients that are multiplied before they are divided.

use std::ops::Mul;

use crate::real::Real;

/// A numerator and a denominator, which a term of the model gives instead of a value: the terms are
/// multiplied, and one division is left for all of them. A division takes as long as ten
/// multiplications.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quotient<R> {
    /// Numerator.
    pub numerator: R,
    /// Denominator.
    pub denominator: R,
}

impl<R: Real> Quotient<R> {
    /// Numerator over denominator.
    #[inline]
    pub fn value(self) -> R {
        self.numerator / self.denominator
    }
}

impl<R: Real> Mul for Quotient<R> {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Self {
            numerator: self.numerator * other.numerator,
            denominator: self.denominator * other.denominator,
        }
    }
}
