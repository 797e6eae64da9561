//! What all readers of text share: the bytes of a file within limits, its lines with their numbers,
//! what its comments say, numbers, and errors that name the place.

use std::io::Read;
use std::path::Path;

use super::ReadError;
use crate::format::ParseError;
use crate::scan::Metadata;
use crate::scan::RefractiveIndex;

/// A longer line is not a line of readings.
pub(super) const MAX_LINE: usize = 65_536;

/// A larger file is not a scan; the limit keeps an endless input from filling the memory.
const MAX_FILE: u64 = 4 << 30;

/// How much is read before the next look at the length of the lines.
const CHUNK: u64 = 1 << 20;

/// Everything behind what was read of it before, up to the point where it is clear that it is not
/// text with lines.
pub(super) fn read_bytes(
    mut before: Vec<u8>,
    mut reader: impl Read,
    expected_size: u64,
) -> std::io::Result<Vec<u8>> {
    let capacity = usize::try_from(expected_size.min(MAX_FILE)).unwrap_or(0);
    before.reserve(capacity.saturating_sub(before.len()) + 1);
    while (before.len() as u64) <= MAX_FILE {
        if reader.by_ref().take(CHUNK).read_to_end(&mut before)? == 0 {
            break;
        }
        let tail = &before[before.len().saturating_sub(MAX_LINE + 1)..];
        if tail.len() > MAX_LINE && !tail.iter().any(|&byte| is_line_end(byte)) {
            break;
        }
    }
    Ok(before)
}

fn is_line_end(byte: u8) -> bool {
    byte == b'\n' || byte == b'\r'
}

/// The text of a file, and the file that errors are about.
#[derive(Clone, Copy)]
pub(super) struct Text<'a> {
    pub(super) path: &'a Path,
    bytes: &'a [u8],
}

impl<'a> Text<'a> {
    /// The text without its byte order mark.
    ///
    /// Errors: it is none.
    pub(super) fn new(path: &'a Path, bytes: &'a [u8]) -> Result<Self, ReadError> {
        match text_of(bytes) {
            Ok(bytes) => Ok(Self { path, bytes }),
            Err(message) => Err(file_error(path, message)),
        }
    }

    /// Number and text of each line; a line ends with LF, CR or CR LF.
    pub(super) fn lines(&self) -> impl Iterator<Item = (u64, &'a [u8])> + use<'a> {
        lines(self.bytes)
    }

    /// The same; an error where a line is too long.
    pub(super) fn checked_lines(
        &self,
    ) -> impl Iterator<Item = Result<(u64, &'a [u8]), ReadError>> + use<'a> {
        let text = *self;
        self.lines()
            .map(move |(number, line)| text.check_length(number, line).map(|()| (number, line)))
    }

    /// Errors: the line is too long.
    pub(super) fn check_length(&self, number: u64, line: &[u8]) -> Result<(), ReadError> {
        if line.len() <= MAX_LINE {
            return Ok(());
        }
        let message =
            format!("the line is longer than {MAX_LINE} bytes: expected a table of readings");
        Err(self.line_error(number, message))
    }

    pub(super) fn line_error(&self, line: u64, message: impl Into<String>) -> ReadError {
        ReadError::Line {
            path: self.path.to_owned(),
            line,
            message: message.into(),
        }
    }

    /// An error of the file as a whole.
    pub(super) fn error(&self, message: impl Into<String>) -> ReadError {
        file_error(self.path, message)
    }

    pub(super) fn value_error(
        &self,
        line: u64,
        column: &str,
        field: &[u8],
        message: String,
    ) -> ReadError {
        ReadError::Value {
            path: self.path.to_owned(),
            line,
            column: column.to_owned(),
            value: shown(field),
            message,
        }
    }

    /// The number of a field, if `accepts` holds for it.
    pub(super) fn number(
        &self,
        line: u64,
        column: &str,
        field: &Field<'_>,
        expected: &str,
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

    /// The number that the comments give for a key, where they do.
    pub(super) fn said_number(
        &self,
        metadata: &Metadata,
        key: &str,
        expected: &str,
        accepts: fn(f64) -> bool,
    ) -> Result<Option<f64>, ReadError> {
        let Some(value) = metadata.get(key) else {
            return Ok(None);
        };
        if metadata
            .0
            .iter()
            .any(|(other, said)| other == key && said != value)
        {
            let message = format!("{key} stands there twice, with different values");
            return Err(self.error(message));
        }
        match parse_number(value.as_bytes(), true) {
            Some(number) if number.is_finite() && accepts(number) => Ok(Some(number)),
            _ => Err(self.error(format!("{key}: \"{value}\": {expected}"))),
        }
    }
}

/// What stands in one column of one line.
pub(super) struct Field<'a> {
    pub(super) text: &'a [u8],
    /// Whether a comma may stand for the decimal point.
    pub(super) decimal_comma: bool,
}

impl<'a> Field<'a> {
    /// A field in a format that has the decimal point alone.
    pub(super) fn plain(text: &'a [u8]) -> Self {
        Self {
            text,
            decimal_comma: false,
        }
    }
}

pub(super) fn file_error(path: &Path, message: impl Into<String>) -> ReadError {
    ReadError::File {
        path: path.to_owned(),
        message: message.into(),
    }
}

/// The text without its byte order mark, or why it is none.
fn text_of(bytes: &[u8]) -> Result<&[u8], &'static str> {
    if bytes.len() as u64 > MAX_FILE {
        return Err("is larger than 4 GiB: expected a table of readings");
    }
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err("is in UTF-16: expected plain text or UTF-8 (save it as \"CSV UTF-8\")");
    }
    let text = without_mark(bytes);
    // The end of a text file on old systems.
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

pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

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

/// The text of a comment line, also of one that a spreadsheet has put into quotes.
pub(super) fn comment_of(line: &[u8]) -> Option<&[u8]> {
    line.strip_prefix(b"#")
        .or_else(|| line.strip_prefix(b"\"#"))
}

/// `key: value` of a comment; separators that a spreadsheet has put behind it are left out.
pub(super) fn key_and_value(comment: &str) -> Option<(String, String)> {
    let (key, value) = comment.split_once([':', '='])?;
    let key = key.trim().to_lowercase();
    let value = value
        .trim()
        .trim_end_matches([',', ';', '\t', '"'])
        .trim_end();
    let is_word = !key.is_empty() && !key.contains(char::is_whitespace);
    is_word.then(|| (key, value.to_owned()))
}

/// Takes over a value of the metadata that the readings depend on: a second one must be the same.
pub(super) fn set_once<T: PartialEq>(
    slot: &mut Option<T>,
    value: Result<T, String>,
    key: &str,
) -> Result<(), String> {
    let value = value.map_err(|error| format!("{key}: {error}"))?;
    if slot.as_ref().is_some_and(|before| *before != value) {
        return Err(format!("{key} stands there twice, with different values"));
    }
    *slot = Some(value);
    Ok(())
}

/// What the comments say.
#[derive(Default)]
pub(super) struct Said {
    pub(super) metadata: Metadata,
    pub(super) quantity: Option<Quantity>,
    pub(super) refractive_index: Option<RefractiveIndex>,
}

impl Said {
    /// Takes over the key and value of a comment, where it has them.
    pub(super) fn add(&mut self, comment: &str) -> Result<(), String> {
        let Some((key, value)) = key_and_value(comment) else {
            return Ok(());
        };
        match key.as_str() {
            "quantity" => set_once(&mut self.quantity, Quantity::parse(&value), &key)?,
            "refractive_index" => set_once(
                &mut self.refractive_index,
                value.parse().map_err(|error: ParseError| error.to_string()),
                &key,
            )?,
            _ => {}
        }
        self.metadata.0.push((key, value));
        Ok(())
    }
}

/// The quantity that the readings of a file are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Brdf,
    BrdfCos,
    ReflectanceFactor,
}

