//! The fit: buttons, settings, progress, cancellation and results.

use std::time::{Duration, Instant};

use crate::common::{
    Window, click, click_role, drop_file, empty, open_built_in, painted_lines, painted_texts,
    settle, shows, type_number, with_z307, z307,
};
use brdf_fit::plot::Ground;
use brdf_fit::report::{Depth, Report};
use brdf_fit::{FitOptions, Measurements, Method, Part, Phase, RefractiveIndex, Step, Task};
use brdf_viewer::intent::{Command, Intent};
use brdf_viewer::output_kind::OutputKind;
use brdf_viewer::state::fit_run::{FitRun, Progress};
use brdf_viewer::state::fit_settings::{ReadingWeights, Scope, Stages, Start};
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;

fn report(window: &Window) -> Report {
    let state = &window.state().state;
    let scan = state.active_sample().unwrap().scan();
    (**scan.last_fit.as_ref().expect("no fit")).clone()
}

/// The report of the library with the options of the command line.
fn expected(change: impl FnOnce(&mut FitOptions)) -> Report {
    let all = Measurements::from_reader(z307().as_bytes()).unwrap();
    let scan = all.by_wavelength().remove(0);
    let mut options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    change(&mut options);
    Report::new(&scan, &options, Depth::Assessed).0
}

fn check_same(window: &Window, expected: &Report) {
    let found = report(window);
    let (found_fit, expected_fit) = (found.fit.unwrap(), expected.fit.as_ref().unwrap());
    assert_eq!(found_fit.at(), expected_fit.at());
    assert_eq!(found_fit.e_percent, expected_fit.e_percent);
    assert_eq!(found_fit.options, expected_fit.options);
    assert_eq!(found.warnings, expected.warnings);
    assert_eq!(found.uncertainty, expected.uncertainty);
    assert_eq!(found.assessment, expected.assessment);
}

#[test]
fn a_fit_of_both_stages_equals_that_of_the_library() {
    let mut window = with_z307();
    click(&mut window, "fit both stages");
    check_same(&window, &expected(|_| {}));
    click(&mut window, "Report");
    assert!(shows(&window, "stage 1: psi <= 60 deg"));
    assert!(window.query_by_label("1 of 1 fitted").is_some());
    let steps = window
        .state()
        .state
        .active_sample()
        .unwrap()
        .scan()
        .convergence
        .clone();
    let fit = report(&window).fit.unwrap();
    for (phase, stage) in [
        (Phase::Stage1, fit.stage1.unwrap()),
        (Phase::Stage2, fit.stage2.unwrap()),
    ] {
        let points: Vec<_> = steps.iter().filter(|p| p.phase == phase).collect();
        assert_eq!(points.last().unwrap().iteration, stage.iterations);
        assert_eq!(points.len() as u64, stage.iterations + 1);
    }
}

#[test]
fn the_progress_names_the_part_that_runs() {
    let mut window = with_z307();
    let scan = window.state().state.active_sample().unwrap().scan_id();
    let mut run = FitRun::new(7, false, &[scan]).unwrap();
    let step = Step {
        phase: Phase::Assessment,
        iteration: 0,
        part: None,
        e_percent: None,
        parameters: None,
    };
    let part = Part {
        task: Task::CrossValidation,
        number: 3,
        count: 5,
    };
    run.record(scan, &step);
    let begun = Step {
        part: Some(part),
        ..step
    };
    // The steps of a part do not state it again.
    for step in [begun, step] {
        run.record(scan, &step);
    }
    window.state_mut().state.fit_run = Some(run);
    window.step();
    let texts = painted_texts(&window);
    let is_named = |name: &str| texts.iter().any(|(text, _)| text == name);
    assert!(is_named("cross-validation 3 of 5"), "{texts:?}");
}

#[test]
fn each_stage_has_its_button() {
    let mut window = with_z307();
    click(&mut window, "Stage 1");
    check_same(&window, &expected(|options| options.stage2 = None));
    click(&mut window, "Stage 2");
    check_same(&window, &expected(|options| options.stage1 = None));
}

