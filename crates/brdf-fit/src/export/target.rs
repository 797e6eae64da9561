//! The forms in which a coating leaves.

use std::io::{self, Write};
use std::str::FromStr;

use brdf_core::GeometryError;

use super::coating::{Coating, CoatingError};
use super::csv::AngleGrid;
use super::table::{MOST_ENTRIES, Unreachable};
use super::{astm, csv, merl, zemax};

/// A form in which a coating leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A MERL table of three channels.
    Merl,
    /// The model as versioned JSON: what [`Coating::read`] reads.
    Json,
    /// ASTM E1392 text in Cornell's layout, a table.
    Astm,
    /// Zemax tabular BSDF.
    Zemax,
    /// Our own table on a grid of angles.
    Csv,
}

impl Target {
    /// All forms, with the names that options give them.
    pub const NAMED: [(Self, &str); 5] = [
        (Self::Merl, "merl"),
        (Self::Json, "json"),
        (Self::Astm, "astm"),
        (Self::Zemax, "zemax"),
        (Self::Csv, "csv"),
    ];
}

impl FromStr for Target {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::NAMED.iter().find(|(_, name)| *name == text);
        found.map(|(target, _)| *target).ok_or_else(|| {
            let names = Self::NAMED.map(|(_, name)| name).join(", ");
            format!("\"{text}\" is not a format: expected one of {names}")
        })
    }
}

/// What a form may be told.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportOptions {
    /// The first word of the names in source code.
    pub name: String,
    /// The largest error of a table: of f_r interpolated between its entries, relative.
    pub tolerance: f64,
    /// The angles of our own table.
    pub grid: AngleGrid,
}

/// Why a coating does not leave.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The form has no room for it.
    #[error(transparent)]
    Coating(#[from] CoatingError),
    /// No table of a size that is of use keeps to the tolerance.
    #[error(
        "a table within {tolerance:e} has more than {MOST_ENTRIES} entries: expected --tolerance \
         {reachable:.1e} or more"
    )]
    Tolerance {
        /// The tolerance that was asked for.
        tolerance: f64,
        /// One that can be kept to.
        reachable: f64,
    },
    /// Angles outside the model's domain.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// It cannot be written.
    #[error(transparent)]
    Io(#[from] io::Error),
}

impl ExportError {
    pub(super) fn tolerance(tolerance: f64, unreachable: &Unreachable) -> Self {
        Self::Tolerance {
            tolerance,
            reachable: unreachable.reachable,
        }
    }
}

/// Writes a coating in a form.
pub fn export(
    coating: &Coating,
    target: Target,
    options: &ExportOptions,
    writer: &mut dyn Write,
) -> Result<(), ExportError> {
    match target {
        Target::Merl => {
            let fits = coating.fits.as_slice();
            let fit = |i: usize| &fits[i.min(fits.len() - 1)].brdf;
            merl::write([0, 1, 2].map(fit), writer)?;
        }
        Target::Json => coating.write(writer)?,
        Target::Astm => astm::write(coating, options.tolerance, writer)?,
        Target::Zemax => zemax::write(coating.only()?, options.tolerance, writer)?,
        Target::Csv => csv::write(coating, &options.grid, writer)?,
    }
    Ok(())
}
