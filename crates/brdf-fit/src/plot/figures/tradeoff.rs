//! Cost against error of several choices on two logarithmic axes, with their Pareto front.
//!
//! The marks have numbers; the names of the choices are in a key below the axes.

use crate::format::counted;
use crate::plot::axis::Axis;
use crate::plot::canvas::{Canvas, Point, render};
use crate::plot::figure::Figure;
use crate::plot::frame::{Area, Frame, WHOLE};
use crate::plot::legend::{Key, Legend};
use crate::plot::palette::Ground;
use crate::plot::palette::{MarkShape, Rgb};
use crate::plot::style::{EMPHASIS, INK, MAIN, SIZE, TEXT, WHITE};
use crate::plot::svg::{Anchor, Paint};
use crate::plot::text::shortened;
use crate::plot::title::{LEFT, LONGEST_SAMPLE, Title};

/// More than all decades of costs and errors.
const DECADES: i32 = 40;

/// The colour of a choice that is not on the Pareto front.
const DOMINATED: Rgb = [140, 140, 140];

/// Size of the numbers beside the marks.
const NUMBER: f64 = 11.0;

/// Half the width and half the height of a number of two digits.
const HALF_NUMBER: (f64, f64) = (7.5, 5.5);

/// Half the side of the square that a mark covers.
const HALF_MARK: f64 = 3.0;

/// The most positions of a number above its mark, and below it.
const MOST_STACKED: u32 = 12;

/// Distance of the lines of the key.
const KEY_SPACING: f64 = 18.0;

/// Width of an average letter of the key, in units of its size; a wide estimate, because the typeface
/// is the reader's.
const LETTER: f64 = 0.56;

/// From the left edge of a column of the key to the names.
const NAME_INDENT: f64 = 32.0;

/// Between two columns of the key.
const COLUMN_GAP: f64 = 12.0;

/// The most columns of the key.
const MOST_COLUMNS: usize = 4;

/// The most letters of a name in the key.
const LONGEST_NAME: usize = 100;

/// One choice of a trade-off.
#[derive(Debug, Clone, PartialEq)]
pub struct TradePoint {
    /// Its name.
    pub label: String,
    /// Its cost, in the unit of the axis; positive.
    pub x: f64,
    /// Its error; zero is shown at the lower edge.
    pub y: f64,
    /// Whether it is on the Pareto front: no other choice is better in cost or error without being
    /// worse in the other.
    pub pareto: bool,
    /// Whether it is the choice that was made.
    pub chosen: bool,
}

impl TradePoint {
    fn colour(&self) -> Rgb {
        match (self.chosen, self.pareto) {
            (true, _) => EMPHASIS,
            (false, true) => MAIN,
            (false, false) => DOMINATED,
        }
    }

    fn text_colour(&self) -> Rgb {
        match self.colour() {
            DOMINATED => INK,
            colour => colour,
        }
    }

    /// Whether it has a position on logarithmic axes; an error of zero has one at the edge.
    fn can_be_shown(&self) -> bool {
        self.x > 0.0 && self.x.is_finite() && self.y >= 0.0 && self.y.is_finite()
    }
}

/// The figure of a trade-off: the cost of each choice (`x_title`) against its error (`y_title`), both
/// logarithmic, with the Pareto front as a step line and a ring around the chosen point. The marks
/// are numbered in ascending order of cost; a key below the axes has the names.
///
/// Errors of zero are at the lower edge, which the legend notes. Choices with a cost that is not
/// positive, a negative error, or a value that is not finite cannot be shown; legend and caption
/// count them.
pub fn trade_picture(points: &[TradePoint], x_title: &str, y_title: &str, title: &str) -> Figure {
    let trade_off = TradeOff::of(points, [x_title, y_title], title);
    Figure {
        name: "trade".to_owned(),
        caption: trade_off.caption(),
        svg: trade_off.svg(),
    }
}

/// The axes: all positive values, and room below the smallest error for errors of zero.
fn frame(shown: &[&TradePoint]) -> Frame {
    let costs = shown.iter().map(|point| point.x);
    let errors = shown.iter().map(|point| point.y);
    let positive = errors.filter(|&y| y > 0.0);
    let lowest = positive.clone().fold(f64::INFINITY, f64::min);
    let room = (0.2 * lowest).is_finite().then_some(0.2 * lowest);
    let or_default = |axis: Option<Axis>| axis.unwrap_or_else(|| Axis::fixed(0, 1, 1));
    Frame {
        x: or_default(Axis::logarithmic(costs, DECADES)),
        y: or_default(Axis::logarithmic(positive.chain(room), DECADES)),
        area: WHOLE,
    }
}

