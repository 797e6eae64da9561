//! Turns panics of jobs into errors, so that the threads of the worker survive them.

use std::panic::{AssertUnwindSafe, catch_unwind};

/// A panic in a job.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("internal error: {0}")]
pub(super) struct InternalError(String);

/// Runs a job and catches its panics.
pub(super) fn catch_panics<T>(job: impl FnOnce() -> T) -> Result<T, InternalError> {
    catch_unwind(AssertUnwindSafe(job)).map_err(|cause| {
        let text = cause.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| cause.downcast_ref::<&str>().copied());
        InternalError(text.unwrap_or("unknown cause").to_owned())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panics_become_errors_with_their_message() {
        assert_eq!(catch_panics(|| 3), Ok(3));
        let number = 7;
        for (error, message) in [
            (catch_panics(|| panic!("no such thing")), "no such thing"),
            (catch_panics(|| panic!("thing {number}")), "thing 7"),
        ] {
            let error: Result<(), InternalError> = error;
            assert!(error.unwrap_err().to_string().ends_with(message));
        }
    }
}
