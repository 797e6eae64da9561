//! Numbers in the fields of a text, and the ranges of those that are read.

/// The text of one column of one line.
pub(super) struct Field<'a> {
    pub(super) text: &'a [u8],
    /// Whether a comma is accepted as the decimal point.
    pub(super) decimal_comma: bool,
}

impl<'a> Field<'a> {
    /// A field of a format that allows no decimal comma.
    pub(super) fn plain(text: &'a [u8]) -> Self {
        Self {
            text,
            decimal_comma: false,
        }
    }
}

/// The number in a field; `None` where there is none.
///
/// Beside the usual spellings, the minus sign and the spaces of typesetting and the exponent of Fortran
/// are read.
pub(super) fn parse_number(field: &[u8], decimal_comma: bool) -> Option<f64> {
    let field = field.trim_ascii();
    fast_float2::parse(field)
        .ok()
        .or_else(|| parse_unusual_number(field, decimal_comma))
}

fn parse_unusual_number(field: &[u8], decimal_comma: bool) -> Option<f64> {
    const LONGEST: usize = 64;
    let text = str::from_utf8(field)
        .ok()
        .filter(|text| text.len() <= LONGEST)?;
    let decimal_comma = decimal_comma && !text.contains('.') && text.matches(',').count() == 1;
    let is_hexadecimal = text.starts_with("0x");
    let digits_before = |at: usize| text[..at].ends_with(|c: char| c.is_ascii_digit() || c == '.');
    let mut usual = String::with_capacity(text.len());
    for (i, c) in text.char_indices() {
        match c {
            '\u{2212}' | '\u{2013}' => usual.push('-'),
            '\u{a0}' | '\u{202f}' | '\u{2009}' => {}
            ',' if decimal_comma => usual.push('.'),
            'D' | 'd' if !is_hexadecimal && digits_before(i) => usual.push('e'),
            c => usual.push(c),
        }
    }
    fast_float2::parse(usual).ok()
}

/// Whether a field says that a reading was not taken.
pub(super) fn was_not_taken(field: &[u8]) -> bool {
    let field = field.trim_ascii();
    let is = |word: &str| field.eq_ignore_ascii_case(word.as_bytes());
    ["", "-", "nan", "na", "n/a", "#n/a", "null", "none"]
        .into_iter()
        .any(is)
}

/// The number times a power of ten, by a shift of the decimal point: 9.05e-7 shifted by 6 is 0.905.
pub(super) fn shifted(number: f64, exponent: i32) -> f64 {
    let scientific = format!("{number:e}");
    let shifted = scientific.split_once('e').and_then(|(digits, before)| {
        let before: i32 = before.parse().ok()?;
        fast_float2::parse(format!("{digits}e{}", before + exponent)).ok()
    });
    shifted.unwrap_or(number * 10_f64.powi(exponent))
}

/// The text before a percent sign at the end of a field; `None` where there is no such sign.
pub(super) fn without_percent_sign(field: &[u8]) -> Option<&[u8]> {
    field.trim_ascii_end().strip_suffix(b"%")
}

/// Whether a value is one that programs write for a reading that was not taken. As f_r it is impossible.
pub(super) fn looks_missing(value: f64) -> bool {
    [-99.0, -999.0, -9999.0, -99999.0].contains(&value)
}

/// Converts a wavelength from nanometres to micrometres; `None` unless it is a positive number.
///
/// The decimal point of the text is shifted instead of dividing by 1000, so that 630.79 nm is the
/// number nearest to 0.63079 um.
pub(super) fn micrometres(nanometres: &[u8]) -> Option<f64> {
    let number = parse_number(nanometres, false)?;
    let shifted = [nanometres.trim_ascii(), b"e-3"].concat();
    let micrometres = parse_number(&shifted, false).unwrap_or(number / 1000.0);
    (micrometres > 0.0 && micrometres.is_finite()).then_some(micrometres)
}

/// Whether a reading remains finite in every conversion.
pub(super) fn is_reading(value: f64) -> bool {
    value.abs() <= 1e290
}

/// Whether a standard deviation remains finite and above 0 in every conversion.
pub(super) fn is_deviation(value: f64) -> bool {
    (1e-290..=1e290).contains(&value)
}

/// Whether a number can be an angle in degrees or radians, of any number of turns.
pub(super) fn is_angle(value: f64) -> bool {
    value.abs() <= 1e9
}

/// Whether a number can be a wavelength in micrometres.
pub(super) fn is_wavelength(micrometres: f64) -> bool {
    micrometres > 0.0
}
