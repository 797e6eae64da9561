//! Readers, one file a format.

pub mod csv;
mod fields;
pub mod merl;
mod scan;

pub use scan::Scan;

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::measurement::Measurements;

/// A format of files with measured values.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// The project's own table: [`csv`].
    #[default]
    Csv,
    /// A MERL table: [`merl`].
    Merl,
}

impl Format {
    /// All formats, with the names that options and files give them.
    pub const NAMED: [(Self, &str); 2] = [(Self::Csv, "csv"), (Self::Merl, "merl")];

    /// The name that options and files give it.
    pub fn name(self) -> &'static str {
        let found = Self::NAMED.iter().find(|(format, _)| *format == self);
        found.map_or("", |(_, name)| name)
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::NAMED.iter().find(|(_, name)| *name == text);
        found.map(|(format, _)| *format).ok_or_else(|| {
            let names = Self::NAMED.map(|(_, name)| name).join(", ");
            format!("\"{text}\" is not a format: expected one of {names}")
        })
    }
}

/// How a file is read.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// The format; found by the content, then by the extension, where it is not given.
    pub format: Option<Format>,
    /// The side on which the file counts theta positive; as its format has it where it is not given.
    pub theta_positive: Option<Side>,
    /// The side on which the file's azimuth is zero; as its format has it where it is not given.
    pub phi_zero: Option<Side>,
    /// How many readings of each wavelength are kept, evenly over the directions; all where it is not
    /// given.
    pub sample: Option<usize>,
}

impl ReadOptions {
    /// The convention of a file whose format has one of its own.
    pub fn convention(&self, of_format: Convention) -> Convention {
        Convention {
            theta_positive: self.theta_positive.unwrap_or(of_format.theta_positive),
            phi_zero: self.phi_zero.unwrap_or(of_format.phi_zero),
        }
    }
}

impl Format {
    /// The format in which a file is read.
    pub(crate) fn of_file(path: &Path, options: &ReadOptions) -> Self {
        options.format.unwrap_or_else(|| {
            if merl::is_table(path) {
                Self::Merl
            } else {
                Self::Csv
            }
        })
    }
}

impl Measurements {
    /// Reads a file of any [`Format`].
    ///
    /// All readings of a MERL table take 210 MB; [`Scan::of_file`] reads one channel at a time.
    pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Self, ReadError> {
        let path = path.as_ref();
        let all = match Format::of_file(path, options) {
            Format::Csv => Self::read_csv_with(path, options.convention(Convention::default()))?,
            Format::Merl => {
                let channels = merl::channels(merl::Table::open(path)?, options.sample);
                return Self::together(channels);
            }
        };
        Ok(match options.sample {
            Some(count) => all.sampled(count),
            None => all,
        })
    }

    /// The readings of several wavelengths of one file.
    fn together(scans: impl Iterator<Item = Result<Self, ReadError>>) -> Result<Self, ReadError> {
        let mut together = Self::default();
        for scan in scans {
            let scan = scan?;
            let mut readings = std::mem::take(&mut together.readings);
            let mut conversions = std::mem::take(&mut together.conversions);
            readings.extend_from_slice(&scan.readings);
            conversions.extend_from_slice(&scan.conversions);
            together = Self {
                conversions,
                readings,
                ..scan
            };
        }
        Ok(together)
    }
}

/// Which side of the surface normal, or which azimuth, a file calls positive or zero.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The source's side: the model's convention.
    #[default]
    Source,
    /// The side of the mirror direction: as in ASTM E2387 and most goniometers.
    Forward,
}

impl FromStr for Side {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "source" => Ok(Self::Source),
            "forward" => Ok(Self::Forward),
            _ => Err(format!("\"{text}\": expected source or forward")),
        }
    }
}

/// The angular convention of a file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Convention {
    /// The side on which theta counts positive.
    pub theta_positive: Side,
    /// The side on which phi is zero.
    pub phi_zero: Side,
}

/// What differs from the model's convention, in words; nothing where it is that.
impl fmt::Display for Convention {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.theta_positive, self.phi_zero) {
            (Side::Source, Side::Source) => Ok(()),
            (Side::Forward, Side::Source) => f.write_str("theta positive forward"),
            (Side::Source, Side::Forward) => f.write_str("phi zero forward"),
            (Side::Forward, Side::Forward) => f.write_str("theta positive and phi zero forward"),
        }
    }
}

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
        column: &'static str,
        /// What stands there.
        value: String,
        /// What was expected.
        message: String,
    },
}
