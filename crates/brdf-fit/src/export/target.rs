//! The forms in which a coating leaves.

use std::io::{self, Write};
use std::str::FromStr;

use super::coating::{Coating, CoatingError};
use super::merl;

/// A form in which a coating leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A MERL table of three channels.
    Merl,
    /// The model as versioned JSON: what [`Coating::read`] reads.
    Json,
}

impl Target {
    /// All forms, with the names that options give them.
    pub const NAMED: [(Self, &str); 2] = [(Self::Merl, "merl"), (Self::Json, "json")];
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
}

/// Why a coating does not leave.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The form has no room for it.
    #[error(transparent)]
    Coating(#[from] CoatingError),
    /// It cannot be written.
    #[error(transparent)]
    Io(#[from] io::Error),
}

/// Writes a coating in a form.
pub fn export(
    coating: &Coating,
    target: Target,
    _options: &ExportOptions,
    writer: &mut dyn Write,
) -> Result<(), ExportError> {
    match target {
        Target::Merl => {
            let fits = coating.fits.as_slice();
            let fit = |i: usize| &fits[i.min(fits.len() - 1)].brdf;
            merl::write([0, 1, 2].map(fit), writer)?;
        }
        Target::Json => coating.write(writer)?,
    }
    Ok(())
}
