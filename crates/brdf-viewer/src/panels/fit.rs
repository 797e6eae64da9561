//! The fit: its buttons, its settings, and how far it is.

use brdf_fit::Method;
use brdf_fit::fit::robust::Loss;
use egui::{Button, CollapsingHeader, ComboBox, DragValue, Grid, ProgressBar, Ui};

use crate::intent::{Command, Intent};
use crate::state::State;
use crate::state::fitting::{FitChoice, FitRun, Progress, ReadingWeights, Scope, Stages, Start};
use crate::widgets::{choose, named};

/// Draws the fit.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    ui.strong("Fit");
    let mut choice = state.choice.clone();
    ui.horizontal(|ui| {
        ui.label("Start from");
        ui.radio_value(&mut choice.start, Start::Paper, "the paper's values");
        ui.radio_value(&mut choice.start, Start::Sliders, "the sliders");
    });
    ui.horizontal(|ui| {
        let enabled = state.is_enabled(Command::Fit);
        for (name, stages) in [
            ("Stage 1", Stages::First),
            ("Stage 2", Stages::Second),
            ("Both stages", Stages::Both),
        ] {
            if ui.add_enabled(enabled, Button::new(name)).clicked() {
                intents.push(Intent::Fit(stages, Scope::Wavelength));
            }
        }
        let enabled = state.is_enabled(Command::FitAll);
        let all = ui.add_enabled(enabled, Button::new("Fit all"));
        if all.on_hover_text(Command::FitAll.name()).clicked() {
            intents.push(Intent::Do(Command::FitAll));
        }
    });
    if let Some(run) = &state.run {
        show_run(ui, run, intents);
    }
    CollapsingHeader::new("Settings of the fit")
        .default_open(false)
        .show(ui, |ui| show_settings(ui, &mut choice));
    if choice != state.choice {
        intents.push(Intent::FitChoice(choice));
    }
}

fn show_run(ui: &mut Ui, run: &FitRun, intents: &mut Vec<Intent>) {
    if !run.is_running() {
        let words = match run.progress {
            Progress::Cancelled => format!("cancelled: {} of {} were done", run.done(), run.jobs()),
            _ if run.failed.is_empty() => format!("{} of {} fitted", run.fitted(), run.jobs()),
            _ => {
                let failed = run.failed.len();
                format!("{} of {} fitted, {failed} failed", run.fitted(), run.jobs())
            }
        };
        ui.label(words);
        return;
    }
    ui.horizontal(|ui| {
        let cancelling = run.progress == Progress::Cancelling;
        if ui.add_enabled(!cancelling, Button::new("Cancel")).clicked() {
            intents.push(Intent::Do(Command::Cancel));
        }
        let phase = run
            .phase
            .map_or_else(String::new, |phase| phase.to_string());
        let iteration = run.points.last().map_or(0, |point| point.iteration);
        let words = format!(
            "{} of {}: {phase}, iteration {iteration}",
            run.done(),
            run.jobs()
        );
        let part = run.done() as f32 / run.jobs().max(1) as f32;
        ui.add(ProgressBar::new(part).text(words));
    });
}

fn show_settings(ui: &mut Ui, choice: &mut FitChoice) {
    Grid::new("settings")
        .num_columns(2)
        .spacing([8.0, 4.0])
        .show(ui, |ui| {
            show_method(ui, "Method of stage 1", &mut choice.stage1);
            show_method(ui, "Method of stage 2", &mut choice.stage2);
            let label = ui.label("Stage 1 up to");
            ui.add(
                DragValue::new(&mut choice.limit_deg)
                    .range(0.0..=90.0)
                    .suffix("°"),
            )
            .labelled_by(label.id);
            ui.end_row();
            show_weights(ui, &mut choice.weights);
            show_loss(ui, &mut choice.robust);
            ui.checkbox(&mut choice.energy, "rho <= 1 up to");
            let limit = &mut choice.energy_limit_deg;
            let limit = DragValue::new(limit).range(0.0..=89.9).suffix("°");
            let response = ui.add_enabled(choice.energy, limit);
            named(response, egui::Role::SpinButton, "limit of rho <= 1");
            ui.end_row();
        });
    ui.checkbox(&mut choice.compare, "Fit GGX and Beckmann beside it");
}

fn show_method(ui: &mut Ui, name: &str, method: &mut Method) {
    let all = [Method::LevenbergMarquardt, Method::NelderMead];
    show_choice(ui, name, method, &all, Method::to_string);
}

fn show_weights(ui: &mut Ui, weights: &mut ReadingWeights) {
    let name = |weights: &ReadingWeights| match weights {
        ReadingWeights::None => "none".to_owned(),
        ReadingWeights::Sigma => "1/sigma²".to_owned(),
        ReadingWeights::SolidAngle => "solid angle".to_owned(),
    };
    let all = [
        ReadingWeights::None,
        ReadingWeights::Sigma,
        ReadingWeights::SolidAngle,
    ];
    show_choice(ui, "Weights of readings", weights, &all, name);
}

fn show_loss(ui: &mut Ui, loss: &mut Option<Loss>) {
    let name = |loss: &Option<Loss>| {
        loss.map_or_else(|| "least squares".to_owned(), |loss| loss.to_string())
    };
    let all = [None, Some(Loss::Huber), Some(Loss::Tukey)];
    show_choice(ui, "Loss", loss, &all, name);
}

/// A row of the settings: a name, and a box from which one of some values is chosen.
fn show_choice<T: PartialEq + Clone>(
    ui: &mut Ui,
    name: &str,
    value: &mut T,
    all: &[T],
    words: impl Fn(&T) -> String,
) {
    let label = ui.label(name);
    let combo = ComboBox::from_id_salt(name).width(150.0);
    choose(ui, combo, value, all.iter().cloned(), words).labelled_by(label.id);
    ui.end_row();
}
