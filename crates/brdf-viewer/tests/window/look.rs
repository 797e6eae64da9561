//! How the data are looked at: what is shown, axes, layouts, zoom, hover.

use crate::common::{
    Window, click, click_role, colour_of, drop_file, empty, menu, open_built_in, painted_curve,
    painted_lines, painted_marks, settle, shows, with_z307,
};
use brdf_fit::plot::{Layout, Quantity, Scale};
use brdf_fit::read::Side;
use egui::accesskit::{Role, Toggled};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use egui_plot::PlotMemory;

fn plot(window: &Window, name: &str) -> PlotMemory {
    let id = brdf_viewer::plot::id(&window.state().state, name);
    PlotMemory::load(&window.ctx, id).expect("no such plot")
}

/// A scan with readings in two planes, one of them negative, and standard deviations.
const TWO_PLANES: &str = "\
psi_deg,theta_deg,phi_deg,brdf_per_sr,sigma_per_sr
30,-60,0,0.02,0.001
30,-30,0,0.2,0.01
30,0,0,0.05,0.002
30,30,0,-0.01,0.001
30,10,90,0.04,0.001
30,40,90,0.03,0.001
30,40,270,0.031,0.001
60,-60,0,0.4,0.02
60,0,0,0.03,0.001
60,20,90,0.02,0.001
";

#[test]
fn a_check_box_hides_an_incidence() {
    let mut window = with_z307();
    let colour = colour_of(&window, 4);
    assert!(!painted_lines(&window, colour).is_empty());
    let shown = |window: &Window| {
        window
            .state()
            .state
            .active_sample()
            .unwrap()
            .scan()
            .shown_psi()
            .len()
    };
    assert_eq!(shown(&window), 5);
    click(&mut window, "70°");
    assert_eq!(shown(&window), 4);
    assert!(painted_lines(&window, colour).is_empty());
    click(&mut window, "none incidences");
    assert_eq!(shown(&window), 0);
    click(&mut window, "all incidences");
    assert_eq!(shown(&window), 5);
    assert!(!painted_lines(&window, colour).is_empty());
}

#[test]
fn the_logarithmic_axis_shows_logarithms_and_counts_what_it_cannot_show() {
    let mut window = empty();
    drop_file(&mut window, "two.csv", TWO_PLANES);
    let colour = colour_of(&window, 0);
    let marks = painted_marks(&window, colour).len();
    click(&mut window, "log");
    assert_eq!(window.state().state.view.scale, Scale::Logarithmic);
    assert_eq!(
        window.get_by_label("log").accesskit_node().toggled(),
        Some(Toggled::True)
    );
    assert_eq!(painted_marks(&window, colour).len(), marks - 1);
    let words = "1 reading <= 0 cannot be shown on a logarithmic axis";
    assert!(shows(&window, words));
    let scan = window.state().state.active_sample().unwrap().scan();
    let brdf = scan.knobs.brdf().unwrap();
    let pixel = plot(&window, "theory").transform().dvalue_dpos()[1].abs();
    for point in painted_curve(&window, "theory", colour) {
        let at = brdf_core::Geometry::in_plane(scan.incidences[0].psi, point.x.to_radians());
        let expected = brdf.value(&at.unwrap()).log10();
        assert!((point.y - expected).abs() < pixel, "{point:?}: {expected}");
    }
}

#[test]
fn another_plane_than_that_of_incidence() {
    let mut window = empty();
    drop_file(&mut window, "two.csv", TWO_PLANES);
    assert!(shows(&window, "4 readings out of this plane"));
    click_role(&mut window, Role::ComboBox, "plane of view");
    click(&mut window, "phi = 90° / 270°");
    let state = &window.state().state;
    assert!((state.view.azimuth.to_degrees() - 90.0).abs() < 1e-9);
    let id = state.active_sample().unwrap().scan_id();
    let shown: Vec<f64> = state.shown.curves(id)[0]
        .readings
        .iter()
        .map(|r| r.theta_deg)
        .collect();
    // The normal is in every plane.
    assert_eq!(shown.len(), 4);
    assert!(
        (shown[0] + 40.0).abs() < 1e-9 && (shown[3] - 40.0).abs() < 1e-9,
        "{shown:?}"
    );
    assert!(shows(&window, "4 readings out of this plane"));
}

