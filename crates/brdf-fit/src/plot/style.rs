//! Sizes, colours and marks of the figures.

use plotters::style::RGBColor;

/// Size of a figure in the units of its SVG.
pub(super) const SIZE: (u32, u32) = (960, 580);

/// At most so many incidences are in one figure: as many as there are colours.
pub(super) const MOST_CURVES: usize = COLOURS.len();

/// Okabe and Ito's colours, which colour-blind readers tell apart; grey instead of their yellow,
/// which is hardly seen on white.
const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
    RGBColor(140, 140, 140),
];

/// Text and axes.
pub(super) const INK: RGBColor = RGBColor(30, 30, 30);
/// Labelled lines of the grid.
pub(super) const GRID: RGBColor = RGBColor(212, 212, 212);
/// Lines of the grid between the labels.
pub(super) const FINE_GRID: RGBColor = RGBColor(238, 238, 238);
/// A level or an angle that is pointed out.
pub(super) const POINTED_OUT: RGBColor = RGBColor(213, 94, 0);

/// Opacity of a band.
pub(super) const BAND: f64 = 0.22;

/// Size of the text on axes and in legends.
pub(super) const TEXT: f64 = 14.0;
/// Size of the first line of the title.
pub(super) const TITLE: f64 = 17.0;

/// The shape of a reading's mark: a second feature beside the colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mark {
    Circle,
    Square,
    Diamond,
    Triangle,
}

/// The colour of the `i`-th curve.
pub(super) fn colour(i: usize) -> RGBColor {
    COLOURS[i % COLOURS.len()]
}

/// The mark of the `i`-th curve.
pub(super) fn mark(i: usize) -> Mark {
    const MARKS: [Mark; 4] = [Mark::Circle, Mark::Square, Mark::Diamond, Mark::Triangle];
    MARKS[i % MARKS.len()]
}
