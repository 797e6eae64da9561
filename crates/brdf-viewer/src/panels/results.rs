//! The results below: the tables of the command line, and what can be plotted of a fit.

use brdf_fit::fit::grid_search::ProfilePoint;
use brdf_fit::progress::Phase;
use egui::{Color32, Panel, Rangef, RichText, Role, ScrollArea, Ui};
use egui_plot::{AxisHints, Legend, Line, Plot, PlotPoints, Points, VLine};

use crate::axis::Axis;
use crate::intent::Intent;
use crate::state::State;
use crate::state::fitting::Point;
use crate::state::interface::ResultTab;
use crate::state::sample::{Sample, Scan};
use crate::theme;
use crate::widgets::named;

/// Draws the results.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let height = ui.available_height();
    let most = (height * 0.6).max(120.0);
    let panel = Panel::bottom("results")
        .resizable(true)
        .default_size((0.25 * height).clamp(110.0, 240.0));
    panel.size_range(90.0..=most).show(ui, |ui| {
        // The height is the user's, not that of the words in it.
        ui.take_available_height();
        ui.horizontal(|ui| {
            for tab in ResultTab::ALL {
                let on = state.interface.tab == tab;
                if ui.selectable_label(on, tab.name()).clicked() {
                    intents.push(Intent::Tab(tab));
                }
            }
        });
        let Some(sample) = state.active_sample() else {
            ui.label("No sample is open.");
            return;
        };
        match state.interface.tab {
            ResultTab::Tables => show_tables(ui, sample),
            ResultTab::Convergence => show_convergence(ui, state, sample),
            ResultTab::Profile => show_profile(ui, sample.scan()),
            ResultTab::Reflectance => show_reflectance(ui, state, sample),
        }
    });
}

fn show_tables(ui: &mut Ui, sample: &Sample) {
    let scan = sample.scan();
    let warning = ui.visuals().warn_fg_color;
    if let Some(failure) = &scan.failure {
        ui.colored_label(warning, format!("The last fit failed: {failure}"));
    }
    let Some(report) = &scan.fitted else {
        ui.label("Not fitted yet.");
        return;
    };
    if scan.failure.is_some() {
        ui.colored_label(warning, "These tables are of the fit before it.");
    }
    if scan.fit_shown().is_none() {
        ui.colored_label(warning, "The parameters were turned since this fit.");
    }
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        for section in report.sections() {
            if !section.title.is_empty() {
                ui.strong(section.title);
            }
            let text = RichText::new(section.text.trim_matches('\n')).monospace();
            ui.add(egui::Label::new(text).extend());
            ui.add_space(4.0);
        }
    });
}

/// A plot of the results, with logarithmic axes where they are asked for, and their names.
fn result_plot<'a>(name: &str, [x, y]: [Axis; 2], [x_name, y_name]: [&str; 2]) -> Plot<'a> {
    let x_hints = AxisHints::new_x()
        .label(x_name)
        .label_spacing(NUMBERS_APART)
        .formatter(move |mark, range| x.label(mark, range));
    let y_hints = AxisHints::new_y()
        .label(y_name)
        .min_thickness(60.0)
        .formatter(move |mark, range| y.label(mark, range));
    Plot::new(name.to_owned())
        .x_grid_spacer(move |input| x.grid_along(&input))
        .y_grid_spacer(move |input| y.grid(&input))
        .custom_x_axes(vec![x_hints])
        .custom_y_axes(vec![y_hints])
        .label_formatter(|_| None)
        .show_crosshair(false)
}

/// Numbers along an axis are at least so far apart, in points, and clear from the second on: lines of
/// the grid between them have none.
const NUMBERS_APART: Rangef = Rangef {
    min: 31.0,
    max: 36.0,
};

