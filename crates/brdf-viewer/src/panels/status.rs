//! The line at the bottom: what happened last, and what the worker does.

use egui::{Panel, Ui};

use crate::intent::{Command, Intent};
use crate::state::State;

/// Draws the line.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    Panel::bottom("status").show(ui, |ui| {
        ui.horizontal(|ui| {
            if state.reading > 0 {
                ui.label(format!("reading {}", state.reading));
                ui.separator();
            }
            let readings: usize = state.visible().map(|s| s.scan().readings()).sum();
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                for (command, name) in [
                    (Command::Results, "results"),
                    (Command::Parameters, "parameters"),
                    (Command::Samples, "samples"),
                ] {
                    let on = state.is_on(command) == Some(true);
                    let side = ui.selectable_label(on, name);
                    if side.on_hover_text(command.name()).clicked() {
                        intents.push(Intent::Do(command));
                    }
                }
                ui.weak(format!("{readings} readings"));
                // What is left between them belongs to what happened last.
                let rest = egui::Layout::left_to_right(egui::Align::Center);
                ui.with_layout(rest, |ui| {
                    ui.add(egui::Label::new(&state.status).truncate());
                });
            });
        });
    });
}
