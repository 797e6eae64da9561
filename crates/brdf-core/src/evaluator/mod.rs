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
//! What they cost, and how they err for a scene, is measured by [`Plan`](crate::scene::Plan), and by
//! the command `trade`. [`Exact`] differs from single values by a few roundings. The largest relative
//! errors of [`Single`], from cosines, for k2 = 0.3, kD = 0.1, n = 1.5 and p = 1.7, among 100,000
//! points half of which lie next to the mirror direction or at the ends of the ranges
//! (`cargo test -p brdf-core --test evaluators -- --nocapture errors_in_f32` prints more of them):
//!
//! | angles up to | k1 | paper | Smith | power | GGX | Beckmann |
//! |---|---|---|---|---|---|---|
//! | 85 deg | 0.001 | 5.0e-7 | 5.2e-7 | 8.1e-7 | 6.2e-7 | 1.0e-6 |
//! | 85 deg | 0.01 | 4.7e-7 | 4.8e-7 | 8.6e-7 | 6.9e-7 | 1.0e-6 |
//! | 85 deg | 0.1 | 4.9e-7 | 5.1e-7 | 8.5e-7 | 6.5e-7 | 1.2e-6 |
//! | 85 deg | 1 | 5.9e-7 | 5.7e-7 | 5.9e-7 | 6.6e-7 | 1.3e-6 |
//! | 89.9 deg | 0.01 | 5.0e-7 | 5.6e-7 | 1.0e-6 | 6.3e-7 | 1.2e-6 |
//!
//! They are those of the evaluation, at the points as they are given: that a coordinate was rounded
//! to `f32` before is not in them, and no evaluator can mend it. (The cosine of an azimuth next to
//! pi, in `f32`, is good to 3e-4 rad: for narrow lobes, directions or angles are better.)

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
