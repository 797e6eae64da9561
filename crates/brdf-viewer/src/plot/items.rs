//! The items drawn into a plot: lines, bands and readings. None of them affects the bounds.

use std::ops::RangeInclusive;

use brdf_fit::plot::{MarkShape, Reading, Theory};
use egui::{Color32, Mesh, Pos2, Rect, Shape, Stroke, Ui, epaint::PathShape, pos2, vec2};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotTransform};

use super::axis::Axis;
use super::context::DrawnCurve;

/// Positions are clamped to this distance from the plot, in points.
const FAR: f32 = 1e5;

/// Half the size of a mark, in points.
const MARK: f32 = 2.6;

/// A curve with more readings than this is drawn with simple marks, because they overlap.
const DENSE: usize = 250;

/// Opacity of a band of uncertainty.
const BAND: f32 = 0.25;

type Draw<'a> = Box<dyn Fn(&PlotTransform, &mut Vec<Shape>) + 'a>;

/// Shapes in a plot. They have no bounds: the range of the axes is set by the plot itself.
pub struct Drawing<'a> {
    base: PlotItemBase,
    draw: Draw<'a>,
}

impl<'a> Drawing<'a> {
    /// A drawing with a name that is unique in the plot.
    pub fn new(name: String, draw: impl Fn(&PlotTransform, &mut Vec<Shape>) + 'a) -> Self {
        Self {
            base: PlotItemBase::new(name),
            draw: Box::new(draw),
        }
    }
}

impl PlotItem for Drawing<'_> {
    fn shapes(&self, _: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        (self.draw)(transform, shapes);
    }

    fn initialize(&mut self, _: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        Color32::TRANSPARENT
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::None
    }

    fn bounds(&self) -> PlotBounds {
        PlotBounds::NOTHING
    }

    fn base(&self) -> &PlotItemBase {
        &self.base
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.base
    }
}

/// The position of a point of the plot on the screen.
fn screen_position(transform: &PlotTransform, [x, y]: [f64; 2]) -> Pos2 {
    let frame = transform.frame();
    let position = pos2(
        transform.position_from_point_x(x),
        transform.position_from_point_y(y),
    );
    position.clamp(frame.min - vec2(FAR, FAR), frame.max + vec2(FAR, FAR))
}

/// Clips a segment to the plot with a margin, and returns its ends on the screen, in points. The
/// segment is clipped in double precision, because in a zoomed plot it can be much longer than the
/// range of screen positions.
fn clipped(transform: &PlotTransform, [a, b]: [[f64; 2]; 2], margin: f32) -> Option<[Pos2; 2]> {
    let (frame, bounds) = (transform.frame().expand(margin), transform.bounds());
    let point = |[x, y]: [f64; 2]| {
        let part = [
            (x - bounds.min()[0]) / bounds.width(),
            (bounds.max()[1] - y) / bounds.height(),
        ];
        let inner = transform.frame();
        [
            f64::from(inner.left()) + part[0] * f64::from(inner.width()),
            f64::from(inner.top()) + part[1] * f64::from(inner.height()),
        ]
    };
    let (a, b) = (point(a), point(b));
    let sides = [frame.x_range(), frame.y_range()];
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for ((a, b), side) in a.into_iter().zip(b).zip(sides) {
        if !(a.is_finite() && b.is_finite()) {
            return None;
        }
        let parameter = |side: f32| (f64::from(side) - a) / (b - a);
        if a != b {
            let (low, high) = (parameter(side.min), parameter(side.max));
            from = from.max(low.min(high));
            to = to.min(low.max(high));
        } else if !side.contains(a as f32) {
            return None;
        }
    }
    let at = |t: f64| {
        let [x, y] = [0, 1].map(|i| (a[i] + t * (b[i] - a[i])) as f32);
        pos2(x, y)
    };
    (from <= to).then(|| [at(from), at(to)])
}

/// The visible part of a segment, dashed.
pub fn dashed(
    transform: &PlotTransform,
    ends: [[f64; 2]; 2],
    colour: Color32,
    shapes: &mut Vec<Shape>,
) {
    let stroke = Stroke::new(1.0, colour.gamma_multiply(0.6));
    if let Some(ends) = clipped(transform, ends, MARK) {
        shapes.extend(Shape::dashed_line(&ends, stroke, 4.0, 4.0));
    }
}

