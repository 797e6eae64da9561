//! The comments of a text: metadata as `# key: value`, some of which the readings depend on.

use std::fmt::Display;

use super::conversion::Quantity;
use super::error::ReadError;
use super::number::parse_number;
use super::text::Text;
use crate::scan::{Metadata, RefractiveIndex};

/// The text of a comment line, also of one that a spreadsheet has put into quotes; `None` where the
/// line is not a comment.
pub(super) fn comment_of(line: &[u8]) -> Option<&[u8]> {
    line.strip_prefix(b"#")
        .or_else(|| line.strip_prefix(b"\"#"))
}

/// The key in lower case and the value of a comment `key: value` or `key = value`, without the
/// separators that a spreadsheet appends.
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

/// The metadata in the comments of a text.
#[derive(Default)]
pub(super) struct Comments {
    pub(super) metadata: Metadata,
    pub(super) quantity: Option<Quantity>,
    pub(super) refractive_index: Option<RefractiveIndex>,
}

impl Comments {
    /// Adds the key and the value of a comment, if it has them.
    ///
    /// # Errors
    ///
    /// The quantity or the refractive index is not valid, or contradicts an earlier one.
    pub(super) fn add(
        &mut self,
        text: &Text<'_>,
        line: u64,
        comment: &[u8],
    ) -> Result<(), ReadError> {
        let Some((key, value)) = key_and_value(&String::from_utf8_lossy(comment)) else {
            return Ok(());
        };
        let set = match key.as_str() {
            "quantity" => set_once(&mut self.quantity, quantity(&value), &key),
            "refractive_index" => set_once(&mut self.refractive_index, value.parse(), &key),
            _ => Ok(()),
        };
        set.map_err(|message| text.line_error(line, message))?;
        self.metadata.0.push((key, value));
        Ok(())
    }
}

fn quantity(value: &str) -> Result<Quantity, String> {
    let expected = "expected brdf, brdf_cos or reflectance_factor";
    Quantity::named(value).ok_or_else(|| format!("\"{value}\" is not known: {expected}"))
}

/// Sets a value that the readings depend on. A key may be repeated with the same value only.
fn set_once<T: PartialEq>(
    slot: &mut Option<T>,
    value: Result<T, impl Display>,
    key: &str,
) -> Result<(), String> {
    let value = value.map_err(|error| format!("{key}: {error}"))?;
    if slot.as_ref().is_some_and(|before| *before != value) {
        return Err(contradiction(key));
    }
    *slot = Some(value);
    Ok(())
}

fn contradiction(key: &str) -> String {
    format!("{key} is given twice, with different values")
}

/// The number that the metadata give for a key; `None` where they do not contain it.
///
/// # Errors
///
/// The value is not a finite number for which `accepts` is true, or the key has several values.
pub(super) fn number_of_key(
    text: &Text<'_>,
    metadata: &Metadata,
    key: &str,
    expected: &str,
    accepts: fn(f64) -> bool,
) -> Result<Option<f64>, ReadError> {
    let Some(value) = metadata.get(key) else {
        return Ok(None);
    };
    let contradicts = |(name, other): &(String, String)| name == key && other != value;
    if metadata.0.iter().any(contradicts) {
        return Err(text.error(contradiction(key)));
    }
    match parse_number(value.as_bytes(), true) {
        Some(number) if number.is_finite() && accepts(number) => Ok(Some(number)),
        _ => Err(text.error(format!("{key}: \"{value}\": {expected}"))),
    }
}
