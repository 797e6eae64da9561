//! Opening and writing of files: dialogs, dropped files, exports, recent files, and the settings saved
//! between sessions.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use crate::common::{
    NoDialogs, Window, click, click_role, drop_file, drop_path, empty, enter_path, menu,
    open_built_in, open_path, settle, shows, type_number, window_with, with_z307, z307,
};
use brdf_fit::report::{Depth, Document, Report};
use brdf_fit::{Convention, FitOptions, Measurements, RefractiveIndex, Side};
use brdf_viewer::events::EventSender;
use brdf_viewer::intent::Intent;
use brdf_viewer::job::Event;
use brdf_viewer::output_kind::OutputKind;
use brdf_viewer::platform::Dialogs;
use brdf_viewer::platform::current::SettingsFile;
use brdf_viewer::state::saved::Settings;
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;

fn names(window: &Window) -> Vec<String> {
    window
        .state()
        .state
        .samples
        .iter()
        .map(|sample| sample.name.clone())
        .collect()
}

#[test]
fn a_path_is_opened_and_remembered() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("paint.csv");
    std::fs::write(&path, z307()).unwrap();
    let mut window = empty();
    open_path(&mut window, &path);
    assert_eq!(names(&window), ["paint"]);
    assert_eq!(window.state().state.samples[0].scans.len(), 2);
    assert_eq!(window.state().state.recent, std::slice::from_ref(&path));
    menu(&mut window, "File", "Close all samples");
    assert!(names(&window).is_empty());
    window.get_by_role_and_label(Role::Button, "File").click();
    window.run();
    window.get_by_label_contains("Open recent").hover();
    window.run();
    window.get_by_label_contains("Open recent").click();
    window.run();
    window.get_by_label(&path.display().to_string()).click();
    settle(&mut window);
    assert_eq!(names(&window), ["paint"]);
}

#[test]
fn an_invalid_file_is_reported_with_line_and_value_and_the_data_stay() {
    let mut window = with_z307();
    let before = names(&window);
    drop_file(
        &mut window,
        "bad.csv",
        "psi_deg,theta_deg,brdf_per_sr\n10,0,0.1\n9x,0,0.2\n",
    );
    assert_eq!(names(&window), before);
    let error = &window.state().state.errors()[0];
    for part in ["bad.csv", "line 3", "psi_deg", "9x"] {
        assert!(error.contains(part), "{error}");
    }
    assert!(window.query_by_label(error.as_str()).is_some());
    click(&mut window, "Dismiss");
    assert!(window.state().state.messages.is_empty());
    open_path(&mut window, Path::new("/no/such/file.csv"));
    assert!(window.state().state.errors()[0].contains("/no/such/file.csv"));
    open_path(&mut window, Path::new("/no/such/fit.json"));
    assert!(window.state().state.errors()[1].contains("/no/such/fit.json"));
    assert_eq!(names(&window), before);
}

#[test]
fn a_valid_file_is_dropped() {
    let mut window = empty();
    drop_file(&mut window, "a.csv", &z307());
    assert_eq!(names(&window), ["a"]);
    assert!(shows(&window, "112 readings"));
}

/// Dialogs that answer immediately.
struct Answers {
    open: PathBuf,
    write: PathBuf,
}

impl Dialogs for Answers {
    fn available(&self) -> bool {
        true
    }
    fn open(&self, events: EventSender) {
        events.send(Event::FilesChosen(vec![self.open.clone()]));
    }
    fn export(&self, kind: OutputKind, suggested: &Path, events: EventSender) {
        assert!(suggested.extension().is_some());
        events.send(Event::OutputChosen(kind, self.write.clone()));
    }
}