/// The iterations of the fit that runs, or of the last one, of the scan that is shown.
fn steps<'a>(state: &'a State, sample: &'a Sample) -> &'a [Point] {
    let runs = state.run.as_ref().filter(|run| run.is_running());
    match runs.filter(|run| run.scan == sample.scan_id()) {
        Some(run) => &run.points,
        None => &sample.scan().steps,
    }
}

fn show_convergence(ui: &mut Ui, state: &State, sample: &Sample) {
    let steps = steps(state, sample);
    if steps.is_empty() {
        ui.label("No stage of this wavelength has been fitted yet.");
        return;
    }
    let ground = theme::ground(ui.ctx());
    let axes = [Axis::Linear, Axis::Logarithmic];
    let plot = result_plot("convergence", axes, ["iteration", "E / %"]).legend(Legend::default());
    let response = plot.show(ui, |plot_ui| {
        for (i, phase) in [Phase::Stage1, Phase::Stage2].into_iter().enumerate() {
            let of_phase = steps.iter().filter(|point| point.phase == phase);
            let points: Vec<[f64; 2]> = of_phase
                .filter_map(|p| Some([p.iteration as f64, Axis::Logarithmic.place(p.e_percent)?]))
                .collect();
            let colour = theme::plain(i, ground);
            let name = phase.to_string();
            plot_ui.line(Line::new(name.clone(), PlotPoints::from(points.clone())).color(colour));
            plot_ui.points(
                Points::new(name, PlotPoints::from(points))
                    .radius(2.5)
                    .color(colour),
            );
        }
    });
    named(
        response.response,
        Role::Image,
        "plot of E against iteration",
    );
}

fn show_profile(ui: &mut Ui, scan: &Scan) {
    let fit = scan.fitted.as_ref().and_then(|report| report.fit.as_ref());
    let profile = fit.and_then(|fit| Some(&fit.global_check.as_ref()?.profile));
    let Some(profile) = profile.filter(|profile| profile.len() > 1) else {
        ui.label("There is no profile: not fitted yet, or a model without k1, or k1 held.");
        return;
    };
    let log = |x: f64| Axis::Logarithmic.place(x);
    let point = |p: &ProfilePoint| Some([log(p.parameters.k1)?, log(100.0 * p.error)?]);
    let points: Vec<[f64; 2]> = profile.iter().filter_map(point).collect();
    let colour = theme::plain(0, theme::ground(ui.ctx()));
    let plot = result_plot("profile", [Axis::Logarithmic; 2], ["k1", "lowest E / %"]);
    let here = log(scan.knobs.at.k1);
    let weak = ui.visuals().weak_text_color();
    let response = plot.show(ui, |plot_ui| {
        plot_ui.line(
            Line::new("profile", PlotPoints::from(points))
                .color(colour)
                .width(1.8),
        );
        if let Some(k1) = here {
            plot_ui.vline(VLine::new("k1", k1).color(weak));
        }
    });
    named(response.response, Role::Image, "plot of the profile of k1");
}

fn show_reflectance(ui: &mut Ui, state: &State, sample: &Sample) {
    let points = state.shown.reflectance(sample.scan_id()).to_vec();
    let colour = theme::plain(0, theme::ground(ui.ctx()));
    let limit = Color32::from_rgb(0xd5, 0x5e, 0x00);
    let names = ["incidence psi / deg", "rho"];
    let plot = result_plot("reflectance", [Axis::Linear; 2], names)
        .include_x(0.0)
        .include_x(90.0)
        .include_y(0.0);
    let above_one = points.iter().any(|[_, rho]| *rho > 1.0);
    let response = plot.show(ui, |plot_ui| {
        plot_ui.line(
            Line::new("rho", PlotPoints::from(points))
                .color(colour)
                .width(1.8),
        );
        if above_one {
            plot_ui.hline(egui_plot::HLine::new("1", 1.0).color(limit));
        }
    });
    named(
        response.response,
        Role::Image,
        "plot of the hemispherical reflectance",
    );
}
