//! The polar plot of the paper's figures: f_r as radius at the view angle.

use brdf_fit::plot::{Reading, Theory, View};
use egui::{Align2, Shape, Stroke, Ui, Vec2};
use egui_plot::{Plot, PlotPoint, PlotTransform, Text};

use super::axis::Axis;
use super::choice::choose;
use super::common::{self, describe, reset_on_demand};
use super::context::{DrawnCurve, PlotContext};
use super::hover::show_values;
use super::items::{self, Drawing};
use super::navigation::navigate;
use super::ticks::{linear_label, round_up};

/// The largest number of circles. There are at least three, except for the smallest numbers.
const MOST_CIRCLES: f64 = 5.0;

/// The position of a value at a view angle in degrees. The normal points upwards, and positive
/// angles to the right.
fn position(theta_deg: f64, value: f64) -> [f64; 2] {
    let theta = theta_deg.to_radians();
    [value * theta.sin(), value * theta.cos()]
}

/// The radius of the outermost circle, and the step from circle to circle.
fn circles(largest: f64) -> (f64, f64) {
    let step = round_up(if largest > 0.0 { largest } else { 1.0 } / MOST_CIRCLES);
    ((largest / step).ceil().max(1.0) * step, step)
}

/// Draws the polar plot.
pub(super) fn show(ui: &mut Ui, context: &PlotContext) {
    let curves: Vec<&DrawnCurve> = context.curves.iter().collect();
    let (radius, step) = circles(context.range.1);
    let view = &context.state.view;
    let plot = empty_plot(context, ui.available_size(), radius);
    let plot = reset_on_demand(ui, context.state, "polar", plot);
    let colour = ui.visuals().weak_text_color();
    let home = [
        [-1.12 * radius, 1.12 * radius],
        [-0.16 * radius, 1.12 * radius],
    ];
    let response = plot.show(ui, |plot_ui| {
        navigate(plot_ui, home);
        let stroke = Stroke::new(1.0, colour.gamma_multiply(0.35));
        plot_ui.add(Drawing::new("grid".to_owned(), move |transform, shapes| {
            grid(transform, radius, step, stroke, shapes);
        }));
        for (name, [x, y], text) in labels(radius, step, view) {
            let text = Text::new(name, PlotPoint::new(x, y), text).color(colour);
            plot_ui.text(text.anchor(Align2::CENTER_CENTER));
        }
        for (i, drawn) in curves.iter().enumerate() {
            plot_ui.add(Drawing::new(
                format!("curve {i}"),
                move |transform, shapes| draw(transform, drawn, view, radius, shapes),
            ));
        }
    });
    show_values(&response, view, &curves, position_at_radius);
    let of_reading = |reading: &Reading| position_at_radius(reading.theta_deg, reading.value);
    choose(context, &response, &curves, of_reading);
    describe(&response, "BRDF plot", &curves);
}

/// A plot around a half disc with a radius, without any curves.
fn empty_plot<'a>(context: &PlotContext, size: Vec2, radius: f64) -> Plot<'a> {
    let plot = Plot::new("polar")
        .id(common::id(context.state, "polar"))
        .width(size.x)
        .height(size.y)
        .data_aspect(1.0)
        .show_axes(false)
        .show_grid(false)
        .show_crosshair(false)
        .allow_scroll(false)
        .allow_drag(!context.state.choosing)
        .label_formatter(|_| None);
    let corners = [[-1.12, -0.16], [1.12, 1.12]];
    corners.into_iter().fold(plot, |plot, [x, y]| {
        plot.include_x(x * radius).include_y(y * radius)
    })
}

/// The position of a value at a view angle in degrees; `None` if the value is negative.
fn position_at_radius(theta_deg: f64, value: f64) -> Option<[f64; 2]> {
    (value >= 0.0).then(|| position(theta_deg, value))
}

