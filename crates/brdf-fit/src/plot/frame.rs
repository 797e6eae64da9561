//! Title, axes and legend around a figure, and curves within the axes.

use plotters::style::{Color, RGBColor};

use super::axis::Axis;
use super::canvas::{Canvas, Place, Stands, drawn_above};
use super::clip::within;
use super::curves::{Styled, evenly};
use super::error::PlotError;
use super::palette::MarkShape;
use super::style::{BAND, FINE_GRID, GRID, INK, SIZE, TEXT, TITLE, ink};
use super::title::Title;

/// Where the legend begins, beside the axes.
const LEGEND: f64 = 780.0;

/// So many lines of a legend are for curves: the others are needed for what else is explained.
const CURVE_LINES: usize = 30;

/// The lines of a legend are so far apart, where there is room.
const LINES_APART: f64 = 20.0;

/// Where the axes stand in the figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
}

/// The axes of a figure with one plane.
pub(super) const WHOLE: Area = Area {
    left: 86.0,
    right: 762.0,
    top: 66.0,
    bottom: 514.0,
};

/// A plane of two axes.
pub(super) struct Frame {
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) area: Area,
}

impl Frame {
    /// The frame of a figure over the signed view angle.
    pub(super) fn over_theta(y: Axis) -> Self {
        Self {
            x: Axis::fixed(-90, 90, 15),
            y,
            area: WHOLE,
        }
    }

    /// A place by its parts of the axes, from 0 to 1.
    fn at(&self, x: f64, y: f64) -> Place {
        let Area {
            left,
            right,
            top,
            bottom,
        } = self.area;
        (left + x * (right - left), bottom - y * (bottom - top))
    }

