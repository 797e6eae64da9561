//! Why the scans of an array cannot be fitted.

use std::io;
use std::path::{Path, PathBuf};

use crate::batch::BatchError;
use crate::output::WriteError;

/// Why the scans of an array cannot be fitted.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CubeError {
    /// The array cannot be read, or is not one of readings.
    #[error("{}: {message}", path.display())]
    Array {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what was expected.
        message: String,
    },
    /// The array has several dimensions with as many elements as there are angles.
    #[error(
        "{}: dimensions {first} and {second} of {shape} both have the number of angles, {readings}: expected \
         to be told which one runs over the readings", path.display()
    )]
    Ambiguous {
        /// The file.
        path: PathBuf,
        /// The shape of the array.
        shape: String,
        /// The first dimension in question.
        first: usize,
        /// The second.
        second: usize,
        /// The number of angles.
        readings: usize,
    },
    /// The scans cannot be fitted.
    #[error(transparent)]
    Fit(#[from] BatchError),
    /// The fits cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl CubeError {
    pub(super) fn array(path: &Path, message: impl Into<String>) -> Self {
        Self::Array {
            path: path.to_owned(),
            message: message.into(),
        }
    }

    pub(super) fn io(path: &Path, error: &io::Error) -> Self {
        Self::array(path, format!("cannot be read: {error}"))
    }
}
