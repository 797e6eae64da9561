//! All menu entries, with the mouse and with their keys.

use crate::common::{Window, click, menu, open_menu_and_click, settle, type_number, with_z307};
use brdf_viewer::intent::Command;
use brdf_viewer::output_kind::{FigureFormat, OutputKind};
use brdf_viewer::shortcuts::MENUS;
use brdf_viewer::state::State;
use brdf_viewer::state::fit_run::{FitRun, Progress};
use brdf_viewer::state::interface::Dialog;
use egui_kittest::kittest::Queryable as _;

/// A window in which a command is enabled and has not had its effect.
fn ready(command: Command) -> Window {
    let mut window = with_z307();
    if command != Command::FitAll {
        click(&mut window, "fit both stages");
        type_number(&mut window, "k1", "0.4");
    }
    match command {
        Command::Redo => menu(&mut window, "Edit", "Undo"),
        Command::UnpinAll => menu(&mut window, "Edit", "Pin curves"),
        Command::SystemTheme => window.state_mut().state.interface.dark = Some(true),
        Command::Export(OutputKind::Mesh) => click(&mut window, "Lobe"),
        // A run that does not end by itself, because the worker does not know it.
        Command::Cancel => {
            let scan = window.state().state.active_sample().unwrap().scan_id();
            window.state_mut().state.fit_run = FitRun::new(0, false, &[scan]);
        }
        _ => {}
    }
    window.step();
    window
}

/// Whether a command has had its effect.
fn effect(command: Command, window: &Window) -> bool {
    let state = &window.state().state;
    match command {
        Command::Open | Command::OpenPath => matches!(state.dialog, Some(Dialog::Open { .. })),
        // The fit is not in a file.
        Command::Close | Command::CloseAll => matches!(state.dialog, Some(Dialog::Close { .. })),
        Command::Pin => state.ghosts.len() == 1,
        Command::UnpinAll => state.ghosts.is_empty(),
        Command::Export(kind) => {
            matches!(&state.dialog, Some(Dialog::Export { kind: asked, .. }) if *asked == kind)
        }
        Command::CopyFigure => state.status == "figure copied",
        Command::CopyParameters => state.status == "parameters copied",
        Command::Undo => state.history.can_redo(),
        Command::Redo => !state.history.can_redo() && k1(state) == 0.4,
        Command::ResetAll => k1(state) != 0.4,
        // One wavelength is fitted, and has the parameters of the fit.
        Command::Fit => {
            let scans = &state.samples[0].scans;
            scans[0].current_fit().is_some() && scans[1].last_fit.is_none()
        }
        Command::FitAll => state.samples[0].scans.iter().all(|s| s.last_fit.is_some()),
        Command::Cancel => {
            let run = state.fit_run.as_ref();
            run.is_some_and(|run| run.progress == Progress::Cancelling)
        }
        Command::Quit => is_closing(window),
        Command::ResetZoom => state.zoom_resets == 2,
        Command::About => state.dialog == Some(Dialog::About),
        Command::Samples | Command::Parameters | Command::Results => {
            state.is_on(command) == Some(false)
        }
        _ => state.is_on(command) == Some(true),
    }
}

fn k1(state: &State) -> f64 {
    state.active_sample().unwrap().scan().parameters.values.k1
}

/// Whether the window was asked to close in the last frame.
fn is_closing(window: &Window) -> bool {
    let viewports = &window.output().viewport_output;
    let mut commands = viewports.values().flat_map(|viewport| &viewport.commands);
    commands.any(|command| *command == egui::ViewportCommand::Close)
}

fn commands() -> impl Iterator<Item = (&'static str, Command)> {
    MENUS.iter().flat_map(|menu| {
        menu.entries
            .iter()
            .flatten()
            .map(|command| (menu.title, *command))
    })
}

/// Runs frames until a command has had its effect.
fn check(window: &mut Window, command: Command) {
    let started = std::time::Instant::now();
    loop {
        window.step();
        if effect(command, window) {
            break;
        }
        assert!(started.elapsed().as_secs() < 30, "{command:?}");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let errors = window.state().state.errors();
    assert!(errors.is_empty(), "{command:?}: {errors:?}");
}

#[test]
fn each_menu_entry_has_its_effect() {
    for (title, command) in commands() {
        let mut window = ready(command);
        // The window starts with all incidences in one plot.
        if command != Command::Together {
            assert!(!effect(command, &window), "{command:?}");
        }
        open_menu_and_click(&mut window, title, command.name());
        check(&mut window, command);
    }
}

#[test]
fn each_key_has_the_effect_of_its_menu_entry() {
    for (_, command) in commands() {
        let mut window = ready(command);
        let key = command.shortcut().expect("each entry has a key");
        window.event(egui::Event::Key {
            key: key.logical_key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: key.modifiers,
        });
        check(&mut window, command);
    }
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
fn commands_without_an_object_are_disabled() {
    let mut window = crate::common::empty();
    for command in [
        Command::Close,
        Command::Undo,
        Command::Fit,
        Command::Cancel,
        Command::Export(OutputKind::Fit),
        Command::Export(OutputKind::Figure(FigureFormat::Svg)),
    ] {
        assert!(!window.state().state.is_enabled(command), "{command:?}");
    }
    window.key_press(egui::Key::F5);
    settle(&mut window);
    assert!(window.state().state.fit_run.is_none());
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
            state.samples[0].scan().reading_count() > 0,
            entry.measured,
            "{}",
            entry.name
        );
        assert!(state.errors().is_empty());
    }
}

#[test]
fn side_panels_are_hidden() {
    let mut window = with_z307();
    for name in ["samples", "parameters", "results"] {
        click(&mut window, name);
    }
    assert!(window.query_by_label("fit both stages").is_none());
    assert!(window.query_by_label("Summary").is_none());
    let wide = window.get_by_label("BRDF plot").rect().width();
    assert!(wide > 1000.0, "{wide}");
}
