//! A drawing in SVG: lines, areas, marks and text at places in the units of the figure.

use plotters::backend::SVGBackend;
use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform, IntoFont, RGBColor, TextStyle};

use super::error::PlotError;
use super::palette::MarkShape;
use super::style::SIZE;

/// The backend's coordinates are whole numbers: so many of them are one unit of the figure, or a
/// curve would be a staircase.
const FINE: u32 = 20;

/// The backend takes the size of a typeface's line and writes the size of its letters.
const LINE_OF_LETTERS: f64 = 1.24;

/// A place in the figure, from its upper left corner.
pub(super) type Place = (f64, f64);

/// What a figure is drawn on.
pub(super) struct Canvas<'a> {
    backend: SVGBackend<'a>,
}

/// Where a text stands from its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Stands {
    Right,
    Left,
    Centred,
    /// Centred, read from below.
    Upwards,
}

/// The SVG that `draw` draws on a white ground.
pub(super) fn drawn(
    draw: impl FnOnce(&mut Canvas) -> Result<(), PlotError>,
) -> Result<String, PlotError> {
    drawn_above(0, draw)
}

/// The same with room for so many units below.
pub(super) fn drawn_above(
    room: u32,
    draw: impl FnOnce(&mut Canvas) -> Result<(), PlotError>,
) -> Result<String, PlotError> {
    let mut svg = String::new();
    let size = (SIZE.0, SIZE.1 + room);
    let (width, height) = (size.0 * FINE, size.1 * FINE);
    let mut canvas = Canvas {
        backend: SVGBackend::with_string(&mut svg, (width, height)),
    };
    let white = plotters::style::WHITE.filled();
    let corner = |x: u32, y: u32| (i32::try_from(x), i32::try_from(y));
    if let (Ok(x), Ok(y)) = corner(width, height) {
        let ground = canvas.backend.draw_rect((0, 0), (x, y), &white, true);
        ground.map_err(failed)?;
    }
    draw(&mut canvas)?;
    canvas.backend.present().map_err(failed)?;
    drop(canvas);
    // The size that is shown; the coordinates inside stay the fine ones.
    let fine = format!("width=\"{width}\" height=\"{height}\"");
    let shown = format!("width=\"{}\" height=\"{}\"", size.0, size.1);
    Ok(svg.replacen(&fine, &shown, 1))
}

fn failed(error: impl std::fmt::Display) -> PlotError {
    PlotError::Draw(error.to_string())
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a cast from a float saturates, and no place is that far away"
)]
fn fine(length: f64) -> i32 {
    (length * f64::from(FINE)).round() as i32
}

fn fine_place((x, y): Place) -> (i32, i32) {
    (fine(x), fine(y))
}

fn fine_width(width: f64) -> u32 {
    fine(width).unsigned_abs().max(1)
}

/// XML has no way to write a control character, whatever a file puts in its sample's name.
fn printable(text: &str) -> String {
    let unwritable = |c: char| c.is_control() || ('\u{fffe}'..='\u{ffff}').contains(&c);
    text.replace(unwritable, " ")
}

