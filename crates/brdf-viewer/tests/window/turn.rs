//! What is turned by hand: sliders, numbers, the model, holding, undo and redo.

use crate::common::{
    Window, click, click_role, colour_of, menu, open_built_in, painted_curve, settle, type_number,
    with_z307,
};
use brdf_core::Geometry;
use brdf_fit::model::{Model, Parameter};
use brdf_viewer::state::sample::Knobs;
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};

fn knobs(window: &Window) -> Knobs {
    window.state().state.active_sample().unwrap().scan().knobs
}

fn e_percent(window: &Window) -> f64 {
    let state = &window.state().state;
    let id = state.active_sample().unwrap().scan_id();
    state.shown.errors(id).unwrap().unwrap().e_percent
}

/// Each painted curve is the theory of the parameters.
fn check_painted_curves(window: &Window) {
    let scan = window.state().state.active_sample().unwrap().scan();
    let brdf = scan.knobs.brdf().unwrap();
    let id = brdf_viewer::plot::id(&window.state().state, "theory");
    let memory = egui_plot::PlotMemory::load(&window.ctx, id).unwrap();
    let pixel = memory.transform().dvalue_dpos()[1].abs();
    let top = memory.bounds().max()[1];
    for (i, psi) in scan.shown_psi().into_iter().enumerate() {
        let curve = painted_curve(window, "theory", colour_of(window, i));
        assert!(curve.len() > 100, "psi = {psi}: {} points", curve.len());
        for point in curve {
            let theta = point.x.to_radians();
            let expected = brdf.value(&Geometry::in_plane(psi, theta).unwrap());
            if expected > top {
                continue;
            }
            // Near the mirror direction a hundredth of a pixel in theta shows in f_r.
            let aside = 2e-3_f64.to_radians();
            let slope =
                (brdf.value(&Geometry::in_plane(psi, theta + aside).unwrap()) - expected).abs();
            let error = (point.y - expected).abs();
            assert!(
                error < 0.2 * pixel + 2.0 * slope,
                "psi {psi}, {point:?}: {expected}"
            );
        }
    }
}

#[test]
fn a_slider_is_dragged_and_everything_follows_in_the_same_frame() {
    let mut window = with_z307();
    check_painted_curves(&window);
    let before = (knobs(&window), e_percent(&window));
    let rail = window.get_by_role_and_label(Role::Slider, "k1").rect();
    let at = |part: f32| egui::pos2(rail.left() + rail.width() * part, rail.center().y);
    window.hover_at(at(0.5));
    window.step();
    window.drag_at(at(0.5));
    window.step();
    window.hover_at(at(0.9));
    window.step();
    // No further frame: what was painted with this one is the new theory.
    let dragged = knobs(&window);
    assert!(dragged.at.k1 > 2.0 * before.0.at.k1, "{dragged:?}");
    assert_eq!(dragged.at.k2, before.0.at.k2);
    assert_ne!(e_percent(&window), before.1);
    check_painted_curves(&window);
    let words = format!("E = {} %", brdf_fit::format::digits(e_percent(&window)));
    assert!(window.query_by_label(&words).is_some());
    window.drop_at(at(0.9));
    settle(&mut window);
    // The drag is taken back as one.
    click_role(&mut window, Role::Button, "Undo");
    assert_eq!(knobs(&window), before.0);
    click_role(&mut window, Role::Button, "Redo");
    assert_eq!(knobs(&window), dragged);
}

#[test]
fn a_number_is_typed_and_more_than_the_slider_reaches() {
    let mut window = with_z307();
    type_number(&mut window, "k2", "0.125");
    assert_eq!(knobs(&window).at.k2, 0.125);
    type_number(&mut window, "k1", "55");
    assert_eq!(knobs(&window).at.k1, 55.0);
    type_number(&mut window, "k1", "1e9");
    assert_eq!(knobs(&window).at.k1, Parameter::K1.range().1);
    type_number(&mut window, "kD", "-3");
    assert_eq!(knobs(&window).at.kd, 0.0);
    let before = knobs(&window);
    type_number(&mut window, "n", "what?");
    assert_eq!(knobs(&window), before);
    check_painted_curves(&window);
}

#[test]
fn a_number_that_is_looked_at_does_not_change() {
    let mut window = with_z307();
    click(&mut window, "Both stages");
    let before = knobs(&window);
    window.get_by_role_and_label(Role::SpinButton, "k1").click();
    settle(&mut window);
    window.key_press(egui::Key::Enter);
    settle(&mut window);
    assert_eq!(knobs(&window), before);
}

#[test]
fn a_double_click_and_the_button_reset_to_the_fit() {
    let mut window = with_z307();
    click(&mut window, "Both stages");
    let fitted = knobs(&window);
    type_number(&mut window, "k1", "0.9");
    type_number(&mut window, "k2", "0.9");
    let rail = window.get_by_role_and_label(Role::Slider, "k1").rect();
    // Long after the last click: the third in a row would be a triple click.
    window.run_steps(60);
    for _ in 0..2 {
        window.drag_at(rail.center());
        window.step();
        window.drop_at(rail.center());
        window.step();
    }
    settle(&mut window);
    assert_eq!(knobs(&window).at.k1, fitted.at.k1);
    assert_eq!(knobs(&window).at.k2, 0.9);
    click(&mut window, "reset k2");
    assert_eq!(knobs(&window), fitted);
    type_number(&mut window, "kD", "0.5");
    click(&mut window, "Reset all");
    assert_eq!(knobs(&window), fitted);
}

