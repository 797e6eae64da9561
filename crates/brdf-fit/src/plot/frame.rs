//! Title, axes and legend around a figure, and curves within the axes.

use plotters::style::{Color, RGBColor};

use super::PlotError;
use super::axis::Axis;
use super::canvas::{Canvas, Place, Stands};
use super::clip::within;
use super::style::{BAND, FINE_GRID, GRID, INK, Mark, TEXT, TITLE, colour, mark};
use super::title::Title;

/// Where the axes stand, and where the legend begins beside them.
const LEFT: f64 = 86.0;
const RIGHT: f64 = 762.0;
const TOP: f64 = 66.0;
const BOTTOM: f64 = 514.0;
const LEGEND: f64 = 780.0;

/// A plane of two axes.
pub(super) struct Frame {
    pub(super) x: Axis,
    pub(super) y: Axis,
}

impl Frame {
    /// The frame of a figure over the signed view angle.
    pub(super) fn over_theta(y: Axis) -> Self {
        Self {
            x: Axis::fixed(-90, 90, 15),
            y,
        }
    }

    /// Where a point is.
    pub(super) fn place(&self, (x, y): (f64, f64)) -> Place {
        at(self.x.height(x), self.y.height(y))
    }

    /// Whether a point is within both axes.
    pub(super) fn contains(&self, (x, y): (f64, f64)) -> bool {
        self.x.contains(x) && self.y.contains(y)
    }

    /// The grid, the axes and their names.
    pub(super) fn draw(
        &self,
        canvas: &mut Canvas,
        x_name: &str,
        y_name: &str,
    ) -> Result<(), PlotError> {
        for &x in &self.x.fine {
            self.upright(canvas, x, &FINE_GRID)?;
        }
        for &y in &self.y.fine {
            self.level(canvas, y, &FINE_GRID)?;
        }
        for tick in &self.x.ticks {
            self.upright(canvas, tick.value, &GRID)?;
            let place = (at(self.x.height(tick.value), 0.0).0, BOTTOM + 16.0);
            canvas.text(&tick.label, place, TEXT, Stands::Centred)?;
        }
        for tick in &self.y.ticks {
            self.level(canvas, tick.value, &GRID)?;
            let place = (LEFT - 8.0, at(0.0, self.y.height(tick.value)).1);
            canvas.text(&tick.label, place, TEXT, Stands::Left)?;
        }
        let border = [(0.0, 1.0), (0.0, 0.0), (1.0, 0.0)].map(|(x, y)| at(x, y));
        canvas.line(&border, &INK, 1.0)?;
        let middle = (0.5 * (LEFT + RIGHT), 0.5 * (TOP + BOTTOM));
        canvas.text(
            x_name,
            (middle.0, BOTTOM + 42.0),
            TEXT + 1.0,
            Stands::Centred,
        )?;
        canvas.text(y_name, (20.0, middle.1), TEXT + 1.0, Stands::Upwards)
    }

    /// A thin line all over the plane at a value of x.
    fn upright(&self, canvas: &mut Canvas, x: f64, colour: &impl Color) -> Result<(), PlotError> {
        let x = self.x.height(x);
        canvas.line(&[at(x, 0.0), at(x, 1.0)], colour, 1.0)
    }

    /// A thin line all over the plane at a value of y.
    pub(super) fn level(
        &self,
        canvas: &mut Canvas,
        y: f64,
        colour: &impl Color,
    ) -> Result<(), PlotError> {
        let y = self.y.height(y);
        canvas.line(&[at(0.0, y), at(1.0, y)], colour, 1.0)
    }

    /// A dashed line all over the plane at a value of x.
    pub(super) fn upright_dashes(
        &self,
        canvas: &mut Canvas,
        x: f64,
        colour: &impl Color,
    ) -> Result<(), PlotError> {
        let x = self.x.height(x);
        canvas.dashes(at(x, 0.0), at(x, 1.0), colour, 1.0)
    }

    /// A dashed line all over the plane at a value of y.
    pub(super) fn level_dashes(
        &self,
        canvas: &mut Canvas,
        y: f64,
        colour: &impl Color,
    ) -> Result<(), PlotError> {
        let y = self.y.height(y);
        canvas.dashes(at(0.0, y), at(1.0, y), colour, 1.0)
    }

    /// A line through points, cut where it leaves the axis.
    pub(super) fn line(
        &self,
        canvas: &mut Canvas,
        points: impl Iterator<Item = (f64, f64)>,
        colour: &impl Color,
        width: f64,
    ) -> Result<(), PlotError> {
        let heights: Vec<(f64, f64)> = points
            .map(|(x, y)| (self.x.height(x), self.y.height(y)))
            .collect();
        for piece in within(&heights) {
            let places: Vec<Place> = piece.into_iter().map(|(x, y)| at(x, y)).collect();
            canvas.line(&places, colour, width)?;
        }
        Ok(())
    }

