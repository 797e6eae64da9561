//! The result first: the fit on opening, the card, the models, and what each scan is said to be.

use std::fmt::Write as _;

use crate::common::{
    NoDialogs, Window, click, colour_of, drop_file, painted_lines, settle, shows, window_with, z307,
};
use brdf_fit::plot::Scale;
use brdf_viewer::intent::Intent;
use brdf_viewer::state::saved::Settings;
use egui_kittest::kittest::Queryable as _;

/// A window as users open it: scans are fitted when they are opened. It is tall enough for all rows of
/// the tables.
fn window() -> Window {
    let mut window = window_with([1280.0, 1400.0], NoDialogs, Settings::in_memory());
    window.state_mut().state.fit_settings.on_opening = true;
    window
}

fn with_z307() -> Window {
    let mut window = window();
    drop_file(&mut window, "paint.csv", &z307());
    window
}

#[test]
fn a_scan_is_fitted_when_it_is_opened_and_its_quality_is_said() {
    let window = with_z307();
    let state = &window.state().state;
    let sample = state.active_sample().unwrap();
    assert!(sample.scans.iter().all(|scan| scan.current_fit().is_some()));
    assert!(shows(&window, "fair: the model follows the sample roughly"));
    assert!(shows(&window, "rms error 17 % (E = 2.8 %)"));
    assert!(shows(&window, "n = 1.5 is assumed"));
    assert!(shows(&window, "smith+n suffices"));
    // The parameters have their names and intervals.
    assert!(shows(&window, "facet width"));
    assert!(shows(&window, "0.191 (0.116 ... 0.313)"));
    // What was not asked for is not undone and is not work that could be lost.
    assert!(!state.history.can_undo());
    assert!(!sample.has_unsaved_work());
}

#[test]
fn the_model_that_suffices_is_taken_with_a_button() {
    let mut window = with_z307();
    click(&mut window, "Use smith+n");
    let scan = window.state().state.active_sample().unwrap().scan();
    let report = scan.current_fit().unwrap();
    assert_eq!(report.model.name(), "smith+n");
    assert!(shows(&window, "good: the model describes the sample"));
    assert!(window.query_by_label("Use smith+n").is_none());
}

/// A lobe that no model of the hierarchy has: readings that alternate.
fn bad_scan() -> String {
    use std::fmt::Write as _;
    let mut text = "psi_deg,theta_deg,brdf_per_sr\n".to_owned();
    for psi in [10, 30, 50, 70] {
        for (i, theta) in (-80..=80).step_by(10).enumerate() {
            let value = if i % 2 == 0 { 0.9 } else { 0.0001 };
            let _ = writeln!(text, "{psi},{theta},{value}");
        }
    }
    text
}

#[test]
fn what_the_model_does_not_describe_is_plain_to_see() {
    let mut window = window();
    drop_file(&mut window, "chess.csv", &bad_scan());
    assert!(shows(
        &window,
        "poor: the model does not describe the sample"
    ));
    assert!(shows(&window, "Warning: "));
    // The values span more than two decades.
    assert_eq!(window.state().state.view.scale, Scale::Logarithmic);
}

#[test]
fn models_of_the_table_are_shown_as_dashed_lines() {
    let mut window = with_z307();
    click(&mut window, "Models");
    let colour = colour_of(&window, 4);
    let dashes = |window: &Window| {
        let segments = crate::common::painted_segments(window, colour);
        segments.len() + painted_lines(window, colour).len()
    };
    let before = dashes(&window);
    click(&mut window, "show power+n");
    let state = &window.state().state;
    assert_eq!(state.derived.ghost(0).len(), 5);
    assert!(
        dashes(&window) > before + 10,
        "{before}, {}",
        dashes(&window)
    );
    assert_eq!(window.state().state.ghosts[0].name, "power+n, 0.63079 µm");
    click(&mut window, "show power+n");
    assert_eq!(dashes(&window), before);
    click(&mut window, "use power+n");
    let scan = window.state().state.active_sample().unwrap().scan();
    assert_eq!(scan.current_fit().unwrap().model.name(), "power+n");
}

#[test]
fn pinned_curves_stay_when_parameters_change() {
    let mut window = with_z307();
    click(&mut window, "Pin curves");
    crate::common::type_number(&mut window, "k1", "0.9");
    let state = &window.state().state;
    let k1 = state.ghosts[0].parameters.values.k1;
    assert!((k1 - 0.19).abs() < 0.01, "{k1}");
    assert_eq!(state.derived.ghost(0).len(), 5);
    click(&mut window, "unpin three, 0.63079 µm");
    assert!(window.state().state.ghosts.is_empty());
}

