//! Reading a file of any format.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::error::ReadError;
use super::foreign::foreign;
use super::options::ReadOptions;
use super::reader::Reader;
use super::text::{HEAD, Text, read_bytes};
use super::{detect, merl};
use crate::scan::{Format, Measurements};

impl Measurements {
    /// Reads a file of any [`Format`].
    ///
    /// All readings of a MERL table take 210 MB of memory;
    /// [`LazyScan::open`](super::LazyScan::open) reads one channel at a time.
    ///
    /// # Examples
    ///
    /// ```no_run
    /// use brdf_fit::Measurements;
    /// use brdf_fit::read::ReadOptions;
    ///
    /// let scan = Measurements::read("paint.bsdf", &ReadOptions::default())?;
    /// for conversion in &scan.conversions {
    ///     println!("{conversion}");
    /// }
    /// # Ok::<(), brdf_fit::read::ReadError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The file cannot be read, or is not a scan in the format that `options` give or that is
    /// detected. Errors name the file and, where possible, the line, the column and the value, and
    /// state what was expected.
    pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Self, ReadError> {
        let path = path.as_ref();
        if detect::is_merl_file(path, options) {
            return merl::read(merl::Table::open(path)?, options);
        }
        let io = |error| ReadError::io(path, error);
        let mut file = File::open(path).map_err(io)?;
        let size = file.metadata().map_err(io)?.len();
        let mut head = Vec::new();
        let mut beginning = file.by_ref().take(HEAD as u64);
        beginning.read_to_end(&mut head).map_err(io)?;
        let is_text = check_head(path, &head, options)? == Data::Text;
        let bytes = read_bytes(head, file, size, is_text).map_err(io)?;
        from_bytes(path, &bytes, options)
    }

    /// Reads a stream of any [`Format`], such as standard input; `name` stands for the path of the
    /// file in errors and reports.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    pub fn from_stream(
        name: &str,
        reader: impl Read,
        options: &ReadOptions,
    ) -> Result<Self, ReadError> {
        let path = Path::new(name);
        let io = |error| ReadError::io(path, error);
        let (mut reader, mut head) = (reader, Vec::new());
        let mut beginning = reader.by_ref().take(HEAD as u64);
        beginning.read_to_end(&mut head).map_err(io)?;
        let is_text =
            !may_be_merl(&head, options) && check_head(path, &head, options)? == Data::Text;
        let bytes = read_bytes(head, reader, 0, is_text).map_err(io)?;
        from_bytes(path, &bytes, options)
    }

    /// Reads the content of a file of any [`Format`]. `name` stands for the path of the file in
    /// errors and reports, and in the detection of the format by the extension.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    pub fn from_bytes(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Self, ReadError> {
        let path = Path::new(name);
        if !may_be_merl(bytes, options) {
            check_head(path, &bytes[..bytes.len().min(HEAD)], options)?;
        }
        from_bytes(path, bytes, options)
    }
}

/// What a file holds by its first block.
#[derive(PartialEq, Eq)]
enum Data {
    Binary,
    Text,
}

/// Refuses a file by its first block: one of another program, or binary data of no known format.
fn check_head(path: &Path, head: &[u8], options: &ReadOptions) -> Result<Data, ReadError> {
    let reader = options.format.map(Reader::of);
    let reader = reader.or_else(|| detect::by_mark(head));
    if reader.is_some_and(Reader::is_binary) {
        return Ok(Data::Binary);
    }
    match foreign(head).filter(|_| reader.is_none()) {
        Some(message) => Err(ReadError::file(path, message)),
        None if head.iter().all(u8::is_ascii_whitespace) => Ok(Data::Text),
        None => Text::new(path, head).map(|_| Data::Text),
    }
}

/// Whether a stream may be a MERL table: its beginning is that of one, or the options say so.
fn may_be_merl(head: &[u8], options: &ReadOptions) -> bool {
    options.format == Some(Format::Merl) || merl::begins_table(head)
}

fn from_bytes(path: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Measurements, ReadError> {
    let known = options.format.or_else(|| Format::detect(bytes, path));
    let reader = Reader::of(known.unwrap_or_default());
    let mut all = reader
        .read(path, bytes, options)
        .map_err(|error| match known {
            Some(_) => error,
            None => error.with_known_formats(),
        })?;
    all.read_settings = options.settings();
    Ok(match options.sample {
        // The channels of a MERL table are sampled one after the other.
        Some(count) if reader.format != Format::Merl => all.sampled(count),
        _ => all,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_binary_stream_without_line_ends_is_read_to_its_end() {
        let bins: [i32; 3] = [50, 50, 30];
        let mut bytes: Vec<u8> = bins.into_iter().flat_map(i32::to_le_bytes).collect();
        // More than a chunk of bytes of which none is a line end.
        bytes.resize(bytes.len() + 3 * 8 * 50 * 50 * 30, 0);
        let options = ReadOptions::default();
        let scan = Measurements::from_stream("a", bytes.as_slice(), &options).unwrap();
        assert_eq!(scan.format, Format::Merl);
    }
}
