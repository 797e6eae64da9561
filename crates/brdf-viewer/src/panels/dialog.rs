//! The dialogs of the viewer: file paths, and the version with the keys.

use egui::{Context, Grid, Id, Key, Modal, TextEdit, Ui};

use crate::intent::Intent;
use crate::platform::Host;
use crate::platform::current::CurrentHost;
use crate::shortcuts::MENUS;
use crate::state::State;
use crate::state::id::SampleId;
use crate::state::interface::Dialog;

/// Draws the open dialog. `browse` is whether the system has file dialogs.
pub fn show(ctx: &Context, state: &State, browse: bool, intents: &mut Vec<Intent>) {
    let Some(dialog) = &state.dialog else {
        return;
    };
    let modal = Modal::new(Id::unique("dialog")).show(ctx, |ui| match dialog {
        Dialog::Open { path } => {
            ui.heading("Open a scan, or a fit as JSON");
            show_path(ui, path, "Open", browse, intents);
        }
        Dialog::Export { kind, path } => {
            ui.heading(format!("Save {}", kind.name()));
            show_path(ui, path, "Save", browse, intents);
            if std::path::Path::new(path.trim()).exists() {
                ui.colored_label(
                    ui.visuals().warn_fg_color,
                    "This file exists and will be replaced.",
                );
            }
        }
        Dialog::Close { samples } => show_close(ui, state, samples, intents),
        Dialog::About => show_about(ui, intents),
    });
    if modal.should_close() {
        intents.push(Intent::CloseDialog);
    }
}

fn show_path(ui: &mut Ui, path: &str, verb: &str, browse: bool, intents: &mut Vec<Intent>) {
    let mut text = path.to_owned();
    let label = ui.label("File path");
    let edit = TextEdit::singleline(&mut text).desired_width(460.0);
    let response = ui.add(edit).labelled_by(label.id);
    let entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    if !entered && ui.memory(|memory| memory.focused().is_none()) {
        response.request_focus();
    }
    if text != path {
        intents.push(Intent::Path(text.clone()));
    }
    ui.horizontal(|ui| {
        let has_path = !text.trim().is_empty();
        let pressed = ui.add_enabled(has_path, egui::Button::new(verb)).clicked();
        if pressed || (entered && has_path) {
            intents.push(Intent::Confirm);
        }
        let hint = "No file dialog of the system is available";
        let button = ui.add_enabled(browse, egui::Button::new("Browse..."));
        if button.on_disabled_hover_text(hint).clicked() {
            intents.push(Intent::Browse);
        }
        if ui.button("Cancel").clicked() {
            intents.push(Intent::CloseDialog);
        }
    });
}

/// Asks whether samples are closed in spite of work that is not in a file.
fn show_close(ui: &mut Ui, state: &State, samples: &[SampleId], intents: &mut Vec<Intent>) {
    ui.heading("Close without saving?");
    let unsaved = samples.iter().filter_map(|id| state.sample(*id));
    let names: Vec<&str> = unsaved
        .filter(|sample| sample.has_unsaved_work())
        .map(|sample| sample.name.as_str())
        .collect();
    ui.label(format!(
        "Fits or choices of readings are not saved in a file: {}. \"Save fit as JSON\" in the menu \
         File keeps them.",
        names.join(", ")
    ));
    ui.horizontal(|ui| {
        if ui.button("Close without saving").clicked() {
            intents.push(Intent::CloseUnsaved(samples.to_vec()));
        }
        if ui.button("Keep open").clicked() {
            intents.push(Intent::CloseDialog);
        }
    });
}

fn show_about(ui: &mut Ui, intents: &mut Vec<Intent>) {
    ui.heading("Theory and measurement for each incidence angle");
    ui.label(
        "The three-parameter BRDF of Li, Yan and Wu (Acta Optica Sinica 22(7), 769, 2002), fitted \
         in two stages to goniometer scans.",
    );
    if let Some(note) = CurrentHost::NOTE {
        ui.label(note);
    }
    ui.label(format!("Version {}", env!("CARGO_PKG_VERSION")));
    ui.separator();
    Grid::new("keys")
        .num_columns(4)
        .striped(true)
        .show(ui, |ui| {
            for pair in keys(ui.ctx()).chunks(2) {
                for (key, name) in pair {
                    ui.strong(key);
                    ui.label(*name);
                }
                ui.end_row();
            }
        });
    if ui.button("Close").clicked() {
        intents.push(Intent::CloseDialog);
    }
}

/// All keys and pointer actions with their effects.
fn keys(ctx: &Context) -> Vec<(String, &'static str)> {
    let commands = MENUS.iter().flat_map(|menu| menu.entries.iter().flatten());
    let of_commands = commands.filter_map(|command| {
        let key = ctx.format_shortcut(&command.shortcut()?);
        Some((key, command.name()))
    });
    let others = [
        ("Drag", "Pan the plot"),
        ("Ctrl+scroll", "Zoom the plot"),
        ("Right drag", "Zoom into a rectangle"),
        ("Double click", "Reset a slider, or the zoom of a plot"),
        ("Ctrl+plus, Ctrl+minus", "Zoom the window"),
    ];
    let others = others.map(|(key, name)| (key.to_owned(), name));
    of_commands.chain(others).collect()
}