    /// Where a point is.
    pub(super) fn place(&self, (x, y): (f64, f64)) -> Place {
        self.at(self.x.height(x), self.y.height(y))
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
            let place = (
                self.at(self.x.height(tick.value), 0.0).0,
                self.area.bottom + 16.0,
            );
            canvas.text(&tick.label, place, TEXT, Stands::Centred)?;
        }
        for tick in &self.y.ticks {
            self.level(canvas, tick.value, &GRID)?;
            if !self.has_room(tick.value) {
                continue;
            }
            let place = (
                self.area.left - 8.0,
                self.at(0.0, self.y.height(tick.value)).1,
            );
            canvas.text(&tick.label, place, TEXT, Stands::Left)?;
        }
        let border = [(0.0, 1.0), (0.0, 0.0), (1.0, 0.0)].map(|(x, y)| self.at(x, y));
        canvas.line(&border, &INK, 1.0)?;
        let middle = (
            0.5 * (self.area.left + self.area.right),
            0.5 * (self.area.top + self.area.bottom),
        );
        canvas.text(
            x_name,
            (middle.0, self.area.bottom + 42.0),
            TEXT + 1.0,
            Stands::Centred,
        )?;
        canvas.text(
            y_name,
            (self.area.left - 66.0, middle.1),
            TEXT + 1.0,
            Stands::Upwards,
        )
    }

    /// Whether there is room for a number at this value of y: in a low plane every second or fifth
    /// line of the grid has one.
    fn has_room(&self, value: f64) -> bool {
        let [first, second, ..] = self.y.ticks.as_slice() else {
            return true;
        };
        if self.y.is_logarithmic() {
            return true;
        }
        let step = second.value - first.value;
        let apart = step / (self.y.high() - self.y.low()) * (self.area.bottom - self.area.top);
        let every = [1.0, 2.0, 5.0]
            .into_iter()
            .find(|k| k * apart >= LEAST_APART);
        (value / step).round().rem_euclid(every.unwrap_or(10.0)) == 0.0
    }

    /// A thin line all over the plane at a value of x.
    fn upright(&self, canvas: &mut Canvas, x: f64, colour: &impl Color) -> Result<(), PlotError> {
        let x = self.x.height(x);
        canvas.line(&[self.at(x, 0.0), self.at(x, 1.0)], colour, 1.0)
    }

    /// A thin line all over the plane at a value of y.
    pub(super) fn level(
        &self,
        canvas: &mut Canvas,
        y: f64,
        colour: &impl Color,
    ) -> Result<(), PlotError> {
        let y = self.y.height(y);
        canvas.line(&[self.at(0.0, y), self.at(1.0, y)], colour, 1.0)
    }

    /// A dashed line all over the plane at a value of x.
    pub(super) fn upright_dashes(
        &self,
        canvas: &mut Canvas,
        x: f64,
        colour: &impl Color,
    ) -> Result<(), PlotError> {
        let x = self.x.height(x);
        canvas.dashes(self.at(x, 0.0), self.at(x, 1.0), colour, 1.0)
    }

    /// A dashed line all over the plane at a value of y.
    pub(super) fn level_dashes(
        &self,
        canvas: &mut Canvas,
        y: f64,
        colour: &impl Color,
    ) -> Result<(), PlotError> {
        let y = self.y.height(y);
        canvas.dashes(self.at(0.0, y), self.at(1.0, y), colour, 1.0)
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
            let places: Vec<Place> = piece.into_iter().map(|(x, y)| self.at(x, y)).collect();
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
                .map(move |&(x, y)| self.at(self.x.height(x), self.y.height(y[i]).clamp(0.0, 1.0)))
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

/// The two lines of the title, and below the figure a line for each of several samples.
pub(super) fn draw_title(canvas: &mut Canvas, title: &Title) -> Result<(), PlotError> {
    canvas.text(&title.sample, (20.0, 22.0), TITLE, Stands::Right)?;
    canvas.text(&title.details, (20.0, 45.0), TEXT, Stands::Right)?;
    for (i, sample) in title.samples.iter().enumerate() {
        let y = f64::from(SIZE.1) + LINES_APART * (i as f64 + 0.5);
        canvas.text(sample, (20.0, y), TEXT, Stands::Right)?;
    }
    Ok(())
}

/// A drawing with room below for the lines of the samples.
pub(super) fn drawn_with_samples(
    title: &Title,
    draw: impl FnOnce(&mut Canvas) -> Result<(), PlotError>,
) -> Result<String, PlotError> {
    let lines = u32::try_from(title.samples.len()).unwrap_or(0);
    // Half a line more, so that the last one does not stand on the border.
    let room = if lines > 0 { 20 * lines + 10 } else { 0 };
    drawn_above(room, draw)
}

/// A text that is not longer than so many letters: of a longer one its start and its end, where
/// names differ most.
pub(super) fn shortened_within(text: &str, longest: usize) -> String {
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= longest {
        return text.to_owned();
    }
    let end = (longest - 3) / 2;
    let start = letters[..longest - 3 - end].iter();
    let end = letters[letters.len() - end..].iter();
    start.chain(&['.'; 3]).chain(end).collect()
}

/// Numbers at the axis of values are at least so far apart.
const LEAST_APART: f64 = 15.0;

/// Letters of a line of the legend beside its key.
const A_LINE: usize = 21;

/// Letters of a line without a key.
const A_NOTE: usize = 27;

/// The legend, to the right of the axes.
#[derive(Default)]
pub(super) struct Legend {
    lines: Vec<(Key, String)>,
}

/// What stands before the words of a legend.
#[derive(Debug, Clone, Copy)]
pub(super) enum Key {
    /// The line of a curve, with its mark where there are readings.
    Curve(RGBColor, Option<MarkShape>),
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
        let longest = if matches!(key, Key::Note) {
            A_NOTE
        } else {
            A_LINE
        };
        let mut key = key;
        for line in wrapped(text, longest) {
            self.lines.push((key, line));
            key = match key {
                Key::Note => Key::Note,
                _ => Key::Line(plotters::style::WHITE),
            };
        }
    }

    /// Adds the curves, sample by sample, or evenly as many of them as there is room for, and says
    /// so.
    pub(super) fn add_curves(&mut self, curves: &[Styled], measured: bool) {
        let of_sample = |a: &Styled, b: &Styled| a.sample == b.sample;
        let samples = curves.chunk_by(of_sample).count();
        let named = evenly(curves, CURVE_LINES.saturating_sub(samples).max(2));
        for of in named.chunk_by(of_sample) {
            if let Some(sample) = &of[0].sample {
                self.add(Key::Note, &shortened_within(sample, A_NOTE));
            }
            for of in of {
                let mark = measured.then_some(of.mark);
                self.add(Key::Curve(ink(of.colour), mark), &of.curve.name());
            }
        }
        if named.len() < curves.len() {
            let words = format!("{} of {} curves are named", named.len(), curves.len());
            self.add(Key::Note, &words);
        }
    }

    pub(super) fn draw(&self, canvas: &mut Canvas) -> Result<(), PlotError> {
        let top = WHOLE.top + 8.0;
        let room = f64::from(SIZE.1) - top;
        let apart = (room / self.lines.len().max(1) as f64).min(LINES_APART);
        for (i, (key, text)) in self.lines.iter().enumerate() {
            let y = top + apart * i as f64;
            let indent = if matches!(key, Key::Note) { 0.0 } else { 34.0 };
            key.draw(canvas, y)?;
            let size = TEXT.min(0.8 * apart);
            canvas.text(text, (LEGEND + indent, y), size, Stands::Right)?;
        }
        Ok(())
    }
}

impl Key {
    fn draw(self, canvas: &mut Canvas, y: f64) -> Result<(), PlotError> {
        let (from, to) = ((LEGEND, y), (LEGEND + 26.0, y));
        let middle = (LEGEND + 13.0, y);
        match self {
            Self::Curve(colour, mark) => {
                canvas.line(&[from, to], &colour, 2.0)?;
                mark.map_or(Ok(()), |mark| canvas.mark(middle, mark, colour))
            }
            Self::Line(colour) => canvas.line(&[from, to], &colour, 1.5),
            Self::Dashes(colour) => canvas.dashes(from, to, &colour, 1.0),
            Self::Mark(colour) => canvas.mark(middle, MarkShape::Circle, colour),
            Self::ErrorBar => {
                canvas.mark(middle, MarkShape::Circle, INK)?;
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

    #[test]
    fn long_names_keep_their_start_and_their_end() {
        assert_eq!(shortened_within("short", 9), "short");
        assert_eq!(shortened_within("black_paint_cycled", 11), "blac...cled");
    }
}
