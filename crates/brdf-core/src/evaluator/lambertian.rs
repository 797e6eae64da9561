//! The Lambertian part alone.

use std::f64::consts::FRAC_1_PI;

use super::formula::Formula;
use super::interface::{Evaluator, Precision};
use super::points::{LengthError, Points};
use super::vector::{evaluate, native};
use crate::direction_pair::DirectionPair;
use crate::numeric::Real;

/// The constant kD/pi everywhere above the surface, for surfaces without a specular part and for
/// ranges of angles in which the specular part is negligible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lambertian {
    kd: f64,
}

impl Lambertian {
    /// An evaluator of a surface with the diffuse weight kD.
    pub fn new(kd: f64) -> Self {
        Self { kd }
    }
}

impl Formula for Lambertian {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "it is part of vector code")]
    fn at<R: Real>(&self, pair: &DirectionPair<R>) -> R {
        pair.if_above_surface(R::of(self.kd * FRAC_1_PI))
    }
}

impl Evaluator for Lambertian {
    fn name(&self) -> &'static str {
        "lambertian"
    }

    fn precision(&self) -> Precision {
        Precision::Single
    }

    fn values(&self, points: &Points<f64>, out: &mut [f64]) -> Result<(), LengthError> {
        native(points, out, |points, out| evaluate(*self, points, out))
    }

    fn values_f32(&self, points: &Points<f32>, out: &mut [f32]) -> Result<(), LengthError> {
        native(points, out, |points, out| evaluate(*self, points, out))
    }
}
