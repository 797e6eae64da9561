//! The errors of a trade-off of fitting.

use serde::{Serialize, Serializer};

use crate::fit::FitError;
use crate::format::counted;
use crate::model::Parameter;
use crate::objective::ObjectiveError;

/// Why the ways to fit a scan cannot be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TradeoffError {
    /// The reference fit fails.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The thread on which the fits are timed cannot be started.
    #[error("cannot start the thread on which the fits are timed: {0}")]
    Thread(String),
}

impl TradeoffError {
    /// Whether other options may avoid the error, with the readings as they are.
    pub fn is_usage(&self) -> bool {
        matches!(self, Self::Fit(error) if error.is_usage())
    }
}

/// Why one way to fit a scan has no result. In JSON it is its message.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrialError {
    /// The fit fails.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// There are too few incidences to leave one out.
    #[error("the scan has {}: none can be left out", counted(*.0, "incidence"))]
    TooFewIncidences(usize),
    /// A fit by the profile supports neither a robust loss nor the condition rho(psi) <= 1.
    #[error("a fit by the profile supports neither a robust loss nor the condition rho <= 1")]
    ProfileOptions,
    /// The profile is refined along k1, and another parameter besides the weights is free.
    #[error("the profile is refined along k1 alone, and {0} is free")]
    ProfileNotRefined(Parameter),
}

impl From<ObjectiveError> for TrialError {
    fn from(error: ObjectiveError) -> Self {
        Self::Fit(error.into())
    }
}

impl Serialize for TrialError {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
