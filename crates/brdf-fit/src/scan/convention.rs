//! The conventions of a file: its format, and the directions in which it counts its angles.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::format::ParseError;

/// A format of files with measured values.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// The project's own table: [`read::csv`](crate::read::csv).
    #[default]
    Csv,
    /// A MERL table: [`read::merl`](crate::read::merl).
    Merl,
    /// ASTM E1392 and E2387 text, including the layout of Cornell: [`read::astm`](crate::read::astm).
    Astm,
    /// Zemax tabular BSDF: [`read::zemax`](crate::read::zemax).
    Zemax,
    /// Reflectance factors of the Black Lab: [`read::black_lab`](crate::read::black_lab).
    BlackLab,
    /// Incidences in columns, views in rows: [`read::goniometer`](crate::read::goniometer).
    Goniometer,
    /// A sheet of a workbook, Excel or OpenDocument: [`read::workbook`](crate::read::workbook).
    Workbook,
    /// Tabulated BSDF of FRED: [`read::fred`](crate::read::fred).
    Fred,
    /// Look-up table of ASAM OpenMATERIAL 3D: [`read::open_material`](crate::read::open_material).
    OpenMaterial,
    /// Table of BSDF of a TracePro surface property: [`read::tracepro`](crate::read::tracepro).
    #[serde(rename = "tracepro")]
    TracePro,
    /// Surface scattering distribution data of libbsdf: [`read::ssdd`](crate::read::ssdd).
    Ssdd,
    /// Ansys Speos tables of a surface: [`read::speos`](crate::read::speos).
    Speos,
    /// LightTools tables of a BSDF: [`read::lighttools`](crate::read::lighttools).
    #[serde(rename = "lighttools")]
    LightTools,
    /// Exports of the goniophotometer RT-300S: [`read::rt300s`](crate::read::rt300s).
    Rt300s,
    /// RGL tensor files of measured BRDFs: [`read::rgl`](crate::read::rgl).
    Rgl,
    /// LBNL WINDOW XML files with a Klems basis: [`read::klems`](crate::read::klems).
    Klems,
}

impl Format {
    /// All formats, with their names in options and files.
    pub const NAMED: [(Self, &str); 16] = [
        (Self::Csv, "csv"),
        (Self::Merl, "merl"),
        (Self::Astm, "astm"),
        (Self::Zemax, "zemax"),
        (Self::BlackLab, "black-lab"),
        (Self::Goniometer, "goniometer"),
        (Self::Workbook, "workbook"),
        (Self::Fred, "fred"),
        (Self::OpenMaterial, "open-material"),
        (Self::TracePro, "tracepro"),
        (Self::Ssdd, "ssdd"),
        (Self::Speos, "speos"),
        (Self::LightTools, "lighttools"),
        (Self::Rt300s, "rt300s"),
        (Self::Rgl, "rgl"),
        (Self::Klems, "klems"),
    ];

    /// The name in options and files.
    pub fn name(self) -> &'static str {
        let found = Self::NAMED.iter().find(|(format, _)| *format == self);
        found.map_or("", |(_, name)| name)
    }

    pub(crate) fn names() -> String {
        Self::NAMED.map(|(_, name)| name).join(", ")
    }
}

impl FromStr for Format {
    type Err = ParseError;

    fn from_str(text: &str) -> Result<Self, ParseError> {
        let found = Self::NAMED.iter().find(|(_, name)| *name == text);
        found.map(|(format, _)| *format).ok_or_else(|| {
            let names = Self::names();
            ParseError::new(format!(
                "\"{text}\" is not a format: expected one of {names}"
            ))
        })
    }
}

/// The side of the surface normal that a file counts as positive, or as azimuth zero.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The side of the source: the convention of the model.
    #[default]
    Source,
    /// The side of the mirror direction, as in ASTM E2387 and on most goniometers.
    Forward,
}

impl FromStr for Side {
    type Err = ParseError;

    fn from_str(text: &str) -> Result<Self, ParseError> {
        match text {
            "source" => Ok(Self::Source),
            "forward" => Ok(Self::Forward),
            _ => Err(ParseError::new(format!(
                "\"{text}\": expected source or forward"
            ))),
        }
    }
}

/// The angular convention of a file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Convention {
    /// The side on which theta is positive.
    pub theta_positive: Side,
    /// The side on which phi is zero.
    pub phi_zero: Side,
}

impl Convention {
    /// Theta and phi in radians in the convention of the model, from degrees in this convention.
    pub(crate) fn in_model(self, theta_deg: f64, phi_deg: f64) -> (f64, f64) {
        let theta = match self.theta_positive {
            Side::Source => theta_deg,
            Side::Forward => -theta_deg,
        };
        // The sum is taken in degrees, where it is exact.
        let phi = match self.phi_zero {
            Side::Source => phi_deg,
            Side::Forward => phi_deg + 180.0,
        };
        (theta.to_radians(), phi.to_radians())
    }
}

/// What was said about a file, beside its format and its convention, when it was read.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReadSettings {
    /// What columns are whose names do not say it: see
    /// [`ReadOptions::columns`](crate::read::ReadOptions::columns).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub columns: Vec<(String, String)>,
    /// Keys and values in place of those of the comments: see
    /// [`ReadOptions::declarations`](crate::read::ReadOptions::declarations).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub declarations: Vec<(String, String)>,
    /// The files that are joined as one scan; empty for a file on its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joined: Vec<String>,
}

impl ReadSettings {
    /// Whether nothing was said.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// The differences from the convention of the model; empty if there are none.
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
