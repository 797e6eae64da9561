//! The viewer's own dialogs: the path of a file, and what this is.

use egui::{Context, Grid, Id, Key, Modal, TextEdit, Ui};

use crate::intent::Intent;
use crate::shortcuts::MENUS;
use crate::state::State;
use crate::state::interface::Dialog;

/// Draws the dialog that is open. `browse` says whether the system has dialogs for files.
pub fn show(ctx: &Context, state: &State, browse: bool, intents: &mut Vec<Intent>) {
    let Some(dialog) = &state.dialog else {
        return;
    };
    let modal = Modal::new(Id::unique("dialog")).show(ctx, |ui| match dialog {
        Dialog::Open { path } => {
            ui.heading("Open a scan, or a fit as JSON");
            show_path(ui, path, "Open", browse, intents);
        }
        Dialog::Export { what, path } => {
            ui.heading(format!("Write {}", what.name()));
            show_path(ui, path, "Write", browse, intents);
            if std::path::Path::new(path.trim()).exists() {
                ui.colored_label(ui.visuals().warn_fg_color, "This file will be replaced.");
            }
        }
        Dialog::About => show_about(ui, intents),
    });
    if modal.should_close() {
        intents.push(Intent::CloseDialog);
    }
}

fn show_path(ui: &mut Ui, path: &str, verb: &str, browse: bool, intents: &mut Vec<Intent>) {
    let mut text = path.to_owned();
    let label = ui.label("Path of the file");
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
        let some = !text.trim().is_empty();
        let pressed = ui.add_enabled(some, egui::Button::new(verb)).clicked();
        if pressed || (entered && some) {
            intents.push(Intent::Confirm);
        }
        let hint = "no dialog for files was found on this system";
        let button = ui.add_enabled(browse, egui::Button::new("Browse..."));
        if button.on_disabled_hover_text(hint).clicked() {
            intents.push(Intent::Browse);
        }
        if ui.button("Cancel").clicked() {
            intents.push(Intent::CloseDialog);
        }
    });
}

fn show_about(ui: &mut Ui, intents: &mut Vec<Intent>) {
    ui.heading("Theory against experiment for each incidence angle");
    ui.label(
        "The three-parameter BRDF of Li, Yan and Wu (Acta Optica Sinica 22(7), 769, 2002), fitted \
         in two stages to goniometer scans.",
    );
    ui.label(format!("Version {}", env!("CARGO_PKG_VERSION")));
    ui.separator();
    let commands = MENUS.iter().flat_map(|menu| menu.entries.iter().flatten());
    let keys: Vec<(String, &str)> = commands
        .filter_map(|command| {
            let key = ui.ctx().format_shortcut(&command.shortcut()?);
            Some((key, command.name()))
        })
        .chain([
            ("Drag".to_owned(), "Pan the plot"),
            ("Ctrl+scroll".to_owned(), "Zoom the plot"),
            ("Right drag".to_owned(), "Zoom into a rectangle"),
            (
                "Double click".to_owned(),
                "Reset a slider, or the zoom of a plot",
            ),
            (
                "Ctrl+plus, Ctrl+minus".to_owned(),
                "Everything larger, smaller",
            ),
        ])
        .collect();
    Grid::new("keys")
        .num_columns(4)
        .striped(true)
        .show(ui, |ui| {
            for pair in keys.chunks(2) {
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
