//! Why a file cannot be read as a scan.

use std::io;
use std::path::{Path, PathBuf};

use crate::scan::Format;

/// Why a file cannot be read as a scan: the place in the file, what is there, and what was expected.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be opened or read.
    #[error("{}: cannot be read: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        error: io::Error,
    },
    /// The file as a whole is not a scan.
    #[error("{}: {message}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what was expected.
        message: String,
    },
    /// A line is not as expected.
    #[error("{}, line {line}: {message}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// The number of the line, counted from 1.
        line: u64,
        /// What is wrong, and what was expected.
        message: String,
    },
    /// A single value is not as expected.
    #[error("{}, line {line}, column {column}: \"{value}\" {message}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The number of the line, counted from 1.
        line: u64,
        /// The name of the column.
        column: String,
        /// The value as it is written in the file.
        value: String,
        /// What is wrong, and what was expected.
        message: String,
    },
}

impl ReadError {
    pub(super) fn io(path: &Path, error: io::Error) -> Self {
        Self::Io {
            path: path.to_owned(),
            error,
        }
    }

    pub(super) fn file(path: &Path, message: impl Into<String>) -> Self {
        Self::File {
            path: path.to_owned(),
            message: message.into(),
        }
    }

    /// Adds the names of the known formats to the message: for a file whose format was not
    /// recognised.
    pub(super) fn with_known_formats(mut self) -> Self {
        if let Self::File { message, .. } | Self::Line { message, .. } = &mut self {
            let names = Format::names();
            *message = format!("{message}; known formats are {names}");
        }
        self
    }
}
