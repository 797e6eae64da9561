//! Sums and products in `f64` whose rounding errors are carried.

#![expect(
    clippy::inline_always,
    reason = "a call costs as much as the operation"
)]

use std::ops::{Add, Mul};

/// A number in `f64` and a rest of a few units of its last place, which is to be added.
///
/// The errors of sums and products follow T. J. Dekker, "A floating-point technique for extending the
/// available precision", Numerische Mathematik 18, 224-242 (1971).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Carried {
    value: f64,
    rest: f64,
}

impl Carried {
    /// value + rest for a rest that is not larger than the value.
    #[inline(always)]
    pub(crate) fn new(value: f64, rest: f64) -> Self {
        let sum = value + rest;
        Self {
            value: sum,
            rest: rest - (sum - value),
        }
    }

    /// value + rest for a rest that is a few units of the value's last place.
    #[inline(always)]
    pub(crate) fn from_parts(value: f64, rest: f64) -> Self {
        Self { value, rest }
    }

    /// a + b without an error.
    #[inline(always)]
    pub(crate) fn sum(a: f64, b: f64) -> Self {
        let value = a + b;
        let b_part = value - a;
        Self {
            value,
            rest: (a - (value - b_part)) + (b - b_part),
        }
    }

    /// a b with an error of about 2^-78 of the product.
    #[inline(always)]
    pub(crate) fn product(a: f64, b: f64) -> Self {
        let value = a * b;
        let ((a, a_low), (b, b_low)) = (split(a), split(b));
        let rest = ((a * b - value) + (a * b_low + a_low * b)) + a_low * b_low;
        Self { value, rest }
    }

    /// The nearest `f64`.
    #[inline(always)]
    pub(crate) fn nearest(self) -> f64 {
        self.value + self.rest
    }

    /// The number without its rest.
    #[inline(always)]
    pub(crate) fn value(self) -> f64 {
        self.value
    }

    /// The rest.
    #[inline(always)]
    pub(crate) fn rest(self) -> f64 {
        self.rest
    }

    /// Half of the number.
    #[inline(always)]
    pub(crate) fn halved(self) -> Self {
        Self {
            value: 0.5 * self.value,
            rest: 0.5 * self.rest,
        }
    }

    /// Twice the number.
    #[inline(always)]
    pub(crate) fn doubled(self) -> Self {
        Self {
            value: 2.0 * self.value,
            rest: 2.0 * self.rest,
        }
    }

    /// The square, rounded once more than the nearest number.
    #[inline(always)]
    pub(crate) fn squared(self) -> f64 {
        self.value * (self.value + 2.0 * self.rest)
    }

    /// 1 less the number, which is at most 1/2 in magnitude.
    #[inline(always)]
    pub(crate) fn complement(self) -> Self {
        let value = 1.0 - self.value;
        Self {
            value,
            rest: ((1.0 - value) - self.value) - self.rest,
        }
    }
}

impl Add for Carried {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let sum = Self::sum(self.value, other.value);
        Self {
            value: sum.value,
            rest: sum.rest + (self.rest + other.rest),
        }
    }
}

impl Add<f64> for Carried {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: f64) -> Self {
        let sum = Self::sum(self.value, other);
        Self {
            value: sum.value,
            rest: sum.rest + self.rest,
        }
    }
}

impl Mul for Carried {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let product = Self::product(self.value, other.value);
        Self {
            value: product.value,
            rest: product.rest + (self.value * other.rest + self.rest * other.value),
        }
    }
}

/// A number as the sum of two of at most 27 bits each.
#[inline(always)]
fn split(a: f64) -> (f64, f64) {
    let high = f64::from_bits(a.to_bits() & (u64::MAX << 27));
    (high, a - high)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn errors_of_products_are_those_of_a_fused_operation(a in -10.0..10.0, b in -1e-9..1e-9) {
            let product = Carried::product(a, b);
            let error = f64::mul_add(a, b, -product.value());
            prop_assert!((product.rest() - error).abs() <= 1e-23 * product.value().abs());
        }

        #[test]
        fn sums_have_no_error(a in -1.0..1.0, log_b in -40.0..5.0_f64) {
            let sum = Carried::sum(a, log_b.exp());
            let back = Carried::sum(sum.value(), -a) + sum.rest();
            prop_assert_eq!(back.nearest(), log_b.exp());
        }
    }
}
