//! Sizes and colours of what is around the curves of the figures.

use plotters::style::RGBColor;

/// Size of a figure in the units of its SVG.
pub(super) const SIZE: (u32, u32) = (960, 580);

/// Text and axes.
pub(super) const INK: RGBColor = RGBColor(30, 30, 30);
/// Labelled lines of the grid.
pub(super) const GRID: RGBColor = RGBColor(212, 212, 212);
/// Lines of the grid between the labels.
pub(super) const FINE_GRID: RGBColor = RGBColor(238, 238, 238);
/// The only curve of a figure: the first of the palette.
pub(super) const MAIN: RGBColor = RGBColor(0, 114, 178);
/// A level or an angle that is pointed out.
pub(super) const POINTED_OUT: RGBColor = RGBColor(213, 94, 0);

/// Opacity of a band.
pub(super) const BAND: f64 = 0.22;

/// Size of the text on axes and in legends.
pub(super) const TEXT: f64 = 14.0;
/// Size of the first line of the title.
pub(super) const TITLE: f64 = 17.0;

/// A colour of the palette as the canvas takes it.
pub(super) fn ink([r, g, b]: [u8; 3]) -> RGBColor {
    RGBColor(r, g, b)
}