struct TradeOff<'a> {
    /// In ascending order of cost.
    shown: Vec<&'a TradePoint>,
    left_out: usize,
    frame: Frame,
    title: Title,
    axes: [&'a str; 2],
}

impl<'a> TradeOff<'a> {
    fn of(points: &'a [TradePoint], axes: [&'a str; 2], title: &str) -> Self {
        let mut shown: Vec<&TradePoint> = points.iter().filter(|p| p.can_be_shown()).collect();
        shown.sort_by(|a, b| a.x.total_cmp(&b.x));
        let [x_title, y_title] = axes;
        Self {
            frame: frame(&shown),
            left_out: points.len() - shown.len(),
            title: Title {
                sample: shortened(title, LONGEST_SAMPLE),
                details: format!("{y_title} against {x_title}"),
                ..Title::default()
            },
            axes,
            shown,
        }
    }

    fn caption(&self) -> String {
        let notes = self.notes().into_iter();
        let notes = notes.map(|note| format!(" {note}."));
        format!(
            "{}. The line is the Pareto front: no other choice has both a lower cost and a lower \
             error.{}",
            self.title.details,
            notes.collect::<String>()
        )
    }

    /// Notes on what the marks do not show.
    fn notes(&self) -> Vec<String> {
        let zeros = self.shown.iter().filter(|point| point.y == 0.0).count();
        let note = |count: usize, text: &str| {
            (count > 0).then(|| format!("{} {text}", counted(count, "point")))
        };
        [
            note(zeros, "with an error of zero at the lower edge"),
            note(self.left_out, "not shown: outside logarithmic axes"),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    fn svg(&self) -> String {
        let key = NameKey::of(&self.shown);
        render(key.height(), Ground::Light, |canvas| {
            self.title.draw(canvas);
            self.draw(canvas);
            self.legend().draw(canvas);
            key.draw(canvas);
        })
    }

    fn draw(&self, canvas: &mut Canvas) {
        let [x_name, y_name] = self.axes;
        self.frame.draw(canvas, x_name, y_name);
        let front = self.front().into_iter();
        self.frame.line(canvas, front, MAIN, 1.5);
        let marks: Vec<Point> = self.shown.iter().map(|point| self.point(point)).collect();
        let numbers = number_points(&marks, &self.frame.area);
        for (&mark, &number) in marks.iter().zip(&numbers) {
            // A number beside its mark needs no leader.
            if number.0 == mark.0 {
                canvas.line(&[mark, number], DOMINATED, 0.7);
            }
        }
        let dominated = |i: &usize| self.shown[*i].colour() == DOMINATED;
        let (behind, before): (Vec<usize>, Vec<usize>) = (0..marks.len()).partition(dominated);
        for i in behind.into_iter().chain(before) {
            draw_mark(canvas, marks[i], self.shown[i]);
        }
        for (i, &number) in numbers.iter().enumerate() {
            draw_number(canvas, i + 1, number, self.shown[i].text_colour());
        }
    }

    /// The point of a choice; errors below the axis are at its lower edge.
    fn point(&self, point: &TradePoint) -> Point {
        let error = point.y.max(self.frame.y.low());
        self.frame.point((point.x, error))
    }

    fn legend(&self) -> Legend {
        let mut legend = Legend::default();
        if self.shown.iter().any(|point| point.chosen) {
            legend.add(Key::Mark(EMPHASIS), "chosen");
        }
        legend.add(Key::Curve(MAIN, Some(MarkShape::Circle)), "Pareto front");
        legend.add(Key::Mark(DOMINATED), "dominated");
        for note in self.notes() {
            legend.add(Key::Note, &note);
        }
        legend
    }

    /// The front as a step line from the upper to the right edge: the lowest error at each cost.
    fn front(&self) -> Vec<(f64, f64)> {
        let (x, y) = (&self.frame.x, &self.frame.y);
        let front = self.shown.iter().filter(|point| point.pareto);
        let mut line = Vec::new();
        let mut error = y.high();
        for point in front {
            let lower = point.y.max(y.low());
            line.extend([(point.x, error), (point.x, lower)]);
            error = lower;
        }
        line.extend(line.last().map(|&(_, error)| (x.high(), error)));
        line
    }
}

fn draw_mark(canvas: &mut Canvas, at: Point, point: &TradePoint) {
    canvas.mark(at, MarkShape::Circle, point.colour());
    if point.chosen {
        canvas.line(&ring(at), EMPHASIS, 1.2);
    }
}

/// A number on a light ground, through which lines behind it are faint.
fn draw_number(canvas: &mut Canvas, number: usize, (x, y): Point, colour: Rgb) {
    let (width, height) = HALF_NUMBER;
    let (left, right, top, bottom) = (x - width, x + width, y - height, y + height);
    let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
    canvas.area(&corners, Paint::translucent(WHITE, 0.8));
    canvas.coloured_text(&number.to_string(), (x, y), NUMBER, Anchor::Middle, colour);
}

/// A ring around a mark.
fn ring((x, y): Point) -> Vec<Point> {
    const RADIUS: f64 = 6.5;
    let at = |i: u32| {
        let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 24.0).sin_cos();
        (x + RADIUS * cos, y + RADIUS * sin)
    };
    (0..=24).map(at).collect()
}

