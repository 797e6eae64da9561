//! Editing of parameters: sliders, number boxes, models, fixed parameters, undo and redo.

use crate::common::{
    Window, click, click_role, colour_of, menu, open_built_in, painted_curve, settle, type_number,
    with_z307,
};
use brdf_core::Geometry;
use brdf_fit::{Model, Parameter};
use brdf_viewer::state::parameters::EditedParameters;
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};

fn parameters(window: &Window) -> EditedParameters {
    window
        .state()
        .state
        .active_sample()
        .unwrap()
        .scan()
        .parameters
}

fn e_percent(window: &Window) -> f64 {
    let state = &window.state().state;
    let id = state.active_sample().unwrap().scan_id();
    state.derived.errors(id).unwrap().unwrap().e_percent
}

/// Checks that each painted curve is the theory of the current parameters.
fn check_painted_curves(window: &Window) {
    let scan = window.state().state.active_sample().unwrap().scan();
    let brdf = scan.parameters.brdf().unwrap();
    let id = brdf_viewer::plot::id(&window.state().state, "theory");
    let memory = egui_plot::PlotMemory::load(&window.ctx, id).unwrap();
    let pixel = memory.transform().dvalue_dpos()[1].abs();
    let top = memory.bounds().max()[1];
    for (i, psi) in scan.visible_psi().into_iter().enumerate() {
        let curve = painted_curve(window, "theory", colour_of(window, i));
        assert!(curve.len() > 100, "psi = {psi}: {} points", curve.len());
        for point in curve {
            let theta = point.x.to_radians();
            let expected = brdf.value(&Geometry::in_plane(psi, theta).unwrap());
            if expected > top {
                continue;
            }
            // Near the mirror direction, a hundredth of a pixel in theta changes f_r visibly.
            let offset = 2e-3_f64.to_radians();
            let slope =
                (brdf.value(&Geometry::in_plane(psi, theta + offset).unwrap()) - expected).abs();
            let error = (point.y - expected).abs();
            assert!(
                error < 0.2 * pixel + 2.0 * slope,
                "psi {psi}, {point:?}: {expected}"
            );
        }
    }
}

#[test]
fn dragging_a_slider_updates_everything_in_the_same_frame() {
    let mut window = with_z307();
    check_painted_curves(&window);
    let before = (parameters(&window), e_percent(&window));
    let rail = window.get_by_role_and_label(Role::Slider, "k1").rect();
    let at = |fraction: f32| egui::pos2(rail.left() + rail.width() * fraction, rail.center().y);
    window.hover_at(at(0.5));
    window.step();
    window.drag_at(at(0.5));
    window.step();
    window.hover_at(at(0.9));
    window.step();
    // Without a further frame, the painted curves are those of the new parameters.
    let dragged = parameters(&window);
    assert!(dragged.values.k1 > 2.0 * before.0.values.k1, "{dragged:?}");
    assert_eq!(dragged.values.k2, before.0.values.k2);
    assert_ne!(e_percent(&window), before.1);
    check_painted_curves(&window);
    let e = e_percent(&window);
    let digits = brdf_fit::format::two_digits;
    let text = format!(
        "rms error {} % (E = {} %)",
        digits(brdf_fit::rms_percent(e)),
        digits(e)
    );
    assert!(window.query_by_label(&text).is_some());
    window.drop_at(at(0.9));
    settle(&mut window);
    // The drag is undone in one step.
    click_role(&mut window, Role::Button, "Undo");
    assert_eq!(parameters(&window), before.0);
    click_role(&mut window, Role::Button, "Redo");
    assert_eq!(parameters(&window), dragged);
}

#[test]
fn a_number_box_accepts_values_beyond_the_slider() {
    let mut window = with_z307();
    type_number(&mut window, "k2", "0.125");
    assert_eq!(parameters(&window).values.k2, 0.125);
    type_number(&mut window, "k1", "55");
    assert_eq!(parameters(&window).values.k1, 55.0);
    type_number(&mut window, "k1", "1e9");
    assert_eq!(parameters(&window).values.k1, Parameter::K1.range().1);
    type_number(&mut window, "kD", "-3");
    assert_eq!(parameters(&window).values.kd, 0.0);
    let before = parameters(&window);
    type_number(&mut window, "n", "what?");
    assert_eq!(parameters(&window), before);
    check_painted_curves(&window);
}

#[test]
fn a_number_box_that_is_left_unchanged_does_not_round_its_value() {
    let mut window = with_z307();
    click(&mut window, "fit both stages");
    let before = parameters(&window);
    window.get_by_role_and_label(Role::SpinButton, "k1").click();
    settle(&mut window);
    window.key_press(egui::Key::Enter);
    settle(&mut window);
    assert_eq!(parameters(&window), before);
}

