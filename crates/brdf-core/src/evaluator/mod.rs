//! Many points at once: ways to evaluate a BRDF that differ in speed, accuracy and memory, behind
//! one interface.
//!
//! | evaluator | arithmetic | memory | for |
//! |---|---|---|---|
//! | [`Exact`] | `f64` | none | all, and the measure of the others |
//! | [`Single`] | `f32` | none | what a renderer wants |
//! | [`FittedFresnel`] | `f32`, the Fresnel factor a polynomial in cos gamma with a known error | none | the same, a little faster |
//! | [`Lambertian`] | a constant | none | a surface, or a range of angles, without a specular part to speak of |
//! | [`SpecularOnly`] | `f32` without the Lambertian part | none | where that is not to be seen |
//! | [`IsotropicTable`] | `f32`, a table over alpha and gamma | some KiB | processors whose divisions and roots are slow |
//! | [`IncidenceTable`] | `f32`, a table over signed theta | some KiB | one incidence, in plane |
//! | [`InPlaneTable`] | `f32`, a table over psi and signed theta | MiB | in plane |
//!
//! What they cost and how they err is not promised here but measured: by
//! [`Plan`](crate::scene::Plan) for the scene at hand, and by the command `trade`.

mod exact;
mod fitted_fresnel;
mod lambertian;
mod points;
mod single;
mod table;
pub(crate) mod vector;

use std::fmt::Debug;

pub use exact::Exact;
pub use fitted_fresnel::FittedFresnel;
pub use lambertian::Lambertian;
pub use points::Points;
pub use single::{Single, SpecularOnly};
pub use table::{InPlaneTable, IncidenceTable, IsotropicTable, TableError};
pub use vector::PARALLEL_FROM;
pub use vector::vector_unit;

/// Arrays of different lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("an array has {found} elements: expected {expected}, as many as the others have")]
pub struct LengthError {
    /// The length of the first array.
    pub expected: usize,
    /// That of the other.
    pub found: usize,
}

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