#[test]
fn the_dialogs_of_the_system_are_used_if_available() {
    let folder = tempfile::tempdir().unwrap();
    let open = folder.path().join("in.csv");
    std::fs::write(&open, z307()).unwrap();
    let write = folder.path().join("out.csv");
    let answers = Answers {
        open: open.clone(),
        write: write.clone(),
    };
    let mut window = window_with([1280.0, 800.0], answers, Settings::in_memory());
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::O);
    settle(&mut window);
    settle(&mut window);
    assert_eq!(names(&window), ["in"]);
    menu(&mut window, "File", "Export theory and readings as CSV...");
    settle(&mut window);
    wait_for(&mut window, &write);
    // The dialog of the viewer can open that of the system.
    menu(&mut window, "File", "Open path...");
    click(&mut window, "Browse...");
    settle(&mut window);
    assert_eq!(names(&window), ["in"]);
    assert!(window.state().state.status.contains("is open already"));
}

fn wait_for(window: &mut Window, path: &Path) {
    for _ in 0..2000 {
        window.step();
        if path.exists() {
            settle(window);
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    panic!("{} was not written", path.display());
}

#[test]
fn the_figure_is_written_as_svg_and_png() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = with_z307();
    click(&mut window, "fit both stages");
    let (svg, png) = (folder.path().join("a.svg"), folder.path().join("a.png"));
    for layout in ["Together", "Panels", "Polar"] {
        click(&mut window, layout);
        write(&mut window, "Export figure as SVG...", &svg);
        let text = std::fs::read_to_string(&svg).unwrap();
        assert!(
            text.contains("<svg") && text.contains("psi = 70 deg"),
            "{layout}"
        );
        write(&mut window, "Export figure as PNG...", &png);
        let image = image::open(&png).unwrap();
        assert!(image.width() >= 2000, "{}", image.width());
        let pixels = image.to_rgb8();
        assert!(
            pixels
                .pixels()
                .filter(|p| p.0.iter().all(|c| *c < 120))
                .count()
                > 1000
        );
    }
}

/// Writes a file, which may exist, and waits for it.
fn write(window: &mut Window, entry: &str, path: &Path) {
    let _ = std::fs::remove_file(path);
    menu(window, "File", entry);
    enter_path(window, path);
    click_role(window, Role::Button, "Save");
    wait_for(window, path);
}

#[test]
fn theory_and_readings_are_written_for_the_current_parameters() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("curves.csv");
    let mut window = with_z307();
    type_number(&mut window, "k1", "0.25");
    write(&mut window, "Export theory and readings as CSV...", &path);
    let brdf = window
        .state()
        .state
        .active_sample()
        .unwrap()
        .scan()
        .parameters
        .brdf()
        .unwrap();
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path(&path)
        .unwrap();
    let columns = reader.headers().unwrap().clone();
    let column = |name: &str| columns.iter().position(|c| c == name).unwrap();
    let (psi, theta) = (column("psi_deg"), column("theta_deg"));
    let (theory, measured) = (column("theory_per_sr"), column("measured_per_sr"));
    let mut rows = 0;
    for row in reader.records().map(Result::unwrap) {
        let value = |i: usize| row[i].parse::<f64>().unwrap();
        let at = brdf_core::Geometry::in_plane(value(psi).to_radians(), value(theta).to_radians());
        let expected = brdf.value(&at.unwrap());
        assert!((value(theory) - expected).abs() < 1e-9 * expected);
        rows += usize::from(!row[measured].is_empty());
    }
    assert_eq!(rows, 112);
}

#[test]
fn a_fit_is_written_and_read_back_to_the_last_digit() {
    let folder = tempfile::tempdir().unwrap();
    let (scan, json) = (
        folder.path().join("paint.csv"),
        folder.path().join("fit.json"),
    );
    std::fs::write(&scan, z307()).unwrap();
    let mut window = empty();
    open_path(&mut window, &scan);
    click(&mut window, "Fit all");
    export_fit(&mut window, &json);
    let document = Document::read(&json).unwrap();
    assert_eq!(document.reports.len(), 2);
    let parameters = |window: &Window| {
        let scans = &window.state().state.active_sample().unwrap().scans;
        scans
            .iter()
            .map(|scan| scan.parameters.values)
            .collect::<Vec<_>>()
    };
    let fitted = parameters(&window);
    menu(&mut window, "File", "Close all samples");
    open_path(&mut window, &json);
    assert_eq!(parameters(&window), fitted);
    assert!(shows(&window, "verdict"));
    // The scan is found if it was moved together with the fit.
    let moved = tempfile::tempdir().unwrap();
    std::fs::rename(&scan, moved.path().join("paint.csv")).unwrap();
    std::fs::rename(&json, moved.path().join("fit.json")).unwrap();
    menu(&mut window, "File", "Close all samples");
    open_path(&mut window, &moved.path().join("fit.json"));
    assert_eq!(parameters(&window), fitted);
    std::fs::remove_file(moved.path().join("paint.csv")).unwrap();
    menu(&mut window, "File", "Close all samples");
    open_path(&mut window, &moved.path().join("fit.json"));
    assert!(window.state().state.errors()[0].contains("cannot be found"));
}

