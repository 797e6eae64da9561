//! The models that a fit was compared with, as a table to choose from.

use brdf_fit::format::two_digits;
use brdf_fit::{Assessment, Candidate, Quality, rms_percent};
use egui::{Button, Grid, RichText, Role, ScrollArea, Ui};

use crate::intent::Intent;
use crate::state::State;
use crate::state::sample::Scan;
use crate::theme;
use crate::widgets::named;

/// Draws the table.
pub(super) fn show(ui: &mut Ui, state: &State, scan: &Scan, intents: &mut Vec<Intent>) {
    let report = scan.last_fit.as_ref();
    let Some(assessment) = report.and_then(|report| report.assessment.as_ref()) else {
        ui.label("The models are compared after a fit.");
        return;
    };
    ui.weak("Click on models to show them as dashed lines in the plot.");
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        Grid::new("models")
            .striped(true)
            .spacing([14.0, 3.0])
            .show(ui, |ui| {
                for (name, hint) in [
                    ("model", ""),
                    ("", ""),
                    ("rms %", "The rms error of the fit, sqrt(E)"),
                    (
                        "predicted rms %",
                        "The rms error of each incidence, predicted from the others",
                    ),
                    (
                        "predicts %",
                        "The typical relative error of an incidence that was not fitted",
                    ),
                    ("parameters, with intervals of 95 %", ""),
                ] {
                    let label = ui.weak(name);
                    if !hint.is_empty() {
                        label.on_hover_text(hint);
                    }
                }
                ui.end_row();
                for candidate in &assessment.models {
                    show_candidate(ui, state, scan, assessment, candidate, intents);
                    ui.end_row();
                }
                for left_out in &assessment.left_out {
                    ui.weak(left_out.model.name());
                    for _ in 0..4 {
                        ui.label("");
                    }
                    ui.weak(format!("not fitted: {}", left_out.reason));
                    ui.end_row();
                }
            });
    });
}

fn show_candidate(
    ui: &mut Ui,
    state: &State,
    scan: &Scan,
    assessment: &Assessment,
    candidate: &Candidate,
    intents: &mut Vec<Intent>,
) {
    let model = candidate.model;
    let rms = rms_percent(candidate.e_percent);
    let quality = Quality::of_rms(rms);
    let verdict = assessment
        .verdict
        .as_ref()
        .and_then(|verdict| verdict.model);
    let mut name = RichText::new(format!("{model} ({})", quality.word()))
        .color(theme::quality_colour(quality, theme::ground(ui.ctx())));
    if verdict == Some(model) {
        name = name.strong().underline();
    }
    let shown = state.shows_model(model);
    let row = named(
        ui.add(Button::selectable(shown, name)),
        Role::Button,
        &format!("show {model}"),
    );
    if row.on_hover_text(model.description()).clicked() {
        intents.push(Intent::ToggleModel(model));
    }
    let is_current = scan.parameters.model == model;
    let button = ui.add_enabled(!is_current, Button::new("use").small());
    if named(button, Role::Button, &format!("use {model}")).clicked() {
        intents.push(Intent::UseModel(model));
    }
    let dash = || "-".to_owned();
    ui.label(two_digits(rms));
    let predicted = candidate.predicted_e_percent;
    ui.label(predicted.map_or_else(dash, |e| two_digits(rms_percent(e))));
    let relative = candidate.relative_prediction.as_ref();
    let predicts = relative.filter(|prediction| !prediction.incidences.is_empty());
    ui.label(predicts.map_or_else(dash, |p| two_digits(p.within_percent())));
    let parameters: Vec<String> = candidate
        .estimates
        .iter()
        .map(|estimate| format!("{} {estimate}", estimate.parameter))
        .collect();
    ui.label(parameters.join(", "));
}
