//! Plots of the fit: E against iteration, the profile of E over k1, the hemispherical reflectance.

use brdf_fit::Phase;
use brdf_fit::ProfilePoint;
use brdf_fit::format::digits;
use egui::{Color32, Rangef, Role, Ui};
use egui_plot::{AxisHints, HLine, HoverPosition, Legend, Line, Plot, PlotPoints, Points, VLine};

use crate::plot::axis::Axis;
use crate::state::State;
use crate::state::convergence::ConvergencePoint;
use crate::state::sample::{Sample, Scan};
use crate::theme;
use crate::widgets::named;

/// A plot with named axes.
pub(super) fn result_plot<'a>(
    name: &str,
    [x, y]: [Axis; 2],
    [x_name, y_name]: [&str; 2],
) -> Plot<'a> {
    let x_hints = AxisHints::new_x()
        .label(x_name)
        .label_spacing(LABEL_SPACING)
        .formatter(move |mark, range| x.label(mark, range));
    let y_hints = AxisHints::new_y()
        .label(y_name)
        .min_thickness(60.0)
        .formatter(move |mark, range| y.label(mark, range));
    let (x_text, y_text) = (x_name.to_owned(), y_name.to_owned());
    Plot::new(name.to_owned())
        .x_grid_spacer(move |input| x.horizontal_grid(&input))
        .y_grid_spacer(move |input| y.vertical_grid(&input))
        .custom_x_axes(vec![x_hints])
        .custom_y_axes(vec![y_hints])
        .label_formatter(move |position| match position {
            HoverPosition::NearDataPoint {
                plot_name,
                position,
                ..
            } => {
                let (at_x, at_y) = (digits(x.value(position.x)), digits(y.value(position.y)));
                Some(format!("{plot_name}\n{x_text} {at_x}\n{y_text} {at_y}"))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
        .show_crosshair(false)
        .allow_scroll(false)
}

/// Distances between grid lines along a horizontal axis, in points: below the first, lines have no
/// label, from the second on the label is opaque.
const LABEL_SPACING: Rangef = Rangef {
    min: 31.0,
    max: 36.0,
};

/// A line of one of the result plots.
pub(super) fn line<'a>(name: &str, points: Vec<[f64; 2]>, colour: Color32) -> Line<'a> {
    Line::new(name.to_owned(), PlotPoints::from(points))
        .color(colour)
        .width(1.8)
}

/// The iterations of the current scan: of the running fit, or else of the last one.
pub(super) fn convergence<'a>(state: &'a State, sample: &'a Sample) -> &'a [ConvergencePoint] {
    let running = state.fit_run.as_ref().filter(|run| run.is_running());
    match running.filter(|run| run.scan == sample.scan_id()) {
        Some(run) => &run.points,
        None => &sample.scan().convergence,
    }
}

pub(super) fn show_convergence(ui: &mut Ui, convergence: &[ConvergencePoint]) {
    if convergence.is_empty() {
        ui.label("This wavelength has not been fitted yet.");
        return;
    }
    let ground = theme::ground(ui.ctx());
    let axes = [Axis::Linear, Axis::Logarithmic];
    let plot = result_plot("convergence", axes, ["iteration", "E, %"])
        .x_grid_spacer(|input| Axis::integer_grid(&input))
        .legend(Legend::default());
    let position =
        |p: &ConvergencePoint| Some([p.iteration as f64, Axis::Logarithmic.position(p.e_percent)?]);
    let response = plot.show(ui, |plot_ui| {
        for (i, phase) in [Phase::Stage1, Phase::Stage2].into_iter().enumerate() {
            let of_phase = convergence.iter().filter(|point| point.phase == phase);
            let points: Vec<[f64; 2]> = of_phase.filter_map(position).collect();
            let colour = theme::series_colour(i, ground);
            let name = phase.to_string();
            let marks = Points::new(name.clone(), PlotPoints::from(points.clone()));
            plot_ui.line(Line::new(name, PlotPoints::from(points)).color(colour));
            plot_ui.points(marks.radius(2.5).color(colour));
        }
    });
    named(
        response.response,
        Role::Image,
        "plot of E against iteration",
    );
}

pub(super) fn show_profile(ui: &mut Ui, scan: &Scan) {
    let fit = scan.last_fit.as_ref();
    let fit = fit.and_then(|report| report.fit.as_ref());
    let profile = fit.and_then(|fit| Some(&fit.global_check.as_ref()?.profile));
    let Some(profile) = profile.filter(|profile| profile.len() > 1) else {
        ui.label("No profile: the scan is not fitted, k1 is fixed, or the model has no k1.");
        return;
    };
    let log = |x: f64| Axis::Logarithmic.position(x);
    let point = |p: &ProfilePoint| Some([log(p.parameters.k1)?, log(100.0 * p.error)?]);
    let points: Vec<[f64; 2]> = profile.iter().filter_map(point).collect();
    let colour = theme::series_colour(0, theme::ground(ui.ctx()));
    let plot = result_plot("profile", [Axis::Logarithmic; 2], ["k1", "lowest E, %"]);
    let current = log(scan.parameters.values.k1);
    let weak = ui.visuals().weak_text_color();
    let response = plot.show(ui, |plot_ui| {
        plot_ui.line(line("profile", points, colour));
        if let Some(k1) = current {
            plot_ui.vline(VLine::new("k1", k1).color(weak));
        }
    });
    named(response.response, Role::Image, "plot of the profile of k1");
}

pub(super) fn show_reflectance(ui: &mut Ui, reflectance: &[[f64; 2]]) {
    let colour = theme::series_colour(0, theme::ground(ui.ctx()));
    let limit = Color32::from_rgb(0xd5, 0x5e, 0x00);
    let names = ["incidence ψ, deg", "reflectance ρ"];
    let plot = result_plot("reflectance", [Axis::Linear; 2], names)
        .include_x(0.0)
        .include_x(90.0)
        .include_y(0.0);
    let exceeds_one = reflectance.iter().any(|[_, rho]| *rho > 1.0);
    let response = plot.show(ui, |plot_ui| {
        plot_ui.line(line("rho", reflectance.to_vec(), colour));
        if exceeds_one {
            plot_ui.hline(HLine::new("1", 1.0).color(limit));
        }
    });
    named(
        response.response,
        Role::Image,
        "plot of the hemispherical reflectance",
    );
}
