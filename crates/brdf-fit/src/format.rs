//! Counts, numbers and angles as text: in messages, tables and files.
//!
//! ```
//! use brdf_fit::format::{counted, digits, in_degrees, shortest};
//!
//! assert_eq!(counted(3, "reading"), "3 readings");
//! assert_eq!(digits(0.022_859_766), "0.0228598");
//! assert_eq!(shortest(1.5), "1.5");
//! assert_eq!(in_degrees(41.4_f64.to_radians()), 41.4);
//! ```

/// A text that is not a value of the expected kind, as a sentence.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct ParseError {
    message: String,
}

impl ParseError {
    /// An error with a message that shows the text and says what is expected.
    pub fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
        }
    }
}

/// A text without the characters that control a terminal or the direction of writing: each is replaced by
/// its code, such as `\u{1b}`. Line ends and tabs are kept.
pub fn printable(text: &str) -> String {
    let controls = |c: char| {
        let direction = matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        let separator = matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}');
        c.is_control() && c != '\n' && c != '\t' || direction || separator
    };
    let mut printable = String::with_capacity(text.len());
    for c in text.chars() {
        if controls(c) {
            printable.extend(c.escape_unicode());
        } else {
            printable.push(c);
        }
    }
    printable
}

/// The largest number of names that a message lists.
const LISTED: usize = 20;

/// Names with a separator, and the number of those beyond the first twenty: a message names each of a
/// few scans or wavelengths, and remains readable where a file holds thousands of them.
///
/// ```
/// use brdf_fit::format::listed;
///
/// assert_eq!(listed(&["a.csv", "b.csv"], ", "), "a.csv, b.csv");
/// assert!(listed(&["a.csv"; 1000], ", ").ends_with(", a.csv and 980 others"));
/// ```
pub fn listed(names: &[impl AsRef<str>], separator: &str) -> String {
    let shown: Vec<&str> = names.iter().take(LISTED).map(AsRef::as_ref).collect();
    let shown = shown.join(separator);
    match names.len().saturating_sub(LISTED) {
        0 => shown,
        others => format!("{shown} and {}", counted(others, "other")),
    }
}

/// Each item once, in the order of first occurrence.
#[cfg(feature = "export")]
pub(crate) fn distinct<T>(all: impl IntoIterator<Item = T>) -> Vec<T>
where
    T: Eq + std::hash::Hash + Clone,
{
    let mut known = std::collections::HashSet::new();
    let all = all.into_iter();
    all.filter(|item| known.insert(item.clone())).collect()
}

/// `1 reading`, `3 readings`.
pub fn counted(count: usize, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

/// The shortest form of a number that has at most six significant digits, otherwise six
/// significant digits.
pub fn shortest(value: f64) -> String {
    let plain = value.to_string();
    let six = digits(value);
    if plain.len() < six.len() { plain } else { six }
}

/// All digits of a number, in the form that is read back to the last bit: decimal, or scientific where the
/// decimal form would begin or end with many zeros.
///
/// ```
/// use brdf_fit::format::exact;
///
/// assert_eq!(exact(0.25), "0.25");
/// assert_eq!(exact(6.5e-12), "6.5e-12");
/// assert_eq!(exact(1e300), "1e300");
/// ```
pub fn exact(value: f64) -> String {
    let is_usual = value == 0.0 || (1e-5..1e16).contains(&value.abs());
    if is_usual || !value.is_finite() {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// Six significant digits, in decimal or scientific notation, whichever is shorter.
pub fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let scientific = format!("{value:.5e}");
    let exponent = scientific
        .split_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok());
    match exponent {
        Some(exponent @ -4..=5) => {
            let decimals = usize::try_from(5_i32 - exponent).unwrap_or(0);
            format!("{value:.decimals$}")
        }
        _ => scientific,
    }
}

/// A number to two significant digits of its error, with at most 8 decimals; in scientific notation
/// where the number is below 1e-4 and would need more, and from 1e15 on.
pub fn rounded(value: f64, error: f64) -> String {
    if !(error > 0.0 && error.is_finite() && value.is_finite()) {
        return exact(value);
    }
    if value.abs() >= 1e15 {
        return format!("{value:.3e}");
    }
    #[expect(clippy::cast_possible_truncation, reason = "an exponent of ten")]
    let decimals = (1.0 - error.log10().floor()) as i64;
    let decimals = usize::try_from(decimals).unwrap_or(0);
    if decimals <= 8 || value.abs() >= 1e-4 {
        format!("{value:.*}", decimals.min(8))
    } else {
        format!("{value:.3e}")
    }
}

/// A number with fixed decimals; with six significant digits from a million on.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    if value.abs() < 1e6 {
        format!("{value:.decimals$}")
    } else {
        digits(value)
    }
}

