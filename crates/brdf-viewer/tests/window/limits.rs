//! The limits of a fit that are dragged in the plot: the range of view angles, and stage 1.

use crate::common::{
    NoDialogs, Window, click, click_role, menu, press, release, settle, shows, transform_of,
    type_number, window_with, with_z307, z307,
};
use brdf_fit::report::{Depth, Report};
use brdf_fit::{FitOptions, Measurement, Measurements, RefractiveIndex};
use brdf_viewer::intent::{Command, Intent};
use brdf_viewer::state::sample::Scan;
use brdf_viewer::state::saved::Settings;
use egui::accesskit::Role;
use egui::{CursorIcon, Pos2};
use egui_kittest::kittest::Queryable as _;

const SHOW: &str = "Limits of the fit in the plot";

fn scan(window: &Window) -> &Scan {
    window.state().state.active_sample().unwrap().scan()
}

/// Where the grip of a limit is, by the start of its name.
fn grip(window: &Window, name: &str) -> Pos2 {
    let found = window.get_by(|node| {
        let label = node.label().unwrap_or_default();
        node.role() == Role::Slider && label.starts_with(name)
    });
    found.rect().center()
}

fn has_grip(window: &Window, name: &str) -> bool {
    let grips = window.query_all_by(|node| {
        let label = node.label().unwrap_or_default();
        node.role() == Role::Slider && label.starts_with(name)
    });
    grips.count() > 0
}

/// Drags the grip of a limit to a view angle in degrees.
fn drag(window: &mut Window, name: &str, to_deg: f64) {
    let from = grip(window, name);
    let x = transform_of(window, "theory").position_from_point_x(to_deg);
    press(window, from);
    window.hover_at(egui::pos2(0.5 * (from.x + x), from.y));
    window.step();
    release(window, egui::pos2(x, from.y));
}

/// The library's fit of the readings that are kept.
fn expected(is_kept: impl Fn(&Measurement) -> bool, options: FitOptions) -> Report {
    let all = Measurements::from_reader(z307().as_bytes()).unwrap();
    let scan = all.by_wavelength().remove(0);
    let kept = scan.readings().iter().filter(|reading| is_kept(reading));
    let kept = Measurements::new("kept", kept.copied().collect()).unwrap();
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..options
    };
    Report::new(&kept, &options, Depth::Fit).0
}

#[test]
fn a_dragged_end_of_the_view_angles_leaves_readings_out_and_uses_them_again() {
    let mut window = with_z307();
    assert!(!has_grip(&window, "fit:"), "not shown at its default");
    click(&mut window, SHOW);
    drag(&mut window, "fit: θ ≥", -52.0);
    let beyond = |reading: &Measurement| reading.in_plane_theta().unwrap().to_degrees() < -52.0;
    let left_out: Vec<usize> = {
        let readings = scan(&window).measurements.readings().iter().enumerate();
        let beyond = readings.filter(|(_, reading)| beyond(reading));
        beyond.map(|(i, _)| i).collect()
    };
    assert!(left_out.len() > 5);
    assert!(scan(&window).left_out().iter().eq(&left_out));
    assert!(shows(&window, "readings used"));
    click(&mut window, "fit both stages");
    let fit = scan(&window).last_fit.clone().unwrap();
    let (found, library) = (
        fit.fit.as_ref().unwrap(),
        expected(|r| !beyond(r), FitOptions::default()),
    );
    let library = library.fit.unwrap();
    assert_eq!(found.at(), library.at());
    assert_eq!(found.e_percent, library.e_percent);
    assert_eq!(fit.left_out, left_out);
    // A limit that is not at its default is shown even where the user does not ask for it.
    click(&mut window, SHOW);
    assert!(has_grip(&window, "fit: θ ≥") && !has_grip(&window, "fit: θ ≤"));
    drag(&mut window, "fit: θ ≥", -89.0);
    assert!(scan(&window).left_out().is_empty());
    menu(&mut window, "Edit", "Undo");
    assert!(scan(&window).left_out().iter().eq(&left_out), "one step");
}