/// A line through points, interrupted at values that have no position on the axis.
pub fn line(
    transform: &PlotTransform,
    axis: Axis,
    points: impl Iterator<Item = (f64, f64)>,
    stroke: Stroke,
    shapes: &mut Vec<Shape>,
) {
    let mut run: Vec<Pos2> = Vec::new();
    let mut end_run = |run: &mut Vec<Pos2>| {
        if run.len() > 1 {
            shapes.push(Shape::Path(PathShape::line(std::mem::take(run), stroke)));
        }
        run.clear();
    };
    let mut before = None;
    for (x, value) in points {
        let here = axis.position(value).map(|y| [x, y]);
        let ends = before.zip(here);
        match ends.and_then(|(a, b)| clipped(transform, [a, b], FAR)) {
            Some([from, to]) => {
                if run.last() != Some(&from) {
                    end_run(&mut run);
                    run.push(from);
                }
                run.push(to);
            }
            None => end_run(&mut run),
        }
        before = here;
    }
    end_run(&mut run);
}

/// The line of the theory.
pub fn theory(
    transform: &PlotTransform,
    axis: Axis,
    theory: &[Theory],
    colour: Color32,
    shapes: &mut Vec<Shape>,
) {
    let points = theory.iter().map(|t| (t.theta_deg, t.value));
    line(transform, axis, points, Stroke::new(1.8, colour), shapes);
}

/// The band of one standard error on both sides of the theory.
pub fn band(
    transform: &PlotTransform,
    axis: Axis,
    theory: &[Theory],
    colour: Color32,
    shapes: &mut Vec<Shape>,
) {
    let bottom = transform.bounds().min()[1];
    let ends = theory.iter().map(|t| {
        let sigma = t.sigma?;
        let high = axis.position(t.value + sigma)?;
        // An end without a position on a logarithmic axis is below the plot.
        let low = axis.position(t.value - sigma).unwrap_or(bottom).max(bottom);
        Some([[t.theta_deg, high], [t.theta_deg, low]])
    });
    ribbon(transform, ends, colour, shapes);
}

/// The area between two lines, given by pairs of points; interrupted at `None`.
pub fn ribbon(
    transform: &PlotTransform,
    ends: impl Iterator<Item = Option<[[f64; 2]; 2]>>,
    colour: Color32,
    shapes: &mut Vec<Shape>,
) {
    let faint = colour.gamma_multiply(BAND);
    let mut mesh = Mesh::default();
    let mut last: Option<u32> = None;
    for ends in ends {
        let Some(ends) = ends else {
            last = None;
            continue;
        };
        let here = mesh.vertices.len() as u32;
        for end in ends {
            mesh.colored_vertex(screen_position(transform, end), faint);
        }
        if let Some(before) = last {
            mesh.add_triangle(before, before + 1, here);
            mesh.add_triangle(before + 1, here, here + 1);
        }
        last = Some(here);
    }
    if !mesh.is_empty() {
        shapes.push(Shape::mesh(mesh));
    }
}

/// The appearance of readings.
#[derive(Clone, Copy)]
pub struct MarkStyle {
    /// The mark.
    pub mark: MarkShape,
    /// The colour.
    pub colour: Color32,
}

/// Readings with their error bars, hollow where they are left out. `value` is the value of a reading
/// that is shown.
pub fn readings(
    transform: &PlotTransform,
    axis: Axis,
    drawn: &DrawnCurve,
    value: impl Fn(&Reading) -> Option<f64>,
    shapes: &mut Vec<Shape>,
) {
    let (readings, style) = (&drawn.curve.readings, drawn.mark_style());
    let bottom = transform.bounds().min()[1];
    for reading in readings {
        let Some(value) = value(reading) else {
            continue;
        };
        let x = reading.theta_deg;
        let ends = reading.sigma.and_then(|sigma| {
            let high = axis.position(value + sigma)?;
            let low = axis.position(value - sigma).unwrap_or(bottom);
            Some([[x, low], [x, high]])
        });
        error_bar(transform, ends, style.colour, shapes);
    }
    let at = |reading: &Reading| Some([reading.theta_deg, axis.position(value(reading)?)?]);
    used_and_left_out(transform, drawn, at, shapes);
}