    /// The area between two values of y at each x, cut at the ends of the axis.
    pub(super) fn band(
        &self,
        canvas: &mut Canvas,
        points: &[(f64, [f64; 2])],
        colour: RGBColor,
    ) -> Result<(), PlotError> {
        let edge = |i: usize| {
            points
                .iter()
                .map(move |&(x, y)| at(self.x.height(x), self.y.height(y[i]).clamp(0.0, 1.0)))
        };
        let outline: Vec<Place> = edge(0).chain(edge(1).rev()).collect();
        canvas.area(&outline, &colour.mix(BAND))
    }

    /// The error bar of a reading, cut at the ends of the axis.
    pub(super) fn error_bar(
        &self,
        canvas: &mut Canvas,
        x: f64,
        (low, high): (f64, f64),
        colour: RGBColor,
    ) -> Result<(), PlotError> {
        const HALF_CAP: f64 = 2.5;
        self.line(canvas, [(x, low), (x, high)].into_iter(), &colour, 1.0)?;
        for end in [low, high] {
            if self.contains((x, end)) {
                let (x, y) = self.place((x, end));
                canvas.line(&[(x - HALF_CAP, y), (x + HALF_CAP, y)], &colour, 1.0)?;
            }
        }
        Ok(())
    }
}

fn at(x: f64, y: f64) -> Place {
    (LEFT + x * (RIGHT - LEFT), BOTTOM - y * (BOTTOM - TOP))
}

/// The two lines of the title.
pub(super) fn draw_title(canvas: &mut Canvas, title: &Title) -> Result<(), PlotError> {
    canvas.text(&title.sample, (20.0, 22.0), TITLE, Stands::Right)?;
    canvas.text(&title.details, (20.0, 45.0), TEXT, Stands::Right)
}

/// The legend, to the right of the axes.
#[derive(Default)]
pub(super) struct Legend {
    lines: Vec<(Key, String)>,
}

/// What stands before the words of a legend.
#[derive(Debug, Clone, Copy)]
pub(super) enum Key {
    /// The line of the `i`-th curve, with its mark where there are readings.
    Curve(usize, bool),
    /// A line in a colour.
    Line(RGBColor),
    /// A dashed line in a colour.
    Dashes(RGBColor),
    /// A mark.
    Mark(RGBColor),
    /// A mark with an error bar.
    ErrorBar,
    /// A band.
    Band,
    /// Nothing: a note.
    Note,
}

impl Legend {
    /// Adds a line, or for a longer text several.
    pub(super) fn add(&mut self, key: Key, text: &str) {
        let longest = if matches!(key, Key::Note) { 27 } else { 21 };
        let mut key = key;
        for line in wrapped(text, longest) {
            self.lines.push((key, line));
            key = match key {
                Key::Note => Key::Note,
                _ => Key::Line(plotters::style::WHITE),
            };
        }
    }

    pub(super) fn draw(&self, canvas: &mut Canvas) -> Result<(), PlotError> {
        for (i, (key, text)) in self.lines.iter().enumerate() {
            let y = TOP + 8.0 + 20.0 * i as f64;
            let indent = if matches!(key, Key::Note) { 0.0 } else { 34.0 };
            key.draw(canvas, y)?;
            canvas.text(text, (LEGEND + indent, y), TEXT, Stands::Right)?;
        }
        Ok(())
    }
}

impl Key {
    fn draw(self, canvas: &mut Canvas, y: f64) -> Result<(), PlotError> {
        let (from, to) = ((LEGEND, y), (LEGEND + 26.0, y));
        let middle = (LEGEND + 13.0, y);
        match self {
            Self::Curve(i, measured) => {
                canvas.line(&[from, to], &colour(i), 2.0)?;
                if measured {
                    canvas.mark(middle, mark(i), colour(i))?;
                }
                Ok(())
            }
            Self::Line(colour) => canvas.line(&[from, to], &colour, 1.5),
            Self::Dashes(colour) => canvas.dashes(from, to, &colour, 1.0),
            Self::Mark(colour) => canvas.mark(middle, Mark::Circle, colour),
            Self::ErrorBar => {
                canvas.mark(middle, Mark::Circle, INK)?;
                let bar = [(middle.0, y - 8.0), (middle.0, y + 8.0)];
                canvas.line(&bar, &INK, 1.0)
            }
            Self::Band => {
                let corners = [
                    (from.0, y - 6.0),
                    (to.0, y - 6.0),
                    (to.0, y + 6.0),
                    (from.0, y + 6.0),
                ];
                canvas.area(&corners, &INK.mix(BAND))?;
                canvas.line(&[from, to], &INK, 2.0)
            }
            Self::Note => Ok(()),
        }
    }
}

/// Lines of whole words, of so many letters where the words allow.
fn wrapped(text: &str, longest: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= longest => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_are_wrapped_between_words() {
        assert_eq!(wrapped("one two three", 7), ["one two", "three"]);
        assert_eq!(wrapped("incomprehensible", 7), ["incomprehensible"]);
        assert!(wrapped("", 7).is_empty());
    }
}
