//! The coordinate system of a figure: its axes with their grid, and lines, bands and error bars
//! within them.

use super::axis::Axis;
use super::canvas::{Canvas, Point};
use super::clip::clip;
use super::palette::Rgb;
use super::style::{BAND, FINE_GRID, GRID, INK, TEXT};
use super::svg::{Anchor, Paint};

/// The smallest distance between two numbers at the vertical axis.
const NUMBER_SPACING: f64 = 15.0;

/// The rectangle between the axes, in the units of the figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
}

/// The area of a figure with one coordinate system.
pub(super) const WHOLE: Area = Area {
    left: 86.0,
    right: 762.0,
    top: 66.0,
    bottom: 514.0,
};

impl Area {
    /// Whether a rectangle lies inside, by its centre, half its width and half its height.
    pub(super) fn contains(&self, (x, y): Point, (width, height): (f64, f64)) -> bool {
        x - width > self.left
            && x + width < self.right
            && y - height > self.top
            && y + height < self.bottom
    }

    fn centre(&self) -> Point {
        (
            0.5 * (self.left + self.right),
            0.5 * (self.top + self.bottom),
        )
    }

    /// Writes the name of the horizontal axis below.
    pub(super) fn draw_x_name(&self, canvas: &mut Canvas, name: &str) {
        let point = (self.centre().0, self.bottom + 42.0);
        canvas.text(name, point, TEXT + 1.0, Anchor::Middle);
    }

    /// Writes the name of the vertical axis to the left.
    pub(super) fn draw_y_name(&self, canvas: &mut Canvas, name: &str) {
        let point = (self.left - 66.0, self.centre().1);
        canvas.text(name, point, TEXT + 1.0, Anchor::MiddleUpwards);
    }
}

/// Points with x and y exchanged.
fn swapped(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.into_iter().map(|(x, y)| (y, x)).collect()
}

