//! What the pointer is at: a reading is read out with the theory beside it, a line of the theory by
//! itself.

use std::f64::consts::PI;

use brdf_fit::format::digits;
use brdf_fit::plot::{Curve, Layout, Reading, Scale, Theory, View, value_range};
use egui::{PopupAnchor, Pos2, Stroke, Tooltip};
use egui_plot::{PlotResponse, PlotTransform};

use super::Drawn;
use crate::axis::Axis;
use crate::state::State;
use crate::widgets::degrees;

/// A reading or a point of the theory is meant when the pointer is within this of it, in points.
const NEAR: f32 = 14.0;

/// What all plots of a frame share.
pub struct Plots<'a> {
    /// What is loaded and chosen.
    pub state: &'a State,
    /// The curves.
    pub drawn: &'a [Drawn<'a>],
    /// The axis of the BRDF.
    pub axis: Axis,
    /// The ends of that axis, the same for all panels.
    pub range: (f64, f64),
    /// How far up and down the axis of the residuals goes.
    pub reach: f64,
}

impl<'a> Plots<'a> {
    /// The plots of a frame.
    pub fn new(state: &'a State, drawn: &'a [Drawn<'a>]) -> Self {
        let curves = drawn.iter().map(|drawn| drawn.curve);
        let scale = match state.view.layout {
            Layout::Polar => Scale::Linear,
            _ => state.view.scale,
        };
        Self {
            state,
            drawn,
            axis: scale.into(),
            range: value_range(curves, scale).unwrap_or((0.001, 1.0)),
            reach: reach(drawn),
        }
    }
}

/// A little more than the largest residual.
fn reach(drawn: &[Drawn]) -> f64 {
    let readings = drawn.iter().flat_map(|drawn| &drawn.curve.readings);
    let largest = readings.map(|reading| reading.residual().abs());
    match 1.1 * largest.fold(0.0, f64::max) {
        0.0 => 1.0,
        reach => reach,
    }
}

/// What the pointer is at, and where it stands.
enum Found<'a> {
    Reading(Pos2, &'a Drawn<'a>, &'a Reading),
    Theory(Pos2, &'a Drawn<'a>, &'a Theory),
}

/// Rings the reading nearest to the pointer, or where none is near the theory, and reads it out.
/// `place` says where a value at a view angle in degrees stands.
pub fn read_out(
    response: &PlotResponse<()>,
    plots: &Plots,
    drawn: &[&Drawn],
    place: impl Fn(f64, f64) -> Option<[f64; 2]>,
) {
    let reading = |reading: &Reading| place(reading.theta_deg, reading.value);
    let theory = |theory: &Theory| place(theory.theta_deg, theory.value);
    read_out_as(response, plots, drawn, reading, theory);
}

/// The same for the residuals, where there is no theory to be seen.
pub fn read_out_residuals(response: &PlotResponse<()>, plots: &Plots, drawn: &[&Drawn]) {
    let reading = |reading: &Reading| Some([reading.theta_deg, reading.residual()]);
    read_out_as(response, plots, drawn, reading, |_| None);
}

fn read_out_as(
    response: &PlotResponse<()>,
    plots: &Plots,
    drawn: &[&Drawn],
    of_reading: impl Fn(&Reading) -> Option<[f64; 2]>,
    of_theory: impl Fn(&Theory) -> Option<[f64; 2]>,
) {
    let Some(pointer) = response.response.hover_pos() else {
        return;
    };
    let transform = &response.transform;
    let readings = all(drawn, |curve| &curve.readings);
    let theory = all(drawn, |curve| &curve.theory);
    let reading = nearest(transform, readings, of_reading, pointer)
        .map(|(at, one, reading)| Found::Reading(at, one, reading));
    let found = reading.or_else(|| {
        let (at, one, theory) = nearest(transform, theory, of_theory, pointer)?;
        Some(Found::Theory(at, one, theory))
    });
    if let Some(found) = found {
        show(response, &plots.state.view, &found);
    }
}

/// Every point of the curves, with its curve.
fn all<'a, T: 'a>(
    drawn: &'a [&'a Drawn<'a>],
    points: impl Fn(&'a Curve) -> &'a Vec<T>,
) -> impl Iterator<Item = (&'a Drawn<'a>, &'a T)> {
    let drawn = drawn.iter();
    drawn.flat_map(move |one| points(one.curve).iter().map(move |point| (*one, point)))
}

fn nearest<'a, T>(
    transform: &PlotTransform,
    points: impl Iterator<Item = (&'a Drawn<'a>, &'a T)>,
    place: impl Fn(&T) -> Option<[f64; 2]>,
    pointer: Pos2,
) -> Option<(Pos2, &'a Drawn<'a>, &'a T)> {
    let at = |[x, y]: [f64; 2]| {
        egui::pos2(
            transform.position_from_point_x(x),
            transform.position_from_point_y(y),
        )
    };
    points
        .filter_map(|(one, point)| Some((at(place(point)?), one, point)))
        .filter(|(at, ..)| at.distance_sq(pointer) < NEAR * NEAR)
        .min_by(|a, b| {
            let distance = |at: Pos2| at.distance_sq(pointer);
            distance(a.0).total_cmp(&distance(b.0))
        })
}

fn show(response: &PlotResponse<()>, view: &View, found: &Found) {
    let (at, words) = match found {
        Found::Reading(at, one, reading) => (*at, reading_in_words(view, one, reading)),
        Found::Theory(at, one, theory) => (*at, theory_in_words(view, one, theory)),
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
    tooltip.gap(14.0).show(|ui| ui.label(words));
}

/// The sample and the directions.
fn geometry_in_words(view: &View, drawn: &Drawn, theta_deg: f64) -> String {
    let phi = if view.azimuth == 0.0 {
        String::new()
    } else {
        let other_half = view.theta(theta_deg) < 0.0;
        let half = if other_half { PI } else { 0.0 };
        format!(", phi {}", degrees(view.azimuth + half))
    };
    let psi = degrees(drawn.curve.psi);
    format!("{}\npsi {psi}, theta {theta_deg:.2}°{phi}", drawn.sample)
}

fn more_or_less(sigma: Option<f64>) -> String {
    sigma.map_or_else(String::new, |sigma| format!(" ± {}", digits(sigma)))
}

fn reading_in_words(view: &View, drawn: &Drawn, reading: &Reading) -> String {
    format!(
        "{}\nmeasured {}{}\ntheory {}\ndifference {}",
        geometry_in_words(view, drawn, reading.theta_deg),
        digits(reading.value),
        more_or_less(reading.sigma),
        digits(reading.theory),
        digits(reading.residual()),
    )
}

fn theory_in_words(view: &View, drawn: &Drawn, theory: &Theory) -> String {
    format!(
        "{}\ntheory {}{}",
        geometry_in_words(view, drawn, theory.theta_deg),
        digits(theory.value),
        more_or_less(theory.sigma),
    )
}
