//! The view of the data: visible incidences and samples, axes, layouts, zoom and tooltips.

use crate::common::{
    NoDialogs, Window, click, click_role, colour_of, drop_file, empty, menu, open_built_in,
    painted_areas, painted_curve, painted_lines, painted_marks, painted_segments, painted_texts,
    settle, shows, transform_of, window_with, with_z307,
};
use brdf_fit::Side;
use brdf_fit::plot::{Ground, Layout, Quantity, Scale};
use brdf_viewer::state::saved::Settings;
use brdf_viewer::theme;
use egui::accesskit::{Role, Toggled};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use egui_plot::{PlotMemory, PlotPoint};

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
            .visible_psi()
            .len()
    };
    assert_eq!(shown(&window), 5);
    click(&mut window, "70°");
    assert_eq!(shown(&window), 4);
    assert!(painted_lines(&window, colour).is_empty());
    click(&mut window, "hide all incidences");
    assert_eq!(shown(&window), 0);
    click(&mut window, "show all incidences");
    assert_eq!(shown(&window), 5);
    assert!(!painted_lines(&window, colour).is_empty());
}

#[test]
fn the_logarithmic_axis_shows_logarithms_and_counts_readings_without_one() {
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
    let text = "1 reading <= 0 cannot be shown on a logarithmic axis";
    assert!(shows(&window, text));
    let scan = window.state().state.active_sample().unwrap().scan();
    let brdf = scan.parameters.brdf().unwrap();
    let pixel = plot(&window, "theory").transform().dvalue_dpos()[1].abs();
    for point in painted_curve(&window, "theory", colour) {
        let at = brdf_core::Geometry::in_plane(scan.incidences[0].psi, point.x.to_radians());
        let expected = brdf.value(&at.unwrap()).log10();
        assert!((point.y - expected).abs() < pixel, "{point:?}: {expected}");
    }
}

#[test]
fn another_plane_than_the_plane_of_incidence_is_shown() {
    let mut window = empty();
    drop_file(&mut window, "two.csv", TWO_PLANES);
    assert!(shows(&window, "4 readings outside this plane"));
    click_role(&mut window, Role::ComboBox, "plane of view");
    click(&mut window, "φ = 90° / 270°");
    let state = &window.state().state;
    assert!((state.view.azimuth.to_degrees() - 90.0).abs() < 1e-9);
    let id = state.active_sample().unwrap().scan_id();
    let shown: Vec<f64> = state.derived.curves(id)[0]
        .readings
        .iter()
        .map(|r| r.theta_deg)
        .collect();
    // The direction of the normal is in every plane.
    assert_eq!(shown.len(), 4);
    assert!(
        (shown[0] + 40.0).abs() < 1e-9 && (shown[3] - 40.0).abs() < 1e-9,
        "{shown:?}"
    );
    assert!(shows(&window, "4 readings outside this plane"));
}

#[test]
fn error_bars_are_painted_where_sigma_is_given() {
    let mut window = empty();
    drop_file(&mut window, "two.csv", TWO_PLANES);
    let bars = |window: &Window| {
        let colour = colour_of(window, 1).gamma_multiply(0.55);
        painted_segments(window, colour).len()
    };
    assert_eq!(bars(&window), 2);
    click(&mut window, "Polar");
    assert_eq!(bars(&window), 2);
    click(&mut window, "Together");
    let plain = TWO_PLANES.replace(",sigma_per_sr", ",other");
    menu(&mut window, "File", "Close sample");
    drop_file(&mut window, "plain.csv", &plain);
    assert_eq!(bars(&window), 0);
}

#[test]
fn the_quantity_and_the_positive_side_are_chosen() {
    let mut window = with_z307();
    let first = |window: &Window| {
        let state = &window.state().state;
        let id = state.active_sample().unwrap().scan_id();
        state.derived.curves(id)[4].readings[0]
    };
    let plain = first(&window);
    click(&mut window, "× cos θ");
    assert_eq!(window.state().state.view.quantity, Quantity::BrdfCosine);
    let with_cosine = first(&window);
    let expected = plain.value * plain.theta_deg.to_radians().cos();
    assert!((with_cosine.value - expected).abs() < 1e-15);
    click_role(&mut window, Role::ComboBox, "positive side");
    click(&mut window, "θ > 0: forward");
    assert_eq!(window.state().state.view.theta_positive, Side::Forward);
    let state = &window.state().state;
    let id = state.active_sample().unwrap().scan_id();
    let last = *state.derived.curves(id)[4].readings.last().unwrap();
    assert_eq!(last.theta_deg, -with_cosine.theta_deg);
    assert_eq!(last.value, with_cosine.value);
}

