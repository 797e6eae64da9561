//! How the data are looked at: the line above the plot.

use brdf_fit::plot::{Layout, Scale};
use brdf_fit::read::Side;
use brdf_fit::words::counted;
use egui::{Checkbox, ComboBox, Ui};

use super::axis::Axis;
use crate::intent::{Command, Intent};
use crate::panels::{degrees, named};
use crate::state::State;

/// Draws the line, and below it what the plot cannot show.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    ui.horizontal_wrapped(|ui| {
        for (command, name) in [
            (Command::Together, "Together"),
            (Command::Panels, "Panels"),
            (Command::Polar, "Polar"),
        ] {
            let on = state.is_on(command) == Some(true);
            if ui
                .selectable_label(on, name)
                .on_hover_text(command.name())
                .clicked()
            {
                intents.push(Intent::Do(command));
            }
        }
        ui.separator();
        let cartesian = state.view.layout != Layout::Polar;
        for (command, name) in [
            (Command::Logarithmic, "log"),
            (Command::TimesCosine, "× cos theta"),
            (Command::Residuals, "residuals"),
        ] {
            let mut on = state.is_on(command) == Some(true);
            let possible = cartesian || command == Command::TimesCosine;
            let box_ = ui.add_enabled(possible, Checkbox::new(&mut on, name));
            if box_.on_hover_text(command.name()).changed() {
                intents.push(Intent::Do(command));
            }
        }
        ui.separator();
        show_side(ui, state, intents);
        show_planes(ui, state, intents);
        if ui.button("Reset zoom").clicked() {
            intents.push(Intent::Do(Command::ResetZoom));
        }
    });
    let left_out = left_out(state);
    if !left_out.is_empty() {
        ui.weak(left_out);
    }
}

fn show_side(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let name = |side: Side| match side {
        Side::Source => "theta > 0: source side",
        Side::Forward => "theta > 0: forward side",
    };
    let mut view = state.view;
    let combo = ComboBox::from_id_salt("side").width(150.0);
    let shown = combo
        .selected_text(name(view.theta_positive))
        .show_ui(ui, |ui| {
            for side in [Side::Source, Side::Forward] {
                ui.selectable_value(&mut view.theta_positive, side, name(side));
            }
        });
    named(shown.response, egui::Role::ComboBox, "positive side");
    if view != state.view {
        intents.push(Intent::View(view));
    }
}

/// The planes of view, where there are others than that of incidence.
fn show_planes(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let Some(sample) = state.active_sample() else {
        return;
    };
    let planes = &sample.scan().planes;
    if planes.iter().all(|plane| *plane == 0.0) {
        return;
    }
    let name = |azimuth: f64| {
        let other = degrees(azimuth + std::f64::consts::PI);
        format!("phi = {} / {other}", degrees(azimuth))
    };
    let mut view = state.view;
    let combo = ComboBox::from_id_salt("plane").width(130.0);
    let shown = combo.selected_text(name(view.azimuth)).show_ui(ui, |ui| {
        for &plane in planes {
            ui.selectable_value(&mut view.azimuth, plane, name(plane));
        }
    });
    named(shown.response, egui::Role::ComboBox, "plane of view");
    if view != state.view {
        intents.push(Intent::View(view));
    }
}

/// What of the readings the plot does not show, in words.
fn left_out(state: &State) -> String {
    let (mut drawn, mut in_plane, mut all, mut without_place) = (0, 0, 0, 0);
    let axis = match state.view.layout {
        Layout::Polar => Axis::Linear,
        _ => Axis::from(state.view.scale),
    };
    for sample in state.visible() {
        let id = sample.scan_id();
        if let Some(selection) = state.shown.selection(id) {
            drawn += selection.shown();
            in_plane += selection.all();
        }
        let shown = sample.scan().incidences.iter().filter(|i| i.shown);
        all += shown.map(|i| i.readings).sum::<usize>();
        let curves = state.shown.curves(id).iter();
        let readings = curves.flat_map(|curve| &curve.readings);
        without_place += readings.filter(|r| axis.place(r.value).is_none()).count();
    }
    let mut words = Vec::new();
    if all > in_plane {
        words.push(format!(
            "{} out of this plane",
            counted(all - in_plane, "reading")
        ));
    }
    if in_plane > drawn {
        words.push(format!(
            "{drawn} of {in_plane} readings drawn: the first, lowest and highest of each {}",
            if state.view.scale == Scale::Linear {
                "column"
            } else {
                "column of points"
            }
        ));
    }
    if without_place > 0 {
        words.push(format!(
            "{} <= 0 cannot be shown on a logarithmic axis",
            counted(without_place, "reading")
        ));
    }
    words.join("; ")
}
