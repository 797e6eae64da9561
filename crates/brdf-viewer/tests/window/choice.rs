//! The choice of readings: left out by a click, a rectangle or an incidence.

use crate::common::{Window, click, menu, press, release, transform_of, with_z307, z307};
use brdf_fit::report::{Depth, Report};
use brdf_fit::{FitOptions, Measurements, RefractiveIndex};
use brdf_viewer::state::sample::Scan;
use egui_kittest::kittest::Queryable as _;

fn scan(window: &Window) -> &Scan {
    window.state().state.active_sample().unwrap().scan()
}

/// The library's fit of the scan without the readings that `is_left_out`.
fn expected(is_left_out: impl Fn(&brdf_fit::Measurement) -> bool) -> Report {
    let all = Measurements::from_reader(z307().as_bytes()).unwrap();
    let scan = all.by_wavelength().remove(0);
    let kept = scan
        .readings()
        .iter()
        .filter(|reading| !is_left_out(reading));
    let kept = Measurements::new("kept", kept.copied().collect()).unwrap();
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    Report::new(&kept, &options, Depth::Assessed).0
}

#[test]
fn an_incidence_that_is_not_used_is_not_in_the_fit() {
    let mut window = with_z307();
    click(&mut window, "use 70° in the fit");
    assert_eq!(scan(&window).left_out().len(), 27);
    click(&mut window, "fit both stages");
    let expected = expected(|reading| reading.psi > 60_f64.to_radians());
    let report = scan(&window).last_fit.clone().unwrap();
    let (found, expected) = (report.fit.as_ref().unwrap(), expected.fit.unwrap());
    assert_eq!(found.at(), expected.at());
    assert_eq!(found.e_percent, expected.e_percent);
    assert_eq!(report.left_out.len(), 27);
    // The choice is undone.
    menu(&mut window, "Edit", "Undo");
    menu(&mut window, "Edit", "Undo");
    assert!(scan(&window).left_out().is_empty());
}

/// The position of a reading on the screen.
fn position(window: &Window, incidence: usize, reading: usize) -> (egui::Pos2, usize) {
    let state = &window.state().state;
    let id = state.active_sample().unwrap().scan_id();
    let reading = state.derived.curves(id)[incidence].readings[reading];
    let transform = transform_of(window, "theory");
    let at = egui_plot::PlotPoint::new(reading.theta_deg, reading.value);
    (transform.position_from_point(&at), reading.index)
}

#[test]
fn a_click_leaves_a_reading_out_and_uses_it_again() {
    let mut window = with_z307();
    let (at, index) = position(&window, 4, 1);
    press(&mut window, at);
    release(&mut window, at);
    assert!(
        scan(&window).left_out().is_empty(),
        "a click alone chooses nothing"
    );
    click(&mut window, "Choose readings in the plot");
    press(&mut window, at);
    release(&mut window, at);
    assert_eq!(
        scan(&window).left_out().iter().copied().collect::<Vec<_>>(),
        [index]
    );
    assert!(window.query_by_label("111 of 112 readings used").is_some());
    press(&mut window, at);
    release(&mut window, at);
    assert!(scan(&window).left_out().is_empty());
}

#[test]
fn a_rectangle_leaves_the_readings_in_it_out() {
    let mut window = with_z307();
    click(&mut window, "Choose readings in the plot");
    let frame = *transform_of(&window, "theory").frame();
    let (first, _) = position(&window, 4, 1);
    let corner = frame.left_top() + egui::vec2(1.0, 1.0);
    let opposite = first + egui::vec2(4.0, 4.0);
    press(&mut window, corner);
    release(&mut window, opposite);
    let left_out = scan(&window).left_out().clone();
    assert!(!left_out.is_empty() && left_out.len() < 10, "{left_out:?}");
    click(&mut window, "use all readings");
    assert!(scan(&window).left_out().is_empty());
}
