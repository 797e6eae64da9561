//! Why E is not defined for a set of readings.

use brdf_core::GeometryError;

/// Why E is not defined for a set of readings.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ObjectiveError {
    /// Weights by sigma, and a reading without one.
    #[error(
        "weights by 1/sigma^2 need the standard deviation of every reading (column sigma_per_sr)"
    )]
    NoSigma,
    /// Angles outside the model's domain, which no
    /// [validated](crate::Measurement::validated) reading has.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The squares of the readings, or of what they are divided by, leave the range of numbers.
    #[error("the largest weighted reading is {0:e} 1/sr: expected one between 1e-30 and 1e30 1/sr")]
    Size(f64),
    /// The denominator of E is zero.
    #[error("all readings are zero, or weigh nothing: E of eq. (5) is not defined")]
    AllZero,
}
