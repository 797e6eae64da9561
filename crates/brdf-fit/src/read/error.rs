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
        /// What the options of the reading can say in place of the file.
        remedy: Option<Remedy>,
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
        /// What the options of the reading can say in place of the file.
        remedy: Option<Remedy>,
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
        /// What the options of the reading can say in place of the file.
        remedy: Option<Remedy>,
    },
}

/// What the [options](super::ReadOptions) of the reading can say where a file does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Remedy {
    /// [`ReadOptions::columns`](super::ReadOptions::columns): what a column is.
    Columns,
    /// The declaration `psi_deg`: the incidence angle.
    Incidence,
    /// The declaration `columns`: whether the angles of columns are incidences or azimuths.
    ColumnAngles,
    /// [`ReadOptions::phi_zero`](super::ReadOptions::phi_zero): the side on which the azimuth is zero.
    PhiZero,
    /// The declaration `sheet`: which sheet of a workbook is read.
    Sheet,
    /// The declaration `missing`: the number that stands for a reading that was not taken.
    Missing,
}

impl ReadError {
    /// What the options of the reading can say where the file does not.
    pub fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::Io { .. } => None,
            Self::File { remedy, .. } | Self::Line { remedy, .. } | Self::Value { remedy, .. } => {
                *remedy
            }
        }
    }

    /// The error with another remedy.
    pub(super) fn with_remedy(mut self, to: Option<Remedy>) -> Self {
        match &mut self {
            Self::Io { .. } => {}
            Self::File { remedy, .. } | Self::Line { remedy, .. } | Self::Value { remedy, .. } => {
                *remedy = to;
            }
        }
        self
    }

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
            remedy: None,
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
