//! The tooltip at the pointer: the nearest reading with the theory at its angle, or else the nearest
//! point of the theory.

use std::f64::consts::PI;

use brdf_fit::format::digits;
use brdf_fit::plot::{Curve, Reading, Theory, View};
use egui::{PopupAnchor, Pos2, Stroke, Tooltip};
use egui_plot::{PlotResponse, PlotTransform};

use super::context::DrawnCurve;
use crate::widgets::degrees;

/// The largest distance from the pointer to a reading or to the theory, in points.
const MOST_DISTANCE: f32 = 14.0;

/// A point of a curve near the pointer, with its position on the screen.
enum Target<'a> {
    Reading(Pos2, &'a DrawnCurve<'a>, &'a Reading),
    Theory(Pos2, &'a DrawnCurve<'a>, &'a Theory),
}

/// Shows the tooltip in a plot of values. `position` is the position in the plot of a value at a
/// view angle in degrees.
pub(super) fn show_values(
    response: &PlotResponse<()>,
    view: &View,
    curves: &[&DrawnCurve],
    position: impl Fn(f64, f64) -> Option<[f64; 2]>,
) {
    let reading = |reading: &Reading| position(reading.theta_deg, reading.value);
    let theory = |theory: &Theory| position(theory.theta_deg, theory.value);
    show(response, view, curves, reading, theory);
}

/// Shows the tooltip in a plot of residuals, which has no theory. `position` is that of a reading.
pub(super) fn show_residuals(
    response: &PlotResponse<()>,
    view: &View,
    curves: &[&DrawnCurve],
    position: impl Fn(&Reading) -> Option<[f64; 2]>,
) {
    show(response, view, curves, position, |_| None);
}

/// The reading nearest to a place on the screen, with its position and its curve.
pub(super) fn nearest_reading<'a>(
    transform: &PlotTransform,
    curves: &'a [&'a DrawnCurve<'a>],
    position: impl Fn(&Reading) -> Option<[f64; 2]>,
    pointer: Pos2,
) -> Option<(Pos2, &'a DrawnCurve<'a>, &'a Reading)> {
    let readings = points_of(curves, |curve| &curve.readings);
    nearest(transform, readings, position, pointer)
}

/// The position on the screen of a point of the plot.
pub(super) fn on_screen(transform: &PlotTransform, [x, y]: [f64; 2]) -> Pos2 {
    egui::pos2(
        transform.position_from_point_x(x),
        transform.position_from_point_y(y),
    )
}

fn show(
    response: &PlotResponse<()>,
    view: &View,
    curves: &[&DrawnCurve],
    reading_position: impl Fn(&Reading) -> Option<[f64; 2]>,
    theory_position: impl Fn(&Theory) -> Option<[f64; 2]>,
) {
    let Some(pointer) = response.response.hover_pos() else {
        return;
    };
    let transform = &response.transform;
    let theory = points_of(curves, |curve| &curve.theory);
    let reading = nearest_reading(transform, curves, reading_position, pointer)
        .map(|(at, drawn, reading)| Target::Reading(at, drawn, reading));
    let target = reading.or_else(|| {
        let (at, drawn, theory) = nearest(transform, theory, theory_position, pointer)?;
        Some(Target::Theory(at, drawn, theory))
    });
    if let Some(target) = target {
        show_target(response, view, &target);
    }
}

/// All points of the curves, each with its curve.
fn points_of<'a, T: 'a>(
    curves: &'a [&'a DrawnCurve<'a>],
    points: impl Fn(&'a Curve) -> &'a Vec<T>,
) -> impl Iterator<Item = (&'a DrawnCurve<'a>, &'a T)> {
    let curves = curves.iter();
    curves.flat_map(move |drawn| points(drawn.curve).iter().map(move |point| (*drawn, point)))
}

fn nearest<'a, T>(
    transform: &PlotTransform,
    points: impl Iterator<Item = (&'a DrawnCurve<'a>, &'a T)>,
    position: impl Fn(&T) -> Option<[f64; 2]>,
    pointer: Pos2,
) -> Option<(Pos2, &'a DrawnCurve<'a>, &'a T)> {
    points
        .filter_map(|(drawn, point)| Some((on_screen(transform, position(point)?), drawn, point)))
        .filter(|(at, ..)| at.distance_sq(pointer) < MOST_DISTANCE * MOST_DISTANCE)
        .min_by(|a, b| {
            let distance = |at: Pos2| at.distance_sq(pointer);
            distance(a.0).total_cmp(&distance(b.0))
        })
}

/// Draws a ring around the target, and shows the tooltip.
fn show_target(response: &PlotResponse<()>, view: &View, target: &Target) {
    let (at, text) = match target {
        Target::Reading(at, drawn, reading) => (*at, reading_text(view, drawn, reading)),
        Target::Theory(at, drawn, theory) => (*at, theory_text(view, drawn, theory)),
    };
    let ctx = &response.response.ctx;
    let ring = Stroke::new(1.5, ctx.global_style().visuals.strong_text_color());
    let painter = ctx.layer_painter(response.response.layer_id);
    painter
        .with_clip_rect(*response.transform.frame())
        .circle_stroke(at, 6.0, ring);
    let tooltip = Tooltip::always_open(
        ctx.clone(),
        response.response.layer_id,
        response.response.id,
        PopupAnchor::Pointer,
    );
    tooltip.gap(14.0).show(|ui| ui.label(text));
}

/// The sample and the directions.
fn geometry_text(view: &View, drawn: &DrawnCurve, theta_deg: f64) -> String {
    let phi = if view.azimuth == 0.0 {
        String::new()
    } else {
        let is_opposite = view.theta(theta_deg) < 0.0;
        let half_plane = if is_opposite { PI } else { 0.0 };
        format!(", φ {}", degrees(view.azimuth + half_plane))
    };
    let psi = degrees(drawn.curve.psi);
    format!("{}\nψ {psi}, θ {theta_deg:.2}°{phi}", drawn.sample)
}

fn plus_minus(sigma: Option<f64>) -> String {
    sigma.map_or_else(String::new, |sigma| format!(" ± {}", digits(sigma)))
}

fn reading_text(view: &View, drawn: &DrawnCurve, reading: &Reading) -> String {
    let left_out = if drawn.left_out.contains(&reading.index) {
        "\nleft out of the fit"
    } else {
        ""
    };
    format!(
        "{}\nmeasured {}{}\ntheory {}\ndifference {}{left_out}",
        geometry_text(view, drawn, reading.theta_deg),
        digits(reading.value),
        plus_minus(reading.sigma),
        digits(reading.theory),
        digits(reading.residual()),
    )
}

fn theory_text(view: &View, drawn: &DrawnCurve, theory: &Theory) -> String {
    format!(
        "{}\ntheory {}{}",
        geometry_text(view, drawn, theory.theta_deg),
        digits(theory.value),
        plus_minus(theory.sigma),
    )
}
