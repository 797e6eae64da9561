//! The menu bar, with the key of each command.

use brdf_fit::{Convention, Side};
use egui::{Button, MenuBar, Panel, Ui};

use crate::intent::{Command, Intent};
use crate::platform::Host;
use crate::platform::current::CurrentHost;
use crate::shortcuts::{MENUS, Menu};
use crate::state::{State, built_in};

/// Draws the menu bar.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    Panel::top("menu").show(ui, |ui| {
        MenuBar::new().ui(ui, |ui| {
            for (i, menu) in MENUS.iter().enumerate() {
                ui.menu_button(menu.title, |ui| show_entries(ui, state, menu, intents));
                if i == 0 {
                    ui.menu_button("Built-in", |ui| show_built_in(ui, intents));
                }
            }
        });
    });
}

fn show_entries(ui: &mut Ui, state: &State, menu: &Menu, intents: &mut Vec<Intent>) {
    let is_offered = |entry: &Option<Command>| entry.is_some_and(CurrentHost::offers);
    for (i, entry) in menu.entries.iter().enumerate() {
        match entry {
            Some(command) if CurrentHost::offers(*command) => {
                show_command(ui, state, *command, intents);
            }
            None if menu.entries[i..].iter().any(is_offered) => {
                ui.separator();
            }
            Some(_) | None => {}
        }
        if *entry == Some(Command::OpenPath) {
            show_recent(ui, state, intents);
            show_convention(ui, state.convention, intents);
        }
    }
}

fn show_command(ui: &mut Ui, state: &State, command: Command, intents: &mut Vec<Intent>) {
    let mut button = Button::new(command.name());
    if let Some(shortcut) = command.shortcut() {
        button = button.shortcut_text(ui.ctx().format_shortcut(&shortcut));
    }
    if let Some(on) = state.is_on(command) {
        button = button.selected(on);
    }
    if ui.add_enabled(state.is_enabled(command), button).clicked() {
        intents.push(Intent::Command(command));
        ui.close();
    }
}

fn show_recent(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    ui.add_enabled_ui(!state.recent.is_empty(), |ui| {
        ui.menu_button("Open recent", |ui| {
            for path in &state.recent {
                if ui.button(path.display().to_string()).clicked() {
                    intents.push(Intent::Open(vec![path.clone()]));
                    ui.close();
                }
            }
        });
    });
}

/// The angular convention in which files are read from now on.
fn show_convention(ui: &mut Ui, convention: Convention, intents: &mut Vec<Intent>) {
    let sides = [
        ("the source side", Side::Source),
        ("the forward side", Side::Forward),
    ];
    ui.menu_button("Angles in files", |ui| {
        for (name, side) in sides {
            let choice = Convention {
                theta_positive: side,
                ..convention
            };
            let text = format!("theta positive on {name}");
            if ui.radio(choice == convention, text).clicked() {
                intents.push(Intent::Convention(choice));
            }
        }
        ui.separator();
        for (name, side) in sides {
            let choice = Convention {
                phi_zero: side,
                ..convention
            };
            let text = format!("phi zero on {name}");
            if ui.radio(choice == convention, text).clicked() {
                intents.push(Intent::Convention(choice));
            }
        }
    });
}

fn show_built_in(ui: &mut Ui, intents: &mut Vec<Intent>) {
    let mut measured = None;
    for (i, entry) in built_in::entries().into_iter().enumerate() {
        if measured.replace(entry.measured) != Some(entry.measured) {
            ui.weak(if entry.measured {
                "Measured samples"
            } else {
                "Theory with the parameters of the paper"
            });
        }
        if ui.button(entry.name).clicked() {
            intents.push(Intent::OpenBuiltIn(i));
            ui.close();
        }
    }
}