/// The centres of the numbers of marks. Each is at the first free position of a few beside its mark
/// and further ones above and below it: within the area, off all marks and off the numbers before it.
fn number_points(marks: &[Point], area: &Area) -> Vec<Point> {
    let mut numbers: Vec<Point> = Vec::new();
    for &(x, y) in marks {
        let is_free = |&number: &Point| {
            let covers = |points: &[Point], half: Point| {
                let distance = (HALF_NUMBER.0 + half.0, HALF_NUMBER.1 + half.1);
                points
                    .iter()
                    .any(|&point| is_within(point, number, distance))
            };
            area.contains(number, HALF_NUMBER)
                && !covers(marks, (HALF_MARK, HALF_MARK))
                && !covers(&numbers, HALF_NUMBER)
        };
        // Diagonally beside the mark, because the lines of the front are horizontal and vertical.
        let (dx, dy) = (HALF_NUMBER.0 + 2.0, HALF_NUMBER.1 + 4.0);
        let beside = [(dx, -dy), (-dx, -dy), (-dx, dy), (dx, dy)];
        let stacked =
            |side: f64| (1..=MOST_STACKED).map(move |i| (0.0, side * (dy + NUMBER * f64::from(i))));
        let candidates = beside.into_iter().chain(stacked(-1.0)).chain(stacked(1.0));
        let mut candidates = candidates.map(|(dx, dy)| (x + dx, y + dy));
        let number = candidates.find(is_free).unwrap_or((x + dx, y - dy));
        numbers.push(number);
    }
    numbers
}

/// Whether two points are less than a distance apart, both horizontally and vertically.
fn is_within(a: Point, b: Point, distance: Point) -> bool {
    (a.0 - b.0).abs() < distance.0 && (a.1 - b.1).abs() < distance.1
}

/// The names of the numbered choices, in columns below the axes.
struct NameKey<'a> {
    entries: Vec<(String, &'a TradePoint)>,
    column_width: f64,
    rows: usize,
}

