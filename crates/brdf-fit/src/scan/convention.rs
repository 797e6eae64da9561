//! How a file states its readings: its format, and the sides from which it counts its angles.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// A format of files with measured values.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// The project's own table: [`read::csv`](crate::read::csv).
    #[default]
    Csv,
    /// A MERL table: [`read::merl`](crate::read::merl).
    Merl,
    /// ASTM E1392 and E2387 text, also as Cornell wrote it: [`read::astm`](crate::read::astm).
    Astm,
    /// Zemax tabular BSDF: [`read::zemax`](crate::read::zemax).
    Zemax,
    /// Reflectance factors of the Black Lab: [`read::black_lab`](crate::read::black_lab).
    BlackLab,
    /// Incidences in columns, views in rows: [`read::goniometer`](crate::read::goniometer).
    Goniometer,
}

impl Format {
    /// All formats, with the names that options and files give them.
    pub const NAMED: [(Self, &str); 6] = [
        (Self::Csv, "csv"),
        (Self::Merl, "merl"),
        (Self::Astm, "astm"),
        (Self::Zemax, "zemax"),
        (Self::BlackLab, "black-lab"),
        (Self::Goniometer, "goniometer"),
    ];

    /// The name that options and files give it.
    pub fn name(self) -> &'static str {
        let found = Self::NAMED.iter().find(|(format, _)| *format == self);
        found.map_or("", |(_, name)| name)
    }

    pub(crate) fn names() -> String {
        Self::NAMED.map(|(_, name)| name).join(", ")
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::NAMED.iter().find(|(_, name)| *name == text);
        found.map(|(format, _)| *format).ok_or_else(|| {
            let names = Self::names();
            format!("\"{text}\" is not a format: expected one of {names}")
        })
    }
}

/// Which side of the surface normal, or which azimuth, a file calls positive or zero.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The source's side: the model's convention.
    #[default]
    Source,
    /// The side of the mirror direction: as in ASTM E2387 and most goniometers.
    Forward,
}

impl FromStr for Side {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "source" => Ok(Self::Source),
            "forward" => Ok(Self::Forward),
            _ => Err(format!("\"{text}\": expected source or forward")),
        }
    }
}

/// The angular convention of a file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Convention {
    /// The side on which theta counts positive.
    pub theta_positive: Side,
    /// The side on which phi is zero.
    pub phi_zero: Side,
}

impl Convention {
    /// Theta and phi in radians in the model's convention, from degrees in this one.
    pub(crate) fn in_model(self, theta_deg: f64, phi_deg: f64) -> (f64, f64) {
        let theta = match self.theta_positive {
            Side::Source => theta_deg,
            Side::Forward => -theta_deg,
        };
        // In degrees, so that 180 deg remains what it is.
        let phi = match self.phi_zero {
            Side::Source => phi_deg,
            Side::Forward => phi_deg + 180.0,
        };
        (theta.to_radians(), phi.to_radians())
    }
}

/// What differs from the model's convention, in words; nothing where it is that.
impl fmt::Display for Convention {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.theta_positive, self.phi_zero) {
            (Side::Source, Side::Source) => Ok(()),
            (Side::Forward, Side::Source) => f.write_str("theta positive forward"),
            (Side::Source, Side::Forward) => f.write_str("phi zero forward"),
            (Side::Forward, Side::Forward) => f.write_str("theta positive and phi zero forward"),
        }
    }
}
