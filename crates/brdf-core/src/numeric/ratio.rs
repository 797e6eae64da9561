//! Ratios that are multiplied before they are divided.

use std::ops::Mul;

use super::real::Real;

/// A numerator over a denominator.
///
/// Each term of the model is returned in this form, so that the product of all terms needs one
/// division only. A division takes as long as ten multiplications.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratio<R> {
    /// The numerator.
    pub numerator: R,
    /// The denominator.
    pub denominator: R,
}

impl<R: Real> Ratio<R> {
    /// The numerator divided by the denominator.
    #[inline]
    pub fn value(self) -> R {
        self.numerator / self.denominator
    }
}

impl<R: Real> Mul for Ratio<R> {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Self {
            numerator: self.numerator * other.numerator,
            denominator: self.denominator * other.denominator,
        }
    }
}
