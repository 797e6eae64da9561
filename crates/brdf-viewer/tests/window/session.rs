//! The session: what comes back on the next start, what is asked before it is lost, files that change.

use std::path::Path;

use crate::common::{
    NoDialogs, Window, click, drop_path, menu, open_path, settle, shows, type_number, window_with,
    z307,
};
use brdf_viewer::intent::{Command, Intent};
use brdf_viewer::state::saved::{Saved, Settings};
use egui_kittest::kittest::Queryable as _;

const SIZE: [f32; 2] = [1280.0, 800.0];

fn next_session(window: &Window) -> Window {
    let settings = Settings {
        saved: window.state().state.saved(SIZE),
        ..Settings::in_memory()
    };
    let json = serde_json::to_string(&settings.saved).unwrap();
    let saved: Saved = serde_json::from_str(&json).unwrap();
    assert_eq!(saved, settings.saved);
    let mut next = window_with(SIZE, NoDialogs, settings);
    next.state_mut().state.fit_settings.on_opening = true;
    next.state_mut().open_at_start(Vec::new());
    settle(&mut next);
    next
}

fn paint(folder: &Path) -> std::path::PathBuf {
    let path = folder.join("paint.csv");
    std::fs::write(&path, z307()).unwrap();
    path
}

#[test]
fn models_fits_and_choices_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window_with(SIZE, NoDialogs, Settings::in_memory());
    open_path(&mut window, &paint(folder.path()));
    click(&mut window, "use 0° in the fit");
    click(&mut window, "fix kD");
    click(&mut window, "fit both stages");
    window
        .state_mut()
        .state
        .apply(Intent::Command(Command::Residuals));
    let before = window.state().state.active_sample().unwrap().scan().clone();
    let next = next_session(&window);
    let after = next.state().state.active_sample().unwrap().scan();
    assert_eq!(after.parameters, before.parameters);
    assert_eq!(after.left_out(), before.left_out());
    let fits = [&before, after].map(|scan| {
        let report = scan.current_fit().unwrap();
        report.fit.as_ref().unwrap().e_percent
    });
    assert_eq!(fits[0], fits[1]);
    assert!(next.state().state.view.residuals);
}

#[test]
fn edited_parameters_come_back_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window_with(SIZE, NoDialogs, Settings::in_memory());
    open_path(&mut window, &paint(folder.path()));
    type_number(&mut window, "k1", "0.42");
    let next = next_session(&window);
    let scan = next.state().state.active_sample().unwrap().scan();
    assert_eq!(scan.parameters.values.k1, 0.42);
    assert!(scan.last_fit.is_some() && scan.current_fit().is_none());
}

#[test]
fn unsaved_fits_are_asked_for_before_they_are_lost() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window_with(SIZE, NoDialogs, Settings::in_memory());
    open_path(&mut window, &paint(folder.path()));
    click(&mut window, "fit both stages");
    menu(&mut window, "File", "Close sample");
    assert!(shows(&window, "Close without saving?"));
    click(&mut window, "Keep open");
    assert_eq!(window.state().state.samples.len(), 1);
    window.state_mut().state.apply(Intent::Write(
        brdf_viewer::output_kind::OutputKind::Fit,
        folder.path().join("fit"),
    ));
    for _ in 0..500 {
        settle(&mut window);
        if folder.path().join("fit.json").exists() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    settle(&mut window);
    menu(&mut window, "File", "Close sample");
    assert!(window.state().state.samples.is_empty());
}

#[test]
fn a_file_is_opened_once_and_reloaded_when_it_has_changed() {
    let folder = tempfile::tempdir().unwrap();
    let path = paint(folder.path());
    let mut window = window_with(SIZE, NoDialogs, Settings::in_memory());
    open_path(&mut window, &path);
    type_number(&mut window, "k1", "0.42");
    drop_path(&mut window, &path);
    assert_eq!(window.state().state.samples.len(), 1);
    // One reading fewer, and a later time.
    let text = z307();
    let shorter = text.trim_end().rsplit_once('\n').unwrap().0;
    std::fs::write(&path, shorter).unwrap();
    let later = std::time::SystemTime::now() + std::time::Duration::from_secs(5);
    let file = std::fs::File::options().write(true).open(&path).unwrap();
    file.set_modified(later).unwrap();
    window.event(egui::Event::WindowFocused(true));
    settle(&mut window);
    assert!(shows(&window, "changed on disk"));
    click(&mut window, "reload paint");
    let state = &window.state().state;
    let sample = state.active_sample().unwrap();
    let readings: usize = sample
        .scans
        .iter()
        .map(brdf_viewer::state::sample::Scan::reading_count)
        .sum();
    assert_eq!((state.samples.len(), readings), (1, 223));
    assert_eq!(sample.scan().parameters.values.k1, 0.42);
    assert!(window.query_by_label("reload paint").is_none());
}

#[test]
fn one_error_is_told_once_and_all_are_dismissed_together() {
    let mut window = window_with(SIZE, NoDialogs, Settings::in_memory());
    for name in ["/no/such/file.csv", "/no/such/file.csv", "/no/other.csv"] {
        window
            .state_mut()
            .state
            .apply(Intent::Open(vec![name.into()]));
        settle(&mut window);
    }
    assert_eq!(window.state().state.errors().len(), 2);
    click(&mut window, "Dismiss all");
    assert!(window.state().state.messages.is_empty());
}
