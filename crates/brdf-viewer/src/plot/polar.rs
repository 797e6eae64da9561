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
use super::radius::Radius;

/// The position at a view angle in degrees and a distance from the centre. The normal points upwards,
/// and positive angles to the right.
fn position(theta_deg: f64, distance: f64) -> [f64; 2] {
    let theta = theta_deg.to_radians();
    [distance * theta.sin(), distance * theta.cos()]
}

/// The position of a value at a view angle in degrees; `None` if it has no radius.
fn place(radius: Radius, theta_deg: f64, value: f64) -> Option<[f64; 2]> {
    Some(position(theta_deg, radius.of(value)?))
}

/// Draws the polar plot.
pub(super) fn show(ui: &mut Ui, context: &PlotContext) {
    let curves: Vec<&DrawnCurve> = context.curves.iter().collect();
    let view = &context.state.view;
    let radius = Radius::new(context.range, view.scale);
    let outermost = radius.outermost();
    let plot = empty_plot(context, ui.available_size(), outermost);
    let plot = reset_on_demand(ui, context.state, "polar", plot);
    let colour = ui.visuals().weak_text_color();
    let home = [
        [-1.12 * outermost, 1.12 * outermost],
        [-0.16 * outermost, 1.12 * outermost],
    ];
    let response = plot.show(ui, |plot_ui| {
        navigate(plot_ui, home);
        let stroke = Stroke::new(1.0, colour.gamma_multiply(0.35));
        plot_ui.add(Drawing::new("grid".to_owned(), move |transform, shapes| {
            grid(transform, radius, stroke, shapes);
        }));
        for (name, [x, y], text) in labels(radius, view) {
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
    show_values(&response, view, &curves, |theta_deg, value| {
        place(radius, theta_deg, value)
    });
    let of_reading = |reading: &Reading| place(radius, reading.theta_deg, reading.value);
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

fn draw(
    transform: &PlotTransform,
    drawn: &DrawnCurve,
    view: &View,
    radius: Radius,
    shapes: &mut Vec<Shape>,
) {
    let (curve, colour) = (drawn.curve, drawn.colour);
    if let Some(mirror) = view.mirror_deg(curve.psi) {
        let ends = [[0.0, 0.0], position(mirror, radius.outermost())];
        items::dashed(transform, ends, colour, shapes);
    }
    let bands = curve.theory.iter().map(|theory| band(theory, radius));
    items::ribbon(transform, bands, colour, shapes);
    for reading in &curve.readings {
        items::error_bar(transform, error_bar(reading, radius), colour, shapes);
    }
    let at = |reading: &Reading| place(radius, reading.theta_deg, reading.value);
    items::used_and_left_out(transform, drawn, at, shapes);
    let theory = |theory: &Theory| place(radius, theory.theta_deg, theory.value);
    let points = curve.theory.iter().map(|of| {
        let at = theory(of);
        at.map_or((f64::NAN, f64::NAN), |[x, y]| (x, y))
    });
    let stroke = Stroke::new(1.8, colour);
    items::line(transform, Axis::Linear, points, stroke, shapes);
    items::ghosts(transform, drawn, theory, shapes);
}

/// The ends of the band at a point of the theory, without its negative part.
fn band(theory: &Theory, radius: Radius) -> Option<[[f64; 2]; 2]> {
    let sigma = theory.sigma?;
    ends(theory.theta_deg, theory.value, sigma, radius)
}

/// The ends of the error bar of a reading, without its negative part.
fn error_bar(reading: &Reading, radius: Radius) -> Option<[[f64; 2]; 2]> {
    let sigma = reading.sigma?;
    ends(reading.theta_deg, reading.value, sigma, radius)
}

fn ends(theta_deg: f64, value: f64, sigma: f64, radius: Radius) -> Option<[[f64; 2]; 2]> {
    let high = place(radius, theta_deg, value + sigma)?;
    let low = radius.of(value - sigma).unwrap_or(0.0);
    Some([position(theta_deg, low), high])
}

/// Half circles at round values, and rays at multiples of 30 deg.
fn grid(transform: &PlotTransform, radius: Radius, stroke: Stroke, shapes: &mut Vec<Shape>) {
    let mut line = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let points = points.map(|[x, y]| (x, y));
        items::line(transform, Axis::Linear, points, stroke, shapes);
    };
    for (value, _) in radius.circles() {
        let distance = radius.of(value).unwrap_or(0.0);
        let circle = (-90..=90).step_by(3);
        line(&mut circle.map(|deg| position(f64::from(deg), distance)));
    }
    for deg in (-90..=90).step_by(30) {
        let end = position(f64::from(deg), radius.outermost());
        line(&mut [[0.0, 0.0], end].into_iter());
    }
}

/// The labels of the grid and the name of the quantity: identifiers, positions and texts.
fn labels(radius: Radius, view: &View) -> Vec<(String, [f64; 2], String)> {
    let outermost = radius.outermost();
    let angles = (-90..=90).step_by(30).map(|deg: i32| {
        let at = position(f64::from(deg), 1.06 * outermost);
        (format!("angle {deg}"), at, format!("{deg}°"))
    });
    let radii = radius.circles().into_iter().enumerate();
    let radii = radii.map(|(i, (value, label))| {
        let at = [radius.of(value).unwrap_or(0.0), -0.04 * outermost];
        (format!("radius {i}"), at, label)
    });
    let name = view.quantity.axis_name().to_owned();
    let name = ("name".to_owned(), [0.0, -0.11 * outermost], name);
    angles.chain(radii).chain([name]).collect()
}
