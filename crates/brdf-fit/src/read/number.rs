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
