//! How a file is read.

use std::path::Path;

use super::error::ReadError;
use super::text;
use crate::scan::{Convention, Format, Side};

/// How a file is read.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// The format; found by the content, then by the extension, where it is not given.
    pub format: Option<Format>,
    /// The side on which the file counts theta positive; as its format has it where it is not given.
    pub theta_positive: Option<Side>,
    /// The side on which the file's azimuth is zero; as its format has it where it is not given.
    pub phi_zero: Option<Side>,
    /// How many readings of each wavelength are kept, evenly over the directions; all where it is not
    /// given.
    pub sample: Option<usize>,
}

impl ReadOptions {
    /// The convention of a file whose format has one of its own.
    pub fn convention(&self, of_format: Convention) -> Convention {
        Convention {
            theta_positive: self.theta_positive.unwrap_or(of_format.theta_positive),
            phi_zero: self.phi_zero.unwrap_or(of_format.phi_zero),
        }
    }

    /// The convention of a file whose format leaves no choice.
    ///
    /// Errors: an option says that it is another, and `why` it cannot be.
    pub(super) fn fixed(
        &self,
        path: &Path,
        of_format: Convention,
        why: &str,
    ) -> Result<Convention, ReadError> {
        if self.convention(of_format) == of_format {
            return Ok(of_format);
        }
        let message = format!("its sides cannot be chosen: {why}");
        Err(text::file_error(path, message))
    }
}
