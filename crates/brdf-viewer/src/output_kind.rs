//! The kinds of files that the viewer writes.

/// A kind of file that can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputKind {
    /// The figure, for print.
    Figure(FigureFormat),
    /// The lobe as a mesh for other programs.
    Mesh,
    /// Theory and readings.
    Curves,
    /// The fits, in the format that `fit --again` and the viewer read.
    Fit,
}

/// The format of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FigureFormat {
    /// Vector graphics.
    Svg,
    /// Pixels.
    Png,
}

impl OutputKind {
    /// The file name extension.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Figure(FigureFormat::Svg) => "svg",
            Self::Figure(FigureFormat::Png) => "png",
            Self::Mesh => "obj",
            Self::Curves => "csv",
            Self::Fit => "json",
        }
    }

    /// The name in dialogs and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Figure(FigureFormat::Svg) => "figure as SVG",
            Self::Figure(FigureFormat::Png) => "figure as PNG",
            Self::Mesh => "lobe as OBJ",
            Self::Curves => "theory and readings as CSV",
            Self::Fit => "fit as JSON",
        }
    }
}
