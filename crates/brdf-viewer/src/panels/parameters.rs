//! The panel at the right: the model with its parameters, and the reflectances that follow from
//! them.

use brdf_core::N_DOMAIN;
use brdf_fit::format::digits;
use brdf_fit::{Model, Parameter};
use egui::{
    ComboBox, DragValue, Id, Panel, RichText, Role, ScrollArea, Sense, Slider, SliderClamping, Ui,
};

use crate::intent::{Command, Intent};
use crate::plot::ticks::round_up;
use crate::state::State;
use crate::state::fit_settings::Scope;
use crate::state::parameters::EditedParameters;
use crate::state::sample::{Sample, Scan};
use crate::widgets::{choose, named};

/// In windows narrower than this, in points, the panel is below the plot: a telephone held upright.
const NARROW: f32 = 640.0;

/// Draws the panel: the card of the result and the model scroll, the buttons of the fit stay below.
pub fn show_panel(ui: &mut Ui, above: impl FnOnce(&mut Ui), fit: impl FnOnce(&mut Ui)) {
    let panel = if ui.available_width() < NARROW {
        let height = ui.available_height();
        Panel::bottom("parameters below")
            .resizable(true)
            .default_size(0.5 * height)
            .size_range(0.3 * height..=0.7 * height)
    } else {
        Panel::right("parameters")
            .default_size(325.0)
            .size_range(300.0..=460.0)
    };
    panel.show(ui, |ui| {
        Panel::bottom("fit").resizable(false).show(ui, fit);
        ScrollArea::vertical().auto_shrink(false).show(ui, above);
    });
}

/// Draws the model and its parameters.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    ui.add_space(4.0);
    let Some(sample) = state.active_sample() else {
        ui.label("No sample is open.");
        return;
    };
    show_model(ui, sample, intents);
    let scan = sample.scan();
    let fitted = scan.fitted_parameters();
    for parameter in scan.parameters.model_parameters() {
        ui.push_id(parameter as u8, |ui| {
            show_parameter(ui, parameter, scan, &fitted, intents);
        });
    }
    show_buttons(ui, state, intents);
}

fn show_model(ui: &mut Ui, sample: &Sample, intents: &mut Vec<Intent>) {
    let current = sample.scan().parameters.model;
    let mut model = current;
    let combo = ComboBox::from_id_salt("model")
        .width(280.0)
        .height(400.0)
        .truncate();
    let text = |model: &Model| format!("{model}: {}", model.description());
    let shown = choose(ui, combo, &mut model, Model::ALL, text);
    named(shown, Role::ComboBox, "model");
    if model != current {
        intents.push(Intent::Model(model, Scope::Wavelength));
    }
    if sample.scans.len() > 1 {
        let mut scans = sample.scans.iter();
        let differs = scans.any(|scan| scan.parameters.model != current);
        let button = egui::Button::new("Use this model for all wavelengths").small();
        if ui.add_enabled(differs, button).clicked() {
            intents.push(Intent::Model(current, Scope::Sample));
        }
    }
}

fn show_buttons(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    ui.horizontal(|ui| {
        for command in [Command::Undo, Command::Redo, Command::ResetAll] {
            let name = if command == Command::ResetAll {
                "Reset all"
            } else {
                command.name()
            };
            let enabled = state.is_enabled(command);
            let button = ui.add_enabled(enabled, egui::Button::new(name));
            if button.clicked() {
                intents.push(Intent::Command(command));
            }
        }
    });
}

/// Two lines: the name with the estimate; slider, number box, reset button and check box.
fn show_parameter(
    ui: &mut Ui,
    parameter: Parameter,
    scan: &Scan,
    fitted: &EditedParameters,
    intents: &mut Vec<Intent>,
) {
    let label = show_name(ui, parameter, scan);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        show_controls(ui, parameter, &label, &scan.parameters, fitted, intents);
    });
}

/// The name of a parameter, and what the data say of it where it is as fitted.
fn show_name(ui: &mut Ui, parameter: Parameter, scan: &Scan) -> egui::Response {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let name = RichText::new(parameter.to_string()).strong();
        let label = ui.add(egui::Label::new(name).sense(Sense::click()));
        ui.label(format!("{}:", title(parameter)));
        let uncertainty = scan
            .current_fit()
            .and_then(|report| report.uncertainty.as_ref());
        let estimate = uncertainty.and_then(|uncertainty| uncertainty.estimate(parameter));
        if let Some(estimate) = estimate {
            let hint = "The fitted value, and the interval of 95 %";
            ui.label(estimate.to_string()).on_hover_text(hint);
        } else {
            ui.label(digits(parameter.of(&scan.parameters.values)));
        }
        label.on_hover_text(meaning(parameter))
    })
    .inner
}

