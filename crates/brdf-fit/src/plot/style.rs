//! Sizes and colours of everything but the curves.

use super::palette::Rgb;

/// Size of a figure, in the units of its SVG.
pub(super) const SIZE: (u32, u32) = (960, 580);

/// Text and axes.
pub(super) const INK: Rgb = [30, 30, 30];
/// Grid lines with a label.
pub(super) const GRID: Rgb = [212, 212, 212];
/// Grid lines without a label.
pub(super) const FINE_GRID: Rgb = [238, 238, 238];
/// The only curve of a figure: the first colour of the palette.
pub(super) const MAIN: Rgb = [0, 114, 178];
/// A value or a point that is emphasised.
pub(super) const EMPHASIS: Rgb = [213, 94, 0];
/// The page.
pub(super) const WHITE: Rgb = [255, 255, 255];

/// The grey of a dark page, as of the dark windows of the viewer.
pub(super) const DARK_PAGE: u8 = 27;
/// The grey in place of black on a dark page.
pub(super) const LIGHT_INK: u8 = 250;

/// Opacity of an error band.
pub(super) const BAND: f64 = 0.22;

/// Size of the text on axes and in legends.
pub(super) const TEXT: f64 = 14.0;
/// Size of the first line of the title.
pub(super) const TITLE: f64 = 17.0;
/// Distance of the lines of text, where there is room.
pub(super) const LINE_SPACING: f64 = 20.0;
