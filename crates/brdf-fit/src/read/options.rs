//! How a file is read.

use std::path::Path;

use super::error::ReadError;
use crate::scan::{Convention, Format, ReadSettings, Side};

/// The key of the sheet of a workbook.
pub(super) const SHEET: &str = "sheet";

/// The keys of comments that the readings of a table depend on, and that of the sheet of a workbook.
pub const DECLARED_KEYS: [&str; 13] = [
    "quantity",
    "unit",
    "factor",
    "missing",
    "psi_deg",
    "phi_deg",
    "source_azimuth_deg",
    "wavelength_um",
    "wavelength_nm",
    "refractive_index",
    "polarisation",
    "columns",
    SHEET,
];

/// How a file is read.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// The format of the file. `None` detects it by the content, then by the extension.
    pub format: Option<Format>,
    /// The side of the normal on which the file counts theta positive. `None` takes the convention of
    /// the format.
    pub theta_positive: Option<Side>,
    /// The side of the normal on which the file's azimuth is zero. `None` takes the convention of the
    /// format.
    pub phi_zero: Option<Side>,
    /// How many readings of each wavelength are kept, spread evenly over the directions. `None` keeps
    /// all.
    pub sample: Option<usize>,
    /// What columns of a table are whose names do not say it: the name in the file, and a name of the
    /// [table](crate::read::csv), such as `Incident` and `psi_deg`.
    pub columns: Vec<(String, String)>,
    /// Keys and values in place of those of the comments of a file, such as `quantity` and
    /// `reflectance_factor`; see [`DECLARED_KEYS`].
    pub declarations: Vec<(String, String)>,
}

impl ReadOptions {
    /// The angular convention of a file: the sides that are set here, and otherwise those of its
    /// format.
    pub fn convention(&self, of_format: Convention) -> Convention {
        Convention {
            theta_positive: self.theta_positive.unwrap_or(of_format.theta_positive),
            phi_zero: self.phi_zero.unwrap_or(of_format.phi_zero),
        }
    }

    /// What a scan that is read with these options keeps of them.
    pub(super) fn settings(&self) -> ReadSettings {
        ReadSettings {
            columns: self.columns.clone(),
            declarations: self.declarations.clone(),
            joined: Vec::new(),
        }
    }

    /// The angular convention of a file whose format fixes it.
    ///
    /// # Errors
    ///
    /// A side is set that differs from the format's; the message gives `why` the format fixes it.
    pub(super) fn fixed_convention(
        &self,
        path: &Path,
        of_format: Convention,
        why: &str,
    ) -> Result<Convention, ReadError> {
        if self.convention(of_format) == of_format {
            return Ok(of_format);
        }
        let message = format!("the angular convention cannot be chosen: {why}");
        Err(ReadError::file(path, message))
    }
}