/// A percentage with two significant digits, whole above 10, in scientific notation from a million on.
pub fn two_digits(value: f64) -> String {
    if !value.is_finite() {
        return "?".to_owned();
    }
    let decimals = match value.abs() {
        size if size >= 999_999.5 => return format!("{value:.1e}"),
        size if size >= 9.95 => 0,
        size if size >= 0.995 => 1,
        size if size >= 0.0995 => 2,
        size if size >= 0.000_95 => 3,
        0.0 => 0,
        _ => return format!("{value:.0e}"),
    };
    format!("{value:.decimals$}")
}

/// An angle in degrees, from radians, rounded so that an angle that was given in degrees is
/// recovered exactly.
pub fn in_degrees(radians: f64) -> f64 {
    (radians.to_degrees() * 1e9).round() / 1e9
}

/// Serialises an angle in radians as degrees: files hold angles in degrees.
pub(crate) mod as_degrees {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[allow(
        clippy::trivially_copy_pass_by_ref,
        reason = "serde's signature; on 32 bits it is no lint"
    )]
    pub(crate) fn serialize<S: Serializer>(radians: &f64, to: S) -> Result<S::Ok, S::Error> {
        super::in_degrees(*radians).serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        f64::deserialize(from).map(f64::to_radians)
    }
}

/// [`as_degrees`] for an optional angle.
pub(crate) mod as_optional_degrees {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[expect(clippy::ref_option, reason = "serde's signature")]
    pub(crate) fn serialize<S: Serializer>(
        radians: &Option<f64>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        radians.map(super::in_degrees).serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
        Ok(Option::<f64>::deserialize(from)?.map(f64::to_radians))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_that_control_a_terminal_are_replaced_by_their_codes() {
        assert_eq!(printable("paint\t1\nk\u{3b8}"), "paint\t1\nk\u{3b8}");
        assert_eq!(printable("\x1b[31mred\r"), "\\u{1b}[31mred\\u{d}");
        assert_eq!(printable("a\u{202e}b\u{9b}"), "a\\u{202e}b\\u{9b}");
    }

    #[test]
    fn counts_have_their_plural() {
        assert_eq!(counted(1, "reading"), "1 reading");
        assert_eq!(counted(0, "reading"), "0 readings");
    }

    #[test]
    fn numbers_have_six_significant_digits() {
        assert_eq!(digits(0.0), "0");
        assert_eq!(digits(0.022_859_766), "0.0228598");
        assert_eq!(digits(301.502_668), "301.503");
        assert_eq!(digits(-2.839_658), "-2.83966");
        assert_eq!(digits(123_456_789.0), "1.23457e8");
        assert_eq!(digits(1.5e-9), "1.50000e-9");
    }

    #[test]
    fn numbers_have_two_digits_of_their_error() {
        assert_eq!(rounded(0.022_859_766, 0.000_5), "0.02286");
        assert_eq!(rounded(1870.3, 20.0), "1870");
        assert_eq!(rounded(0.156, 1e-17), "0.15600000");
        assert_eq!(rounded(1.5e-9, 1e-11), "1.500e-9");
    }

    #[test]
    fn angles_come_back_as_they_were_written() {
        for degrees in [0.1_f64, 41.4, 63.256_3, 89.999] {
            assert_eq!(in_degrees(degrees.to_radians()), degrees);
        }
    }
}
