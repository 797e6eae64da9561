//! The fits of all wavelengths of a sample: a table, and a plot of one parameter.

use brdf_fit::format::{digits, two_digits};
use brdf_fit::{Estimate, Parameter, Quality};
use egui::{Button, Color32, Grid, RichText, Role, ScrollArea, Ui};
use egui_plot::{Line, PlotPoints, Points};

use super::plots::{line, result_plot};
use crate::intent::Intent;
use crate::plot::axis::Axis;
use crate::state::State;
use crate::state::sample::{Sample, Scan};
use crate::theme;
use crate::widgets::named;

/// The most rows of the table; a plot shows the others.
const MOST_ROWS: usize = 400;

/// Draws the table and the plot side by side.
pub(super) fn show(ui: &mut Ui, state: &State, sample: &Sample, intents: &mut Vec<Intent>) {
    if !sample.is_fitted() {
        ui.label("No wavelength has been fitted yet.");
        return;
    }
    let parameters: Vec<Parameter> = Parameter::ALL
        .into_iter()
        .filter(|p| {
            sample
                .scans
                .iter()
                .any(|scan| scan.parameters.model.frees(*p))
        })
        .collect();
    ui.columns(2, |columns| {
        if let [left, right] = columns {
            show_table(left, sample, &parameters, intents);
            show_plot(right, state, sample, &parameters, intents);
        }
    });
}

fn show_table(ui: &mut Ui, sample: &Sample, parameters: &[Parameter], intents: &mut Vec<Intent>) {
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        Grid::new("all wavelengths")
            .striped(true)
            .spacing([12.0, 2.0])
            .show(ui, |ui| {
                ui.weak("wavelength");
                ui.weak("rms %");
                for parameter in parameters {
                    ui.weak(parameter.to_string());
                }
                ui.end_row();
                for (i, scan) in sample.scans.iter().enumerate().take(MOST_ROWS) {
                    show_row(ui, sample, i, scan, parameters, intents);
                    ui.end_row();
                }
            });
        if sample.scans.len() > MOST_ROWS {
            let more = sample.scans.len() - MOST_ROWS;
            ui.weak(format!(
                "{more} further wavelengths: see the plot, or export the fits."
            ));
        }
    });
}

fn show_row(
    ui: &mut Ui,
    sample: &Sample,
    i: usize,
    scan: &Scan,
    parameters: &[Parameter],
    intents: &mut Vec<Intent>,
) {
    let um = scan.wavelength_um();
    let wavelength = um.map_or_else(|| "not stated".to_owned(), |um| format!("{um} µm"));
    let button = ui.add(Button::selectable(sample.current == i, &wavelength));
    let button = named(button, Role::Button, &format!("show {wavelength}"));
    if button.clicked() {
        intents.push(Intent::Wavelength(sample.id, i));
    }
    let report = scan.last_fit.as_ref();
    let Some(fit) = report.and_then(|report| report.fit.as_ref()) else {
        ui.weak("not fitted");
        return;
    };
    let quality = Quality::of(fit);
    let colour = theme::quality_colour(quality, theme::ground(ui.ctx()));
    let rms = format!("{} {}", two_digits(fit.rms_percent()), quality.word());
    ui.label(RichText::new(rms).color(colour));
    for parameter in parameters {
        let text = estimate(scan, *parameter).map(ToString::to_string);
        ui.label(text.unwrap_or_else(|| digits(parameter.of(&fit.at()))));
    }
}

fn estimate(scan: &Scan, parameter: Parameter) -> Option<&Estimate> {
    let uncertainty = scan.last_fit.as_ref()?.uncertainty.as_ref()?;
    uncertainty.estimate(parameter)
}

/// The plot of one parameter with its intervals, and above it the choice of the parameter.
fn show_plot(
    ui: &mut Ui,
    state: &State,
    sample: &Sample,
    parameters: &[Parameter],
    intents: &mut Vec<Intent>,
) {
    let shown = state.interface.parameter;
    ui.horizontal(|ui| {
        for parameter in parameters {
            let on = shown == *parameter;
            let button = ui.selectable_label(on, parameter.to_string());
            if named(button, Role::Button, &format!("plot {parameter}")).clicked() {
                intents.push(Intent::PlotParameter(*parameter));
            }
        }
    });
    let fits = sample.scans.iter().filter_map(|scan| {
        let fit = scan.last_fit.as_ref()?.fit.as_ref()?;
        Some((scan, scan.wavelength_um()?, shown.of(&fit.at())))
    });
    let points: Vec<[f64; 2]> = fits.clone().map(|(_, um, value)| [um, value]).collect();
    if points.is_empty() {
        ui.label("The scans state no wavelength.");
        return;
    }
    let intervals: Vec<[[f64; 2]; 2]> = fits
        .filter_map(|(scan, um, _)| {
            let interval = estimate(scan, shown)?.interval_95();
            Some([[um, interval.from?], [um, interval.to?]])
        })
        .collect();
    let name = shown.to_string();
    let colour = theme::series_colour(0, theme::ground(ui.ctx()));
    let plot = result_plot(
        "over wavelength",
        [Axis::Linear; 2],
        ["wavelength, µm", &name],
    );
    let response = plot.show(ui, |plot_ui| {
        for interval in intervals {
            let bar = Line::new("", PlotPoints::from(interval.to_vec()));
            plot_ui.line(bar.color(faint(colour)).width(1.0).allow_hover(false));
        }
        plot_ui.line(line(&name, points.clone(), colour));
        plot_ui.points(
            Points::new(name.clone(), PlotPoints::from(points))
                .radius(2.5)
                .color(colour),
        );
    });
    named(
        response.response,
        Role::Image,
        "plot of a parameter over wavelength",
    );
}

fn faint(colour: Color32) -> Color32 {
    colour.gamma_multiply(0.6)
}
