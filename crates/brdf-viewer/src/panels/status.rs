//! The status line: files being read, the last action, and buttons for the side panels.

use brdf_fit::format::counted;
use egui::{Panel, Ui};

use crate::intent::{Command, Intent};
use crate::state::State;

/// Draws the status line.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    Panel::bottom("status").show(ui, |ui| {
        ui.horizontal(|ui| {
            if state.files_being_read > 0 {
                ui.label(format!(
                    "reading {}",
                    counted(state.files_being_read, "file")
                ));
                ui.separator();
            }
            let readings: usize = state.visible().map(|s| s.scan().reading_count()).sum();
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                show_panel_buttons(ui, state, intents);
                ui.weak(format!("{readings} readings"));
                // The status fills the space that is left, and is truncated to it.
                let rest = egui::Layout::left_to_right(egui::Align::Center);
                ui.with_layout(rest, |ui| {
                    ui.add(egui::Label::new(&state.status).truncate());
                });
            });
        });
    });
}

fn show_panel_buttons(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    for (command, name) in [
        (Command::Results, "results"),
        (Command::Parameters, "parameters"),
        (Command::Samples, "samples"),
    ] {
        let on = state.is_on(command) == Some(true);
        let button = ui.selectable_label(on, name);
        if button.on_hover_text(command.name()).clicked() {
            intents.push(Intent::Command(command));
        }
    }
}