fn export_fit(window: &mut Window, path: &Path) {
    write(window, "Save fit as JSON...", path);
}

#[test]
fn a_fit_of_a_built_in_sample_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("fit.json");
    let mut window = with_z307();
    click(&mut window, "fit both stages");
    export_fit(&mut window, &json);
    menu(&mut window, "File", "Close all samples");
    open_path(&mut window, &json);
    assert!(
        window
            .state()
            .state
            .active_sample()
            .unwrap()
            .scan()
            .current_fit()
            .is_some()
    );
}

#[test]
fn a_fit_that_names_a_fit_as_its_scan_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("fit.json");
    let mut window = with_z307();
    click(&mut window, "fit both stages");
    export_fit(&mut window, &json);
    let text = std::fs::read_to_string(&json).unwrap();
    let itself = text.replace("data/measured/z307_on_aluminium.csv", "fit.json");
    assert_ne!(itself, text);
    std::fs::write(&json, itself).unwrap();
    open_path(&mut window, &json);
    let error = &window.state().state.errors()[0];
    assert!(error.contains("fit.json, line 1"), "{error}");
}

#[test]
fn the_angular_convention_of_a_file_is_chosen_by_the_user() {
    let folder = tempfile::tempdir().unwrap();
    let (scan, json) = (
        folder.path().join("turned.csv"),
        folder.path().join("fit.json"),
    );
    let rows = "psi_deg,theta_deg,brdf_per_sr\n30,-30,0.1\n30,0,0.2\n30,30,0.9\n30,45,0.5\n";
    std::fs::write(&scan, rows).unwrap();
    let mut window = empty();
    menu(&mut window, "File", "Angles in files");
    window
        .get_by_label("theta positive on the forward side")
        .click();
    window.run();
    open_path(&mut window, &scan);
    let check = |window: &Window| {
        let measurements = &window
            .state()
            .state
            .active_sample()
            .unwrap()
            .scan()
            .measurements;
        let brightest = measurements.readings()[2];
        assert!((brightest.theta + 30_f64.to_radians()).abs() < 1e-12);
        assert_eq!(measurements.convention.theta_positive, Side::Forward);
    };
    check(&window);
    click(&mut window, "Stage 1");
    export_fit(&mut window, &json);
    // A fit stores the convention of its scan, which overrides the one for the next file.
    menu(&mut window, "File", "Close all samples");
    let convention = Convention::default();
    window
        .state_mut()
        .state
        .apply(Intent::Convention(convention));
    open_path(&mut window, &json);
    check(&window);
    let saved = window.state().state.saved([900.0, 600.0]);
    assert_eq!(saved.open[0].convention.theta_positive, Side::Forward);
    assert_eq!(saved.convention, convention);
}

