//! Errors of reading a material and of choosing among its fits.

use std::path::PathBuf;

use brdf_core::ParameterError;

use crate::format::listed;
use crate::report::{DocumentError, without_position};

/// The version of the JSON format of a [`Material`](super::Material).
pub(super) const FORMAT_VERSION: u32 = 1;

/// Why a file cannot be read as a [`Material`](super::Material).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MaterialError {
    /// The file cannot be read, or is neither an exported model nor a document of fits.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// The file has the top-level keys of an exported model but is damaged.
    #[error(
        "{}, line {}, column {}: {}: expected an exported model",
        path.display(), error.line(), error.column(), without_position(.error)
    )]
    Model {
        /// The file.
        path: PathBuf,
        /// The error of the JSON parser, with line and column.
        error: serde_json::Error,
    },
    /// The model was written by another version of the format.
    #[error(
        "{}: format_version {found} of a model: expected {FORMAT_VERSION} (was it written by a later \
         version?)",
        path.display()
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// The version of the file.
        found: u32,
    },
    /// The model contains no fit.
    #[error("{}: contains no fit: expected a model of at least one", path.display())]
    NoFits {
        /// The file.
        path: PathBuf,
    },
    /// The parameters of a fit are outside the domain of the model.
    #[error("{}, the fit of {file}: {error}", path.display())]
    Parameter {
        /// The file.
        path: PathBuf,
        /// The file of the scan.
        file: String,
        /// The parameter and its domain.
        error: ParameterError,
    },
}

/// Why the fits to export cannot be chosen from a [`Material`](super::Material).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SelectionError {
    /// No scan has the given name.
    #[error("no fit of {name}: expected one of {}", listed(.available, ", "))]
    NoSuchFile {
        /// The given path or file name.
        name: String,
        /// The paths of the scans.
        available: Vec<String>,
    },
    /// The fits are of several scans.
    #[error("there are fits of several files: choose one of {}", listed(.available, ", "))]
    SeveralFiles {
        /// The paths of the scans.
        available: Vec<String>,
    },
    /// No fit is within 1 % of the given wavelength.
    #[error("no fit at {wavelength_um} um: expected one of {}", listed(.available, ", "))]
    NoSuchWavelength {
        /// The given wavelength in micrometres.
        wavelength_um: f64,
        /// The wavelengths of the fits, as text.
        available: Vec<String>,
    },
    /// One fit is needed, and there are several.
    #[error("there are several fits: choose one of the wavelengths {}", listed(.available, ", "))]
    SeveralWavelengths {
        /// The wavelengths of the fits, as text.
        available: Vec<String>,
    },
    /// There is no fit for one of the colours red, green and blue.
    #[error(
        "no fit within {max_distance_um} um of {colour} ({primary_um} um): choose one wavelength, for \
         grey, or those of red, green and blue, from {}",
        listed(.available, ", ")
    )]
    NoColour {
        /// The colour.
        colour: &'static str,
        /// The wavelength of the colour in micrometres.
        primary_um: f64,
        /// The largest accepted distance from it in micrometres.
        max_distance_um: f64,
        /// The wavelengths of the fits, as text.
        available: Vec<String>,
    },
}
