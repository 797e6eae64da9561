//! The results below: the tables of the command line, and what can be plotted of a fit.

use brdf_fit::profile::ProfilePoint;
use brdf_fit::watch::Phase;
use egui::{Color32, Panel, RichText, ScrollArea, Ui};
use egui_plot::{Legend, Line, Plot, PlotPoints, Points, VLine};

use super::theme;
use crate::intent::Intent;
use crate::plot::axis::Axis;
use crate::state::State;
use crate::state::interface::ResultTab;
use crate::state::sample::{Sample, Scan};

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
            ResultTab::Convergence => show_convergence(ui, state),
            ResultTab::Profile => show_profile(ui, sample.scan()),
            ResultTab::Reflectance => show_reflectance(ui, state, sample),
        }
    });
}

fn show_tables(ui: &mut Ui, sample: &Sample) {
    let scan = sample.scan();
    let Some(report) = &scan.fitted else {
        ui.label("Not fitted yet.");
        return;
    };
    if scan.fit_shown().is_none() {
        ui.colored_label(
            ui.visuals().warn_fg_color,
            "The parameters were turned since this fit.",
        );
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

/// A plot of the results, with logarithmic axes where they are asked for.
fn result_plot<'a>(name: &str, x: Axis, y: Axis) -> Plot<'a> {
    Plot::new(name.to_owned())
        .x_grid_spacer(move |input| x.grid(&input))
        .x_axis_formatter(move |mark, range| x.label(mark, range))
        .y_grid_spacer(move |input| y.grid(&input))
        .y_axis_formatter(move |mark, range| y.label(mark, range))
        .y_axis_min_width(60.0)
        .label_formatter(|_| None)
        .show_crosshair(false)
}

fn named_plot(response: &egui_plot::PlotResponse<()>, name: &str) {
    response
        .response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
}

fn show_convergence(ui: &mut Ui, state: &State) {
    let Some(run) = state.run.as_ref().filter(|run| !run.points.is_empty()) else {
        ui.label("No stage has been fitted yet.");
        return;
    };
    let ground = theme::ground(ui.ctx());
    let plot = result_plot("convergence", Axis::Linear, Axis::Logarithmic)
        .x_axis_label("iteration")
        .y_axis_label("E / %")
        .legend(Legend::default());
    let response = plot.show(ui, |plot_ui| {
        for (i, phase) in [Phase::Stage1, Phase::Stage2].into_iter().enumerate() {
            let of_phase = run.points.iter().filter(|point| point.phase == phase);
            let points: Vec<[f64; 2]> = of_phase
                .filter_map(|p| Some([p.iteration as f64, Axis::Logarithmic.place(p.e_percent)?]))
                .collect();
            let colour = theme::colour(0, i, 2, ground);
            let name = phase.to_string();
            plot_ui.line(Line::new(name.clone(), PlotPoints::from(points.clone())).color(colour));
            plot_ui.points(
                Points::new(name, PlotPoints::from(points))
                    .radius(2.5)
                    .color(colour),
            );
        }
    });
    named_plot(&response, "plot of E against iteration");
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
    let colour = theme::colour(0, 0, 2, theme::ground(ui.ctx()));
    let plot = result_plot("profile", Axis::Logarithmic, Axis::Logarithmic)
        .x_axis_label("k1")
        .y_axis_label("lowest E / %");
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
    named_plot(&response, "plot of the profile of k1");
}

fn show_reflectance(ui: &mut Ui, state: &State, sample: &Sample) {
    let points = state.shown.reflectance(sample.scan_id()).to_vec();
    let colour = theme::colour(0, 0, 2, theme::ground(ui.ctx()));
    let limit = Color32::from_rgb(0xd5, 0x5e, 0x00);
    let plot = result_plot("reflectance", Axis::Linear, Axis::Linear)
        .x_axis_label("incidence psi / deg")
        .y_axis_label("rho")
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
    named_plot(&response, "plot of the hemispherical reflectance");
}