#[test]
fn the_number_boxes_have_the_same_range() {
    let mut window = with_z307();
    click(&mut window, SHOW);
    drag(&mut window, "fit: θ ≤", 52.0);
    let by_mouse = scan(&window).left_out().clone();
    assert!(!by_mouse.is_empty());
    menu(&mut window, "Edit", "Undo");
    assert!(scan(&window).left_out().is_empty());
    type_number(&mut window, "highest view angle in the fit", "52");
    assert_eq!(*scan(&window).left_out(), by_mouse);
    // The box shows the last reading that is used.
    let angles = scan(&window).used().readings().iter();
    let highest = angles
        .map(|r| r.in_plane_theta().unwrap())
        .fold(f64::MIN, f64::max);
    let range = window.state().state.active_angle_range().unwrap();
    assert!((range.used[1] - highest.to_degrees()).abs() < 1e-9);
    // Neither end passes the other one.
    type_number(&mut window, "lowest view angle in the fit", "90");
    assert!(scan(&window).used_count() > 0);
}

#[test]
fn the_limit_of_stage_1_is_dragged() {
    let mut window = with_z307();
    menu(&mut window, "Edit", SHOW);
    let name = "stage 1: ψ ≤";
    // Mirror directions are at negative view angles where the source side is positive.
    let at = transform_of(&window, "theory").value_from_position(grip(&window, name));
    assert!((at.x + 60.0).abs() < 0.5, "{at:?}");
    drag(&mut window, name, -34.7);
    assert_eq!(window.state().state.fit_settings.stage1_limit_deg, 35.0);
    click(&mut window, "fit both stages");
    let options = FitOptions {
        stage1_limit: 35_f64.to_radians(),
        ..FitOptions::default()
    };
    let library = expected(|_| true, options.clone()).fit.unwrap();
    let found = scan(&window).last_fit.clone().unwrap();
    let found = found.fit.as_ref().unwrap();
    assert_eq!(found.options.stage1_limit, options.stage1_limit);
    let stages = [found, &library].map(|fit| fit.stage1.unwrap());
    assert_eq!(stages[0].parameters, stages[1].parameters);
    assert_eq!(stages[0].e_percent, stages[1].e_percent);
    // The drag is one step of the history, before the fit.
    menu(&mut window, "Edit", "Undo");
    menu(&mut window, "Edit", "Undo");
    assert_eq!(window.state().state.fit_settings.stage1_limit_deg, 60.0);
    menu(&mut window, "Edit", "Redo");
    assert_eq!(window.state().state.fit_settings.stage1_limit_deg, 35.0);
    // It is the number of the settings.
    click(&mut window, "Fit settings");
    let number = window.get_by_role_and_label(Role::SpinButton, "Largest psi in stage 1");
    assert_eq!(number.value().as_deref(), Some("35°"));
    // It does not leave the range of incidence angles.
    drag(&mut window, name, 20.0);
    assert_eq!(window.state().state.fit_settings.stage1_limit_deg, 0.0);
}

#[test]
fn a_grip_tells_what_it_is_and_that_it_can_be_dragged() {
    let mut window = with_z307();
    click(&mut window, "log");
    click(&mut window, SHOW);
    let at = grip(&window, "stage 1: ψ ≤");
    window.hover_at(at);
    settle(&mut window);
    let cursor = window.output().platform_output.cursor_icon;
    assert_eq!(cursor, CursorIcon::ResizeHorizontal);
    for _ in 0..60 {
        window.step();
    }
    assert!(shows(&window, "Stage 1 fits the incidences up to ψ = 60°"));
    // A drag of a grip does not move the plot.
    let before = *transform_of(&window, "theory").bounds();
    drag(&mut window, "fit: θ ≤", 40.0);
    assert_eq!(*transform_of(&window, "theory").bounds(), before);
    // In the polar form there are no limits.
    click_role(&mut window, Role::Button, "Polar");
    assert!(!has_grip(&window, "fit:") && !has_grip(&window, "stage 1"));
}

#[test]
fn the_limits_come_back_in_the_next_session() {
    let mut window = with_z307();
    click(&mut window, SHOW);
    drag(&mut window, "fit: θ ≥", -52.0);
    drag(&mut window, "stage 1: ψ ≤", -40.0);
    let saved = window.state().state.saved([1280.0, 800.0]);
    let settings = Settings {
        saved,
        ..Settings::in_memory()
    };
    let mut next = window_with([1280.0, 800.0], NoDialogs, settings);
    next.state_mut().open_at_start(Vec::new());
    settle(&mut next);
    assert_eq!(scan(&next).left_out(), scan(&window).left_out());
    assert_eq!(next.state().state.fit_settings.stage1_limit_deg, 40.0);
    assert!(has_grip(&next, "fit: θ ≤"), "the limits are still shown");
    next.state_mut()
        .state
        .apply(Intent::Command(Command::Limits));
    settle(&mut next);
    assert!(!has_grip(&next, "fit: θ ≤") && has_grip(&next, "fit: θ ≥"));
}
