//! The interface that all evaluators share.

use std::fmt::Debug;

use super::points::{LengthError, Points};

/// The numbers that an evaluator computes in. It accepts arrays of them without a conversion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// `f64`.
    Double,
    /// `f32`.
    Single,
}

/// A way to evaluate f_r of one BRDF in 1/sr.
///
/// Points and values of another precision than the evaluator's are rounded: the value is that at the
/// rounded point.
pub trait Evaluator: Debug + Send + Sync {
    /// The name of the evaluator.
    fn name(&self) -> &'static str;

    /// The numbers that it computes in.
    fn precision(&self) -> Precision;

    /// f_r in 1/sr at each of the points; NaN outside the domain.
    ///
    /// # Errors
    ///
    /// [`LengthError`] if the arrays have different lengths.
    fn values(&self, points: &Points<f64>, out: &mut [f64]) -> Result<(), LengthError>;

    /// [`values`](Self::values) with arrays of `f32`.
    ///
    /// # Errors
    ///
    /// [`LengthError`] if the arrays have different lengths.
    fn values_f32(&self, points: &Points<f32>, out: &mut [f32]) -> Result<(), LengthError>;

    /// f_r in 1/sr at psi, signed theta and phi, in radians; NaN outside the domain.
    fn value(&self, psi: f64, theta: f64, phi: f64) -> f64 {
        let mut out = [f64::NAN];
        let point = Points::Angles {
            psi: &[psi],
            theta: &[theta],
            phi: &[phi],
        };
        // All arrays have one element, so that there is no error.
        let _ = self.values(&point, &mut out);
        out[0]
    }
}
