//! Readers, one file a format. Each converts once to the model's convention, and says so in
//! [`Measurements::conversions`].

mod angles;
pub mod astm;
pub mod black_lab;
pub mod csv;
mod detect;
mod fields;
pub mod goniometer;
pub mod merl;
mod scan;
mod text;
pub mod zemax;

pub use scan::Scan;

use std::fmt;
use std::fs::File;
use std::io::{Cursor, Read as _};
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
    /// ASTM E1392 and E2387 text, also as Cornell wrote it: [`astm`].
    Astm,
    /// Zemax tabular BSDF: [`zemax`].
    Zemax,
    /// Reflectance factors of the Black Lab: [`black_lab`].
    BlackLab,
    /// Incidences in columns, views in rows: [`goniometer`].
    Goniometer,
}

impl Format {
    /// All formats, with the names that options and files give them.
    pub const NAMED: [(Self, &str); 6] = [
        (Self::Csv, "csv"),
        (Self::Merl, "merl"),
        (Self::Astm, "astm"),
        (Self::Zemax, "zemax"),
        (Self::BlackLab, "black-lab"),
        (Self::Goniometer, "goniometer"),
    ];

    /// The name that options and files give it.
    pub fn name(self) -> &'static str {
        let found = Self::NAMED.iter().find(|(format, _)| *format == self);
        found.map_or("", |(_, name)| name)
    }

    fn names() -> String {
        Self::NAMED.map(|(_, name)| name).join(", ")
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::NAMED.iter().find(|(_, name)| *name == text);
        found.map(|(format, _)| *format).ok_or_else(|| {
            let names = Self::names();
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

    /// The convention of a file whose format leaves no choice.
    ///
    /// Errors: an option says that it is another, and `why` it cannot be.
    fn fixed(
        &self,
        path: &Path,
        of_format: Convention,
        why: &str,
    ) -> Result<Convention, ReadError> {
        if self.convention(of_format) == of_format {
            return Ok(of_format);
        }
        let message = format!("its sides cannot be chosen: {why}");
        Err(text::file_error(path, message))
    }
}

impl Measurements {
    /// Reads a file of any [`Format`].
    ///
    /// All readings of a MERL table take 210 MB; [`Scan::of_file`] reads one channel at a time.
    ///
    /// Errors name the file, and where they can the line, the column and the value, and say what
    /// was expected.
    pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Self, ReadError> {
        let path = path.as_ref();
        if merl::is_table(path, options) {
            return merl::read(merl::Table::open(path)?, options);
        }
        let io = |error| ReadError::Io {
            path: path.to_owned(),
            error,
        };
        let mut file = File::open(path).map_err(io)?;
        let size = file.metadata().map_err(io)?.len();
        let mut head = Vec::new();
        let mut beginning = file.by_ref().take(detect::HEAD);
        beginning.read_to_end(&mut head).map_err(io)?;
        let bytes = text::read_bytes(head, file, size).map_err(io)?;
        of_bytes(path, &bytes, options)
    }

    /// Reads what is in a file of any [`Format`]; `name` stands for the file in errors and reports,
    /// and its extension for that of the file.
    ///
    /// Errors as those of [`read`](Self::read).
    pub fn from_bytes(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Self, ReadError> {
        of_bytes(Path::new(name), bytes, options)
    }
}

fn of_bytes(path: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Measurements, ReadError> {
    let found = options.format.or_else(|| Format::detect(bytes, path));
    let format = found.unwrap_or_default();
    if format == Format::Merl {
        let name = path.display().to_string();
        return merl::read(merl::Table::new(Cursor::new(bytes), &name)?, options);
    }
    let all = of_text(format, path, bytes, options).map_err(|error| match found {
        Some(_) => error,
        None => error.with_known_formats(),
    })?;
    Ok(match options.sample {
        Some(count) => all.sampled(count),
        None => all,
    })
}

fn of_text(
    format: Format,
    path: &Path,
    bytes: &[u8],
    options: &ReadOptions,
) -> Result<Measurements, ReadError> {
    let text = text::Text::new(path, bytes)?;
    match format {
        Format::Csv | Format::Merl => csv::read(text, options.convention(Convention::default())),
        Format::Astm => astm::read(text, options),
        Format::Zemax => zemax::read(text, options),
        Format::BlackLab => black_lab::read(text, options),
        Format::Goniometer => goniometer::read(text, options.convention(Convention::default())),
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

impl Convention {
    /// Theta and phi in radians in the model's convention, from degrees in this one.
    fn in_model(self, theta_deg: f64, phi_deg: f64) -> (f64, f64) {
        let theta = match self.theta_positive {
            Side::Source => theta_deg,
            Side::Forward => -theta_deg,
        };
        // In degrees, so that 180 deg remains what it is.
        let phi = match self.phi_zero {
            Side::Source => phi_deg,
            Side::Forward => phi_deg + 180.0,
        };
        (theta.to_radians(), phi.to_radians())
    }
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
        column: String,
        /// What stands there.
        value: String,
        /// What was expected.
        message: String,
    },
}

impl ReadError {
    /// The same of a file that may be of a format that is not known.
    fn with_known_formats(mut self) -> Self {
        if let Self::File { message, .. } | Self::Line { message, .. } = &mut self {
            let names = Format::names();
            *message = format!("{message}; known formats are {names}");
        }
        self
    }
}