fn draw(
    transform: &PlotTransform,
    drawn: &DrawnCurve,
    view: &View,
    radius: f64,
    shapes: &mut Vec<Shape>,
) {
    let (curve, colour) = (drawn.curve, drawn.colour);
    if let Some(mirror) = view.mirror_deg(curve.psi) {
        let ends = [[0.0, 0.0], position(mirror, radius)];
        items::dashed(transform, ends, colour, shapes);
    }
    items::ribbon(transform, curve.theory.iter().map(band), colour, shapes);
    for reading in &curve.readings {
        items::error_bar(transform, error_bar(reading), colour, shapes);
    }
    let at = |reading: &Reading| position_at_radius(reading.theta_deg, reading.value);
    items::used_and_left_out(transform, drawn, at, shapes);
    let points = curve.theory.iter().map(|theory| {
        let [x, y] = position(theory.theta_deg, theory.value);
        (x, y)
    });
    let stroke = Stroke::new(1.8, colour);
    items::line(transform, Axis::Linear, points, stroke, shapes);
    let ghost = |theory: &Theory| position_at_radius(theory.theta_deg, theory.value);
    items::ghosts(transform, drawn, ghost, shapes);
}

/// The ends of the band at a point of the theory.
fn band(theory: &Theory) -> Option<[[f64; 2]; 2]> {
    let sigma = theory.sigma?;
    let ends = [theory.value - sigma, theory.value + sigma];
    Some(ends.map(|value| position(theory.theta_deg, value.max(0.0))))
}

/// The ends of the error bar of a reading, without its negative part.
fn error_bar(reading: &Reading) -> Option<[[f64; 2]; 2]> {
    let sigma = reading.sigma?;
    let high = position_at_radius(reading.theta_deg, reading.value + sigma)?;
    let low = position(reading.theta_deg, (reading.value - sigma).max(0.0));
    Some([low, high])
}

/// Half circles at round values, and rays at multiples of 30 deg.
fn grid(
    transform: &PlotTransform,
    radius: f64,
    step: f64,
    stroke: Stroke,
    shapes: &mut Vec<Shape>,
) {
    let mut line = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let points = points.map(|[x, y]| (x, y));
        items::line(transform, Axis::Linear, points, stroke, shapes);
    };
    for value in values(radius, step) {
        let circle = (-90..=90).step_by(3);
        line(&mut circle.map(|deg| position(f64::from(deg), value)));
    }
    for deg in (-90..=90).step_by(30) {
        line(&mut [[0.0, 0.0], position(f64::from(deg), radius)].into_iter());
    }
}

/// The values of the circles.
fn values(radius: f64, step: f64) -> impl Iterator<Item = f64> {
    let count = (radius / step).round() as u32;
    (1..=count).map(move |i| f64::from(i) * step)
}

/// The labels of the grid and the name of the quantity: identifiers, positions and texts.
fn labels(radius: f64, step: f64, view: &View) -> Vec<(String, [f64; 2], String)> {
    let angles = (-90..=90).step_by(30).map(|deg: i32| {
        let at = position(f64::from(deg), 1.06 * radius);
        (format!("angle {deg}"), at, format!("{deg}°"))
    });
    let radii = values(radius, step).enumerate().map(|(i, value)| {
        let at = [value, -0.04 * radius];
        (format!("radius {i}"), at, linear_label(value, step))
    });
    let name = view.quantity.axis_name().to_owned();
    let name = ("name".to_owned(), [0.0, -0.11 * radius], name);
    angles.chain(radii).chain([name]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_value_uses_most_of_the_radius() {
        for largest in [0.021, 0.1, 0.21, 0.33, 0.51, 0.9, 1.01, 7e-5, 3e4] {
            let (radius, step) = circles(largest);
            assert!(
                largest <= radius * (1.0 + 1e-12) && largest > 0.66 * radius,
                "{largest}"
            );
            assert!((2..=5).contains(&values(radius, step).count()), "{largest}");
        }
        assert_eq!(circles(0.0).1, 0.2);
    }
}