/// The marks of readings at positions of the plot: filled for those that are used in the fit, hollow
/// for those that are left out.
pub fn used_and_left_out(
    transform: &PlotTransform,
    drawn: &DrawnCurve,
    at: impl Fn(&Reading) -> Option<[f64; 2]>,
    shapes: &mut Vec<Shape>,
) {
    let readings = &drawn.curve.readings;
    let is_used = |reading: &&Reading| !drawn.left_out.contains(&reading.index);
    let used = readings.iter().filter(is_used).filter_map(&at);
    marks(
        transform,
        &used.collect::<Vec<_>>(),
        drawn.mark_style(),
        shapes,
    );
    if drawn.left_out.is_empty() {
        return;
    }
    let frame = transform.frame().expand(MARK);
    let stroke = Stroke::new(1.2, drawn.colour);
    let left_out = readings.iter().filter(|reading| !is_used(reading));
    let positions = left_out
        .filter_map(at)
        .map(|at| screen_position(transform, at));
    let visible = positions.filter(|position| frame.contains(*position));
    shapes.extend(visible.map(|position| Shape::circle_stroke(position, 1.4 * MARK, stroke)));
}

/// A hollow diamond at a position of the plot, larger than the mark of a reading; `None` outside the plot.
pub fn mark_outline(transform: &PlotTransform, at: [f64; 2], stroke: Stroke) -> Option<Shape> {
    let position = screen_position(transform, at);
    let size = 2.0 * MARK;
    let is_visible = transform.frame().expand(size).contains(position);
    let corners = [
        vec2(size, 0.0),
        vec2(0.0, size),
        vec2(-size, 0.0),
        vec2(0.0, -size),
    ];
    let corners = corners.map(|corner| position + corner);
    is_visible.then(|| Shape::closed_line(corners.to_vec(), stroke))
}

/// The theories that stay in the plot, each with a dash pattern of its own.
pub fn ghosts(
    transform: &PlotTransform,
    drawn: &DrawnCurve,
    position: impl Fn(&Theory) -> Option<[f64; 2]>,
    shapes: &mut Vec<Shape>,
) {
    for (index, curve) in &drawn.ghosts {
        let (dash, gap) = dashes(*index);
        let stroke = Stroke::new(1.6, drawn.colour);
        let mut solid = Vec::new();
        let points = curve.theory.iter().map(|theory| {
            let at = position(theory);
            at.map_or((f64::NAN, f64::NAN), |[x, y]| (x, y))
        });
        line(transform, Axis::Linear, points, stroke, &mut solid);
        for shape in solid {
            if let Shape::Path(path) = shape {
                let visible = within(transform, &path.points);
                shapes.extend(Shape::dashed_line(&visible, stroke, dash, gap));
            }
        }
    }
}

/// The dash pattern of a ghost: the lengths of dash and gap, in points.
pub fn dashes(index: usize) -> (f32, f32) {
    [(9.0, 5.0), (3.5, 3.5), (15.0, 4.0), (6.0, 9.0)][index % 4]
}

/// The points of a line up to a plot beyond the frame, so that the number of dashes stays small.
fn within(transform: &PlotTransform, points: &[Pos2]) -> Vec<Pos2> {
    let frame = transform.frame();
    let margin = frame.size();
    let near = frame.expand2(margin);
    points
        .iter()
        .map(|point| point.clamp(near.min, near.max))
        .collect()
}

/// The visible part of the error bar of a reading, if it has one.
pub fn error_bar(
    transform: &PlotTransform,
    ends: Option<[[f64; 2]; 2]>,
    colour: Color32,
    shapes: &mut Vec<Shape>,
) {
    if let Some(ends) = ends.and_then(|ends| clipped(transform, ends, MARK)) {
        let bar = Stroke::new(1.0, colour.gamma_multiply(0.55));
        shapes.push(Shape::line_segment(ends, bar));
    }
}

/// The marks of readings within the plot.
pub fn marks(
    transform: &PlotTransform,
    points: &[[f64; 2]],
    MarkStyle { mark, colour }: MarkStyle,
    shapes: &mut Vec<Shape>,
) {
    let frame = transform.frame().expand(MARK);
    let positions = points
        .iter()
        .map(|point| screen_position(transform, *point));
    let visible = positions.filter(|position| frame.contains(*position));
    if points.len() > DENSE {
        shapes.push(squares(visible, colour));
    } else {
        shapes.extend(visible.map(|position| mark_at(mark, position, MARK, colour)));
    }
}

