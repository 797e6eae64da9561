//! Why a figure cannot be drawn or written.

use std::io;
use std::path::PathBuf;

use brdf_core::{GeometryError, ParameterError};

use crate::output::WriteError;

/// Why a figure cannot be drawn or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// The parameters of the fit are outside the domain of the model.
    #[error(transparent)]
    Parameters(#[from] ParameterError),
    /// An angle is outside the domain of the model.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The SVG cannot be parsed for the conversion to PNG, with the message of the parser.
    #[error("the SVG of the figure cannot be read: {0}")]
    Svg(String),
    /// The scale gives an image without pixels, or one that is too large.
    #[error("scale {scale}: expected one that gives an image of 1 to {largest_side} pixels a side")]
    Scale {
        /// Pixels for each unit of the SVG.
        scale: f32,
        /// The largest side of an image, in pixels.
        largest_side: f32,
    },
    /// The image cannot be encoded as PNG, with the message of the encoder.
    #[error("the PNG cannot be encoded: {0}")]
    Png(String),
    /// The output folder cannot be created.
    #[error("{}: cannot create the output folder: {error}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The error of the operating system.
        error: io::Error,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
