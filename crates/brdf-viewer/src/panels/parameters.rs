//! The model and its parameters at the right, and below them what follows and the fit.

use brdf_core::N_DOMAIN;
use brdf_fit::format::digits;
use brdf_fit::model::{Model, Parameter};
use egui::{
    ComboBox, DragValue, Grid, Id, Panel, Role, ScrollArea, Sense, Slider, SliderClamping, Ui,
};

use super::fit;
use crate::axis::round_number_above;
use crate::intent::{Command, Intent};
use crate::state::State;
use crate::state::fitting::Scope;
use crate::state::sample::{Knobs, Sample};
use crate::widgets::{choose, named};

/// Draws the panel. What is turned here is applied before what follows from it is drawn; whether
/// anything was turned.
pub fn show(ui: &mut Ui, state: &mut State) -> bool {
    let mut turned = false;
    let panel = Panel::right("parameters")
        .default_size(325.0)
        .size_range(300.0..=460.0);
    panel.show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            let mut intents = Vec::new();
            ui.add_space(4.0);
            ui.strong("Model");
            match state.active_sample() {
                Some(sample) => show_model(ui, state, sample, &mut intents),
                None => {
                    ui.label("No sample is open.");
                }
            }
            turned = !intents.is_empty();
            for intent in intents.drain(..) {
                state.apply(intent);
            }
            state.refresh();
            show_outcome(ui, state);
            ui.separator();
            fit::show(ui, state, &mut intents);
            for intent in intents.drain(..) {
                state.apply(intent);
            }
        });
    });
    turned
}

fn show_model(ui: &mut Ui, state: &State, sample: &Sample, intents: &mut Vec<Intent>) {
    let knobs = sample.scan().knobs;
    let mut model = knobs.model;
    let combo = ComboBox::from_id_salt("model")
        .width(280.0)
        .height(400.0)
        .truncate();
    let text = |model: &Model| format!("{model}: {}", model.description());
    let shown = choose(ui, combo, &mut model, Model::ALL, text);
    named(shown, Role::ComboBox, "model");
    if model != knobs.model {
        intents.push(Intent::Model(model, Scope::Wavelength));
    }
    show_model_for_all(ui, sample, intents);
    let fitted = sample.scan().fitted_knobs();
    Grid::new("parameters")
        .num_columns(5)
        .spacing([6.0, 5.0])
        .show(ui, |ui| {
            for parameter in knobs.parameters() {
                show_parameter(ui, parameter, &knobs, &fitted, intents);
                ui.end_row();
            }
        });
    ui.horizontal(|ui| {
        for command in [Command::Undo, Command::Redo, Command::ResetAll] {
            let name = if command == Command::ResetAll {
                "Reset all"
            } else {
                command.name()
            };
            let enabled = state.is_enabled(command);
            if ui.add_enabled(enabled, egui::Button::new(name)).clicked() {
                intents.push(Intent::Do(command));
            }
        }
    });
}

/// The model for the other wavelengths as well, where there are any.
fn show_model_for_all(ui: &mut Ui, sample: &Sample, intents: &mut Vec<Intent>) {
    if sample.scans.len() < 2 {
        return;
    }
    let model = sample.scan().knobs.model;
    let differs = sample.scans.iter().any(|scan| scan.knobs.model != model);
    let button = egui::Button::new("This model for all wavelengths").small();
    if ui.add_enabled(differs, button).clicked() {
        intents.push(Intent::Model(model, Scope::Sample));
    }
}

/// A row: name, slider, number, back to the fit, hold.
fn show_parameter(
    ui: &mut Ui,
    parameter: Parameter,
    knobs: &Knobs,
    fitted: &Knobs,
    intents: &mut Vec<Intent>,
) {
    let value = parameter.of(&knobs.at);
    let reset = parameter.of(&fitted.at);
    let label = ui.add(egui::Label::new(parameter.to_string()).sense(Sense::click()));
    let label = label.on_hover_text(meaning(parameter));

    let mut slid = value;
    let slider = slider(parameter, &mut slid, reset).show_value(false);
    let slider = ui.add(slider).labelled_by(label.id);
    // A slider does not feel clicks: this lies over it and does.
    let over = ui.interact(
        slider.rect,
        Id::unique(("reset", parameter as u8)),
        Sense::click(),
    );
    let over = named(over, Role::Unknown, &format!("slider of {parameter}"));
    let mut typed = value;
    number(ui, parameter, &mut typed).labelled_by(label.id);

    let button = ui.add_enabled(value != reset, egui::Button::new("reset").small());
    let name = format!("reset {parameter}");
    let button = named(button, Role::Button, &name);
    let button = button.on_hover_text(format!("{name} to {}", digits(reset)));
    let twice = over.double_clicked() || label.double_clicked();

    if twice || button.clicked() {
        intents.push(Intent::Reset(parameter));
    } else {
        let turned = if slider.changed() { slid } else { typed };
        if turned != value && turned.is_finite() {
            let mut knobs = *knobs;
            parameter.set(&mut knobs.at, turned);
            intents.push(Intent::Turn(knobs));
        }
    }
    show_hold(ui, parameter, knobs, intents);
}