#[test]
fn a_double_click_and_the_button_reset_to_the_fit() {
    let mut window = with_z307();
    click(&mut window, "fit both stages");
    let fitted = parameters(&window);
    type_number(&mut window, "k1", "0.9");
    type_number(&mut window, "k2", "0.9");
    let rail = window.get_by_role_and_label(Role::Slider, "k1").rect();
    // Wait after the last click, because a third click in a row would be a triple click.
    window.run_steps(60);
    for _ in 0..2 {
        window.drag_at(rail.center());
        window.step();
        window.drop_at(rail.center());
        window.step();
    }
    settle(&mut window);
    assert_eq!(parameters(&window).values.k1, fitted.values.k1);
    assert_eq!(parameters(&window).values.k2, 0.9);
    click(&mut window, "reset k2");
    assert_eq!(parameters(&window), fitted);
    type_number(&mut window, "kD", "0.5");
    click(&mut window, "Reset all");
    assert_eq!(parameters(&window), fitted);
}

#[test]
fn arrow_keys_move_a_slider() {
    let mut window = with_z307();
    let before = parameters(&window).values.k2;
    window.get_by_role_and_label(Role::Slider, "k2").focus();
    window.run();
    window.key_press(egui::Key::ArrowRight);
    settle(&mut window);
    assert!(parameters(&window).values.k2 > before);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    settle(&mut window);
    assert_eq!(parameters(&window).values.k2, before);
    let redo = egui::Modifiers::COMMAND.plus(egui::Modifiers::SHIFT);
    window.key_press_modifiers(redo, egui::Key::Z);
    settle(&mut window);
    assert!(parameters(&window).values.k2 > before);
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
        assert_eq!(parameters(&window).model, model);
        for parameter in Parameter::ALL {
            let name = parameter.to_string();
            let slider = window
                .query_by_role_and_label(Role::Slider, &name)
                .is_some();
            assert_eq!(
                slider,
                parameters(&window).model_parameters().contains(&parameter)
            );
        }
        check_painted_curves(&window);
    }
    menu(&mut window, "Edit", "Undo");
    assert_eq!(parameters(&window).model, Model::ALL[Model::ALL.len() - 2]);
}

#[test]
fn a_fit_does_not_change_a_fixed_parameter() {
    let mut window = with_z307();
    type_number(&mut window, "k1", "0.3");
    click(&mut window, "fix k1");
    let fixed = window.get_by_label("fix k1");
    assert_eq!(
        fixed.accesskit_node().toggled(),
        Some(egui::accesskit::Toggled::True)
    );
    let free = parameters(&window).values.k2;
    click(&mut window, "fit both stages");
    assert_eq!(parameters(&window).values.k1, 0.3);
    assert_ne!(parameters(&window).values.k2, free);
    click(&mut window, "fix k1");
    click(&mut window, "fit both stages");
    assert_ne!(parameters(&window).values.k1, 0.3);
}

#[test]
fn each_wavelength_has_its_own_parameters() {
    let mut window = with_z307();
    type_number(&mut window, "k1", "0.7");
    window.get_by_label("wavelength 0.85223 µm").click();
    settle(&mut window);
    assert_ne!(parameters(&window).values.k1, 0.7);
    assert_eq!(window.state().state.active_sample().unwrap().current, 1);
    // Undo selects the wavelength that it changes.
    menu(&mut window, "Edit", "Undo");
    assert_eq!(window.state().state.active_sample().unwrap().current, 0);
}

#[test]
fn a_model_is_set_for_all_wavelengths_and_undone_in_one_step() {
    let mut window = with_z307();
    let models = |window: &Window| {
        let scans = window.state().state.active_sample().unwrap().scans.iter();
        scans.map(|scan| scan.parameters.model).collect::<Vec<_>>()
    };
    click_role(&mut window, Role::ComboBox, "model");
    let name = format!("{}: {}", Model::PowerN, Model::PowerN.description());
    window.get_all_by_label(&name).last().unwrap().click();
    settle(&mut window);
    assert_eq!(models(&window), [Model::PowerN, Model::Three]);
    click(&mut window, "Use this model for all wavelengths");
    assert_eq!(models(&window), [Model::PowerN; 2]);
    menu(&mut window, "Edit", "Undo");
    assert_eq!(models(&window), [Model::PowerN, Model::Three]);
    menu(&mut window, "Edit", "Redo");
    assert_eq!(models(&window), [Model::PowerN; 2]);
}

#[test]
fn reset_keeps_parameters_fixed() {
    let mut window = with_z307();
    // Without a fit, and with one.
    for _ in 0..2 {
        type_number(&mut window, "k1", "0.9");
        click(&mut window, "fix k1");
        click(&mut window, "Reset all");
        assert!(parameters(&window).is_fixed(Parameter::K1));
        assert_ne!(parameters(&window).values.k1, 0.9);
        click(&mut window, "fix k1");
        click(&mut window, "fit both stages");
    }
}

#[test]
fn undo_shows_the_sample_that_it_changes() {
    let mut window = with_z307();
    type_number(&mut window, "k1", "0.7");
    open_built_in(&mut window, "titanium_anodise.csv");
    click(&mut window, "show z307_on_aluminium");
    assert!(!window.state().state.samples[0].visible);
    menu(&mut window, "Edit", "Undo");
    let state = &window.state().state;
    assert!(state.samples[0].visible);
    assert_eq!(state.active, Some(state.samples[0].id));
    assert_ne!(parameters(&window).values.k1, 0.7);
}