#[test]
fn residuals_share_the_range_of_view_angles() {
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
fn a_plot_is_zoomed_panned_and_reset() {
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
    // A figure that is exported shows this part.
    settle(&mut window);
    let shown = window.state().state.zoom.unwrap();
    assert_eq!(shown.theta_deg, [panned.min()[0], panned.max()[0]]);
    click(&mut window, "Reset zoom");
    assert_eq!(plot(&window, "theory").bounds(), &whole);
    zoom_at(&mut window, "BRDF plot");
    window.key_press(egui::Key::Home);
    settle(&mut window);
    assert_eq!(plot(&window, "theory").bounds(), &whole);
}

#[test]
fn panels_show_one_plot_per_incidence_with_the_same_axes() {
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
fn the_polar_plot_has_f_r_as_radius() {
    let mut window = with_z307();
    click(&mut window, "Polar");
    let scan = window.state().state.active_sample().unwrap().scan();
    let (psi, brdf) = (scan.incidences[2].psi, scan.parameters.brdf().unwrap());
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
fn the_tooltip_shows_the_reading_at_the_pointer() {
    let mut window = with_z307();
    let state = &window.state().state;
    let id = state.active_sample().unwrap().scan_id();
    let reading = state.derived.curves(id)[4].readings[2];
    let transform = plot(&window, "theory").transform();
    let at = transform.position_from_point(&PlotPoint::new(reading.theta_deg, reading.value));
    window.hover_at(at);
    window.run();
    let digits = brdf_fit::format::digits;
    for text in [
        "ψ 70°".to_owned(),
        format!("θ {:.2}°", reading.theta_deg),
        format!("measured {}", digits(reading.value)),
        format!("theory {}", digits(reading.theory)),
        format!("difference {}", digits(reading.residual())),
    ] {
        assert!(shows(&window, &text), "{text}");
    }
}

#[test]
fn samples_are_shown_and_hidden_each_in_its_own_colours() {
    let mut window = with_z307();
    open_built_in(&mut window, "titanium_anodise.csv");
    open_built_in(&mut window, "Table 1, 001 at 0.91 um");
    let state = &window.state().state;
    let families: Vec<usize> = state.samples.iter().map(|sample| sample.family).collect();
    assert_eq!(families, [0, 1, 2]);
    assert_eq!(state.visible().count(), 3);
    // A theory without readings has lines and no marks.
    let theory = state.active_sample().unwrap();
    assert_eq!(theory.scan().reading_count(), 0);
    assert_eq!(state.derived.curves(theory.scan_id()).len(), 5);
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
fn the_tabs_plot_the_results_of_a_fit() {
    let mut window = with_z307();
    click(&mut window, "fit both stages");
    let scan = window.state().state.active_sample().unwrap().scan();
    let fit = scan.last_fit.as_ref().unwrap().fit.clone().unwrap();
    let first = theme::series_colour(0, Ground::Light);
    click(&mut window, "Iterations");
    let (line, numbers) = painted_result(&window, "plot of E against iteration", first);
    let iterations = fit.stage1.unwrap().iterations;
    assert_eq!(line.len() as u64, iterations + 1);
    assert!(numbers.len() > 2, "{numbers:?}");
    click(&mut window, "Profile");
    let (line, numbers) = painted_result(&window, "plot of the profile of k1", first);
    let profile = fit.global_check.unwrap().profile;
    assert_eq!(line.len(), profile.len());
    // The lowest painted point is that of the lowest E.
    let lowest = (0..line.len()).max_by(|a, b| line[*a].y.total_cmp(&line[*b].y));
    let error = |i: &usize| profile[*i].error;
    let expected = (0..profile.len()).min_by(|a, b| error(a).total_cmp(&error(b)));
    assert_eq!(lowest, expected);
    assert!(numbers.len() > 1, "{numbers:?}");
    click(&mut window, "Reflectance");
    let name = "plot of the hemispherical reflectance";
    let (line, numbers) = painted_result(&window, name, first);
    let state = &window.state().state;
    let rho = state
        .derived
        .reflectance(state.active_sample().unwrap().scan_id());
    assert_eq!(line.len(), rho.len());
    let last = rho.len() - 1;
    let slope = f64::from(line[last].y - line[0].y) / (rho[last][1] - rho[0][1]);
    for (at, [_, value]) in line.iter().zip(rho) {
        let expected = f64::from(line[0].y) + slope * (value - rho[0][1]);
        assert!((f64::from(at.y) - expected).abs() < 0.5, "{at:?}");
    }
    // The labels are evenly spaced.
    let values: Vec<f64> = numbers.iter().map(|text| text.parse().unwrap()).collect();
    let steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(steps.len() > 5, "{values:?}");
    assert!(steps.iter().all(|step| *step == steps[0]), "{values:?}");
    click(&mut window, "Report");
    assert!(shows(&window, "verdict"));
}

/// The longest line of a colour in a plot of the results, and the labels below the plot.
fn painted_result(
    window: &Window,
    name: &str,
    colour: egui::Color32,
) -> (Vec<egui::Pos2>, Vec<String>) {
    let frame = window.get_by_label(name).rect();
    let lines = painted_lines(window, colour).into_iter();
    let lines = lines.filter(|line| line.iter().all(|at| frame.expand(2.0).contains(*at)));
    let below = |rect: &egui::Rect| {
        rect.top() > frame.bottom() - 2.0
            && rect.bottom() < frame.bottom() + 18.0
            && (frame.left() - 20.0..frame.right() + 20.0).contains(&rect.center().x)
    };
    let texts = painted_texts(window).into_iter();
    let numbers = texts.filter(|(text, rect)| text.parse::<f64>().is_ok() && below(rect));
    (
        lines.max_by_key(Vec::len).unwrap_or_default(),
        numbers.map(|(text, _)| text).collect(),
    )
}

#[test]
fn readings_without_a_position_are_counted_before_thinning() {
    use std::fmt::Write as _;
    let mut text = "psi_deg,theta_deg,brdf_per_sr\n".to_owned();
    for i in 0..9000 {
        let brdf = if i % 3 == 0 { -0.01 } else { 0.1 };
        let _ = writeln!(text, "30,{:.3},{brdf}", -80.0 + 0.017 * f64::from(i));
    }
    let mut window = empty();
    drop_file(&mut window, "noisy.csv", &text);
    click(&mut window, "log");
    let text = "3000 readings <= 0 cannot be shown on a logarithmic axis";
    assert!(shows(&window, text));
}

#[test]
fn one_huge_sigma_does_not_determine_the_range_of_the_axis() {
    let mut window = empty();
    let tops = |window: &mut Window, text: &str| {
        drop_file(window, "two.csv", text);
        let linear = plot(window, "theory").bounds().max()[1];
        click(window, "log");
        let logarithmic = 10_f64.powf(plot(window, "theory").bounds().max()[1]);
        click(window, "log");
        menu(window, "File", "Close sample");
        [linear, logarithmic]
    };
    let before = tops(&mut window, TWO_PLANES);
    let huge = tops(&mut window, &TWO_PLANES.replace("0.4,0.02", "0.4,4000"));
    for (top, before) in huge.into_iter().zip(before) {
        assert!(top < 1.5 * before, "{top}: {before}");
    }
}

#[test]
fn the_mirror_direction_is_a_dashed_line() {
    let window = with_z307();
    let scan = window.state().state.active_sample().unwrap().scan();
    let transform = transform_of(&window, "theory");
    for (i, psi) in scan.visible_psi().into_iter().enumerate() {
        let dashes = painted_segments(&window, colour_of(&window, i).gamma_multiply(0.6));
        assert!(dashes.len() > 10, "{i}");
        for at in dashes.into_iter().flatten() {
            let theta = transform.value_from_position(at).x;
            assert!((theta + psi.to_degrees()).abs() < 0.1, "{theta}");
        }
    }
}

#[test]
fn the_band_extends_one_standard_error_to_both_sides() {
    let mut window = with_z307();
    let faint = colour_of(&window, 1).gamma_multiply(0.25);
    assert!(painted_areas(&window, faint).is_empty());
    click(&mut window, "fit both stages");
    let area = painted_areas(&window, faint).concat();
    let transform = transform_of(&window, "theory");
    let state = &window.state().state;
    let curve = &state
        .derived
        .curves(state.active_sample().unwrap().scan_id())[1];
    assert_eq!(area.len(), 2 * curve.theory.len());
    let pixel = transform.dvalue_dpos()[1].abs();
    for (theory, ends) in curve.theory.iter().zip(area.chunks(2)) {
        for (end, sign) in ends.iter().zip([1.0, -1.0]) {
            let at = transform.value_from_position(*end);
            let expected = theory.value + sign * theory.sigma.unwrap();
            assert!((at.y - expected).abs() < 0.1 * pixel + 1e-5 * expected);
        }
    }
}

#[test]
fn residuals_are_painted_at_their_values() {
    let mut window = with_z307();
    click(&mut window, "residuals");
    let transform = transform_of(&window, "residuals");
    let marks = painted_marks(&window, colour_of(&window, 3));
    let inside = marks
        .into_iter()
        .filter(|at| transform.frame().contains(*at));
    let painted: Vec<PlotPoint> = inside.map(|at| transform.value_from_position(at)).collect();
    let state = &window.state().state;
    let curve = &state
        .derived
        .curves(state.active_sample().unwrap().scan_id())[3];
    assert_eq!(painted.len(), curve.readings.len());
    let pixel = transform.dvalue_dpos()[1].abs();
    for (at, reading) in painted.iter().zip(&curve.readings) {
        assert!((at.x - reading.theta_deg).abs() < 0.2);
        assert!((at.y - reading.residual()).abs() < pixel, "{at:?}");
    }
}

#[test]
fn a_plot_zooms_into_a_rectangle_and_a_double_click_resets_it() {
    let mut window = with_z307();
    let whole = *plot(&window, "theory").bounds();
    let frame = *transform_of(&window, "theory").frame();
    let corners = [frame.center(), frame.center() + egui::vec2(120.0, 80.0)];
    let transform = transform_of(&window, "theory");
    let expected = corners.map(|at| transform.value_from_position(at));
    let button = |pos, pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Secondary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };
    // The rectangle starts where the pointer has moved far enough for a drag.
    let before = corners[0] - egui::vec2(10.0, 10.0);
    window.hover_at(before);
    window.step();
    window.event(button(before, true));
    window.step();
    for corner in corners {
        window.hover_at(corner);
        window.step();
    }
    window.event(button(corners[1], false));
    window.run_steps(30);
    let zoomed = *plot(&window, "theory").bounds();
    let pixel = transform.dvalue_dpos()[0].abs();
    let off = [
        zoomed.min()[0] - expected[0].x,
        zoomed.max()[0] - expected[1].x,
    ];
    assert!(off.iter().all(|off| off.abs() < 2.0 * pixel), "{zoomed:?}");
    for _ in 0..2 {
        window.drag_at(frame.center());
        window.step();
        window.drop_at(frame.center());
        window.step();
    }
    window.run_steps(30);
    assert_eq!(*plot(&window, "theory").bounds(), whole);
}

#[test]
fn the_theme_is_toggled_from_that_of_the_system_and_can_follow_it_again() {
    let mut window = with_z307();
    window.state_mut().state.interface.dark = None;
    for system in [egui::Theme::Dark, egui::Theme::Light] {
        let seen = |window: &mut Window| {
            window.input_mut().system_theme = Some(system);
            settle(window);
            window.ctx.theme()
        };
        assert_eq!(seen(&mut window), system);
        window.key_press(egui::Key::F9);
        assert_ne!(seen(&mut window), system);
        window.key_press(egui::Key::F9);
        assert_eq!(seen(&mut window), system);
        menu(&mut window, "View", "Theme of the system");
        assert_eq!(window.state().state.interface.dark, None);
        assert_eq!(seen(&mut window), system);
    }
}

#[test]
fn a_long_status_does_not_overlap_the_buttons() {
    let mut window = with_z307();
    let long = "/a/very/long/path".repeat(40);
    window.state_mut().state.status = long.clone();
    settle(&mut window);
    let status = window.get_by_label(&long).rect();
    for name in ["samples", "parameters", "results"] {
        let button = window.get_by_label(name).rect();
        assert!(!status.intersects(button), "{status:?} {button:?}");
    }
}

#[test]
fn the_tooltip_shows_the_theory_between_readings() {
    let mut window = empty();
    open_built_in(&mut window, "Table 1, 001 at 0.91 um");
    let state = &window.state().state;
    let curve = &state
        .derived
        .curves(state.active_sample().unwrap().scan_id())[1];
    let theory = curve.theory[250];
    let transform = transform_of(&window, "theory");
    let at = PlotPoint::new(theory.theta_deg, theory.value);
    window.hover_at(transform.position_from_point(&at));
    window.run();
    for text in [
        "ψ 30°".to_owned(),
        format!("θ {:.2}°", theory.theta_deg),
        format!("theory {}", brdf_fit::format::digits(theory.value)),
    ] {
        assert!(shows(&window, &text), "{text}");
    }
    assert!(!shows(&window, "measured") && !shows(&window, ", phi"));
}

#[test]
fn the_tooltip_shows_the_azimuth_outside_the_plane_of_incidence() {
    let mut window = empty();
    drop_file(&mut window, "two.csv", TWO_PLANES);
    click_role(&mut window, Role::ComboBox, "plane of view");
    click(&mut window, "φ = 90° / 270°");
    for (reading, phi) in [(0, ", φ 270°"), (3, ", φ 90°")] {
        let state = &window.state().state;
        let curve = &state
            .derived
            .curves(state.active_sample().unwrap().scan_id())[0];
        let reading = curve.readings[reading];
        let transform = transform_of(&window, "theory");
        let at = PlotPoint::new(reading.theta_deg, reading.value);
        window.hover_at(transform.position_from_point(&at));
        window.run();
        assert!(shows(&window, phi), "{phi}");
    }
}

#[test]
fn the_axes_have_names_and_units_in_a_small_window_and_in_panels() {
    let mut window = window_with([900.0, 600.0], NoDialogs, Settings::in_memory());
    open_built_in(&mut window, "z307_on_aluminium.csv");
    for layout in ["Together", "Panels", "Polar"] {
        click(&mut window, layout);
        let texts = painted_texts(&window);
        let has = |part: &str| texts.iter().any(|(text, _)| text.contains(part));
        assert!(has("(1/sr)"), "{layout}");
        assert!(has("theta / deg") || layout == "Polar", "{layout}");
    }
}

#[test]
fn the_polar_plot_omits_and_counts_negative_readings() {
    let mut window = empty();
    drop_file(&mut window, "two.csv", TWO_PLANES);
    let colour = colour_of(&window, 0);
    let marks = painted_marks(&window, colour).len();
    click(&mut window, "Polar");
    assert_eq!(painted_marks(&window, colour).len(), marks - 1);
    assert!(shows(&window, "1 reading < 0 cannot be shown as a radius"));
    let transform = transform_of(&window, "polar");
    let centre = transform.position_from_point(&PlotPoint::new(0.0, 0.0));
    let marks = painted_marks(&window, colour);
    assert!(
        marks.iter().all(|mark| mark.y < centre.y + 1.0),
        "{marks:?}"
    );
}

#[test]
fn the_polar_plot_has_a_band() {
    let mut window = with_z307();
    click(&mut window, "Polar");
    click(&mut window, "fit both stages");
    let area = painted_areas(&window, colour_of(&window, 2).gamma_multiply(0.25)).concat();
    assert!(area.len() > 100);
    let transform = transform_of(&window, "polar");
    let pixel = transform.dvalue_dpos()[0].abs();
    let state = &window.state().state;
    let curve = &state
        .derived
        .curves(state.active_sample().unwrap().scan_id())[2];
    for (theory, ends) in curve.theory.iter().zip(area.chunks(2)) {
        let (sin, cos) = theory.theta_deg.to_radians().sin_cos();
        for (end, sign) in ends.iter().zip([-1.0, 1.0]) {
            let at = transform.value_from_position(*end);
            let radius = (theory.value + sign * theory.sigma.unwrap()).max(0.0);
            let off = (at.x - radius * sin).hypot(at.y - radius * cos);
            assert!(off < 0.1 * pixel, "{at:?}");
        }
    }
}
