//! The text of a file: its bytes within limits, its lines with their numbers, and errors that name
//! the line.

use std::fmt::Display;
use std::io::{ErrorKind, Read};
use std::path::Path;

use super::error::{ReadError, Remedy};
use super::number::{Field, is_reading, looks_missing, parse_number, was_not_taken};

/// The longest line in bytes: a longer one is not a line of readings.
pub(super) const MAX_LINE: usize = 65_536;

/// The largest file in bytes: the limit keeps an endless input from filling the memory.
const MAX_FILE: u64 = 4 << 30;

/// How many bytes of a file are searched for the marks of a format: more than any header with its
/// comments.
pub(super) const HEAD: usize = 65_536;

/// How many bytes are read before the length of the last line is checked again.
const CHUNK: u64 = 1 << 20;

/// Reads a file to its end, after the bytes of it that were read before. Stops early once it is
/// clear that the file is too large or, if it is text, has no lines. A file that becomes shorter meanwhile
/// is an error.
pub(super) fn read_bytes(
    mut before: Vec<u8>,
    mut reader: impl Read,
    expected_size: u64,
    is_text: bool,
) -> std::io::Result<Vec<u8>> {
    let capacity = usize::try_from(expected_size.min(MAX_FILE)).unwrap_or(0);
    before.reserve(capacity.saturating_sub(before.len()) + 1);
    while (before.len() as u64) <= MAX_FILE {
        if reader.by_ref().take(CHUNK).read_to_end(&mut before)? == 0 {
            check_size(before.len() as u64, expected_size)?;
            break;
        }
        let tail = &before[before.len().saturating_sub(MAX_LINE + 1)..];
        if is_text && tail.len() > MAX_LINE && !tail.iter().any(|&byte| is_line_end(byte)) {
            break;
        }
    }
    Ok(before)
}

/// Whether a file has the bytes that it had when it was opened.
fn check_size(read: u64, expected: u64) -> std::io::Result<()> {
    if read >= expected {
        return Ok(());
    }
    let message = format!("it ends after {read} of {expected} bytes: it was cut while it was read");
    Err(std::io::Error::new(ErrorKind::UnexpectedEof, message))
}

fn is_line_end(byte: u8) -> bool {
    byte == b'\n' || byte == b'\r'
}

/// The text of a file, with the path that errors name.
#[derive(Clone, Copy)]
pub(super) struct Text<'a> {
    pub(super) path: &'a Path,
    bytes: &'a [u8],
}

impl<'a> Text<'a> {
    /// The text in the bytes of a file, without its byte order mark.
    ///
    /// # Errors
    ///
    /// The bytes are too many, UTF-16, binary data, or nothing but white space.
    pub(super) fn new(path: &'a Path, bytes: &'a [u8]) -> Result<Self, ReadError> {
        match text_in(bytes) {
            Ok(bytes) => Ok(Self { path, bytes }),
            Err(message) => Err(ReadError::file(path, message)),
        }
    }

    /// A text without lines, for the errors of a file that is text in part only.
    pub(super) fn for_errors(path: &'a Path) -> Self {
        Self { path, bytes: &[] }
    }

