//! The interface that all evaluators share.

use std::fmt::Debug;

use super::points::{LengthError, Points};

/// The numbers that an evaluator works in; arrays of those it takes without a conversion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// `f64`.
    Double,
    /// `f32`.
    Single,
}

/// A way to evaluate one BRDF, f_r in 1/sr.
///
/// Where the points or the values are of another precision than the evaluator works in, they are
/// rounded: the value is that of the rounded point.
pub trait Evaluator: Debug + Send + Sync {
    /// What it is called.
    fn name(&self) -> &'static str;

    /// The numbers that it works in.
    fn precision(&self) -> Precision;

    /// The memory that it needs beside its parameters, in bytes.
    fn bytes(&self) -> usize {
        0
    }

    /// f_r at each of the points.
    ///
    /// Errors: arrays of different lengths.
    fn values(&self, points: &Points<f64>, out: &mut [f64]) -> Result<(), LengthError>;

    /// f_r at each of the points, in arrays of `f32`.
    ///
    /// Errors: arrays of different lengths.
    fn values_f32(&self, points: &Points<f32>, out: &mut [f32]) -> Result<(), LengthError>;

    /// f_r at one point, psi, signed theta and phi in radians; NaN outside the domain.
    fn value(&self, psi: f64, theta: f64, phi: f64) -> f64 {
        let mut out = [f64::NAN];
        let point = Points::Angles {
            psi: &[psi],
            theta: &[theta],
            phi: &[phi],
        };
        // The arrays have one element each.
        let _ = self.values(&point, &mut out);
        out[0]
    }
}