/// Squares in one mesh, which is drawn many times faster than separate marks with smooth borders.
fn squares(positions: impl Iterator<Item = Pos2>, colour: Color32) -> Shape {
    let mut mesh = Mesh::default();
    let size = vec2(1.6, 1.6) * MARK;
    for position in positions {
        mesh.add_colored_rect(Rect::from_center_size(position, size), colour);
    }
    Shape::mesh(mesh)
}

/// A mark of a reading.
pub fn mark_at(mark: MarkShape, at: Pos2, size: f32, colour: Color32) -> Shape {
    let polygon = |corners: &[(f32, f32)]| {
        let corners = corners.iter().map(|(x, y)| at + vec2(*x, *y) * size);
        Shape::convex_polygon(corners.collect(), colour, Stroke::NONE)
    };
    match mark {
        MarkShape::Circle => Shape::circle_filled(at, size, colour),
        MarkShape::Square => {
            let square = egui::Rect::from_center_size(at, vec2(1.8, 1.8) * size);
            Shape::rect_filled(square, 0.0, colour)
        }
        MarkShape::Triangle => polygon(&[(0.0, -1.25), (1.15, 0.85), (-1.15, 0.85)]),
        MarkShape::Inverted => polygon(&[(0.0, 1.25), (-1.15, -0.85), (1.15, -0.85)]),
        MarkShape::Cross => {
            let bar = |width: f32, height: f32| {
                let bar = egui::Rect::from_center_size(at, vec2(width, height) * size);
                Shape::rect_filled(bar, 0.0, colour)
            };
            Shape::Vec(vec![bar(2.5, 0.85), bar(0.85, 2.5)])
        }
        MarkShape::Diamond => polygon(&[(0.0, -1.35), (1.35, 0.0), (0.0, 1.35), (-1.35, 0.0)]),
    }
}

/// A vertical dashed line over the whole plot.
pub fn vertical_line(transform: &PlotTransform, x: f64, colour: Color32, shapes: &mut Vec<Shape>) {
    let ([_, bottom], [_, top]) = (transform.bounds().min(), transform.bounds().max());
    dashed(transform, [[x, top], [x, bottom]], colour, shapes);
}

#[cfg(test)]
mod tests {
    use egui::Vec2b;

    use super::*;

    /// A plot of 400 x 300 points that shows `width` of the plane around (0, 1).
    fn zoomed(width: f64) -> PlotTransform {
        let bounds = PlotBounds::from_min_max([-width, 1.0 - width], [width, 1.0 + width]);
        let frame = Rect::from_min_size(pos2(10.0, 20.0), vec2(400.0, 300.0));
        PlotTransform::new(frame, bounds, Vec2b::FALSE)
    }

    #[test]
    fn the_number_of_shapes_does_not_grow_with_the_zoom() {
        for exponent in -15..3 {
            let transform = zoomed(10_f64.powi(exponent));
            let mut shapes = Vec::new();
            dashed(
                &transform,
                [[0.0, 0.0], [0.0, 2.0]],
                Color32::RED,
                &mut shapes,
            );
            dashed(
                &transform,
                [[-3.0, -2.0], [3.0, 4.0]],
                Color32::RED,
                &mut shapes,
            );
            vertical_line(&transform, 0.0, Color32::RED, &mut shapes);
            assert!(
                (30..300).contains(&shapes.len()),
                "{exponent}: {}",
                shapes.len()
            );
        }
    }

    #[test]
    fn a_line_is_clipped_where_it_leaves_the_plot() {
        // Through (0, 1) at 45 deg, to ends at a distance of 1e9 plots.
        let transform = zoomed(1e-9);
        let ends = clipped(&transform, [[-1.0, 0.0], [3.0, 4.0]], 0.0).unwrap();
        assert!((ends[0] - pos2(10.0, 320.0)).length() < 0.01, "{ends:?}");
        assert!((ends[1] - pos2(410.0, 20.0)).length() < 0.01, "{ends:?}");
        assert_eq!(clipped(&transform, [[1.0, 0.0], [2.0, 3.0]], 0.0), None);
        assert_eq!(
            clipped(&transform, [[0.0, f64::NAN], [0.0, 1.0]], 0.0),
            None
        );
    }
}