    /// The number and the text of each line. A line ends with LF, CR or CR LF.
    pub(super) fn lines(&self) -> impl Iterator<Item = (u64, &'a [u8])> + use<'a> {
        lines(self.bytes)
    }

    /// Whether a line of the text is its last and has no line end.
    pub(super) fn ends_within(&self, line: &[u8]) -> bool {
        line.as_ptr_range().end == self.bytes.as_ptr_range().end
    }

    /// As [`lines`](Self::lines), with an error for a line that is too long.
    pub(super) fn checked_lines(
        &self,
    ) -> impl Iterator<Item = Result<(u64, &'a [u8]), ReadError>> + use<'a> {
        let text = *self;
        self.lines()
            .map(move |(number, line)| text.check_length(number, line).map(|()| (number, line)))
    }

    /// # Errors
    ///
    /// The line is longer than [`MAX_LINE`].
    pub(super) fn check_length(&self, number: u64, line: &[u8]) -> Result<(), ReadError> {
        if line.len() <= MAX_LINE {
            return Ok(());
        }
        let message =
            format!("the line is longer than {MAX_LINE} bytes: expected a table of readings");
        Err(self.line_error(number, message))
    }

    /// An error of the file as a whole.
    pub(super) fn error(&self, message: impl Into<String>) -> ReadError {
        ReadError::file(self.path, message)
    }

    pub(super) fn line_error(&self, line: u64, message: impl Into<String>) -> ReadError {
        ReadError::Line {
            path: self.path.to_owned(),
            line,
            message: message.into(),
            remedy: None,
        }
    }

    pub(super) fn value_error(
        &self,
        line: u64,
        column: &str,
        field: &[u8],
        message: impl Into<String>,
    ) -> ReadError {
        ReadError::Value {
            path: self.path.to_owned(),
            line,
            column: column.to_owned(),
            value: quotable(field),
            message: message.into(),
            remedy: None,
        }
    }

    /// The number in a field.
    ///
    /// # Errors
    ///
    /// The field is not a finite number for which `accepts` is true; the message ends with what was
    /// `expected`.
    pub(super) fn number(
        &self,
        line: u64,
        column: &str,
        field: &Field<'_>,
        expected: impl Display,
        accepts: impl Fn(f64) -> bool,
    ) -> Result<f64, ReadError> {
        let problem = match parse_number(field.text, field.decimal_comma) {
            Some(value) if !value.is_finite() => "is not a finite number",
            Some(value) if accepts(value) => return Ok(value),
            Some(_) => "is out of range",
            None if field.text.trim_ascii().is_empty() => "is missing",
            None => "is not a number",
        };
        let message = format!("{problem}: {expected}");
        Err(self.value_error(line, column, field.text, message))
    }

    /// The reading in a field; `None` where none was taken: the field says so, or holds the number
    /// `missing` that stands for it.
    ///
    /// # Errors
    ///
    /// The field is not a finite number, or one that programs write where no reading was taken and that
    /// is not declared to be.
    pub(super) fn reading(
        &self,
        line: u64,
        column: &str,
        field: &Field<'_>,
        missing: Option<f64>,
    ) -> Result<Option<f64>, ReadError> {
        if was_not_taken(field.text) {
            return Ok(None);
        }
        let expected = "expected a reading, or nan where none was taken";
        let value = self.number(line, column, field, expected, is_reading)?;
        if missing == Some(value) {
            return Ok(None);
        }
        if looks_missing(value) {
            let message = format!(
                "looks like a reading that was not taken: expected nan in its place, or in a table a \
                 line \"# missing: {value}\""
            );
            let error = self.value_error(line, column, field.text, message);
            return Err(error.with_remedy(Some(Remedy::Missing)));
        }
        Ok(Some(value))
    }
}

/// The text without its byte order mark, or why the bytes are not text.
fn text_in(bytes: &[u8]) -> Result<&[u8], &'static str> {
    if bytes.len() as u64 > MAX_FILE {
        return Err("is larger than 4 GiB: expected a table of readings");
    }
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err("is in UTF-16: expected plain text or UTF-8 (save it as \"CSV UTF-8\")");
    }
    let text = without_byte_order_mark(bytes);
    // Some old systems end a text file with this control character.
    let text = text.strip_suffix(b"\x1a").unwrap_or(text);
    let is_control = |byte: &u8| *byte < 32 && !b"\t\n\r\x0c".contains(byte);
    if text.iter().take(8192).any(is_control) {
        return Err("is binary data: expected a table of readings as text");
    }
    if text.iter().all(u8::is_ascii_whitespace) {
        return Err(
            "is empty: expected a header with psi_deg, theta_deg and brdf_per_sr, and readings",
        );
    }
    Ok(text)
}

pub(super) fn without_byte_order_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// The lines at the beginning of a file, in which the mark of a format is searched.
pub(super) fn head_lines(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let head = without_byte_order_mark(&bytes[..bytes.len().min(HEAD)]);
    lines(head).map(|(_, line)| line)
}

/// The first word of each line at the beginning of a file.
pub(super) fn first_words(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    head_lines(bytes).map(|line| {
        let mut words = line.trim_ascii_start().split(u8::is_ascii_whitespace);
        words.next().unwrap_or_default()
    })
}

/// The number and the text of each line. A line ends with LF, CR or CR LF.
pub(super) fn lines(text: &[u8]) -> impl Iterator<Item = (u64, &[u8])> {
    let mut rest = text;
    let mut number = 0;
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let end = rest
            .iter()
            .position(|&byte| is_line_end(byte))
            .unwrap_or(rest.len());
        let (line, behind) = rest.split_at(end);
        let ending = if behind.starts_with(b"\r\n") {
            2
        } else {
            behind.len().min(1)
        };
        rest = &behind[ending..];
        number += 1;
        Some((number, line))
    })
}

/// The words of a line, separated by white space and commas.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|&byte| byte.is_ascii_whitespace() || byte == b',')
        .filter(|word| !word.is_empty())
}

/// A field as an error quotes it: printable and at most 60 characters long.
pub(super) fn quotable(field: &[u8]) -> String {
    const LONGEST: usize = 60;
    let text = String::from_utf8_lossy(field)
        .trim()
        .escape_debug()
        .to_string();
    if text.chars().count() <= LONGEST {
        return text;
    }
    text.chars().take(LONGEST).chain("...".chars()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_becomes_shorter_while_it_is_read_is_an_error() {
        let read = |bytes: &[u8], size| read_bytes(b"psi".to_vec(), bytes, size, true);
        assert_eq!(read(b"_deg", 7).unwrap(), b"psi_deg");
        assert_eq!(
            read(b"_deg", 0).unwrap(),
            b"psi_deg",
            "a stream has no size"
        );
        let message = read(b"_d", 7).unwrap_err().to_string();
        assert_eq!(
            message,
            "it ends after 5 of 7 bytes: it was cut while it was read"
        );
    }
}