/// Two axes and the area between them.
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

    /// A point by its fractions of the axes.
    fn at(&self, x: f64, y: f64) -> Point {
        let Area {
            left,
            right,
            top,
            bottom,
        } = self.area;
        (left + x * (right - left), bottom - y * (bottom - top))
    }

    /// The point of two values.
    pub(super) fn point(&self, (x, y): (f64, f64)) -> Point {
        self.at(self.x.fraction(x), self.y.fraction(y))
    }

    /// Whether two values are within their axes.
    pub(super) fn contains(&self, (x, y): (f64, f64)) -> bool {
        self.x.contains(x) && self.y.contains(y)
    }

    /// The grid, the axes and their names.
    pub(super) fn draw(&self, canvas: &mut Canvas, x_name: &str, y_name: &str) {
        for &x in self.x.unlabelled() {
            self.vertical(canvas, x, FINE_GRID);
        }
        for &y in self.y.unlabelled() {
            self.horizontal(canvas, y, FINE_GRID);
        }
        self.draw_x_ticks(canvas);
        self.draw_y_ticks(canvas);
        let border = [(0.0, 1.0), (0.0, 0.0), (1.0, 0.0)].map(|(x, y)| self.at(x, y));
        canvas.line(&border, INK, 1.0);
        self.area.draw_x_name(canvas, x_name);
        self.area.draw_y_name(canvas, y_name);
    }

    fn draw_x_ticks(&self, canvas: &mut Canvas) {
        for tick in self.x.ticks() {
            self.vertical(canvas, tick.value, GRID);
            let (x, _) = self.at(self.x.fraction(tick.value), 0.0);
            let point = (x, self.area.bottom + 16.0);
            canvas.text(&tick.label, point, TEXT, Anchor::Middle);
        }
    }

    fn draw_y_ticks(&self, canvas: &mut Canvas) {
        for tick in self.y.ticks() {
            self.horizontal(canvas, tick.value, GRID);
            if self.has_room_for_number(tick.value) {
                let (_, y) = self.at(0.0, self.y.fraction(tick.value));
                let point = (self.area.left - 8.0, y);
                canvas.text(&tick.label, point, TEXT, Anchor::End);
            }
        }
    }

    /// Whether there is room for a number at this value of y: in a low area only every second,
    /// fifth or tenth grid line has one.
    fn has_room_for_number(&self, value: f64) -> bool {
        let [first, second, ..] = self.y.ticks() else {
            return true;
        };
        if self.y.is_logarithmic() {
            return true;
        }
        let step = second.value - first.value;
        let spacing = step / (self.y.high() - self.y.low()) * (self.area.bottom - self.area.top);
        let every = [1.0, 2.0, 5.0]
            .into_iter()
            .find(|k| k * spacing >= NUMBER_SPACING);
        (value / step).round().rem_euclid(every.unwrap_or(10.0)) == 0.0
    }

    /// A thin vertical line across the area at a value of x.
    fn vertical(&self, canvas: &mut Canvas, x: f64, paint: impl Into<Paint>) {
        let x = self.x.fraction(x);
        canvas.line(&[self.at(x, 0.0), self.at(x, 1.0)], paint, 1.0);
    }

    /// A thin horizontal line across the area at a value of y.
    pub(super) fn horizontal(&self, canvas: &mut Canvas, y: f64, paint: impl Into<Paint>) {
        let y = self.y.fraction(y);
        canvas.line(&[self.at(0.0, y), self.at(1.0, y)], paint, 1.0);
    }

    /// A dashed vertical line across the area at a value of x, if it is on the axis.
    pub(super) fn dashed_vertical(&self, canvas: &mut Canvas, x: f64, paint: impl Into<Paint>) {
        if !self.x.contains(x) {
            return;
        }
        let x = self.x.fraction(x);
        canvas.dashed_line(self.at(x, 0.0), self.at(x, 1.0), paint, 1.0);
    }

    /// A dashed horizontal line across the area at a value of y.
    pub(super) fn dashed_horizontal(&self, canvas: &mut Canvas, y: f64, paint: impl Into<Paint>) {
        let y = self.y.fraction(y);
        canvas.dashed_line(self.at(0.0, y), self.at(1.0, y), paint, 1.0);
    }

    /// A line through values, clipped to both axes.
    pub(super) fn line(
        &self,
        canvas: &mut Canvas,
        values: impl Iterator<Item = (f64, f64)>,
        paint: impl Into<Paint>,
        width: f64,
    ) {
        let paint = paint.into();
        let fractions: Vec<(f64, f64)> = values
            .map(|(x, y)| (self.x.fraction(x), self.y.fraction(y)))
            .collect();
        for piece in clip(&swapped(fractions)) {
            for piece in clip(&swapped(piece)) {
                let points: Vec<Point> = piece.into_iter().map(|(x, y)| self.at(x, y)).collect();
                canvas.line(&points, paint, width);
            }
        }
    }

    /// The area between two values of y at each x, clipped to the vertical axis.
    pub(super) fn band(&self, canvas: &mut Canvas, values: &[(f64, [f64; 2])], colour: Rgb) {
        let edge = |i: usize| {
            let values = values.iter().filter(|(x, _)| self.x.contains(*x));
            values.map(move |&(x, y)| {
                self.at(self.x.fraction(x), self.y.fraction(y[i]).clamp(0.0, 1.0))
            })
        };
        let outline: Vec<Point> = edge(0).chain(edge(1).rev()).collect();
        canvas.area(&outline, Paint::translucent(colour, BAND));
    }

    /// An error bar at x, clipped to the vertical axis.
    pub(super) fn error_bar(
        &self,
        canvas: &mut Canvas,
        x: f64,
        (low, high): (f64, f64),
        colour: Rgb,
    ) {
        const HALF_CAP: f64 = 2.5;
        self.line(canvas, [(x, low), (x, high)].into_iter(), colour, 1.0);
        for end in [low, high] {
            if self.contains((x, end)) {
                let (x, y) = self.point((x, end));
                canvas.line(&[(x - HALF_CAP, y), (x + HALF_CAP, y)], colour, 1.0);
            }
        }
    }
}