#[test]
fn error_bars_are_painted_where_sigma_is_given() {
    let mut window = empty();
    drop_file(&mut window, "two.csv", TWO_PLANES);
    let bars = |window: &Window| {
        let colour = colour_of(window, 1).gamma_multiply(0.55);
        let count = |shape: &egui::Shape| {
            match shape {
            egui::Shape::LineSegment { stroke, .. } => usize::from(stroke.color == colour),
            egui::Shape::Vec(shapes) => shapes
                .iter()
                .filter(|s| matches!(s, egui::Shape::LineSegment { stroke, .. } if stroke.color == colour))
                .count(),
            _ => 0,
        }
        };
        window
            .output()
            .shapes
            .iter()
            .map(|s| count(&s.shape))
            .sum::<usize>()
    };
    assert_eq!(bars(&window), 2);
    let plain = TWO_PLANES.replace(",sigma_per_sr", ",other");
    menu(&mut window, "File", "Close sample");
    drop_file(&mut window, "plain.csv", &plain);
    assert_eq!(bars(&window), 0);
}

#[test]
fn the_quantity_and_the_side_are_chosen() {
    let mut window = with_z307();
    let first = |window: &Window| {
        let state = &window.state().state;
        let id = state.active_sample().unwrap().scan_id();
        state.shown.curves(id)[4].readings[0]
    };
    let plain = first(&window);
    click(&mut window, "× cos theta");
    assert_eq!(window.state().state.view.quantity, Quantity::BrdfCosine);
    let with_cosine = first(&window);
    let expected = plain.value * plain.theta_deg.to_radians().cos();
    assert!((with_cosine.value - expected).abs() < 1e-15);
    click_role(&mut window, Role::ComboBox, "positive side");
    click(&mut window, "theta > 0: forward");
    assert_eq!(window.state().state.view.theta_positive, Side::Forward);
    let state = &window.state().state;
    let id = state.active_sample().unwrap().scan_id();
    let last = *state.shown.curves(id)[4].readings.last().unwrap();
    assert_eq!(last.theta_deg, -with_cosine.theta_deg);
    assert_eq!(last.value, with_cosine.value);
}

#[test]
fn residuals_share_the_view_angle() {
    let mut window = with_z307();
    click(&mut window, "residuals");
    assert!(window.query_by_label("Residual plot").is_some());
    let whole = plot(&window, "residuals").bounds().width();
    zoom_at(&mut window, "BRDF plot");
    let (above, below) = (plot(&window, "theory"), plot(&window, "residuals"));
    assert!(above.bounds().width() < 0.8 * whole);
    assert!((above.bounds().width() - below.bounds().width()).abs() < 1e-9);
}

fn zoom_at(window: &mut Window, label: &str) {
    let center = window.get_by_label(label).rect().center();
    window.hover_at(center);
    window.step();
    window.event(egui::Event::Zoom(1.5));
    settle(window);
}

#[test]
fn zoom_pan_and_reset() {
    let mut window = with_z307();
    let whole = *plot(&window, "theory").bounds();
    zoom_at(&mut window, "BRDF plot");
    let zoomed = *plot(&window, "theory").bounds();
    assert!(zoomed.width() < 0.8 * whole.width());
    let center = window.get_by_label("BRDF plot").rect().center();
    window.drag_at(center);
    window.step();
    window.hover_at(center + egui::vec2(60.0, 20.0));
    window.step();
    window.drop_at(center + egui::vec2(60.0, 20.0));
    settle(&mut window);
    let panned = *plot(&window, "theory").bounds();
    assert!((panned.width() - zoomed.width()).abs() < 1e-9 && panned.min()[0] < zoomed.min()[0]);
    click(&mut window, "Reset zoom");
    assert_eq!(plot(&window, "theory").bounds(), &whole);
    zoom_at(&mut window, "BRDF plot");
    window.key_press(egui::Key::Home);
    settle(&mut window);
    assert_eq!(plot(&window, "theory").bounds(), &whole);
}

