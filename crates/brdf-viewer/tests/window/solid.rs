//! The lobe and the surface in three dimensions.

use std::fmt::Write as _;
use std::path::Path;

use crate::common::{
    Window, click, click_role, drop_file, empty, enter_path, menu, open_built_in, press, release,
    settle, shows, type_number, with_z307,
};
use brdf_fit::plot::{Layout, Quantity, Scale};
use brdf_viewer::solid::Camera;
use brdf_viewer::state::solid::{Beside, Solid, SolidView};
use egui::accesskit::Role;
use egui::{Event, Key, MouseWheelUnit, Pos2, TouchPhase, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};

fn view(window: &Window) -> SolidView {
    window.state().state.solid
}

/// A window with the lobe of Z307.
fn with_lobe() -> Window {
    let mut window = with_z307();
    click(&mut window, "Lobe");
    assert_eq!(view(&window).shown, Some(Solid::Lobe));
    window
}

fn centre(window: &Window, name: &str) -> Pos2 {
    window.get_by_label(name).rect().center()
}

fn drag(window: &mut Window, name: &str, by: egui::Vec2) {
    let from = centre(window, name);
    press(window, from);
    window.hover_at(from + 0.5 * by);
    window.step();
    release(window, from + by);
}

fn write(window: &mut Window, entry: &str, path: &Path) {
    menu(window, "File", entry);
    enter_path(window, path);
    click_role(window, Role::Button, "Save");
    for _ in 0..2000 {
        window.step();
        if path.exists() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    settle(window);
    assert!(path.exists(), "{} was not written", path.display());
}

/// The pixels of the ball of the active sample.
fn ball(window: &Window) -> egui::ColorImage {
    let panes = &window.state().state.derived_solid;
    let first = panes.panes().next().unwrap();
    (*first.pictures[0]).clone()
}

#[test]
fn the_mouse_turns_and_magnifies_the_lobe_and_a_double_click_resets_it() {
    let mut window = with_lobe();
    drag(&mut window, "BRDF lobe", vec2(60.0, 40.0));
    let turned = view(&window).camera;
    let initial = Camera::default();
    assert!((turned.yaw - initial.turned(-0.6, 0.0).yaw).abs() < 0.02);
    assert!(turned.pitch > initial.pitch + 0.3, "{turned:?}");
    let at = centre(&window, "BRDF lobe");
    window.hover_at(at);
    window.step();
    window.event(Event::MouseWheel {
        unit: MouseWheelUnit::Point,
        delta: vec2(0.0, 100.0),
        phase: TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: egui::Modifiers::NONE,
    });
    settle(&mut window);
    assert!(view(&window).camera.zoom > 1.1);
    for _ in 0..2 {
        window.drag_at(at);
        window.step();
        window.drop_at(at);
        window.step();
    }
    settle(&mut window);
    assert_eq!(view(&window).camera, initial);
}

#[test]
fn the_keys_turn_and_magnify_the_lobe_that_was_clicked() {
    let mut window = with_lobe();
    let initial = Camera::default();
    window.key_press(Key::ArrowLeft);
    settle(&mut window);
    assert_eq!(view(&window).camera, initial);
    let at = centre(&window, "BRDF lobe");
    press(&mut window, at);
    release(&mut window, at);
    for key in [Key::ArrowLeft, Key::ArrowLeft, Key::ArrowUp, Key::Plus] {
        window.key_press(key);
        settle(&mut window);
    }
    let camera = view(&window).camera;
    assert!((camera.yaw - initial.yaw - 0.2).abs() < 1e-9, "{camera:?}");
    assert!((camera.pitch - initial.pitch - 0.1).abs() < 1e-9);
    assert!((camera.zoom - 1.2).abs() < 1e-9);
    window.key_press(Key::Home);
    settle(&mut window);
    assert_eq!(view(&window).camera, initial);
}

#[test]
fn quantity_and_radius_of_the_lobe_are_its_own() {
    let mut window = with_lobe();
    let axes = |window: &Window| {
        let scene = window.state().state.derived_solid.lobe().unwrap();
        (scene.lobe.quantity, view(window).scale)
    };
    assert_eq!(axes(&window), (Quantity::BrdfCosine, Scale::Linear));
    assert!(!shows(&window, "open at the rim"));
    click(&mut window, "× cos θ");
    click(&mut window, "log");
    assert_eq!(axes(&window), (Quantity::Brdf, Scale::Logarithmic));
    assert!(shows(&window, "open at the rim"));
    let plot = window.state().state.view;
    assert_eq!((plot.quantity, plot.scale), (Quantity::Brdf, Scale::Linear));
    click(&mut window, "Polar");
    assert_eq!(view(&window).shown, None);
    assert_eq!(window.state().state.view.layout, Layout::Polar);
    window.key_press_modifiers(egui::Modifiers::COMMAND, Key::Num4);
    settle(&mut window);
    assert_eq!(axes(&window), (Quantity::Brdf, Scale::Logarithmic));
}

#[test]
fn any_incidence_has_a_lobe_with_the_nearest_readings() {
    let mut window = with_lobe();
    let lobe = |window: &Window| {
        let scene = window.state().state.derived_solid.lobe().unwrap();
        (scene.lobe.psi.to_degrees(), scene.readings.len())
    };
    assert!((lobe(&window).0 - 30.0).abs() < 1e-9);
    click_role(&mut window, Role::ComboBox, "measured incidence");
    let choices = window.query_all_by_role_and_label(Role::Button, "70°");
    choices.last().unwrap().click();
    settle(&mut window);
    let (psi_deg, readings) = lobe(&window);
    assert!((psi_deg - 70.0).abs() < 1e-9 && readings == 27);
    type_number(&mut window, "incidence of the lobe", "42.5");
    let (psi_deg, readings) = lobe(&window);
    assert!((psi_deg - 42.5).abs() < 1e-9 && readings == 28);
    assert!(shows(&window, "at ψ = 42.5°") && shows(&window, "readings at 50°"));
}

#[test]
fn a_pinned_theory_or_another_sample_is_a_second_lobe() {
    let mut window = with_lobe();
    let has_ghost = |window: &Window| {
        let scene = window.state().state.derived_solid.lobe().unwrap();
        scene.ghost.is_some()
    };
    assert!(!has_ghost(&window));
    menu(&mut window, "Edit", "Pin curves");
    assert!(has_ghost(&window));
    click_role(&mut window, Role::ComboBox, "shown beside");
    click(&mut window, "beside: nothing");
    assert!(!has_ghost(&window));
    open_built_in(&mut window, "titanium_anodise.csv");
    click_role(&mut window, Role::ComboBox, "shown beside");
    let other = window.query_all_by_label("z307_on_aluminium");
    other.last().unwrap().click();
    settle(&mut window);
    assert!(matches!(view(&window).beside, Beside::Sample(_)));
    assert!(has_ghost(&window));
    menu(&mut window, "File", "Close all samples");
    assert!(window.state().state.derived_solid.lobe().is_none());
}

#[test]
fn the_lobe_is_written_as_figure_and_as_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = with_lobe();
    let path = |name: &str| folder.path().join(name);
    write(&mut window, "Export figure as SVG...", &path("a.svg"));
    let svg = std::fs::read_to_string(path("a.svg")).unwrap();
    assert!(svg.matches("<polygon").count() > 5000 && svg.contains("mirror"));
    assert!(svg.contains("z307_on_aluminium") && svg.contains("ψ = 30°"));
    write(&mut window, "Export figure as PNG...", &path("a.png"));
    assert!(image::open(path("a.png")).unwrap().width() >= 2000);
    write(&mut window, "Export lobe as OBJ...", &path("a.obj"));
    let obj = std::fs::read_to_string(path("a.obj")).unwrap();
    let count = |kind: &str| obj.lines().filter(|line| line.starts_with(kind)).count();
    assert_eq!(count("v "), count("vt "));
    assert!(count("f ") > 5000);
    click(&mut window, "Together");
    window.get_by_role_and_label(Role::Button, "File").click();
    window.run();
    let entry = window.get_by_label_contains("Export lobe as OBJ");
    assert!(entry.accesskit_node().is_disabled());
}