#[test]
fn the_settings_are_applied_to_the_fit() {
    let mut window = with_z307();
    click(&mut window, "Fit settings");
    click_role(&mut window, Role::ComboBox, "Stage 1 method");
    click(&mut window, "nelder-mead");
    type_number(&mut window, "Largest psi in stage 1", "40");
    click_role(&mut window, Role::ComboBox, "Reading weights");
    click(&mut window, "solid angle");
    assert_eq!(
        window.state().state.fit_settings.weights,
        ReadingWeights::SolidAngle
    );
    click(&mut window, "fit both stages");
    check_same(
        &window,
        &expected(|options| {
            options.stage1 = Some(Method::NelderMead);
            options.stage1_limit = 40_f64.to_radians();
            options.weights.by_solid_angle = true;
        }),
    );
    click_role(&mut window, Role::ComboBox, "Loss");
    click(&mut window, "tukey");
    click(&mut window, "Enforce rho <= 1 up to");
    click(&mut window, "Also fit GGX and Beckmann");
    click(&mut window, "fit both stages");
    let fit = report(&window).fit.unwrap();
    assert!(fit.robust.is_some() && fit.energy.is_some());
    assert!(report(&window).assessment.unwrap().models.len() > 6);
}

#[test]
fn a_fit_can_start_from_the_current_values() {
    let mut window = with_z307();
    type_number(&mut window, "k1", "0.9");
    click(&mut window, "Fit settings");
    click(&mut window, "current values");
    assert_eq!(window.state().state.fit_settings.start, Start::Current);
    click(&mut window, "fit both stages");
    let fit = report(&window).fit.unwrap();
    assert_eq!(fit.initial.parameters.k1, 0.9);
}

#[test]
fn weights_by_sigma_without_sigma_are_an_error() {
    let mut window = with_z307();
    click(&mut window, "Fit settings");
    click_role(&mut window, Role::ComboBox, "Reading weights");
    click(&mut window, "1/σ²");
    assert!(shows(&window, "E is not available: "));
    click(&mut window, "fit both stages");
    let errors = window.state().state.errors();
    assert!(errors[0].contains("sigma"), "{errors:?}");
    assert!(window.query_by_label("0 of 1 fitted, 1 failed").is_some());
}

#[test]
fn changed_parameters_are_noted_and_have_no_band() {
    let mut window = with_z307();
    click(&mut window, "fit both stages");
    let banded = |window: &Window| {
        let state = &window.state().state;
        let id = state.active_sample().unwrap().scan_id();
        state.derived.curves(id)[0]
            .theory
            .iter()
            .any(|t| t.sigma.is_some())
    };
    assert!(banded(&window));
    type_number(&mut window, "k1", "0.5");
    assert!(!banded(&window));
    assert!(
        window
            .query_by_label("The parameters have changed since this fit.")
            .is_some()
    );
}

/// A scan whose fit takes long enough to be observed: 20 incidences, 200,000 readings.
fn large() -> String {
    use std::fmt::Write as _;
    let mut text = "psi_deg,theta_deg,brdf_per_sr\n".to_owned();
    for i in 0..20 {
        for j in 0..10_000 {
            let theta = -85.0 + 0.017 * f64::from(j);
            let away = (theta + 4.0 * f64::from(i)).to_radians();
            let brdf = 0.02 + 0.2 * (-8.0 * away * away).exp() * (1.0 + 0.1 * f64::from(j % 7));
            let _ = writeln!(text, "{},{theta:.3},{brdf:.6}", 4 * i);
        }
    }
    text
}

