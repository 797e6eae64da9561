//! Readers, one file a format. Each converts once to the model's convention, and says so in
//! [`Measurements::conversions`].

mod angles;
pub mod astm;
pub mod black_lab;
pub mod csv;
mod detect;
mod error;
mod fields;
pub mod goniometer;
mod lazy_scan;
pub mod merl;
mod options;
mod text;
pub mod zemax;

pub use error::ReadError;
pub use lazy_scan::LazyScan;
pub use options::ReadOptions;

use std::fs::File;
use std::io::{Cursor, Read as _};
use std::path::Path;

use crate::scan::{Convention, Format, Measurements};

impl Measurements {
    /// Reads a file of any [`Format`].
    ///
    /// All readings of a MERL table take 210 MB; [`LazyScan::open`] reads one channel at a time.
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
