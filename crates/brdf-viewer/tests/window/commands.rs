//! Every entry of every menu, by the mouse and by its key.

use crate::common::{Window, click, menu, settle, type_number, with_z307};
use brdf_viewer::intent::{Command, Export, Picture};
use brdf_viewer::shortcuts::MENUS;
use brdf_viewer::state::State;
use brdf_viewer::state::interface::Dialog;
use egui_kittest::kittest::Queryable as _;

/// A window in which every command but redoing and cancelling can be carried out.
fn ready() -> Window {
    let mut window = with_z307();
    click(&mut window, "Both stages");
    type_number(&mut window, "k1", "0.4");
    window
}

/// What a command has done, read back from the state; `None` where it shows otherwise.
fn effect(command: Command, state: &State) -> bool {
    match command {
        Command::Open | Command::OpenPath => matches!(state.dialog, Some(Dialog::Open { .. })),
        Command::Close | Command::CloseAll => state.samples.is_empty(),
        Command::Export(what) => {
            matches!(&state.dialog, Some(Dialog::Export { what: asked, .. }) if *asked == what)
        }
        Command::CopyParameters => state.status == "parameters copied",
        Command::Undo => state.history.can_redo(),
        Command::ResetAll | Command::Fit => k1(state) != 0.4,
        Command::FitAll => state.samples[0]
            .scans
            .iter()
            .all(|scan| scan.fitted.is_some()),
        Command::ResetZoom => state.zoom_resets == 2,
        Command::About => state.dialog == Some(Dialog::About),
        // Those that switch are looked at by themselves, the others cannot be carried out here.
        _ => true,
    }
}

fn k1(state: &State) -> f64 {
    state.active_sample().unwrap().scan().knobs.at.k1
}

fn commands() -> impl Iterator<Item = (&'static str, Command)> {
    MENUS.iter().flat_map(|menu| {
        menu.entries
            .iter()
            .flatten()
            .map(|command| (menu.title, *command))
    })
}

#[test]
fn each_entry_of_the_menus_does_what_it_says() {
    for (title, command) in commands() {
        let mut window = ready();
        let before = window.state().state.is_on(command);
        assert!(
            !effect(command, &window.state().state) || is_silent(command),
            "{command:?}"
        );
        menu(&mut window, title, command.name());
        check(&window, command, before);
    }
}

#[test]
fn each_key_does_what_its_entry_says() {
    for (_, command) in commands() {
        let mut window = ready();
        let before = window.state().state.is_on(command);
        let key = command.shortcut().expect("an entry without a key");
        window.key_press_modifiers(key.modifiers, key.logical_key);
        settle(&mut window);
        check(&window, command, before);
    }
}

/// Whether a command shows nothing in the state when all is well.
fn is_silent(command: Command) -> bool {
    let switches = State::default().is_on(command).is_some();
    switches || matches!(command, Command::Quit | Command::Redo | Command::Cancel)
}

fn check(window: &Window, command: Command, before: Option<bool>) {
    let state = &window.state().state;
    assert!(effect(command, state), "{command:?}");
    let after = state.is_on(command);
    match command {
        Command::Together => assert_eq!(after, Some(true)),
        _ => assert_eq!(after, before.map(|on| !on), "{command:?}"),
    }
    assert!(
        state.errors().is_empty(),
        "{command:?}: {:?}",
        state.errors()
    );
}

#[test]
fn no_two_commands_have_the_same_key() {
    let keys: Vec<_> = commands()
        .filter_map(|(_, command)| command.shortcut())
        .collect();
    for (i, key) in keys.iter().enumerate() {
        assert!(!keys[..i].contains(key), "{key:?}");
    }
}

#[test]
fn quit_asks_the_window_to_close() {
    let mut window = ready();
    window.event(egui::Event::Key {
        key: egui::Key::Q,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: egui::Modifiers::COMMAND,
    });
    window.step();
    let viewports = &window.output().viewport_output;
    let mut commands = viewports.values().flat_map(|viewport| &viewport.commands);
    let closed = commands.any(|command| *command == egui::ViewportCommand::Close);
    assert!(closed);
}

#[test]
fn commands_that_cannot_be_carried_out_are_grey() {
    let mut window = crate::common::empty();
    for command in [
        Command::Close,
        Command::Undo,
        Command::Fit,
        Command::Cancel,
        Command::Export(Export::Fit),
        Command::Export(Export::Figure(Picture::Svg)),
    ] {
        assert!(!window.state().state.is_enabled(command), "{command:?}");
    }
    window.key_press(egui::Key::F5);
    settle(&mut window);
    assert!(window.state().state.run.is_none());
}

#[test]
fn every_built_in_sample_opens() {
    for (i, entry) in brdf_viewer::state::built_in::entries()
        .into_iter()
        .enumerate()
    {
        let mut window = crate::common::empty();
        crate::common::open_built_in(&mut window, &entry.name);
        let state = &window.state().state;
        assert_eq!(state.samples.len(), 1, "{i}");
        assert_eq!(
            state.samples[0].scan().readings() > 0,
            entry.measured,
            "{}",
            entry.name
        );
        assert!(state.errors().is_empty());
    }
}

#[test]
fn the_sides_of_the_window_are_hidden_and_shown() {
    let mut window = with_z307();
    for name in ["samples", "parameters", "results"] {
        click(&mut window, name);
    }
    assert!(window.query_by_label("Both stages").is_none());
    assert!(window.query_by_label("Tables").is_none());
    let wide = window.get_by_label("BRDF plot").rect().width();
    assert!(wide > 1000.0, "{wide}");
}