fn show_hold(ui: &mut Ui, parameter: Parameter, knobs: &Knobs, intents: &mut Vec<Intent>) {
    if !knobs.model.frees(parameter) {
        ui.weak("given");
        return;
    }
    let mut held = knobs.holds(parameter);
    let response = ui.checkbox(&mut held, "hold");
    let name = format!("hold {parameter}");
    response.widget_info(|| egui::WidgetInfo::selected(Role::CheckBox, true, held, &name));
    let words = format!("a fit leaves {parameter} as it is");
    if response.on_hover_text(words).changed() {
        let mut knobs = *knobs;
        knobs.fixed[parameter as usize] = held;
        intents.push(Intent::Turn(knobs));
    }
}

fn meaning(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::K2 => "specular weight",
        Parameter::Kd => "diffuse weight",
        Parameter::K1 => "width of the facet distribution",
        Parameter::N => "refractive index",
        Parameter::P => "exponent of the facet distribution",
    }
}

/// What a number box takes.
fn range(parameter: Parameter) -> (f64, f64) {
    match parameter {
        Parameter::K2 | Parameter::Kd => (0.0, 1e30),
        Parameter::N => N_DOMAIN,
        other => other.range(),
    }
}

/// The part of the range that matters on coatings; a number box takes more.
fn slider(parameter: Parameter, value: &mut f64, fitted: f64) -> Slider<'_> {
    let slider = match parameter {
        Parameter::K2 | Parameter::Kd => {
            let top = round_number_above(2.0 * fitted.max(0.5 * *value).max(1e-3));
            Slider::new(value, 0.0..=top)
        }
        Parameter::K1 => Slider::new(value, 1e-4..=10.0).logarithmic(true),
        Parameter::N => Slider::new(value, 1.0..=3.0),
        Parameter::P => Slider::new(value, 0.1..=16.0).logarithmic(true),
    };
    slider.clamping(SliderClamping::Edits).smart_aim(false)
}

fn number(ui: &mut Ui, parameter: Parameter, value: &mut f64) -> egui::Response {
    let (lowest, highest) = range(parameter);
    let before = *value;
    let speed = (before.abs() * 0.005).max(1e-6);
    let box_ = DragValue::new(value)
        .range(lowest..=highest)
        .clamp_existing_to_range(false)
        .speed(speed)
        .update_while_editing(false)
        .custom_formatter(|x, _| digits(x));
    let response = ui.add_sized([70.0, ui.spacing().interact_size.y], box_);
    // A box that is left without a change keeps what its digits do not show.
    if digits(*value) == digits(before) {
        *value = before;
    }
    response
}

/// E and the reflectance of the parameters as they are.
fn show_outcome(ui: &mut Ui, state: &State) {
    let Some(sample) = state.active_sample() else {
        return;
    };
    let id = sample.scan_id();
    ui.add_space(4.0);
    match state.shown.errors(id) {
        Some(Ok(errors)) => {
            ui.strong(format!("E = {} %", digits(errors.e_percent)));
        }
        Some(Err(reason)) => {
            ui.label(format!("no E: {reason}"));
        }
        None => {}
    }
    let rho = state.shown.reflectance(id);
    let words: Vec<String> = rho
        .iter()
        .filter(|[psi_deg, _]| [0.0, 45.0, 60.0, 85.0].contains(psi_deg))
        .map(|[psi_deg, rho]| format!("{rho:.3} at {psi_deg}°"))
        .collect();
    ui.label(format!("Hemispherical reflectance {}", words.join(", ")));
    if let Some([psi_deg, _]) = rho.iter().find(|[_, rho]| *rho > 1.0) {
        let words = format!("more light leaves than arrives at {psi_deg}° and beyond");
        ui.colored_label(ui.visuals().warn_fg_color, words);
    }
}
