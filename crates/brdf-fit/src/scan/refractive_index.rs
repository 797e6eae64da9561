//! The refractive index of the coating: one for all wavelengths, or one for each.

use std::str::FromStr;

use brdf_core::check_refractive_index;
use serde::{Deserialize, Serialize};

use crate::format::ParseError;

/// The largest relative difference between a wavelength and the listed wavelength whose index
/// applies to it.
pub(crate) const WAVELENGTH_TOLERANCE: f64 = 0.01;

/// The refractive index n, relative to air.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RefractiveIndex {
    /// The same at every wavelength.
    Same(f64),
    /// Pairs of a wavelength in micrometres and the index there.
    ByWavelength(Vec<(f64, f64)>),
}

impl RefractiveIndex {
    /// The index at a wavelength in micrometres: that of the nearest listed wavelength within 1 %, so
    /// that 0.63 in a list applies to a scan at 0.63079 um. Nothing is interpolated.
    pub fn at(&self, wavelength_um: Option<f64>) -> Option<f64> {
        match self {
            Self::Same(n) => Some(*n),
            Self::ByWavelength(list) => {
                let wanted = wavelength_um?;
                let distance = |listed: f64| (listed / wanted - 1.0).abs();
                list.iter()
                    .filter(|(listed, _)| distance(*listed) <= WAVELENGTH_TOLERANCE)
                    .min_by(|a, b| distance(a.0).total_cmp(&distance(b.0)))
                    .map(|(_, n)| *n)
            }
        }
    }
}

/// From `1.5`, or `0.63=1.60,0.85=1.58` with wavelengths in micrometres.
impl FromStr for RefractiveIndex {
    type Err = ParseError;

    fn from_str(text: &str) -> Result<Self, ParseError> {
        if !text.contains('=') {
            return parse_index(text).map(Self::Same);
        }
        text.split(',')
            .map(|entry| {
                let (wavelength, n) = entry.split_once('=').ok_or_else(|| {
                    ParseError::new(format!("\"{entry}\": expected WAVELENGTH=INDEX"))
                })?;
                Ok((parse_wavelength(wavelength)?, parse_index(n)?))
            })
            .collect::<Result<Vec<(f64, f64)>, ParseError>>()
            .and_then(without_contradiction)
            .map(Self::ByWavelength)
    }
}

fn without_contradiction(list: Vec<(f64, f64)>) -> Result<Vec<(f64, f64)>, ParseError> {
    let contradicts = |(i, (wavelength, n)): &(usize, &(f64, f64))| {
        list[..*i]
            .iter()
            .any(|(other, m)| other == wavelength && m != n)
    };
    match list.iter().enumerate().find(contradicts) {
        Some((_, (wavelength, _))) => {
            Err(ParseError::new(format!("two indices for {wavelength} um")))
        }
        None => Ok(list),
    }
}

fn parse_index(text: &str) -> Result<f64, ParseError> {
    let n: f64 = text.trim().parse().map_err(|_| {
        ParseError::new(format!(
            "\"{text}\" is not a refractive index: expected a number such as 1.5, or 0.63=1.60,0.85=1.58"
        ))
    })?;
    check_refractive_index(n).map_err(|error| ParseError::new(error.to_string()))
}

fn parse_wavelength(text: &str) -> Result<f64, ParseError> {
    text.trim()
        .parse()
        .ok()
        .filter(|w: &f64| *w > 0.0 && w.is_finite())
        .ok_or_else(|| {
            ParseError::new(format!(
                "\"{text}\" is not a wavelength: expected a positive number of micrometres"
            ))
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_index_holds_everywhere() {
        let n: RefractiveIndex = "1.5".parse().unwrap();
        assert_eq!(n.at(None), Some(1.5));
        assert_eq!(n.at(Some(0.4)), Some(1.5));
    }

    #[test]
    fn a_list_is_looked_up_by_the_nearest_wavelength() {
        let n: RefractiveIndex = "0.63=1.60, 0.85=1.58,0.851=1.57".parse().unwrap();
        assert_eq!(n.at(Some(0.63079)), Some(1.60));
        assert_eq!(n.at(Some(0.8506)), Some(1.57));
        assert_eq!(n.at(Some(0.7)), None);
        assert_eq!(n.at(None), None);
    }

    #[test]
    fn what_is_not_an_index_is_named() {
        let message = |text: &str| text.parse::<RefractiveIndex>().unwrap_err();
        assert!(message("glass").to_string().contains("\"glass\""));
        assert!(message("0.9").to_string().contains("n = 0.9"));
        assert!(message("NaN").to_string().contains("n = NaN"));
        assert!(message("0.6=1.5,2").to_string().contains("\"2\""));
        assert!(message("-0.6=1.5").to_string().contains("\"-0.6\""));
        assert!(message("0.6=1.5,").to_string().contains("\"\""));
        assert!(
            message("0.6=1.5,0.6=1.6")
                .to_string()
                .contains("two indices for 0.6 um")
        );
    }
}
