//! Why a file cannot be read as a scan.

use std::path::PathBuf;

use crate::scan::Format;

/// Why a file cannot be read as a scan: where, what stands there, and what was expected.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file cannot be opened or read.
    #[error("{}: cannot be read: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// Something in the file as a whole.
    #[error("{}: {message}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what was expected.
        message: String,
    },
    /// Something on one line.
    #[error("{}, line {line}: {message}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// What is wrong, and what was expected.
        message: String,
    },
    /// One value.
    #[error("{}, line {line}, column {column}: \"{value}\" {message}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// The name of the column.
        column: String,
        /// What stands there.
        value: String,
        /// What was expected.
        message: String,
    },
}

impl ReadError {
    /// The same of a file that may be of a format that is not known.
    pub(super) fn with_known_formats(mut self) -> Self {
        if let Self::File { message, .. } | Self::Line { message, .. } = &mut self {
            let names = Format::names();
            *message = format!("{message}; known formats are {names}");
        }
        self
    }
}