fn show_controls(
    ui: &mut Ui,
    parameter: Parameter,
    label: &egui::Response,
    current: &EditedParameters,
    fitted: &EditedParameters,
    intents: &mut Vec<Intent>,
) {
    let value = parameter.of(&current.values);
    let reset = parameter.of(&fitted.values);
    let mut slider_value = value;
    let slider = slider(parameter, &mut slider_value, reset).show_value(false);
    let slider = ui.add(slider).labelled_by(label.id);
    // A slider does not sense clicks, so that an area on top of it senses double clicks.
    let area = ui.interact(
        slider.rect,
        Id::unique(("reset", parameter as u8)),
        Sense::click(),
    );
    let area = named(area, Role::Unknown, &format!("slider of {parameter}"));
    let mut typed_value = value;
    number_box(ui, parameter, &mut typed_value).labelled_by(label.id);

    let button = ui.add_enabled(value != reset, egui::Button::new("reset").small());
    let name = format!("reset {parameter}");
    let button = named(button, Role::Button, &name);
    let button = button.on_hover_text(format!("{name} to {}", digits(reset)));
    let double_clicked = area.double_clicked() || label.double_clicked();

    if double_clicked || button.clicked() {
        intents.push(Intent::Reset(parameter));
    } else {
        let new = if slider.changed() {
            slider_value
        } else {
            typed_value
        };
        if new != value && new.is_finite() {
            let mut changed = *current;
            parameter.set(&mut changed.values, new);
            intents.push(Intent::SetParameters(changed));
        }
    }
    show_fix(ui, parameter, current, intents);
}

fn show_fix(
    ui: &mut Ui,
    parameter: Parameter,
    current: &EditedParameters,
    intents: &mut Vec<Intent>,
) {
    if !current.model.frees(parameter) {
        ui.weak("given");
        return;
    }
    let mut fixed = current.is_fixed(parameter);
    let response = ui.checkbox(&mut fixed, "fix");
    let name = format!("fix {parameter}");
    response.widget_info(|| egui::WidgetInfo::selected(Role::CheckBox, true, fixed, &name));
    let hint = format!("fit the other parameters, with {parameter} fixed at its value");
    if response.on_hover_text(hint).changed() {
        let mut changed = *current;
        changed.fixed[parameter as usize] = fixed;
        intents.push(Intent::SetParameters(changed));
    }
}

fn title(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::K2 => "specular weight",
        Parameter::Kd => "diffuse weight",
        Parameter::K1 => "facet width",
        Parameter::N => "refractive index",
        Parameter::P => "facet exponent",
    }
}

/// What a parameter means for the surface.
fn meaning(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::K2 => "More specular weight: the facets of the surface mirror more light.",
        Parameter::Kd => {
            "More diffuse weight: more light comes back from below the surface, in all directions. \
             kD is the reflectance of this part."
        }
        Parameter::K1 => {
            "Wider facets spread the lobe: a small width is a glossy surface, a large one a matt one."
        }
        Parameter::N => {
            "A larger refractive index mirrors more light, most of all far from grazing incidence."
        }
        Parameter::P => {
            "The exponent shapes the lobe: 1 is the shape of the paper, other values change its \
             peak and its tails."
        }
    }
}

/// The range of a number box.
fn range(parameter: Parameter) -> (f64, f64) {
    match parameter {
        Parameter::K2 | Parameter::Kd => (0.0, 1e30),
        Parameter::N => N_DOMAIN,
        other => other.range(),
    }
}

/// A slider over the usual values of coatings. Its number box has a wider range.
fn slider(parameter: Parameter, value: &mut f64, fitted: f64) -> Slider<'_> {
    let slider = match parameter {
        Parameter::K2 | Parameter::Kd => {
            let top = round_up(2.0 * fitted.max(0.5 * *value).max(1e-3));
            Slider::new(value, 0.0..=top)
        }
        Parameter::K1 => Slider::new(value, 1e-4..=10.0).logarithmic(true),
        Parameter::N => Slider::new(value, 1.0..=3.0),
        Parameter::P => Slider::new(value, 0.1..=16.0).logarithmic(true),
    };
    slider.clamping(SliderClamping::Edits).smart_aim(false)
}

fn number_box(ui: &mut Ui, parameter: Parameter, value: &mut f64) -> egui::Response {
    let (lowest, highest) = range(parameter);
    let before = *value;
    let speed = (before.abs() * 0.005).max(1e-6);
    let number = DragValue::new(value)
        .range(lowest..=highest)
        .clamp_existing_to_range(false)
        .speed(speed)
        .update_while_editing(false)
        .custom_formatter(|x, _| digits(x));
    let response = ui.add_sized([70.0, ui.spacing().interact_size.y], number);
    // A box that is left without an edit must not round the value to the digits shown.
    if digits(*value) == digits(before) {
        *value = before;
    }
    response
}

/// Draws the reflectances of the current parameters.
pub fn show_reflectance(ui: &mut Ui, state: &State) {
    let Some(sample) = state.active_sample() else {
        return;
    };
    let rho = state.derived.reflectance(sample.scan_id());
    let values: Vec<String> = rho
        .iter()
        .filter(|[psi_deg, _]| [0.0, 45.0, 60.0, 85.0].contains(psi_deg))
        .map(|[psi_deg, rho]| format!("{rho:.3} at {psi_deg}°"))
        .collect();
    ui.label(format!("Hemispherical reflectance {}", values.join(", ")));
    if let Some([psi_deg, _]) = rho.iter().find(|[_, rho]| *rho > 1.0) {
        let text = format!("energy is not conserved: the reflectance exceeds 1 from {psi_deg}°");
        ui.colored_label(ui.visuals().warn_fg_color, text);
    }
}