impl Quantity {
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        match text {
            "brdf" => Ok(Self::Brdf),
            "brdf_cos" => Ok(Self::BrdfCos),
            "reflectance_factor" => Ok(Self::ReflectanceFactor),
            _ => Err(format!(
                "\"{text}\" is not known: expected brdf, brdf_cos or reflectance_factor"
            )),
        }
    }

    /// f_r of a reading.
    pub(super) fn to_brdf(self, reading: f64, theta: f64) -> f64 {
        match self {
            Self::Brdf => reading,
            Self::BrdfCos => reading / theta.cos(),
            Self::ReflectanceFactor => reading / std::f64::consts::PI,
        }
    }
}

impl Quantity {
    /// What is done to make it the BRDF, in a sentence; none where it is that.
    pub(super) fn conversion(self) -> Option<String> {
        match self {
            Self::Brdf => None,
            Self::BrdfCos => Some("BRDF cos theta is divided by cos theta".to_owned()),
            Self::ReflectanceFactor => Some("reflectance factors are divided by pi".to_owned()),
        }
    }
}

/// Whether a reading stays a finite number in every conversion.
pub(super) fn is_reading(value: f64) -> bool {
    value.abs() <= 1e290
}

/// Whether a standard deviation stays a finite number above 0 in every conversion.
pub(super) fn is_deviation(value: f64) -> bool {
    (1e-290..=1e290).contains(&value)
}

/// Whether this is an angle in degrees or radians, of however many turns.
pub(super) fn is_angle(value: f64) -> bool {
    value.abs() <= 1e9
}

/// Micrometres, from a number in nanometres; in the decimals of the file, so that 630.79 nm is
/// 0.63079 um to the last digit.
pub(super) fn micrometres(nanometres: &[u8]) -> Option<f64> {
    let number = parse_number(nanometres, false)?;
    let shifted = [nanometres.trim_ascii(), b"e-3"].concat();
    let micrometres = parse_number(&shifted, false).unwrap_or(number / 1000.0);
    (micrometres > 0.0 && micrometres.is_finite()).then_some(micrometres)
}

/// A field as it is quoted in an error: not too long, and printable.
pub(super) fn shown(field: &[u8]) -> String {
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

pub(super) fn parse_number(field: &[u8], decimal_comma: bool) -> Option<f64> {
    let field = field.trim_ascii();
    match fast_float2::parse(field) {
        Err(_) if decimal_comma && !field.contains(&b'.') => {
            let comma = field.iter().position(|&byte| byte == b',')?;
            let mut with_point = field.to_vec();
            with_point[comma] = b'.';
            fast_float2::parse(with_point).ok()
        }
        result => result.ok(),
    }
}

/// Words between spaces and tabs, and commas where there are any.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|&byte| byte.is_ascii_whitespace() || byte == b',')
        .filter(|word| !word.is_empty())
}

/// The sentence that so many readings were left out, and why; none where none was.
pub(super) fn left_out(count: usize, why: &str) -> Option<String> {
    match count {
        0 => None,
        1 => Some(format!("1 reading {why} is left out")),
        _ => Some(format!("{count} readings {why} are left out")),
    }
}

/// Why a reading at an angle of 90 deg or more is left out.
pub(super) const BEYOND_HORIZON: &str = "at or beyond 90 deg from the normal";
