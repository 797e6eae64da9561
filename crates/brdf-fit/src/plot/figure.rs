//! A figure as SVG, and as PNG.

use super::error::PlotError;
use super::png;

/// A figure, ready to be written or shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// Stem of its file name, such as "theory-linear".
    pub name: String,
    /// What it shows, and what of the data it does not show.
    pub caption: String,
    /// The drawing. Its text is in the reader's own sans-serif typeface.
    pub svg: String,
}

impl Figure {
    /// The figure as PNG on white, `scale` pixels for each unit of the SVG: 1.0 for a screen, 2.0
    /// for print. Its text is in a typeface of its own: a PNG is the same on every machine.
    pub fn png(&self, scale: f32) -> Result<Vec<u8>, PlotError> {
        png::png(&self.svg, scale)
    }
}
