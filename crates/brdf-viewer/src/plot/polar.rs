//! The polar form of the paper's figures: f_r as radius at the view angle.

use brdf_fit::plot::{Reading, Scale, value_range};
use egui::{Align2, Color32, Shape, Stroke, Ui};
use egui_plot::{Plot, PlotPoint, PlotTransform, Text};

use super::Drawn;
use super::axis::{self, Axis};
use super::cartesian::describe;
use super::hover::{Plots, read_out};
use super::items::{self, Drawing};

/// Where a value stands at a view angle: the normal is upwards, positive angles are at the right.
fn place(theta_deg: f64, value: f64) -> [f64; 2] {
    let theta = theta_deg.to_radians();
    [value * theta.sin(), value * theta.cos()]
}

/// Draws the polar form.
pub fn show(ui: &mut Ui, plots: &Plots) {
    let drawn: Vec<&Drawn> = plots.drawn.iter().collect();
    let curves = drawn.iter().map(|one| one.curve);
    let largest = value_range(curves, Scale::Linear).map_or(1.0, |(_, high)| high);
    let radius = axis::round_number_above(if largest > 0.0 { largest } else { 1.0 });
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
    for [x, y] in [[-1.12, -0.08], [1.12, 1.12]] {
        plot = plot.include_x(x * radius).include_y(y * radius);
    }
    let ink = ui.visuals().weak_text_color();
    let response =
        super::cartesian::reset_on_demand(ui, plots.state, "polar", plot).show(ui, |plot_ui| {
            let faint = Stroke::new(1.0, ink.gamma_multiply(0.35));
            plot_ui.add(Drawing::new("grid".to_owned(), move |transform, shapes| {
                grid(transform, radius, faint, shapes);
            }));
            for (name, position, text) in labels(radius) {
                let position = PlotPoint::new(position[0], position[1]);
                plot_ui.text(
                    Text::new(name, position, text)
                        .color(ink)
                        .anchor(Align2::CENTER_CENTER),
                );
            }
            for (i, one) in drawn.iter().enumerate() {
                let colour = one.colour;
                plot_ui.add(Drawing::new(
                    format!("curve {i}"),
                    move |transform, shapes| {
                        draw(transform, one, colour, plots, radius, shapes);
                    },
                ));
            }
        });
    read_out(&response, &drawn, |reading: &Reading| {
        Some(place(reading.theta_deg, reading.value))
    });
    describe(&response, "BRDF plot", &drawn);
}

fn draw(
    transform: &PlotTransform,
    one: &Drawn,
    colour: Color32,
    plots: &Plots,
    radius: f64,
    shapes: &mut Vec<Shape>,
) {
    let at = |point: [f64; 2]| transform.position_from_point(&PlotPoint::new(point[0], point[1]));
    if let Some(mirror) = plots.state.view.mirror_deg(one.curve.psi) {
        let ends = [[0.0, 0.0], place(mirror, radius)];
        items::dashed(transform, ends, colour, shapes);
    }
    for reading in &one.curve.readings {
        let position = at(place(reading.theta_deg, reading.value));
        shapes.push(items::mark_at(one.mark, position, 2.6, colour));
    }
    // A point of the line is at an angle of its own, so that it is placed before it is drawn.
    let points = one.curve.theory.iter().map(|theory| {
        let [x, y] = place(theory.theta_deg, theory.value);
        (x, y)
    });
    items::line(
        transform,
        Axis::Linear,
        points,
        Stroke::new(1.8, colour),
        shapes,
    );
}

/// Half circles at round values, and rays every 30 deg.
fn grid(transform: &PlotTransform, radius: f64, stroke: Stroke, shapes: &mut Vec<Shape>) {
    let mut line = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let points = points.map(|[x, y]| (x, y));
        items::line(transform, Axis::Linear, points, stroke, shapes);
    };
    for step in 1..=4 {
        let circle = (-90..=90).step_by(3);
        line(&mut circle.map(|deg| place(f64::from(deg), radius * f64::from(step) / 4.0)));
    }
    for deg in (-90..=90).step_by(30) {
        line(&mut [[0.0, 0.0], place(f64::from(deg), radius)].into_iter());
    }
}

/// Names, places and words of the numbers at the grid.
fn labels(radius: f64) -> Vec<(String, [f64; 2], String)> {
    let angles = (-90..=90).step_by(30).map(|deg: i32| {
        let at = place(f64::from(deg), 1.06 * radius);
        (format!("angle {deg}"), at, format!("{deg}°"))
    });
    let radii = [0.5, 1.0].map(|part| {
        let text = format!("{} 1/sr", part * radius);
        (
            format!("radius {part}"),
            [part * radius, -0.04 * radius],
            text,
        )
    });
    angles.chain(radii).collect()
}
