//! What is drawn into a plot: lines, bands and readings, none of which moves the axes.

use std::ops::RangeInclusive;

use brdf_fit::plot::{MarkShape, Reading, Theory};
use egui::{Color32, Mesh, Pos2, Shape, Stroke, Ui, epaint::PathShape, pos2, vec2};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotTransform};

use super::axis::Axis;

/// Farther from the plot than this, in points, a position is not told apart.
const FAR: f32 = 1e5;

/// Half the size of a mark, in points.
const MARK: f32 = 2.6;

type Draw<'a> = Box<dyn Fn(&PlotTransform, &mut Vec<Shape>) + 'a>;

/// Shapes in a plot. It has no bounds: what the axes show is said by the plot itself.
pub struct Drawing<'a> {
    base: PlotItemBase,
    draw: Draw<'a>,
}

impl<'a> Drawing<'a> {
    /// A drawing with a name that no other in the plot has.
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

/// Where a point of the plot is on the screen.
fn place(transform: &PlotTransform, [x, y]: [f64; 2]) -> Pos2 {
    let frame = transform.frame();
    let position = pos2(
        transform.position_from_point_x(x),
        transform.position_from_point_y(y),
    );
    position.clamp(frame.min - vec2(FAR, FAR), frame.max + vec2(FAR, FAR))
}

/// A line over the view angle, interrupted where the axis has no place for it.
pub fn line(
    transform: &PlotTransform,
    axis: Axis,
    points: impl Iterator<Item = (f64, f64)>,
    stroke: Stroke,
    shapes: &mut Vec<Shape>,
) {
    let mut run: Vec<Pos2> = Vec::new();
    let mut end = |run: &mut Vec<Pos2>| {
        if run.len() > 1 {
            shapes.push(Shape::Path(PathShape::line(std::mem::take(run), stroke)));
        }
        run.clear();
    };
    for (x, value) in points {
        match axis.place(value) {
            Some(y) => run.push(place(transform, [x, y])),
            None => end(&mut run),
        }
    }
    end(&mut run);
}

/// The theory's line.
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

/// The band of one standard error to both sides of the theory.
pub fn band(
    transform: &PlotTransform,
    axis: Axis,
    theory: &[Theory],
    colour: Color32,
    shapes: &mut Vec<Shape>,
) {
    let bottom = transform.bounds().min()[1];
    let edge = |t: &Theory| {
        let sigma = t.sigma?;
        let high = place(transform, [t.theta_deg, axis.place(t.value + sigma)?]);
        // What lies below a logarithmic axis ends at its bottom.
        let low = axis.place(t.value - sigma).unwrap_or(bottom).max(bottom);
        Some([high, place(transform, [t.theta_deg, low])])
    };
    let mut mesh = Mesh::default();
    let mut last: Option<u32> = None;
    for t in theory {
        let Some([high, low]) = edge(t) else {
            last = None;
            continue;
        };
        let here = mesh.vertices.len() as u32;
        mesh.colored_vertex(high, colour);
        mesh.colored_vertex(low, colour);
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

/// Readings with their error bars. `value` says what of a reading is shown.
pub fn readings(
    transform: &PlotTransform,
    axis: Axis,
    readings: &[Reading],
    value: impl Fn(&Reading) -> f64,
    mark: MarkShape,
    colour: Color32,
    shapes: &mut Vec<Shape>,
) {
    let frame = transform.frame().expand(MARK);
    let bottom = transform.bounds().min()[1];
    let bars = Stroke::new(1.0, colour.gamma_multiply(0.55));
    for reading in readings {
        let value = value(reading);
        let x = reading.theta_deg;
        if let Some(sigma) = reading.sigma
            && let Some(high) = axis.place(value + sigma)
        {
            let low = axis.place(value - sigma).unwrap_or(bottom);
            let ends = [place(transform, [x, low]), place(transform, [x, high])];
            shapes.push(Shape::line_segment(ends, bars));
        }
        let Some(y) = axis.place(value) else {
            continue;
        };
        let position = place(transform, [x, y]);
        if frame.contains(position) {
            shapes.push(mark_at(mark, position, MARK, colour));
        }
    }
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
        MarkShape::Diamond => polygon(&[(0.0, -1.35), (1.35, 0.0), (0.0, 1.35), (-1.35, 0.0)]),
    }
}

/// An upright dashed line over the whole plot.
pub fn upright(transform: &PlotTransform, x: f64, colour: Color32, shapes: &mut Vec<Shape>) {
    let frame = transform.frame();
    let x = transform.position_from_point_x(x);
    if frame.x_range().contains(x) {
        let ends = [pos2(x, frame.top()), pos2(x, frame.bottom())];
        let stroke = Stroke::new(1.0, colour.gamma_multiply(0.6));
        shapes.extend(Shape::dashed_line(&ends, stroke, 4.0, 4.0));
    }
}