#[test]
fn scans_of_other_formats_and_their_fits_are_opened() {
    let folder = tempfile::tempdir().unwrap();
    let scan = folder.path().join("beam.astm");
    let json = folder.path().join("fit.json");
    let text = "REFRACTIVE_INDEX 1.5\nANGLE_UNIT deg\nVARS theta_i theta_s phi_s BRDF\n\
                30 30 0 0.9\n30 0 0 0.2\n30 -45 0 0.1\n30 60 0 0.5\n";
    std::fs::write(&scan, text).unwrap();
    let check = |window: &Window| {
        let sample = window.state().state.active_sample().unwrap();
        let measurements = &sample.scan().measurements;
        // The format defines azimuth 0 as forward, independently of the menu.
        let theta = measurements.readings()[0].in_plane_theta().unwrap();
        assert!((theta + 30_f64.to_radians()).abs() < 1e-12);
        assert_eq!(measurements.format, brdf_fit::Format::Astm);
    };
    let mut window = empty();
    open_path(&mut window, &scan);
    check(&window);
    click(&mut window, "Stage 1");
    export_fit(&mut window, &json);
    menu(&mut window, "File", "Close all samples");
    open_path(&mut window, &json);
    check(&window);
}

#[test]
fn a_table_is_opened_as_a_goniometer_scan() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("paint.binary");
    // 6 x 5 x 8 bins of three channels, with different values.
    let mut bytes = [6_i32, 5, 8].map(i32::to_le_bytes).concat();
    for value in [150.0_f64, 300.0, 450.0] {
        bytes.extend((0..240).flat_map(|bin| (value + f64::from(bin)).to_le_bytes()));
    }
    std::fs::write(&table, bytes).unwrap();
    let mut window = empty();
    open_path(&mut window, &table);
    let sample = window.state().state.active_sample().unwrap();
    let wavelengths: Vec<_> = sample
        .scans
        .iter()
        .map(brdf_viewer::state::sample::Scan::wavelength_um)
        .collect();
    assert_eq!(wavelengths, [0.464, 0.549, 0.611].map(Some));
    let incidences: Vec<f64> = sample
        .scan()
        .incidences
        .iter()
        .map(|i| i.psi.to_degrees())
        .collect();
    assert_eq!(incidences.len(), 9);
    assert!((incidences[8] - 80.0).abs() < 1e-9);
    // The fit is of all bins, as that of the command line.
    assert!(shows(&window, "The fit is of all bins of the table"));
    click(&mut window, "fit both stages");
    let lazy = brdf_fit::LazyScan::open(&table, &brdf_fit::ReadOptions::default()).unwrap();
    let all = lazy[0].measurements().unwrap();
    let scan = window.state().state.active_sample().unwrap().scan();
    let found = scan.current_fit().unwrap().fit.clone().unwrap();
    let options = &found.options;
    let expected = brdf_fit::fit(&all, options).unwrap();
    assert_eq!(found.readings, all.readings().len());
    assert_eq!(found.at(), expected.at());
    assert_eq!(found.e_percent, expected.e_percent);
}

#[test]
fn an_open_scan_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let scan = folder.path().join("paint.csv");
    std::fs::write(&scan, z307()).unwrap();
    let mut window = empty();
    open_path(&mut window, &scan);
    menu(&mut window, "File", "Export theory and readings as CSV...");
    enter_path(&mut window, &scan);
    assert!(
        window
            .query_by_label("This file exists and will be replaced.")
            .is_some()
    );
    click_role(&mut window, Role::Button, "Save");
    assert!(window.state().state.errors()[0].contains("is an open scan"));
    assert_eq!(std::fs::read_to_string(&scan).unwrap(), z307());
    menu(&mut window, "File", "Export figure as SVG...");
    enter_path(&mut window, Path::new("/no/such/folder/a.svg"));
    click_role(&mut window, Role::Button, "Save");
    for _ in 0..400 {
        window.step();
        std::thread::sleep(std::time::Duration::from_millis(5));
        if window.state().state.errors().len() > 1 {
            break;
        }
    }
    assert!(window.state().state.errors()[1].contains("/no/such/folder/a.svg"));
}

