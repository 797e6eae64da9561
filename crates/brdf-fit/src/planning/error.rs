//! Why a plan cannot be made.

use crate::fit::FitError;
use crate::format::counted;

/// Why readings cannot be planned or reviewed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The scan has several wavelengths.
    #[error(
        "the scan has {0} wavelengths: expected one, since readings are planned for a wavelength"
    )]
    Wavelengths(usize),
    /// A quantity of the instrument or the scene that is not positive.
    #[error("{quantity} {value}: expected a positive number")]
    NotPositive {
        /// What it is.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// A table, of which everything was measured.
    #[error("{count} readings: expected at most {most}, since a table needs no further ones")]
    TooMany {
        /// How many there are.
        count: usize,
        /// How many a plan goes on from.
        most: usize,
    },
    /// The instrument has no setting in the scene, or only those that the scan has already.
    #[error(
        "the instrument has no further setting within the scene: expected angles of the scene within its \
         largest angles, and steps fine enough for another reading"
    )]
    NoSetting,
    /// A scan of too few readings above zero for a review.
    #[error("{} above zero: expected at least {least} for a review", counted(*.count, "reading"))]
    TooFew {
        /// How many there are.
        count: usize,
        /// How many are needed.
        least: usize,
    },
    /// Readings none of which has a logarithm.
    #[error(
        "none of {} is above zero: expected readings of f_r (dark signal subtracted twice, another column?)",
        counted(*.0, "reading")
    )]
    NoneAboveZero(usize),
    /// Readings that cannot be fitted.
    #[error(transparent)]
    Fit(#[from] FitError),
}
