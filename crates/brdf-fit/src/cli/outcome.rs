//! How a command ended, and its exit status.

use std::fmt::Display;
use std::process::ExitCode;

use crate::output::print_error;

/// How a command ended, from the best to the worst.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Outcome {
    /// Everything was done: exit status 0.
    Complete,
    /// The data did not allow all of it, and the remaining results were delivered: exit status 1.
    Incomplete,
    /// Incorrect usage, or a file that cannot be read or written: exit status 2.
    Failed,
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        Self::from(match outcome {
            Outcome::Complete => 0,
            Outcome::Incomplete => 1,
            Outcome::Failed => 2,
        })
    }
}

/// Prints each failure on standard error; [`Outcome::Failed`] if there are any.
pub(super) fn print_failures<F: Display>(failures: impl IntoIterator<Item = F>) -> Outcome {
    let mut outcome = Outcome::Complete;
    for failure in failures {
        print_error(&failure.to_string());
        outcome = Outcome::Failed;
    }
    outcome
}