impl<'a> NameKey<'a> {
    fn of(points: &[&'a TradePoint]) -> Self {
        let entry = |&point: &&'a TradePoint| (shortened(&point.label, LONGEST_NAME), point);
        let entries: Vec<(String, &TradePoint)> = points.iter().map(entry).collect();
        let letters = entries.iter().map(|(name, _)| name.chars().count());
        let name_width = LETTER * TEXT * letters.max().unwrap_or(0) as f64;
        let column_width = NAME_INDENT + name_width + COLUMN_GAP;
        let width = f64::from(SIZE.0) - 2.0 * LEFT;
        let mut columns = 1;
        while (columns + 1) as f64 * column_width <= width && columns < MOST_COLUMNS {
            columns += 1;
        }
        Self {
            rows: entries.len().div_ceil(columns),
            column_width: width / columns as f64,
            entries,
        }
    }

    /// Its height in units of the figure; half a line more keeps the last line off the edge.
    fn height(&self) -> u32 {
        let rows = u32::try_from(self.rows).unwrap_or(0);
        if rows > 0 { 18 * rows + 9 } else { 0 }
    }

    fn draw(&self, canvas: &mut Canvas) {
        for (i, (name, point)) in self.entries.iter().enumerate() {
            let (column, row) = (i / self.rows, i % self.rows);
            let x = LEFT + self.column_width * column as f64;
            let y = f64::from(SIZE.1) + KEY_SPACING * (row as f64 + 0.5);
            let colour = point.text_colour();
            let number = (x + NAME_INDENT - 8.0, y);
            let text = (i + 1).to_string();
            canvas.coloured_text(&text, number, TEXT - 1.0, Anchor::End, colour);
            let name_point = (x + NAME_INDENT, y);
            canvas.coloured_text(name, name_point, TEXT - 1.0, Anchor::Start, colour);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use resvg::usvg::{Options, Tree};

    fn point(label: &str, x: f64, y: f64, pareto: bool) -> TradePoint {
        TradePoint {
            label: label.to_owned(),
            x,
            y,
            pareto,
            chosen: label == "chosen",
        }
    }

    fn picture(points: &[TradePoint]) -> Figure {
        let figure = trade_picture(points, "time / ns", "error", "a title");
        Tree::from_str(&figure.svg, &Options::default()).unwrap();
        assert!(!figure.svg.contains("NaN") && !figure.svg.contains("inf"));
        figure
    }

    #[test]
    fn every_point_is_named_and_an_error_of_zero_is_noted() {
        let figure = picture(&[
            point("fast", 1.0, 1e-3, true),
            point("chosen", 10.0, 0.0, true),
            point("slow", 100.0, 1e-2, false),
        ]);
        for name in ["fast", "chosen", "slow", "Pareto front", "a title"] {
            assert!(figure.svg.contains(name), "{name}");
        }
        assert!(
            figure
                .caption
                .contains("1 point with an error of zero at the lower edge.")
        );
        assert!(!figure.caption.contains("not shown"));
    }

    #[test]
    fn points_that_cannot_be_shown_are_counted() {
        let figure = picture(&[
            point("free", 0.0, 1.0, false),
            point("endless", f64::INFINITY, 1.0, false),
            point("unknown", 1.0, f64::NAN, false),
            point("here", 1.0, 1.0, true),
        ]);
        let words = "3 points not shown: outside logarithmic axes.";
        assert!(figure.caption.contains(words), "{}", figure.caption);
        assert!(!figure.svg.contains("endless"));
    }

    #[test]
    fn a_figure_without_points_or_of_zeros_only_is_drawn() {
        picture(&[]);
        picture(&[point("exact", 1.0, 0.0, true)]);
        picture(&[point("least", f64::MIN_POSITIVE, f64::MIN_POSITIVE, true)]);
        picture(&[point("most", f64::MAX, f64::MAX, true)]);
    }

    #[test]
    fn the_front_descends_in_steps() {
        let points = [
            point("b", 10.0, 0.1, true),
            point("a", 1.0, 1.0, true),
            point("c", 5.0, 0.5, false),
        ];
        let trade_off = TradeOff::of(&points, ["", ""], "");
        let (x, y) = (&trade_off.frame.x, &trade_off.frame.y);
        let expected = [
            (1.0, y.high()),
            (1.0, 1.0),
            (10.0, 1.0),
            (10.0, 0.1),
            (x.high(), 0.1),
        ];
        assert_eq!(trade_off.front(), expected);
    }

    #[test]
    fn numbers_of_a_crowd_cover_neither_a_mark_nor_each_other() {
        let marks: Vec<Point> = (0..20)
            .map(|i| (300.0 + 9.0 * f64::from(i), 500.0))
            .collect();
        let numbers = number_points(&marks, &WHOLE);
        for (i, &number) in numbers.iter().enumerate() {
            assert!(
                !marks
                    .iter()
                    .any(|&mark| is_within(number, mark, HALF_NUMBER))
            );
            let both = (2.0 * HALF_NUMBER.0, 2.0 * HALF_NUMBER.1);
            assert!(
                !numbers[..i]
                    .iter()
                    .any(|&other| is_within(number, other, both))
            );
        }
    }

    #[test]
    fn the_key_has_a_number_and_a_name_for_each_choice() {
        let points: Vec<TradePoint> = (0..25)
            .map(|i| {
                point(
                    &format!("choice of cost {i}"),
                    1.0 + f64::from(i),
                    0.1,
                    false,
                )
            })
            .collect();
        let figure = trade_picture(&points, "cost", "error", "");
        for i in 0..25 {
            let entry = format!(">\n{}\n</text>\n<text", i + 1);
            assert!(figure.svg.contains(&entry), "{i}");
            assert!(figure.svg.contains(&format!("\nchoice of cost {i}\n")));
        }
    }
}
