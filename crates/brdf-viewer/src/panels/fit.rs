//! The fit: buttons, progress and settings.

use brdf_fit::Loss;
use brdf_fit::Method;
use brdf_fit::Phase;
use egui::{
    Button, CollapsingHeader, ComboBox, DragValue, Grid, ProgressBar, RichText, Role, Ui, vec2,
};

use crate::intent::{Command, Intent};
use crate::state::State;
use crate::state::fit_run::{FitRun, Progress};
use crate::state::fit_settings::{FitSettings, ReadingWeights, Scope, Stages, Start};
use crate::widgets::{choose, named};

/// Draws the section of the fit.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let mut settings = state.fit_settings.clone();
    ui.add_space(2.0);
    show_buttons(ui, state, intents);
    match &state.fit_run {
        Some(run) if run.is_running() => show_progress(ui, run, intents),
        Some(run)
            if state
                .active_sample()
                .is_some_and(|s| run.contains(s.scan_id())) =>
        {
            ui.label(result_text(run));
        }
        // The height does not depend on whether there was a fit.
        _ => {
            ui.label("");
        }
    }
    CollapsingHeader::new("Fit settings")
        .default_open(false)
        .show(ui, |ui| show_settings(ui, &mut settings));
    if settings != state.fit_settings {
        intents.push(Intent::FitSettings(settings));
    }
}

fn show_buttons(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    ui.horizontal(|ui| {
        let enabled = state.is_enabled(Command::Fit);
        let text = RichText::new("Fit").strong().size(16.0);
        let button = ui.add_enabled(enabled, Button::new(text).min_size(vec2(90.0, 28.0)));
        let button = named(button, Role::Button, "fit both stages");
        if button
            .on_hover_text("Fit this scan in both stages")
            .clicked()
        {
            intents.push(Intent::Fit(Stages::Both, Scope::Wavelength));
        }
        for (name, stages, hint) in [
            (
                "Stage 1",
                Stages::First,
                "Fit the incidences of stage 1 alone",
            ),
            ("Stage 2", Stages::Second, "Fit all incidences at once"),
        ] {
            let button = ui.add_enabled(enabled, Button::new(name).small());
            if button.on_hover_text(hint).clicked() {
                intents.push(Intent::Fit(stages, Scope::Wavelength));
            }
        }
        let enabled = state.is_enabled(Command::FitAll);
        let all = ui.add_enabled(enabled, Button::new("Fit all").small());
        if all.on_hover_text(Command::FitAll.name()).clicked() {
            intents.push(Intent::Command(Command::FitAll));
        }
    });
}

fn result_text(run: &FitRun) -> String {
    let (fitted, ended, count) = (run.fitted_count(), run.ended_count(), run.fit_count());
    match run.progress {
        Progress::Cancelled => format!("cancelled: {ended} of {count} completed"),
        _ if run.errors.is_empty() => format!("{fitted} of {count} fitted"),
        _ => format!("{fitted} of {count} fitted, {} failed", run.errors.len()),
    }
}

fn show_progress(ui: &mut Ui, run: &FitRun, intents: &mut Vec<Intent>) {
    ui.horizontal(|ui| {
        let cancelling = run.progress == Progress::Cancelling;
        if ui.add_enabled(!cancelling, Button::new("Cancel")).clicked() {
            intents.push(Intent::Command(Command::Cancel));
        }
        let (ended, count) = (run.ended_count(), run.fit_count());
        let text = match count {
            1 => running(run),
            _ => format!("{ended} of {count}: {}", running(run)),
        };
        let fraction = ended as f32 / count.max(1) as f32;
        ui.add(ProgressBar::new(fraction).text(text));
    });
}

/// What runs: the part of the phase, or else the phase.
fn running(run: &FitRun) -> String {
    let phase = || run.phase.map_or("", phase_name).to_owned();
    run.part.map_or_else(phase, |part| part.to_string())
}

/// What a phase of a fit does.
fn phase_name(phase: Phase) -> &'static str {
    match phase {
        Phase::Stage1 => "fitting stage 1",
        Phase::Stage2 => "fitting stage 2",
        Phase::GlobalCheck => "searching all widths",
        Phase::Relative => "fitting relative errors",
        Phase::Robust => "fitting without outliers",
        Phase::Energy => "conserving energy",
        Phase::Uncertainty => "intervals",
        Phase::Assessment => "comparing models",
    }
}

fn show_settings(ui: &mut Ui, settings: &mut FitSettings) {
    ui.horizontal(|ui| {
        ui.label("Start from");
        ui.radio_value(&mut settings.start, Start::Paper, "paper's values");
        ui.radio_value(&mut settings.start, Start::Current, "current values");
    });
    Grid::new("settings")
        .num_columns(2)
        .spacing([8.0, 4.0])
        .show(ui, |ui| {
            show_method(ui, "Stage 1 method", &mut settings.stage1);
            show_method(ui, "Stage 2 method", &mut settings.stage2);
            let label = ui.label("Largest psi in stage 1");
            let limit = DragValue::new(&mut settings.stage1_limit_deg);
            ui.add(limit.range(0.0..=90.0).suffix("°"))
                .labelled_by(label.id);
            ui.end_row();
            show_weights(ui, &mut settings.weights);
            show_loss(ui, &mut settings.loss);
            show_energy(ui, settings);
        });
    ui.checkbox(&mut settings.compare_models, "Also fit GGX and Beckmann");
    ui.checkbox(&mut settings.on_opening, "Fit scans when they are opened");
}

fn show_method(ui: &mut Ui, name: &str, method: &mut Method) {
    let all = [Method::LevenbergMarquardt, Method::NelderMead];
    show_choice(ui, name, method, &all, Method::to_string);
}

fn show_weights(ui: &mut Ui, weights: &mut ReadingWeights) {
    let name = |weights: &ReadingWeights| match weights {
        ReadingWeights::None => "none".to_owned(),
        ReadingWeights::Sigma => "1/σ²".to_owned(),
        ReadingWeights::Relative => "1/model²".to_owned(),
        ReadingWeights::SolidAngle => "solid angle".to_owned(),
    };
    let all = [
        ReadingWeights::None,
        ReadingWeights::Sigma,
        ReadingWeights::Relative,
        ReadingWeights::SolidAngle,
    ];
    show_choice(ui, "Reading weights", weights, &all, name);
}

fn show_loss(ui: &mut Ui, loss: &mut Option<Loss>) {
    let name = |loss: &Option<Loss>| {
        loss.map_or_else(|| "least squares".to_owned(), |loss| loss.to_string())
    };
    let all = [None, Some(Loss::Huber), Some(Loss::Tukey)];
    show_choice(ui, "Loss", loss, &all, name);
}

fn show_energy(ui: &mut Ui, settings: &mut FitSettings) {
    ui.checkbox(&mut settings.constrain_energy, "Enforce rho <= 1 up to");
    let limit = DragValue::new(&mut settings.energy_limit_deg);
    let limit = limit.range(0.0..=89.9).suffix("°");
    let response = ui.add_enabled(settings.constrain_energy, limit);
    named(response, egui::Role::SpinButton, "limit of rho <= 1");
    ui.end_row();
}

/// A row of the settings: a label and a combo box.
fn show_choice<T: PartialEq + Clone>(
    ui: &mut Ui,
    label: &str,
    value: &mut T,
    all: &[T],
    name: impl Fn(&T) -> String,
) {
    let response = ui.label(label);
    let combo = ComboBox::from_id_salt(label).width(150.0);
    choose(ui, combo, value, all.iter().cloned(), name).labelled_by(response.id);
    ui.end_row();
}
