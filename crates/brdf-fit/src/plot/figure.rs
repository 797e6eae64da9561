//! A figure as SVG, and its conversion to PNG.

use super::error::PlotError;
use super::png;

/// A figure, ready to be written or shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// Stem of its file name, such as "theory-linear".
    pub name: String,
    /// What it shows, and which of the data it does not show.
    pub caption: String,
    /// The drawing as an SVG document. Its text is in the reader's own sans-serif typeface.
    pub svg: String,
}

impl Figure {
    /// The figure as PNG on white, with `scale` pixels for each unit of the SVG: 1.0 for a screen,
    /// 2.0 for print. Its text is in a bundled typeface, so that it is the same on every machine.
    ///
    /// # Errors
    ///
    /// [`PlotError::Scale`] where the image would have no pixels or more than 20,000 a side,
    /// [`PlotError::Svg`] and [`PlotError::Png`] where the conversion fails.
    pub fn png(&self, scale: f32) -> Result<Vec<u8>, PlotError> {
        png::png(&self.svg, scale)
    }
}