#[test]
fn the_parameter_table_goes_to_the_clipboard() {
    let mut window = with_z307();
    click(&mut window, "fit both stages");
    window.get_by_role_and_label(Role::Button, "Edit").click();
    window.run();
    window.get_by_label_contains("Copy parameter table").click();
    let mut copied = String::new();
    for _ in 0..4 {
        window.step();
        for command in &window.output().platform_output.commands {
            if let egui::OutputCommand::CopyText(text) = command {
                copied.clone_from(text);
            }
        }
    }
    let parameters = window
        .state()
        .state
        .active_sample()
        .unwrap()
        .scan()
        .parameters;
    assert!(
        copied.contains(&format!("k2\t{}\t", parameters.values.k2)),
        "{copied}"
    );
    assert_eq!(copied.lines().count(), 5);
    assert!(
        copied
            .lines()
            .nth(1)
            .unwrap()
            .split('\t')
            .all(|cell| !cell.is_empty())
    );
}

#[test]
fn the_settings_of_the_last_session_are_restored() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.json");
    let settings = || Settings::load(Some(Rc::new(SettingsFile::new(path.clone()))));
    let mut window = window_with([1000.0, 700.0], NoDialogs, settings());
    window.state_mut().open_at_start(Vec::new());
    settle(&mut window);
    assert_eq!(names(&window), ["z307_on_aluminium"]);
    click(&mut window, "log");
    menu(&mut window, "View", "Polar plot");
    drop(window);
    let mut again = window_with([1000.0, 700.0], NoDialogs, settings());
    again.state_mut().open_at_start(Vec::new());
    settle(&mut again);
    let view = again.state().state.view;
    assert_eq!(view.layout, brdf_fit::plot::Layout::Polar);
    assert_eq!(view.scale, brdf_fit::plot::Scale::Logarithmic);
    assert_eq!(names(&again), ["z307_on_aluminium"]);
    drop(again);
    std::fs::write(&path, "{\"version\": 1, \"view\": nonsense").unwrap();
    let damaged = window_with([1000.0, 700.0], NoDialogs, settings());
    assert_eq!(damaged.state().state.view, brdf_fit::plot::View::default());
    assert!(damaged.query_by_label_contains("state.json").is_some());
}

#[test]
fn a_path_is_entered_with_the_keyboard_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("paint.csv");
    std::fs::write(&path, z307()).unwrap();
    let mut window = empty();
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::O);
    settle(&mut window);
    // The text field has the focus without a click.
    window.event(egui::Event::Text(path.display().to_string()));
    window.run();
    window.key_press(egui::Key::Enter);
    settle(&mut window);
    assert_eq!(names(&window), ["paint"]);
}

#[test]
fn without_dialogs_of_the_system_the_viewer_asks_for_a_path() {
    let mut window = empty();
    menu(&mut window, "File", "Open...");
    assert!(
        window
            .query_by_role_and_label(Role::TextInput, "File path")
            .is_some()
    );
    window.key_press(egui::Key::Escape);
    settle(&mut window);
    assert!(window.state().state.dialog.is_none());
}

/// Tries to write a file, and returns the error.
fn refused(window: &mut Window, entry: &str, path: &Path) -> String {
    let before = window.state().state.errors().len();
    menu(window, "File", entry);
    enter_path(window, path);
    click_role(window, Role::Button, "Save");
    let errors = window.state().state.errors();
    assert_eq!(errors.len(), before + 1, "{errors:?}");
    errors.last().unwrap().clone()
}

#[test]
fn a_scan_opened_through_its_fit_is_not_overwritten_but_the_fit_is() {
    let folder = tempfile::tempdir().unwrap();
    let (scan, json) = (
        folder.path().join("paint.csv"),
        folder.path().join("fit.json"),
    );
    std::fs::write(&scan, z307()).unwrap();
    let mut window = empty();
    open_path(&mut window, &scan);
    click(&mut window, "fit both stages");
    export_fit(&mut window, &json);
    menu(&mut window, "File", "Close all samples");
    open_path(&mut window, &json);
    let curves = "Export theory and readings as CSV...";
    let error = refused(&mut window, curves, &scan);
    assert!(error.contains("is an open scan"), "{error}");
    assert_eq!(std::fs::read_to_string(&scan).unwrap(), z307());
    let error = refused(&mut window, curves, &json);
    assert!(error.contains("is written as .csv"), "{error}");
    // The fit itself is updated.
    click(&mut window, "Fit all");
    export_fit(&mut window, &json);
    assert_eq!(Document::read(&json).unwrap().reports.len(), 2);
    assert_eq!(std::fs::read_to_string(&scan).unwrap(), z307());
}

