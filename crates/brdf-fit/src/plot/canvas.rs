//! What a figure is drawn on: lines, areas, marks and text, in the units of the figure.

use super::palette::{Ground, MarkShape, Rgb};
use super::style::{INK, SIZE};
use super::svg::{Anchor, Coordinates, Document, Paint, Text};

/// Coordinates of the SVG in a unit of the figure. They are whole numbers: with one for each unit,
/// curves would be staircases.
const SUBDIVISIONS: u32 = 20;

/// The size of a typeface is multiplied and divided by this number, which changes at most its last
/// digit: figures stay the same to the byte as those of the library that wrote them before.
const LINE_HEIGHT: f64 = 1.24;

/// A position in the figure, x to the right and y downwards from its upper left corner.
pub(super) type Point = (f64, f64);

/// The drawing of a figure.
pub(super) struct Canvas {
    document: Document,
}

/// The SVG of what `draw` draws on a ground, with `footer` units more below the figure.
pub(super) fn render(footer: u32, ground: Ground, draw: impl FnOnce(&mut Canvas)) -> String {
    let size = (SIZE.0, SIZE.1 + footer);
    let mut canvas = Canvas {
        document: Document::new(size, SUBDIVISIONS, ground),
    };
    draw(&mut canvas);
    canvas.document.finish()
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the cast saturates, and no point lies that far away"
)]
fn subdivided(length: f64) -> i32 {
    (length * f64::from(SUBDIVISIONS)).round() as i32
}

fn coordinates((x, y): Point) -> Coordinates {
    (subdivided(x), subdivided(y))
}

/// A width or radius, which is not zero.
fn subdivided_width(width: f64) -> u32 {
    subdivided(width).unsigned_abs().max(1)
}

impl Canvas {
    /// A line through points; nothing where there are fewer than two.
    pub(super) fn line(&mut self, points: &[Point], paint: impl Into<Paint>, width: f64) {
        if points.len() < 2 {
            return;
        }
        let points = points.iter().map(|&point| coordinates(point));
        let width = subdivided_width(width);
        self.document.polyline(points, paint.into(), width);
    }

    /// A straight dashed line.
    pub(super) fn dashed_line(
        &mut self,
        from: Point,
        to: Point,
        paint: impl Into<Paint>,
        width: f64,
    ) {
        const DASH: f64 = 5.0;
        const GAP: f64 = 4.0;
        let paint = paint.into();
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        let at = |s: f64| {
            let t = (s / length).min(1.0);
            (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1))
        };
        let mut start = 0.0;
        while start < length {
            self.line(&[at(start), at(start + DASH)], paint, width);
            start += DASH + GAP;
        }
    }

    /// A filled polygon.
    pub(super) fn area(&mut self, corners: &[Point], paint: impl Into<Paint>) {
        let corners = corners.iter().map(|&corner| coordinates(corner));
        self.document.polygon(corners, paint.into());
    }

    /// A filled circle.
    pub(super) fn disc(&mut self, centre: Point, radius: f64, paint: impl Into<Paint>) {
        let radius = subdivided_width(radius);
        self.document
            .circle(coordinates(centre), radius, paint.into());
    }

    /// The mark of a reading.
    pub(super) fn mark(&mut self, (x, y): Point, shape: MarkShape, colour: Rgb) {
        // Half the sizes with which the marks look equally large.
        let square = 2.3;
        let (diamond, triangle) = (3.4, 3.2);
        match shape {
            MarkShape::Circle => {
                self.disc((x, y), 2.7, colour);
            }
            MarkShape::Square => self.rectangle((x, y), (square, square), colour),
            MarkShape::Diamond => self.area(
                &[
                    (x - diamond, y),
                    (x, y - diamond),
                    (x + diamond, y),
                    (x, y + diamond),
                ],
                colour,
            ),
            MarkShape::Triangle => self.triangle((x, y), triangle, colour),
            MarkShape::Inverted => self.triangle((x, y), -triangle, colour),
            MarkShape::Cross => {
                let (long, short) = (3.3, 1.1);
                self.rectangle((x, y), (long, short), colour);
                self.rectangle((x, y), (short, long), colour);
            }
        }
    }

    /// A triangle around a point, with its apex below where the size is negative.
    fn triangle(&mut self, (x, y): Point, size: f64, colour: Rgb) {
        let (base, apex) = (y + 0.6 * size, y - 1.1 * size);
        self.area(&[(x - size, base), (x, apex), (x + size, base)], colour);
    }

    /// A rectangle around a point, by half its width and half its height.
    fn rectangle(&mut self, (x, y): Point, (width, height): (f64, f64), colour: Rgb) {
        let (left, right) = (x - width, x + width);
        let (top, bottom) = (y - height, y + height);
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        self.area(&corners, colour);
    }

    /// A line of text, vertically centred at a point.
    pub(super) fn text(&mut self, content: &str, point: Point, size: f64, anchor: Anchor) {
        self.coloured_text(content, point, size, anchor, INK);
    }

    /// [`Self::text`] in a colour.
    pub(super) fn coloured_text(
        &mut self,
        content: &str,
        point: Point,
        size: f64,
        anchor: Anchor,
        colour: Rgb,
    ) {
        self.document.text(&Text {
            content,
            position: coordinates(point),
            anchor,
            size: size * LINE_HEIGHT * f64::from(SUBDIVISIONS) / LINE_HEIGHT,
            paint: colour.into(),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_name_of_a_sample_gives_valid_xml() {
        let name = "a<b>&\"c\"'\u{1}\u{fffe}\u{7f} \u{3bb}";
        let svg = render(0, Ground::Light, |canvas| {
            canvas.text(name, (10.0, 10.0), 12.0, Anchor::Start);
        });
        let tree = resvg::usvg::Tree::from_str(&svg, &resvg::usvg::Options::default()).unwrap();
        assert_eq!((tree.size().width(), tree.size().height()), (960.0, 580.0));
    }
}
