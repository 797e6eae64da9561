//! Scans from a stream, which has no size and can be read only once.

use std::io::Read;
use std::path::Path;

use super::{ReadError, ReadOptions, of_bytes, text};
use crate::scan::Measurements;

impl Measurements {
    /// Reads a scan of any [`Format`](crate::scan::Format) from a stream, such as standard input;
    /// `name` stands for the file in errors and reports.
    ///
    /// # Errors
    ///
    /// Those of [`read`](Self::read).
    pub fn from_stream(
        name: &str,
        reader: impl Read,
        options: &ReadOptions,
    ) -> Result<Self, ReadError> {
        let path = Path::new(name);
        let bytes = text::read_bytes(Vec::new(), reader, 0).map_err(|error| ReadError::Io {
            path: path.to_owned(),
            error,
        })?;
        of_bytes(path, &bytes, options)
    }
}