#[test]
fn the_surface_follows_a_parameter_the_lamp_and_the_exposure() {
    let mut window = with_z307();
    click(&mut window, "Surface");
    let first = ball(&window);
    assert!(shows(&window, "grey at 0.63079 µm"));
    type_number(&mut window, "kD", "0.1");
    let brighter = ball(&window);
    assert_ne!(first, brighter);
    drag(&mut window, "ball of z307_on_aluminium", vec2(-50.0, 20.0));
    let lamp = view(&window).lamp_deg;
    assert!(
        (lamp[0] - 10.0).abs() < 1.0 && (lamp[1] - 25.0).abs() < 1.0,
        "{lamp:?}"
    );
    assert_ne!(ball(&window), brighter);
    let before = window.state().state.derived_solid.stops();
    type_number(&mut window, "exposure", "6");
    assert_eq!(view(&window).stops, Some(6.0));
    click(&mut window, "automatic exposure");
    assert_eq!(view(&window).stops, None);
    assert_eq!(window.state().state.derived_solid.stops(), before);
}

#[test]
fn a_fit_that_reflects_more_than_all_light_is_darkened_automatically() {
    let mut window = with_z307();
    type_number(&mut window, "kD", "4");
    click(&mut window, "Surface");
    settle(&mut window);
    assert_eq!(view(&window).stops, None);
    assert_eq!(window.state().state.derived_solid.stops()[0], -2.5);
}

#[test]
fn two_samples_are_side_by_side_at_the_same_exposure_and_written_as_png() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let mut window = with_z307();
    open_built_in(&mut window, "titanium_anodise.csv");
    click(&mut window, "Surface");
    let names: Vec<String> = {
        let panes = window.state().state.derived_solid.panes();
        panes.map(|pane| pane.name.clone()).collect()
    };
    assert_eq!(names, ["titanium_anodise", "z307_on_aluminium"]);
    write(&mut window, "Export figure as PNG...", &path);
    let image = image::open(&path).unwrap();
    assert_eq!((image.width(), image.height()), (2048, 1536));
    window.get_by_role_and_label(Role::Button, "File").click();
    window.run();
    let entry = window.get_by_label_contains("Export figure as SVG");
    assert!(entry.accesskit_node().is_disabled());
}

#[test]
fn three_wavelengths_are_red_green_and_blue() {
    let mut text = "wavelength_um,psi_deg,theta_deg,brdf_per_sr\n".to_owned();
    for (um, brdf) in [(0.46, 0.02), (0.55, 0.06), (0.61, 0.2)] {
        for theta in [-60, -30, 0, 20, 50] {
            let _ = writeln!(text, "{um},10,{theta},{brdf}\n{um},50,{theta},{brdf}");
        }
    }
    let mut window = empty();
    drop_file(&mut window, "red.csv", &text);
    window.key_press_modifiers(egui::Modifiers::SHIFT, Key::F5);
    settle(&mut window);
    click(&mut window, "Surface");
    assert!(shows(&window, "in colour: 0.61, 0.55, 0.46 µm"));
    let ball = ball(&window);
    let lit = ball.pixels[ball.size[0] * ball.size[1] / 2 + ball.size[0] * 5 / 8];
    assert!(lit.r() > lit.g() && lit.g() > lit.b(), "{lit:?}");
}
