//! The comments of a text: metadata as `# key: value`, some of which the readings depend on.

use std::fmt::Display;

use super::conversion::{Kind, Quantity, Scale, Values};
use super::error::ReadError;
use super::names::quantity_named;
use super::number::{is_wavelength, parse_number};
use super::text::Text;
use crate::scan::{Metadata, RefractiveIndex};

/// The key of the source's azimuth in degrees.
pub(super) const SOURCE_AZIMUTH: &str = "source_azimuth_deg";

/// The text of a comment line, also of one that a spreadsheet has put into quotes; `None` where the
/// line is not a comment.
pub(super) fn comment_of(line: &[u8]) -> Option<&[u8]> {
    line.strip_prefix(b"#")
        .or_else(|| line.strip_prefix(b"\"#"))
}

/// The key in lower case and the value of a comment `key: value` or `key = value`, without the
/// separators that a spreadsheet appends.
///
/// Files of a pab goniophotometer give the direction of the source as `intheta 30` and `inphi 180`.
pub(super) fn key_and_value(comment: &str) -> Option<(String, String)> {
    let mut words = comment.split_whitespace();
    if let (Some(key @ ("intheta" | "inphi")), Some(value), None) =
        (words.next(), words.next(), words.next())
    {
        let key = if key == "intheta" {
            "psi_deg"
        } else {
            SOURCE_AZIMUTH
        };
        return Some((key.to_owned(), value.to_owned()));
    }
    let (key, value) = comment.split_once([':', '='])?;
    let key = key.trim().to_lowercase();
    let value = value
        .trim()
        .trim_end_matches([',', ';', '\t', '"'])
        .trim_end();
    let is_word = !key.is_empty() && !key.contains(char::is_whitespace);
    is_word.then(|| (key, value.to_owned()))
}

/// The metadata in the comments of a text, and those of them that the readings depend on.
#[derive(Default)]
pub(super) struct Comments {
    pub(super) metadata: Metadata,
    pub(super) refractive_index: Option<RefractiveIndex>,
    quantity: Option<Quantity>,
    scale: Option<Scale>,
    factor: Option<f64>,
    missing: Option<f64>,
    /// The keys that the options of the reading declare: they take precedence over the file.
    declared: Vec<String>,
}

impl Comments {
    /// The comments that the options of the reading declare.
    ///
    /// # Errors
    ///
    /// A declaration is not valid.
    pub(super) fn declared(
        text: &Text<'_>,
        declarations: &[(String, String)],
    ) -> Result<Self, ReadError> {
        let mut comments = Self::default();
        for (key, value) in declarations {
            let message = |message| text.error(format!("declared {message}"));
            comments.set(key, value).map_err(message)?;
            comments.metadata.0.push((key.clone(), value.clone()));
            comments.declared.push(key.clone());
        }
        Ok(comments)
    }

    /// Adds the key and the value of a comment, if it has them.
    ///
    /// # Errors
    ///
    /// The value of a key that the readings depend on is not valid, or contradicts an earlier one.
    pub(super) fn add(
        &mut self,
        text: &Text<'_>,
        line: u64,
        comment: &[u8],
    ) -> Result<(), ReadError> {
        let Some((key, value)) = key_and_value(&String::from_utf8_lossy(comment)) else {
            return Ok(());
        };
        if self.declared.contains(&key) {
            return Ok(());
        }
        let set = self.set(&key, &value);
        set.map_err(|message| text.line_error(line, message))?;
        self.metadata.0.push((key, value));
        Ok(())
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), String> {
        match key {
            "quantity" => set_once(&mut self.quantity, quantity(value), key),
            "unit" => set_once(&mut self.scale, scale(value), key),
            "factor" => set_once(&mut self.factor, number(value, |x| x > 0.0), key),
            "missing" => set_once(&mut self.missing, number(value, |_| true), key),
            "refractive_index" => {
                let value = with_decimal_points(value);
                set_once(&mut self.refractive_index, value.parse(), key)
            }
            _ => Ok(()),
        }
    }

    /// The quantity and the factor of the values, from the comments and from what the file itself says
    /// of the values.
    ///
    /// # Errors
    ///
    /// The two contradict each other, or f_r is said to be in percent.
    pub(super) fn values(&self, of_file: Quantity) -> Result<Values, String> {
        let mut quantity = match self.quantity {
            Some(stated) if of_file != Quantity::BRDF && of_file != stated => {
                return Err(format!(
                    "the comments say that the values are {stated}, the column that they are {of_file}"
                ));
            }
            stated => stated.unwrap_or(of_file),
        };
        if let Some(scale) = self.scale {
            if quantity.scale != Scale::One && quantity.scale != scale {
                return Err(format!(
                    "the values are {quantity}: the unit contradicts this"
                ));
            }
            quantity.scale = scale;
        }
        if quantity.scale == Scale::Percent && quantity.kind != Kind::ReflectanceFactor {
            return Err(format!(
                "{quantity} has no meaning: expected \"quantity: reflectance_factor\" beside the unit"
            ));
        }
        let factor = self.factor.unwrap_or(1.0);
        Ok(Values { quantity, factor })
    }

    /// The value that stands for a reading that was not taken.
    pub(super) fn missing(&self) -> Option<f64> {
        self.missing
    }
}

fn quantity(value: &str) -> Result<Quantity, String> {
    quantity_named(value).ok_or_else(|| {
        format!(
            "\"{value}\" is not known: expected brdf, brdf_cos, reflectance_factor, \
             reflectance_factor_percent, log10_brdf or brdf_db"
        )
    })
}

fn scale(value: &str) -> Result<Scale, String> {
    match value.to_lowercase().as_str() {
        "%" | "percent" => Ok(Scale::Percent),
        "1/sr" | "per sr" | "sr^-1" | "1" => Ok(Scale::One),
        "log10" => Ok(Scale::Log10),
        "db" => Ok(Scale::Decibel),
        _ => Err(format!(
            "\"{value}\" is not known: expected percent, 1/sr, log10 or dB"
        )),
    }
}

fn number(value: &str, accepts: fn(f64) -> bool) -> Result<f64, String> {
    let number = parse_number(value.as_bytes(), true);
    let number = number.filter(|number| number.is_finite() && accepts(*number));
    number.ok_or_else(|| format!("\"{value}\": expected a number, of a factor above 0"))
}

/// A single number with a decimal comma, as with a point: a list has other commas.
fn with_decimal_points(value: &str) -> String {
    match parse_number(value.as_bytes(), true) {
        Some(number) if value.matches(',').count() == 1 && !value.contains('=') => {
            number.to_string()
        }
        _ => value.to_owned(),
    }
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

/// The wavelength in micrometres that the metadata give by `wavelength_um` or `wavelength_nm`.
///
/// # Errors
///
/// As [`number_of_key`].
pub(super) fn stated_wavelength_um(
    text: &Text<'_>,
    metadata: &Metadata,
) -> Result<Option<f64>, ReadError> {
    let number = |key, expected, accepts| number_of_key(text, metadata, key, expected, accepts);
    let expected = "expected micrometres above 0";
    let micrometres = number("wavelength_um", expected, is_wavelength)?;
    let expected = "expected nanometres above 0";
    let nanometres = number("wavelength_nm", expected, |nm| is_wavelength(nm / 1000.0))?;
    Ok(micrometres.or(nanometres.map(|nm| nm / 1000.0)))
}