#[test]
fn a_fit_of_several_files_opens_a_sample_for_each() {
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("fits.json");
    let mut window = empty();
    let mut reports = Vec::new();
    for name in ["a.csv", "b.csv"] {
        let scan = folder.path().join(name);
        std::fs::write(&scan, z307()).unwrap();
        open_path(&mut window, &scan);
        click(&mut window, "fit both stages");
        let state = &window.state().state;
        let report = state.active_sample().unwrap().scan().last_fit.clone();
        reports.push((*report.unwrap()).clone());
    }
    let text = serde_json::to_string(&Document::new(reports)).unwrap();
    std::fs::write(&json, text).unwrap();
    menu(&mut window, "File", "Close all samples");
    click(&mut window, "Close without saving");
    open_path(&mut window, &json);
    assert_eq!(names(&window), ["a", "b"]);
    let state = &window.state().state;
    assert!(state.samples.iter().all(|sample| sample.scans.len() == 2));
    assert!(state.samples.iter().all(|s| s.scan().last_fit.is_some()));
    assert_eq!(state.saved([900.0, 600.0]).open.len(), 1);
    // Both fits are written to their file. With one of them closed, it would be lost.
    export_fit(&mut window, &json);
    assert_eq!(Document::read(&json).unwrap().reports.len(), 2);
    click(&mut window, "close a");
    let error = refused(&mut window, "Save fit as JSON...", &json);
    assert!(error.contains("2 scans, of which 1 are open"), "{error}");
}

#[test]
fn a_fit_of_joined_files_opens_one_sample_of_all() {
    let folder = tempfile::tempdir().unwrap();
    let (text, json) = (z307(), folder.path().join("fit.json"));
    let (header, rows) = text.split_at(text.find("0.63079").unwrap());
    let rows: Vec<&str> = rows
        .lines()
        .filter(|row| row.starts_with("0.63079"))
        .collect();
    let halves = rows.split_at(rows.len() / 2);
    let parts = [("a.csv", halves.0), ("b.csv", halves.1)].map(|(name, rows)| {
        let path = folder.path().join(name);
        std::fs::write(&path, format!("{header}{}\n", rows.join("\n"))).unwrap();
        Measurements::read_csv(&path).unwrap()
    });
    let joined = Measurements::joined(parts.to_vec()).unwrap();
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    let (report, _) = Report::new(&joined, &options, Depth::Fit);
    std::fs::write(
        &json,
        serde_json::to_string(&Document::new(vec![report])).unwrap(),
    )
    .unwrap();
    let mut window = empty();
    open_path(&mut window, &json);
    let state = &window.state().state;
    assert_eq!(state.samples.len(), 1, "{:?}", state.errors());
    let scan = state.active_sample().unwrap().scan();
    assert_eq!(scan.measurements.readings(), joined.readings());
    assert!(scan.last_fit.is_some());
}

#[test]
fn relative_paths_are_saved_as_absolute_ones() {
    let mut window = empty();
    let path = Path::new("../../data/measured/z307_on_aluminium.csv");
    window
        .state_mut()
        .state
        .apply(Intent::Open(vec![path.to_owned()]));
    settle(&mut window);
    let state = &window.state().state;
    assert!(state.recent[0].is_absolute());
    let saved = state.saved([900.0, 600.0]);
    assert!(Path::new(&saved.open[0].source).is_absolute());
}

#[test]
fn a_dropped_file_with_a_path_is_added_to_the_recent_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("paint.csv");
    std::fs::write(&path, z307()).unwrap();
    let mut window = empty();
    drop_path(&mut window, &path);
    assert_eq!(names(&window), ["paint"]);
    assert_eq!(window.state().state.recent, [path]);
    drop_path(&mut window, folder.path());
    assert!(window.state().state.errors()[0].contains("is not a regular file"));
}

