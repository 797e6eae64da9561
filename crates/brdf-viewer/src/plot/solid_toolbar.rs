//! The controls of the lobe and of the surface, above them.

use egui::{Button, Checkbox, ComboBox, DragValue, Ui};

use crate::intent::{Command, Intent};
use crate::solid::surface::MOST_STOPS;
use crate::state::State;
use crate::state::solid::SolidView;
use crate::state::solid::view::{LARGEST_PSI_DEG, SMALLEST_PLATE_PSI_DEG};
use crate::widgets::{choose, degrees, named};

/// Draws the controls of the lobe.
pub(super) fn show_lobe(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    for (command, name) in [
        (Command::Logarithmic, "log"),
        (Command::TimesCosine, "× cos θ"),
    ] {
        let mut on = state.is_on(command) == Some(true);
        let check_box = ui.add(Checkbox::new(&mut on, name));
        if check_box.on_hover_text(command.name()).changed() {
            intents.push(Intent::Command(command));
        }
    }
    let mut view = state.solid;
    let mut psi_deg = state.lobe_psi().to_degrees();
    let number = DragValue::new(&mut psi_deg)
        .range(0.0..=LARGEST_PSI_DEG)
        .speed(0.25)
        .max_decimals(2)
        .prefix("ψ = ")
        .suffix("°");
    let number = named(
        ui.add(number),
        egui::Role::SpinButton,
        "incidence of the lobe",
    );
    if number
        .on_hover_text("The incidence angle: drag, or click and type")
        .changed()
    {
        view.psi_deg = Some(psi_deg);
    }
    show_incidences(ui, state, &mut view);
    show_beside(ui, state, &mut view);
    push(state, view, intents);
}

/// The incidences of the active scan.
fn show_incidences(ui: &mut Ui, state: &State, view: &mut SolidView) {
    let Some(sample) = state.active_sample() else {
        return;
    };
    let psi = state.lobe_psi();
    let is_shown = |other: f64| (other - psi).abs() < 1e-6;
    let text = "measured".to_owned();
    let combo = ComboBox::from_id_salt("incidence").width(70.0);
    let shown = combo.selected_text(text).show_ui(ui, |ui| {
        for incidence in &sample.scan().incidences {
            let label = ui.selectable_label(is_shown(incidence.psi), degrees(incidence.psi));
            let psi_deg = incidence.psi.to_degrees();
            if label.clicked() && psi_deg <= LARGEST_PSI_DEG {
                view.psi_deg = Some(psi_deg);
            }
        }
    });
    named(shown.response, egui::Role::ComboBox, "measured incidence");
}

/// Draws the controls of the surface.
pub(super) fn show_surface(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let mut view = state.solid;
    let sky = DragValue::new(&mut view.sky_percent)
        .range(0.0..=100.0)
        .speed(0.5)
        .fixed_decimals(0)
        .prefix("sky ")
        .suffix(" %");
    named(ui.add(sky), egui::Role::SpinButton, "share of the sky")
        .on_hover_text("The share of a uniform sky in the light; the lamp has the others");
    let range = SMALLEST_PLATE_PSI_DEG..=LARGEST_PSI_DEG;
    let plate = DragValue::new(&mut view.plate_psi_deg)
        .range(range)
        .speed(0.1)
        .fixed_decimals(0)
        .prefix("plate ψ = ")
        .suffix("°");
    named(
        ui.add(plate),
        egui::Role::SpinButton,
        "incidence on the plate",
    )
    .on_hover_text("The zenith angle of the lamp behind the plate");
    show_exposure(ui, state, &mut view);
    show_beside(ui, state, &mut view);
    push(state, view, intents);
}

fn show_exposure(ui: &mut Ui, state: &State, view: &mut SolidView) {
    let [mut stops, _] = state.derived_solid.stops();
    let number = DragValue::new(&mut stops)
        .range(-MOST_STOPS..=MOST_STOPS)
        .speed(0.05)
        .max_decimals(1)
        .suffix(" stops");
    let number = named(ui.add(number), egui::Role::SpinButton, "exposure");
    if number
        .on_hover_text("The exposure: each stop doubles the light")
        .changed()
    {
        view.stops = Some(stops);
    }
    let is_automatic = view.stops.is_none();
    let automatic = ui.add(Button::selectable(is_automatic, "auto"));
    let automatic = named(automatic, egui::Role::Button, "automatic exposure");
    let hint = "The largest reflectance is about half of white; a light surface is shown as it is";
    if automatic.on_hover_text(hint).clicked() {
        view.stops = is_automatic.then_some(stops);
    }
}

/// What is shown beside the active sample.
fn show_beside(ui: &mut Ui, state: &State, view: &mut SolidView) {
    let choices = state.choices_beside();
    // With nothing to show there is nothing to choose.
    if choices.len() <= 2 {
        return;
    }
    let name = |beside: &_| {
        let found = choices.iter().find(|(choice, _)| choice == beside);
        found.map_or_else(|| "beside: nothing".to_owned(), |(_, name)| name.clone())
    };
    let combo = ComboBox::from_id_salt("beside").width(120.0);
    let all = choices.iter().map(|(choice, _)| *choice);
    let shown = choose(ui, combo, &mut view.beside, all, name);
    named(shown, egui::Role::ComboBox, "shown beside");
}

fn push(state: &State, view: SolidView, intents: &mut Vec<Intent>) {
    if view != state.solid {
        intents.push(Intent::Solid(view));
    }
}