#[test]
fn a_long_fit_shows_its_progress_and_is_cancelled() {
    let mut window = empty();
    drop_file(&mut window, "large.csv", &large());
    assert_eq!(
        window
            .state()
            .state
            .active_sample()
            .unwrap()
            .scan()
            .reading_count(),
        200_000
    );
    click_role(&mut window, Role::ComboBox, "model");
    let entries = window.get_all_by_label("power+n: the paper's with a free exponent, n free");
    entries.last().unwrap().click();
    settle(&mut window);
    let before = window
        .state()
        .state
        .active_sample()
        .unwrap()
        .scan()
        .parameters;
    click(&mut window, "Iterations");
    window.get_by_label("fit both stages").click();
    let started = Instant::now();
    let mut longest_frame = Duration::ZERO;
    // The curve of the first stage grows from frame to frame.
    let first = brdf_viewer::theme::series_colour(0, Ground::Light);
    let mut lengths = vec![0];
    while lengths.len() < 4 {
        assert!(started.elapsed() < Duration::from_mins(1));
        let frame = Instant::now();
        window.step();
        longest_frame = longest_frame.max(frame.elapsed());
        let below = window.get_by_label("Summary").rect().bottom();
        let lines = painted_lines(&window, first).into_iter();
        let lines = lines.filter(|line| line.iter().all(|at| at.y > below));
        let points = lines.map(|line| line.len()).max().unwrap_or(0);
        assert!(points >= lengths[lengths.len() - 1]);
        lengths.push(points);
        lengths.dedup();
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(window.query_by_role(Role::ProgressIndicator).is_some());
    window.get_by_role_and_label(Role::Button, "Cancel").click();
    let cancelled = Instant::now();
    while window.state().state.is_fitting() {
        assert!(
            cancelled.elapsed() < Duration::from_secs(20),
            "the fit does not end"
        );
        window.step();
        std::thread::sleep(Duration::from_millis(1));
    }
    settle(&mut window);
    println!(
        "cancelled within {:?}; longest frame {longest_frame:?}",
        cancelled.elapsed()
    );
    let state = &window.state().state;
    assert_eq!(
        state.fit_run.as_ref().unwrap().progress,
        Progress::Cancelled
    );
    assert_eq!(state.active_sample().unwrap().scan().parameters, before);
    assert!(state.active_sample().unwrap().scan().last_fit.is_none());
    assert!(shows(&window, "cancelled"));
}

#[test]
fn all_samples_are_fitted_together() {
    let mut window = with_z307();
    open_built_in(&mut window, "black_anodise_on_aluminium.csv");
    open_built_in(&mut window, "Table 1, 003 at 0.91 um");
    click(&mut window, "Fit all");
    let state = &window.state().state;
    let run = state.fit_run.as_ref().unwrap();
    assert_eq!((run.fit_count(), run.ended_count()), (4, 4));
    let measured = state
        .samples
        .iter()
        .filter(|s| s.scan().reading_count() > 0);
    assert!(
        measured
            .flat_map(|s| &s.scans)
            .all(|scan| scan.last_fit.is_some())
    );
}

/// A window with the large scan and another sample, while all are being fitted.
fn fitting_all() -> Window {
    let mut window = empty();
    drop_file(&mut window, "large.csv", &large());
    open_built_in(&mut window, "z307_on_aluminium.csv");
    window.get_by_label("Fit all").click();
    let started = Instant::now();
    let has_begun = |window: &Window| {
        let run = window.state().state.fit_run.as_ref();
        run.is_some_and(|run| !run.points.is_empty())
    };
    while !has_begun(&window) {
        assert!(started.elapsed() < Duration::from_mins(1));
        window.step();
        std::thread::sleep(Duration::from_millis(1));
    }
    window
}

#[test]
fn closing_a_sample_cancels_only_its_own_fit() {
    let mut window = fitting_all();
    assert!(window.state().state.is_fitting());
    window.get_by_label("close large").click();
    settle(&mut window);
    let state = &window.state().state;
    assert_eq!(state.samples.len(), 1);
    assert!(state.samples[0].scans.iter().all(|s| s.last_fit.is_some()));
    let run = state.fit_run.as_ref().unwrap();
    let counts = (run.progress, run.fit_count(), run.ended_count());
    assert_eq!(counts, (Progress::Done, 2, 2));
    assert!(window.query_by_label("2 of 2 fitted").is_some());
}

#[test]
fn closing_all_samples_removes_the_run() {
    let mut window = fitting_all();
    let close_all = Intent::Command(Command::CloseAll);
    window.state_mut().state.apply(close_all);
    settle(&mut window);
    assert!(window.state().state.fit_run.is_none());
    assert!(window.query_by_label_contains("fitted").is_none());
}

#[test]
fn escape_first_closes_a_menu_and_then_cancels_the_fit() {
    let mut window = fitting_all();
    for (role, label) in [(Role::ComboBox, "model"), (Role::Button, "Edit")] {
        window.get_by_role_and_label(role, label).click();
        window.step();
        window.step();
        window.key_press(egui::Key::Escape);
        window.step();
        let run = window.state().state.fit_run.as_ref().unwrap();
        assert_eq!(run.progress, Progress::Running, "{label}");
        window.step();
    }
    window.key_press(egui::Key::Escape);
    window.step();
    let run = window.state().state.fit_run.as_ref().unwrap();
    assert_ne!(run.progress, Progress::Running);
    settle(&mut window);
    let run = window.state().state.fit_run.as_ref().unwrap();
    assert_eq!(run.progress, Progress::Cancelled);
}

#[test]
fn convergence_is_shown_for_the_current_scan() {
    let mut window = with_z307();
    click(&mut window, "fit both stages");
    open_built_in(&mut window, "titanium_anodise.csv");
    click(&mut window, "Iterations");
    let plot = "plot of E against iteration";
    assert!(window.query_by_label(plot).is_none());
    assert!(shows(&window, "This wavelength has not been fitted"));
    click(&mut window, "z307_on_aluminium");
    assert!(window.query_by_label(plot).is_some());
    click(&mut window, "close z307_on_aluminium");
    click(&mut window, "Close without saving");
    assert!(window.query_by_label(plot).is_none());
}

#[test]
fn a_fit_with_weights_by_sigma_equals_that_of_the_library() {
    use std::fmt::Write as _;
    let mut text = "psi_deg,theta_deg,brdf_per_sr,sigma_per_sr\n".to_owned();
    for row in 0..90 {
        let (psi, theta) = (15 * (row % 5), 7 * (row / 5) - 60);
        let away = f64::from(theta + psi).to_radians();
        let brdf = 0.05 + 0.4 * (-6.0 * away * away).exp();
        let sigma = brdf * if row % 2 == 0 { 0.01 } else { 0.1 };
        let brdf = brdf * (1.0 + 0.05 * f64::from(row).sin());
        let _ = writeln!(text, "{psi},{theta},{brdf},{sigma}");
    }
    let mut window = empty();
    drop_file(&mut window, "sigma.csv", &text);
    click(&mut window, "Fit settings");
    click_role(&mut window, Role::ComboBox, "Reading weights");
    click(&mut window, "1/σ²");
    click(&mut window, "fit both stages");
    let scan = Measurements::from_reader(text.as_bytes()).unwrap();
    let mut options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    let plain = Report::new(&scan, &options, Depth::Fit).0.fit.unwrap();
    options.weights.errors = brdf_fit::AssumedErrors::Stated;
    check_same(&window, &Report::new(&scan, &options, Depth::Assessed).0);
    let e = report(&window).fit.unwrap().e_percent;
    assert_ne!(e, plain.e_percent);
    // E of the current parameters has the same weights.
    let text = format!("(E = {} %)", brdf_fit::format::two_digits(e));
    assert!(shows(&window, &text), "{text}");
}

#[test]
fn a_failed_fit_is_reported_above_the_tables_of_the_previous_one() {
    let mut window = with_z307();
    click(&mut window, "fit both stages");
    click(&mut window, "Fit settings");
    click_role(&mut window, Role::ComboBox, "Reading weights");
    click(&mut window, "1/σ²");
    click(&mut window, "fit both stages");
    assert!(shows(&window, "The last fit failed"));
    assert!(shows(&window, "the text is of the previous fit"));
    click_role(&mut window, Role::ComboBox, "Reading weights");
    click(&mut window, "none");
    click(&mut window, "fit both stages");
    assert!(!shows(&window, "The last fit failed"));
}

#[test]
fn a_fit_of_a_wavelength_that_is_not_shown_can_be_saved() {
    let mut window = with_z307();
    let save = Command::Export(OutputKind::Fit);
    assert!(!window.state().state.is_enabled(save));
    click(&mut window, "fit both stages");
    let id = window.state().state.active.unwrap();
    window.state_mut().state.apply(Intent::Wavelength(id, 1));
    settle(&mut window);
    assert!(window.state().state.is_enabled(save));
}

#[test]
fn a_model_set_for_all_scans_is_fitted_to_all_of_them() {
    let mut window = with_z307();
    open_built_in(&mut window, "titanium_anodise.csv");
    let apply = |window: &mut Window, intent| {
        window.state_mut().state.apply(intent);
        settle(window);
    };
    let model = brdf_fit::Model::PowerN;
    apply(&mut window, Intent::Model(model, Scope::All));
    apply(&mut window, Intent::Fit(Stages::Both, Scope::All));
    let mut scans = 0;
    for sample in &window.state().state.samples {
        for scan in &sample.scans {
            let fit = scan.last_fit.as_ref().unwrap().fit.as_ref().unwrap();
            assert_eq!(fit.model(), model);
            scans += 1;
        }
    }
    assert!(scans > 2);
}
