//! Why a minimisation ended without a result.

use crate::progress::Cancelled;

/// Why a minimisation ended without a result.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SolverError {
    /// The minimiser failed.
    #[error("the minimiser failed: {0}")]
    Failed(String),
    /// An [`Observer`](crate::progress::Observer) cancelled the minimisation.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for SolverError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl SolverError {
    /// The error of a run of argmin, which carries a cancellation as a foreign error. It is no
    /// `From` implementation, which would make argmin a part of the public interface.
    pub(crate) fn from_argmin(error: &argmin::core::Error) -> Self {
        if error.is::<Cancelled>() {
            Self::Cancelled
        } else {
            Self::Failed(error.to_string())
        }
    }
}

/// The result of a minimisation whose failure is tolerated: `None` where it failed. Only a
/// cancellation remains an error.
pub(crate) fn unless_cancelled<T>(result: Result<T, SolverError>) -> Result<Option<T>, Cancelled> {
    match result {
        Err(SolverError::Cancelled) => Err(Cancelled),
        result => Ok(result.ok()),
    }
}
