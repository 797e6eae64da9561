//! The polar form of the paper's figures: f_r as radius at the view angle.

use brdf_fit::plot::{Reading, Theory, View};
use egui::{Align2, Shape, Stroke, Ui};
use egui_plot::{Plot, PlotPoint, PlotTransform, Text};

use super::Drawn;
use super::cartesian::describe;
use super::hover::{Plots, read_out};
use super::items::{self, Drawing};
use crate::axis::{self, Axis};

/// Where a value stands at a view angle: the normal is upwards, positive angles are at the right.
fn place(theta_deg: f64, value: f64) -> [f64; 2] {
    let theta = theta_deg.to_radians();
    [value * theta.sin(), value * theta.cos()]
}

/// The radius of the outermost circle, and the step from circle to circle.
fn circles(largest: f64) -> (f64, f64) {
    let step = axis::round_number_above(if largest > 0.0 { largest } else { 1.0 } / MOST_CIRCLES);
    ((largest / step).ceil().max(1.0) * step, step)
}

/// So many circles at the most; three at least, but for the smallest of numbers.
const MOST_CIRCLES: f64 = 5.0;

/// Draws the polar form.
pub fn show(ui: &mut Ui, plots: &Plots) {
    let drawn: Vec<&Drawn> = plots.drawn.iter().collect();
    let (radius, step) = circles(plots.range.1);
    let size = ui.available_size();
    let mut plot = Plot::new("polar")
        .id(super::id(plots.state, "polar"))
        .width(size.x)
        .height(size.y)
        .data_aspect(1.0)
        .show_axes(false)
        .show_grid(false)
        .show_crosshair(false)
        .label_formatter(|_| None);
    for [x, y] in [[-1.12, -0.16], [1.12, 1.12]] {
        plot = plot.include_x(x * radius).include_y(y * radius);
    }
    let ink = ui.visuals().weak_text_color();
    let response =
        super::cartesian::reset_on_demand(ui, plots.state, "polar", plot).show(ui, |plot_ui| {
            let faint = Stroke::new(1.0, ink.gamma_multiply(0.35));
            plot_ui.add(Drawing::new("grid".to_owned(), move |transform, shapes| {
                grid(transform, radius, step, faint, shapes);
            }));
            for (name, position, text) in labels(radius, step, &plots.state.view) {
                let position = PlotPoint::new(position[0], position[1]);
                plot_ui.text(
                    Text::new(name, position, text)
                        .color(ink)
                        .anchor(Align2::CENTER_CENTER),
                );
            }
            for (i, one) in drawn.iter().enumerate() {
                plot_ui.add(Drawing::new(
                    format!("curve {i}"),
                    move |transform, shapes| draw(transform, one, plots, radius, shapes),
                ));
            }
        });
    read_out(&response, plots, &drawn, at_radius);
    describe(&response, "BRDF plot", &drawn);
}

/// Where a value stands at a view angle; a negative one has no radius.
fn at_radius(theta_deg: f64, value: f64) -> Option<[f64; 2]> {
    (value >= 0.0).then(|| place(theta_deg, value))
}

fn draw(
    transform: &PlotTransform,
    one: &Drawn,
    plots: &Plots,
    radius: f64,
    shapes: &mut Vec<Shape>,
) {
    let colour = one.colour;
    if let Some(mirror) = plots.state.view.mirror_deg(one.curve.psi) {
        let ends = [[0.0, 0.0], place(mirror, radius)];
        items::dashed(transform, ends, colour, shapes);
    }
    items::ribbon(transform, one.curve.theory.iter().map(band), colour, shapes);
    for reading in &one.curve.readings {
        items::error_bar(transform, error_bar(reading), colour, shapes);
    }
    let at = |reading: &Reading| at_radius(reading.theta_deg, reading.value);
    let points: Vec<[f64; 2]> = one.curve.readings.iter().filter_map(at).collect();
    items::marks(transform, &points, one.look(), shapes);
    // A point of the line is at an angle of its own, so that it is placed before it is drawn.
    let points = one.curve.theory.iter().map(|theory| {
        let [x, y] = place(theory.theta_deg, theory.value);
        (x, y)
    });
    let stroke = Stroke::new(1.8, colour);
    items::line(transform, Axis::Linear, points, stroke, shapes);
}

/// The ends of the band at a point of the theory.
fn band(theory: &Theory) -> Option<[[f64; 2]; 2]> {
    let sigma = theory.sigma?;
    let ends = [theory.value - sigma, theory.value + sigma];
    Some(ends.map(|value| place(theory.theta_deg, value.max(0.0))))
}

/// The ends of the error bar of a reading, as far as they have a radius.
fn error_bar(reading: &Reading) -> Option<[[f64; 2]; 2]> {
    let sigma = reading.sigma?;
    let high = at_radius(reading.theta_deg, reading.value + sigma)?;
    let low = place(reading.theta_deg, (reading.value - sigma).max(0.0));
    Some([low, high])
}

/// Half circles at round values, and rays every 30 deg.
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
        line(&mut circle.map(|deg| place(f64::from(deg), value)));
    }
    for deg in (-90..=90).step_by(30) {
        line(&mut [[0.0, 0.0], place(f64::from(deg), radius)].into_iter());
    }
}

/// The values of the circles.
fn values(radius: f64, step: f64) -> impl Iterator<Item = f64> {
    let count = (radius / step).round() as u32;
    (1..=count).map(move |i| f64::from(i) * step)
}

/// Names, places and words of the numbers at the grid, and what they are.
fn labels(radius: f64, step: f64, view: &View) -> Vec<(String, [f64; 2], String)> {
    let angles = (-90..=90).step_by(30).map(|deg: i32| {
        let at = place(f64::from(deg), 1.06 * radius);
        (format!("angle {deg}"), at, format!("{deg}°"))
    });
    let radii = values(radius, step).enumerate().map(|(i, value)| {
        let at = [value, -0.04 * radius];
        (format!("radius {i}"), at, axis::number(value, step))
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
