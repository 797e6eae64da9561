//! The fit: its buttons and settings, progress, cancelling, and what it shows.

use std::time::{Duration, Instant};

use crate::common::{
    Window, click, click_role, drop_file, empty, open_built_in, settle, shows, type_number,
    with_z307, z307,
};
use brdf_fit::report::{Depth, Report};
use brdf_fit::watch::Phase;
use brdf_fit::{FitOptions, Measurements, Method, RefractiveIndex};
use brdf_viewer::state::fitting::{Progress, ReadingWeights, Start};
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;

fn report(window: &Window) -> Report {
    let state = &window.state().state;
    let scan = state.active_sample().unwrap().scan();
    (**scan.fitted.as_ref().expect("no fit")).clone()
}

/// The report of the command line's options on the same data.
fn expected(change: impl FnOnce(&mut FitOptions)) -> Report {
    let all = Measurements::from_reader(z307().as_bytes()).unwrap();
    let scan = all.by_wavelength().remove(0);
    let mut options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    change(&mut options);
    Report::of(&scan, &options, Depth::Assessed).0
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
fn both_stages_give_the_numbers_of_the_library() {
    let mut window = with_z307();
    click(&mut window, "Both stages");
    check_same(&window, &expected(|_| {}));
    assert!(shows(&window, "stage 1: psi <= 60 deg"));
    assert!(window.query_by_label("1 of 1 fitted").is_some());
    let steps = window
        .state()
        .state
        .active_sample()
        .unwrap()
        .scan()
        .steps
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
fn each_stage_has_its_button() {
    let mut window = with_z307();
    click(&mut window, "Stage 1");
    check_same(&window, &expected(|options| options.stage2 = None));
    click(&mut window, "Stage 2");
    check_same(&window, &expected(|options| options.stage1 = None));
}

#[test]
fn the_settings_are_those_of_the_fit() {
    let mut window = with_z307();
    click(&mut window, "Settings of the fit");
    click_role(&mut window, Role::ComboBox, "Method of stage 1");
    click(&mut window, "nelder-mead");
    type_number(&mut window, "Stage 1 up to", "40");
    click_role(&mut window, Role::ComboBox, "Weights of readings");
    click(&mut window, "solid angle");
    assert_eq!(
        window.state().state.choice.weights,
        ReadingWeights::SolidAngle
    );
    click(&mut window, "Both stages");
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
    click(&mut window, "rho <= 1 up to");
    click(&mut window, "Fit GGX and Beckmann beside it");
    click(&mut window, "Both stages");
    let fit = report(&window).fit.unwrap();
    assert!(fit.robust.is_some() && fit.energy.is_some());
    assert!(report(&window).assessment.unwrap().models.len() > 6);
}

#[test]
fn the_fit_starts_from_the_sliders_where_the_user_says_so() {
    let mut window = with_z307();
    type_number(&mut window, "k1", "0.9");
    click(&mut window, "the sliders");
    assert_eq!(window.state().state.choice.start, Start::Sliders);
    click(&mut window, "Both stages");
    let fit = report(&window).fit.unwrap();
    assert_eq!(fit.initial.parameters.k1, 0.9);
}

#[test]
fn weights_without_sigma_are_a_clear_error() {
    let mut window = with_z307();
    click(&mut window, "Settings of the fit");
    click_role(&mut window, Role::ComboBox, "Weights of readings");
    click(&mut window, "1/sigma²");
    assert!(shows(&window, "no E: "));
    click(&mut window, "Both stages");
    let errors = window.state().state.errors();
    assert!(errors[0].contains("sigma"), "{errors:?}");
    assert!(window.query_by_label("0 of 1 fitted, 1 failed").is_some());
}

#[test]
fn turned_parameters_are_told_and_lose_the_band() {
    let mut window = with_z307();
    click(&mut window, "Both stages");
    let banded = |window: &Window| {
        let state = &window.state().state;
        let id = state.active_sample().unwrap().scan_id();
        state.shown.curves(id)[0]
            .theory
            .iter()
            .any(|t| t.sigma.is_some())
    };
    assert!(banded(&window));
    type_number(&mut window, "k1", "0.5");
    assert!(!banded(&window));
    assert!(
        window
            .query_by_label("The parameters were turned since this fit.")
            .is_some()
    );
}

/// A scan large enough for its fit to be seen: 20 incidences, 200,000 readings.
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
fn a_long_fit_is_followed_and_cancelled() {
    let mut window = empty();
    drop_file(&mut window, "large.csv", &large());
    assert_eq!(
        window
            .state()
            .state
            .active_sample()
            .unwrap()
            .scan()
            .readings(),
        200_000
    );
    click_role(&mut window, Role::ComboBox, "model");
    let entries = window.get_all_by_label("power+n: the paper's with a free exponent, n free");
    entries.last().unwrap().click();
    settle(&mut window);
    let before = window.state().state.active_sample().unwrap().scan().knobs;
    window.get_by_label("Both stages").click();
    let started = Instant::now();
    let mut lengths = Vec::new();
    let mut longest_frame = Duration::ZERO;
    while lengths.last().is_none_or(|points| *points < 3) {
        assert!(started.elapsed() < Duration::from_mins(1));
        let frame = Instant::now();
        window.step();
        longest_frame = longest_frame.max(frame.elapsed());
        lengths.push(
            window
                .state()
                .state
                .run
                .as_ref()
                .map_or(0, |run| run.points.len()),
        );
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(window.query_by_role(Role::ProgressIndicator).is_some());
    window.get_by_role_and_label(Role::Button, "Cancel").click();
    let cancelled = Instant::now();
    while window.state().state.is_fitting() {
        assert!(
            cancelled.elapsed() < Duration::from_secs(20),
            "the fit does not stop"
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
    assert_eq!(state.run.as_ref().unwrap().progress, Progress::Cancelled);
    assert_eq!(state.active_sample().unwrap().scan().knobs, before);
    assert!(state.active_sample().unwrap().scan().fitted.is_none());
    assert!(shows(&window, "cancelled"));
}

#[test]
fn all_samples_are_fitted_together() {
    let mut window = with_z307();
    open_built_in(&mut window, "black_anodise_on_aluminium.csv");
    open_built_in(&mut window, "Table 1, 003 at 0.91 um");
    click(&mut window, "Fit all");
    let state = &window.state().state;
    let run = state.run.as_ref().unwrap();
    assert_eq!((run.jobs(), run.done()), (4, 4));
    let measured = state.samples.iter().filter(|s| s.scan().readings() > 0);
    assert!(
        measured
            .flat_map(|s| &s.scans)
            .all(|scan| scan.fitted.is_some())
    );
}
