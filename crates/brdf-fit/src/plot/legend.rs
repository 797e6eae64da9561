//! The legend to the right of the axes.

use super::canvas::{Canvas, Point};
use super::frame::WHOLE;
use super::palette::{MarkShape, Rgb};
use super::selection::evenly;
use super::style::{BAND, INK, LINE_SPACING, SIZE, TEXT, WHITE};
use super::styled::Styled;
use super::svg::{Anchor, Paint};
use super::text::{shortened_in_the_middle, wrapped};

/// The left edge of the legend.
const LEFT: f64 = 780.0;

/// The most entries for curves; further lines are left for the other entries.
const CURVE_ENTRIES: usize = 30;

/// Letters of a line beside a key.
const LETTERS: usize = 21;

/// Letters of a line without a key.
const NOTE_LETTERS: usize = 27;

/// The lines of a legend, from top to bottom.
#[derive(Default)]
pub(super) struct Legend {
    lines: Vec<(Key, String)>,
}

/// The sample of what a line of the legend explains.
#[derive(Debug, Clone, Copy)]
pub(super) enum Key {
    /// The line of a curve, with the mark of its readings.
    Curve(Rgb, Option<MarkShape>),
    /// A line.
    Line(Rgb),
    /// A dashed line.
    Dashes(Rgb),
    /// A mark.
    Mark(Rgb),
    /// A mark with an error bar.
    ErrorBar,
    /// An error band.
    Band,
    /// None: the line is a note.
    Note,
}

impl Legend {
    /// Adds an entry, of several lines where the text is long.
    pub(super) fn add(&mut self, key: Key, text: &str) {
        let is_note = matches!(key, Key::Note);
        let longest = if is_note { NOTE_LETTERS } else { LETTERS };
        let mut key = key;
        for line in wrapped(text, longest) {
            self.lines.push((key, line));
            // Further lines are indented like the first one, behind a key that is not visible.
            key = if is_note { key } else { Key::Line(WHITE) };
        }
    }

    /// Adds the curves sample by sample. Where there are too many, a note states how many evenly
    /// spaced ones have an entry.
    pub(super) fn add_curves(&mut self, curves: &[Styled], measured: bool) {
        let of_same_sample = |a: &Styled, b: &Styled| a.sample == b.sample;
        let samples = curves.chunk_by(of_same_sample).count();
        let named = evenly(curves, CURVE_ENTRIES.saturating_sub(samples).max(2));
        for of_sample in named.chunk_by(of_same_sample) {
            if let Some(sample) = &of_sample[0].sample {
                self.add(Key::Note, &shortened_in_the_middle(sample, NOTE_LETTERS));
            }
            for styled in of_sample {
                let mark = measured.then_some(styled.mark);
                self.add(Key::Curve(styled.colour, mark), &styled.curve.name());
            }
        }
        if named.len() < curves.len() {
            let note = format!("{} of {} curves are named", named.len(), curves.len());
            self.add(Key::Note, &note);
        }
    }

    pub(super) fn draw(&self, canvas: &mut Canvas) {
        let top = WHOLE.top + 8.0;
        let room = f64::from(SIZE.1) - top;
        let spacing = (room / self.lines.len().max(1) as f64).min(LINE_SPACING);
        for (i, (key, text)) in self.lines.iter().enumerate() {
            let y = top + spacing * i as f64;
            let indent = if matches!(key, Key::Note) { 0.0 } else { 34.0 };
            key.draw(canvas, y);
            let size = TEXT.min(0.8 * spacing);
            canvas.text(text, (LEFT + indent, y), size, Anchor::Start);
        }
    }
}

impl Key {
    fn draw(self, canvas: &mut Canvas, y: f64) {
        let (from, to) = ((LEFT, y), (LEFT + 26.0, y));
        let middle = (LEFT + 13.0, y);
        match self {
            Self::Curve(colour, mark) => {
                canvas.line(&[from, to], colour, 2.0);
                if let Some(mark) = mark {
                    canvas.mark(middle, mark, colour);
                }
            }
            Self::Line(colour) => canvas.line(&[from, to], colour, 1.5),
            Self::Dashes(colour) => canvas.dashed_line(from, to, colour, 1.0),
            Self::Mark(colour) => canvas.mark(middle, MarkShape::Circle, colour),
            Self::ErrorBar => {
                canvas.mark(middle, MarkShape::Circle, INK);
                let bar = [(middle.0, y - 8.0), (middle.0, y + 8.0)];
                canvas.line(&bar, INK, 1.0);
            }
            Self::Band => draw_band(canvas, from, to),
            Self::Note => {}
        }
    }
}

/// A line within an error band.
fn draw_band(canvas: &mut Canvas, from: Point, to: Point) {
    const HALF_HEIGHT: f64 = 6.0;
    let corners = [
        (from.0, from.1 - HALF_HEIGHT),
        (to.0, to.1 - HALF_HEIGHT),
        (to.0, to.1 + HALF_HEIGHT),
        (from.0, from.1 + HALF_HEIGHT),
    ];
    canvas.area(&corners, Paint::translucent(INK, BAND));
    canvas.line(&[from, to], INK, 2.0);
}