#[test]
fn wavelengths_are_a_list_and_a_table() {
    let mut window = with_z307();
    click(&mut window, "wavelength 0.85223 µm");
    assert_eq!(window.state().state.active_sample().unwrap().current, 1);
    click(&mut window, "Wavelengths");
    click(&mut window, "plot kD");
    click(&mut window, "show 0.63079 µm");
    assert_eq!(window.state().state.active_sample().unwrap().current, 0);
}

#[test]
fn several_wavelengths_are_plotted_together() {
    let mut window = with_z307();
    click(&mut window, "plot 0.85223 µm as well");
    let state = &window.state().state;
    let families: Vec<Option<usize>> = state.plotted().iter().map(|one| one.family).collect();
    assert_eq!(families, [Some(0), Some(1)]);
    let ground = brdf_fit::plot::Ground::Light;
    for family in families {
        let colour = brdf_viewer::theme::colour(family, 4, 5, ground);
        assert!(!painted_lines(&window, colour).is_empty(), "{family:?}");
    }
    click(&mut window, "plot 0.85223 µm as well");
    assert_eq!(window.state().state.plotted().len(), 1);
}

#[test]
fn a_fit_on_request_interrupts_the_automatic_ones() {
    let mut window = window();
    window.state_mut().state.apply(Intent::OpenBytes(
        "paint.csv".to_owned(),
        z307().into_bytes(),
    ));
    // The file is read, and its fits begin.
    for _ in 0..2000 {
        window.step();
        if window.state().state.is_fitting() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    click(&mut window, "fit both stages");
    settle(&mut window);
    let sample = window.state().state.active_sample().unwrap();
    assert!(sample.scans.iter().all(|scan| scan.last_fit.is_some()));
    assert!(sample.scans[0].has_unsaved_work && !sample.scans[1].has_unsaved_work);
}

#[test]
fn residuals_have_three_forms_and_stay_aligned_with_the_plot() {
    let mut window = with_z307();
    click(&mut window, "residuals");
    let frames = ["theory", "residuals"].map(|name| {
        let transform = crate::common::transform_of(&window, name);
        *transform.frame()
    });
    assert_eq!(frames[0].left(), frames[1].left());
    assert_eq!(frames[0].right(), frames[1].right());
    for (name, axis) in [("relative", "measured / theory - 1, %"), ("in σ", "/ σ")] {
        crate::common::click_role(
            &mut window,
            egui::accesskit::Role::ComboBox,
            "form of the residuals",
        );
        click(&mut window, name);
        let texts = crate::common::painted_texts(&window);
        assert!(texts.iter().any(|(text, _)| text.contains(axis)), "{name}");
    }
}

#[test]
fn readings_are_suggested_with_what_they_change_and_copied() {
    let mut window = with_z307();
    let scan = |window: &Window| window.state().state.active_sample().unwrap().scan().clone();
    // Ten of the readings.
    let id = window.state().state.active_sample().unwrap().scan_id();
    let most = (0..112).filter(|i| i % 12 != 0).collect();
    let leave_out = Intent::ToggleReadings(id, most);
    window.state_mut().state.apply(leave_out);
    settle(&mut window);
    click(&mut window, "Plan");
    click(&mut window, "Suggest readings");
    settle(&mut window);
    let plan = scan(&window).current_plan().cloned().unwrap();
    assert!(!plan.readings.is_empty(), "{plan:?}");
    assert!(shows(&window, "Standard errors: k2"));
    click(&mut window, "Copy list");
    assert_eq!(window.state().state.status, "planned readings copied");
    // Another choice of readings needs another plan.
    let use_all = Intent::UseAllReadings(id);
    window.state_mut().state.apply(use_all);
    settle(&mut window);
    assert!(scan(&window).current_plan().is_none());
}

/// A broad lobe with a spike in the mirror direction.
#[test]
fn a_scan_that_the_model_does_not_follow_is_not_planned_for() {
    let mut rows = "psi_deg,theta_deg,brdf_per_sr\n".to_owned();
    for psi in [10, 30, 50, 70] {
        for theta in (-80..=80).step_by(10) {
            let from_mirror = f64::from(theta + psi).abs();
            let spike = if from_mirror == 0.0 { 300.0 } else { 0.0 };
            let value = 0.05 + 2.0 * (-from_mirror / 20.0).exp() + spike;
            writeln!(rows, "{psi},{theta},{value}").unwrap();
        }
    }
    let mut window = window();
    drop_file(&mut window, "mirror.csv", &rows);
    click(&mut window, "Plan");
    click(&mut window, "Suggest readings");
    settle(&mut window);
    assert!(shows(&window, "Advice: the model fails for this surface"));
    assert!(!shows(&window, "Predicted error"));
}