#[test]
fn small_multiples_have_one_plot_an_incidence_with_the_same_axes() {
    let mut window = with_z307();
    click(&mut window, "Panels");
    assert_eq!(window.state().state.view.layout, Layout::Panels);
    let bounds: Vec<_> = (0..5)
        .map(|i| *plot(&window, &format!("theory {i}")).bounds())
        .collect();
    assert!(bounds.iter().all(|b| b == &bounds[0]));
    assert_eq!(window.get_all_by_label("BRDF plot").count(), 5);
}

#[test]
fn the_polar_form_has_f_r_as_radius() {
    let mut window = with_z307();
    click(&mut window, "Polar");
    let scan = window.state().state.active_sample().unwrap().scan();
    let (psi, brdf) = (scan.incidences[2].psi, scan.knobs.brdf().unwrap());
    let pixel = plot(&window, "polar").transform().dvalue_dpos()[0].abs();
    let curve = painted_curve(&window, "polar", colour_of(&window, 2));
    assert!(curve.len() > 100);
    for point in curve {
        let (radius, theta) = (point.x.hypot(point.y), point.x.atan2(point.y));
        if radius < 5.0 * pixel {
            continue;
        }
        let expected = brdf.value(&brdf_core::Geometry::in_plane(psi, theta).unwrap());
        assert!(
            (radius - expected).abs() < pixel + 0.02 * expected,
            "{point:?}: {expected}"
        );
    }
}

#[test]
fn the_pointer_reads_out_what_it_is_at() {
    let mut window = with_z307();
    let state = &window.state().state;
    let id = state.active_sample().unwrap().scan_id();
    let reading = state.shown.curves(id)[4].readings[2];
    let transform = plot(&window, "theory").transform();
    let at =
        transform.position_from_point(&egui_plot::PlotPoint::new(reading.theta_deg, reading.value));
    window.hover_at(at);
    window.run();
    let digits = brdf_fit::words::digits;
    for words in [
        "psi 70°".to_owned(),
        format!("theta {:.2}°", reading.theta_deg),
        format!("measured {}", digits(reading.value)),
        format!("theory {}", digits(reading.theory)),
        format!("difference {}", digits(reading.residual())),
    ] {
        assert!(shows(&window, &words), "{words}");
    }
}

#[test]
fn several_samples_are_shown_and_hidden_each_in_its_colours() {
    let mut window = with_z307();
    open_built_in(&mut window, "titanium_anodise.csv");
    open_built_in(&mut window, "Table 1, 001 at 0.91 um");
    let state = &window.state().state;
    let families: Vec<usize> = state.samples.iter().map(|sample| sample.family).collect();
    assert_eq!(families, [0, 1, 2]);
    assert_eq!(state.visible().count(), 3);
    // Theory alone has lines and no readings.
    let theory = state.active_sample().unwrap();
    assert_eq!(theory.scan().readings(), 0);
    assert_eq!(state.shown.curves(theory.scan_id()).len(), 5);
    let colour = colour_of(&window, 2);
    assert!(!painted_lines(&window, colour).is_empty());
    click(&mut window, "show Table 1, 001 at 0.91 um");
    assert!(painted_lines(&window, colour).is_empty());
    assert_eq!(window.state().state.visible().count(), 2);
    click(&mut window, "z307_on_aluminium");
    let state = &window.state().state;
    assert_eq!(state.active, Some(state.samples[0].id));
    click(&mut window, "close titanium_anodise");
    assert_eq!(window.state().state.samples.len(), 2);
}

#[test]
fn the_tabs_show_what_can_be_plotted_of_a_fit() {
    let mut window = with_z307();
    click(&mut window, "Both stages");
    click(&mut window, "E against iteration");
    assert!(
        window
            .query_by_label("plot of E against iteration")
            .is_some()
    );
    click(&mut window, "Profile of k1");
    assert!(window.query_by_label("plot of the profile of k1").is_some());
    click(&mut window, "Reflectance");
    assert!(
        window
            .query_by_label("plot of the hemispherical reflectance")
            .is_some()
    );
    click(&mut window, "Tables");
    assert!(shows(&window, "verdict"));
}