#[test]
fn the_keys_of_a_slider_move_it() {
    let mut window = with_z307();
    let before = knobs(&window).at.k2;
    window.get_by_role_and_label(Role::Slider, "k2").focus();
    window.run();
    window.key_press(egui::Key::ArrowRight);
    settle(&mut window);
    assert!(knobs(&window).at.k2 > before);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    settle(&mut window);
    assert_eq!(knobs(&window).at.k2, before);
    let redo = egui::Modifiers::COMMAND.plus(egui::Modifiers::SHIFT);
    window.key_press_modifiers(redo, egui::Key::Z);
    settle(&mut window);
    assert!(knobs(&window).at.k2 > before);
}

#[test]
fn every_model_can_be_chosen_and_has_its_parameters() {
    let mut window = with_z307();
    for model in Model::ALL {
        window
            .get_by_role_and_label(Role::ComboBox, "model")
            .click();
        window.run();
        let name = format!("{model}: {}", model.description());
        let entries = window.get_all_by_label(&name);
        entries.last().unwrap().click();
        settle(&mut window);
        assert_eq!(knobs(&window).model, model);
        for parameter in Parameter::ALL {
            let name = parameter.to_string();
            let slider = window
                .query_by_role_and_label(Role::Slider, &name)
                .is_some();
            assert_eq!(slider, knobs(&window).parameters().contains(&parameter));
        }
        check_painted_curves(&window);
    }
    menu(&mut window, "Edit", "Undo");
    assert_eq!(knobs(&window).model, Model::ALL[Model::ALL.len() - 2]);
}

#[test]
fn a_fit_leaves_a_held_parameter_as_it_is() {
    let mut window = with_z307();
    type_number(&mut window, "k1", "0.3");
    click(&mut window, "hold k1");
    let held = window.get_by_label("hold k1");
    assert_eq!(
        held.accesskit_node().toggled(),
        Some(egui::accesskit::Toggled::True)
    );
    let free = knobs(&window).at.k2;
    click(&mut window, "Both stages");
    assert_eq!(knobs(&window).at.k1, 0.3);
    assert_ne!(knobs(&window).at.k2, free);
    click(&mut window, "hold k1");
    click(&mut window, "Both stages");
    assert_ne!(knobs(&window).at.k1, 0.3);
}

#[test]
fn parameters_are_those_of_the_wavelength() {
    let mut window = with_z307();
    type_number(&mut window, "k1", "0.7");
    window
        .get_by_role_and_label(Role::ComboBox, "Wavelength")
        .click();
    window.run();
    window.get_by_label("0.85223 um").click();
    settle(&mut window);
    assert_ne!(knobs(&window).at.k1, 0.7);
    assert_eq!(window.state().state.active_sample().unwrap().current, 1);
    // Undoing shows what is undone.
    menu(&mut window, "Edit", "Undo");
    assert_eq!(window.state().state.active_sample().unwrap().current, 0);
}

#[test]
fn a_model_is_chosen_for_all_wavelengths_and_taken_back_as_one() {
    let mut window = with_z307();
    let models = |window: &Window| {
        let scans = window.state().state.active_sample().unwrap().scans.iter();
        scans.map(|scan| scan.knobs.model).collect::<Vec<_>>()
    };
    click_role(&mut window, Role::ComboBox, "model");
    let name = format!("{}: {}", Model::PowerN, Model::PowerN.description());
    window.get_all_by_label(&name).last().unwrap().click();
    settle(&mut window);
    assert_eq!(models(&window), [Model::PowerN, Model::Three]);
    click(&mut window, "This model for all wavelengths");
    assert_eq!(models(&window), [Model::PowerN; 2]);
    menu(&mut window, "Edit", "Undo");
    assert_eq!(models(&window), [Model::PowerN, Model::Three]);
    menu(&mut window, "Edit", "Redo");
    assert_eq!(models(&window), [Model::PowerN; 2]);
}

#[test]
fn resetting_leaves_what_is_held() {
    let mut window = with_z307();
    // Without a fit, and with one.
    for _ in 0..2 {
        type_number(&mut window, "k1", "0.9");
        click(&mut window, "hold k1");
        click(&mut window, "Reset all");
        assert!(knobs(&window).holds(Parameter::K1));
        assert_ne!(knobs(&window).at.k1, 0.9);
        click(&mut window, "hold k1");
        click(&mut window, "Both stages");
    }
}

#[test]
fn what_is_taken_back_is_shown() {
    let mut window = with_z307();
    type_number(&mut window, "k1", "0.7");
    open_built_in(&mut window, "titanium_anodise.csv");
    click(&mut window, "show z307_on_aluminium");
    assert!(!window.state().state.samples[0].visible);
    menu(&mut window, "Edit", "Undo");
    let state = &window.state().state;
    assert!(state.samples[0].visible);
    assert_eq!(state.active, Some(state.samples[0].id));
    assert_ne!(knobs(&window).at.k1, 0.7);
}