#[cfg(unix)]
#[test]
fn a_pipe_is_refused_and_the_next_file_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.csv");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    let mut window = with_z307();
    open_path(&mut window, &pipe);
    assert!(window.state().state.errors()[0].contains("is not a regular file"));
    menu(&mut window, "File", "Export figure as SVG...");
    enter_path(&mut window, &pipe);
    click_role(&mut window, Role::Button, "Save");
    let path = folder.path().join("paint.csv");
    std::fs::write(&path, z307()).unwrap();
    open_path(&mut window, &path);
    assert!(window.state().state.errors()[1].contains("is written as .svg"));
    assert_eq!(names(&window), ["z307_on_aluminium", "paint"]);
}

#[test]
fn theory_without_readings_is_written_at_the_angles_where_it_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("theory.csv");
    let mut window = empty();
    open_built_in(&mut window, "Table 1, 001 at 0.91 um");
    write(&mut window, "Export theory and readings as CSV...", &path);
    let state = &window.state().state;
    let sample = state.active_sample().unwrap();
    let brdf = sample.scan().parameters.brdf().unwrap();
    let mut reader = csv::Reader::from_path(&path).unwrap();
    let mut rows = 0;
    for row in reader.records().map(Result::unwrap) {
        let value = |i: usize| row[i].parse::<f64>().unwrap();
        let (psi, theta) = (value(2).to_radians(), value(3).to_radians());
        let expected = brdf.value(&brdf_core::Geometry::in_plane(psi, theta).unwrap());
        assert!((value(7) - expected).abs() < 1e-9 * expected, "{row:?}");
        assert!(row[5].is_empty() && row[4] == *"0");
        rows += 1;
    }
    let drawn = state.derived.curves(sample.scan_id());
    let drawn: usize = drawn.iter().map(|curve| curve.theory.len()).sum();
    assert_eq!(rows, drawn);
}

#[test]
fn a_figure_without_any_incidence_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("figure.svg");
    let mut window = with_z307();
    click(&mut window, "hide all incidences");
    let error = refused(&mut window, "Export figure as SVG...", &path);
    assert!(error.contains("no incidence is selected"), "{error}");
    assert!(!path.exists());
}

#[test]
fn a_figure_of_several_samples_names_each_of_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("figure.svg");
    let mut window = with_z307();
    open_built_in(&mut window, "z307_on_aluminium_cycled.csv");
    open_built_in(&mut window, "black_anodise_on_aluminium.csv");
    write(&mut window, "Export figure as SVG...", &path);
    let svg = std::fs::read_to_string(&path).unwrap();
    assert!(!svg.contains("curves are named"));
    for sample in &window.state().state.samples {
        let scan = sample.scan();
        let (name, wavelength) = (&sample.name, scan.wavelength_um().unwrap());
        let text = format!(
            "{name}, {wavelength} um: three: k2 = {:.4}, kD = {:.4}, k1 = {:.4}, n = {:.4}",
            scan.parameters.values.k2,
            scan.parameters.values.kd,
            scan.parameters.values.k1,
            scan.parameters.values.n
        );
        assert!(svg.contains(&text), "{text}");
    }
}

#[test]
fn samples_with_equal_or_long_names_are_distinguishable() {
    let mut window = empty();
    let long = "a_paint_with_a_long_name_on_a_plate_of_aluminium";
    for name in [format!("{long}_1.csv"), format!("{long}_2.csv")] {
        drop_file(&mut window, &name, &z307());
    }
    drop_file(&mut window, "a.csv", &z307());
    drop_file(&mut window, "a.csv", &z307());
    assert_eq!(names(&window)[2..], ["a", "a (2)"]);
    let painted = crate::common::painted_texts(&window);
    let elided = painted
        .iter()
        .filter(|(text, _)| text.starts_with("a_") && text.len() > 4);
    let elided: Vec<&String> = elided.map(|(text, _)| text).collect();
    assert_eq!(elided.len(), 2, "{elided:?}");
    assert!(elided.iter().all(|text| text.contains('…')), "{elided:?}");
    assert_ne!(elided[0], elided[1]);
}