impl Canvas<'_> {
    /// A line through places.
    pub(super) fn line(
        &mut self,
        places: &[Place],
        colour: &impl Color,
        width: f64,
    ) -> Result<(), PlotError> {
        if places.len() < 2 {
            return Ok(());
        }
        let path = places.iter().map(|&place| fine_place(place));
        let style = colour.stroke_width(fine_width(width));
        self.backend.draw_path(path, &style).map_err(failed)
    }

    /// A straight dashed line.
    pub(super) fn dashes(
        &mut self,
        from: Place,
        to: Place,
        colour: &impl Color,
        width: f64,
    ) -> Result<(), PlotError> {
        const DASH: f64 = 5.0;
        const GAP: f64 = 4.0;
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        let at = |s: f64| {
            let t = (s / length).min(1.0);
            (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1))
        };
        let mut start = 0.0;
        while start < length {
            self.line(&[at(start), at(start + DASH)], colour, width)?;
            start += DASH + GAP;
        }
        Ok(())
    }

    /// A filled area.
    pub(super) fn area(&mut self, places: &[Place], colour: &impl Color) -> Result<(), PlotError> {
        let path = places.iter().map(|&place| fine_place(place));
        let filled = self.backend.fill_polygon(path, &colour.filled());
        filled.map_err(failed)
    }

    /// The mark of a reading.
    pub(super) fn mark(
        &mut self,
        (x, y): Place,
        mark: MarkShape,
        colour: RGBColor,
    ) -> Result<(), PlotError> {
        // Half sizes that make the marks look equally large.
        let square = 2.3;
        let (diamond, triangle) = (3.4, 3.2);
        match mark {
            MarkShape::Circle => {
                let (centre, radius) = (fine_place((x, y)), fine_width(2.7));
                let style = colour.filled();
                let drawn = self.backend.draw_circle(centre, radius, &style, true);
                drawn.map_err(failed)
            }
            MarkShape::Square => self.rectangle((x, y), (square, square), colour),
            MarkShape::Diamond => self.area(
                &[
                    (x - diamond, y),
                    (x, y - diamond),
                    (x + diamond, y),
                    (x, y + diamond),
                ],
                &colour,
            ),
            MarkShape::Triangle => self.triangle((x, y), triangle, colour),
            MarkShape::Inverted => self.triangle((x, y), -triangle, colour),
            MarkShape::Cross => {
                let (long, short) = (3.3, 1.1);
                self.rectangle((x, y), (long, short), colour)?;
                self.rectangle((x, y), (short, long), colour)
            }
        }
    }

    /// A triangle around a place; of negative size it stands on its point.
    fn triangle(&mut self, (x, y): Place, size: f64, colour: RGBColor) -> Result<(), PlotError> {
        let (base, point) = (y + 0.6 * size, y - 1.1 * size);
        self.area(&[(x - size, base), (x, point), (x + size, base)], &colour)
    }

    /// A rectangle around a place, of half this size.
    fn rectangle(
        &mut self,
        (x, y): Place,
        (width, height): (f64, f64),
        colour: RGBColor,
    ) -> Result<(), PlotError> {
        let (left, right) = (x - width, x + width);
        let (top, bottom) = (y - height, y + height);
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        self.area(&corners, &colour)
    }

    /// A line of text, its middle at the height of its place.
    pub(super) fn text(
        &mut self,
        text: &str,
        place: Place,
        size: f64,
        stands: Stands,
    ) -> Result<(), PlotError> {
        self.coloured_text(text, place, size, stands, super::style::INK)
    }

    /// [`Self::text`] in a colour.
    pub(super) fn coloured_text(
        &mut self,
        text: &str,
        place: Place,
        size: f64,
        stands: Stands,
        colour: RGBColor,
    ) -> Result<(), PlotError> {
        let size = size * LINE_OF_LETTERS * f64::from(FINE);
        let font = ("sans-serif", size).into_font();
        let (font, side) = match stands {
            Stands::Right => (font, HPos::Left),
            Stands::Left => (font, HPos::Right),
            Stands::Centred => (font, HPos::Center),
            Stands::Upwards => (font.transform(FontTransform::Rotate270), HPos::Center),
        };
        let style = TextStyle::from(font)
            .color(&colour)
            .pos(Pos::new(side, VPos::Center));
        let drawn = self
            .backend
            .draw_text(&printable(text), &style, fine_place(place));
        drawn.map_err(failed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_name_of_a_sample_gives_valid_xml() {
        let name = "a<b>&\"c\"'\u{1}\u{fffe}\u{7f} \u{3bb}";
        let svg = drawn(|canvas| canvas.text(name, (10.0, 10.0), 12.0, Stands::Right)).unwrap();
        let tree = resvg::usvg::Tree::from_str(&svg, &resvg::usvg::Options::default()).unwrap();
        assert_eq!((tree.size().width(), tree.size().height()), (960.0, 580.0));
    }
}
