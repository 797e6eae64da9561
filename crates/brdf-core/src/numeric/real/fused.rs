//! Numbers whose multiplication and addition are one operation.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::number::Real;
use super::primitive::Primitive;

/// A number whose [`mul_add`](Real::mul_add) is rounded once.
///
/// It is for processors with such an instruction; on others each `mul_add` is a slow call.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Fused<T>(T);

impl<T: Primitive> Real for Fused<T> {
    type Stored = T;

    #[inline(always)]
    fn load(stored: T) -> Self {
        Self(stored)
    }

    #[inline(always)]
    fn store(self) -> T {
        self.0
    }

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self(self.0.fused_mul_add(a.0, b.0))
    }
}

impl<T: Primitive> Add for Fused<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl<T: Primitive> Sub for Fused<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl<T: Primitive> Mul for Fused<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

impl<T: Primitive> Div for Fused<T> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
}

impl<T: Primitive> Neg for Fused<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}
