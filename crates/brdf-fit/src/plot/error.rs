//! Why a figure cannot be drawn or written.

use std::io;
use std::path::PathBuf;

use brdf_core::{GeometryError, ParameterError};

use crate::output::WriteError;

/// The largest side of an image, in pixels.
pub(super) const LARGEST_SIDE: f32 = 20_000.0;

/// Why a figure cannot be drawn or written.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The parameters of the fit are outside the model's domain.
    #[error(transparent)]
    Parameters(#[from] ParameterError),
    /// An angle is outside the model's domain.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The SVG cannot be read back for the PNG.
    #[error("the SVG of the figure cannot be read: {0}")]
    Svg(#[from] resvg::usvg::Error),
    /// The scale gives an image of no pixels, or of too many.
    #[error("scale {0}: expected one that gives an image of 1 to {max} pixels a side", max = LARGEST_SIDE)]
    Scale(f32),
    /// The image cannot be encoded.
    #[error("the PNG cannot be encoded: {0}")]
    Png(String),
    /// The folder cannot be made.
    #[error("{}: cannot be made a folder for the pictures: {error}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
