//! How the data are looked at: the line above the plot.

use brdf_fit::format::counted;
use brdf_fit::plot::{Layout, Scale};
use brdf_fit::scan::Side;
use egui::{Checkbox, ComboBox, Ui};

use crate::intent::{Command, Intent};
use crate::state::State;
use crate::widgets::{choose, degrees, named};

/// Draws the line, and below it what the plot cannot show.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    ui.horizontal_wrapped(|ui| {
        // Two lines shall do beside both panels in the smallest window.
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.spacing_mut().button_padding.x = 3.0;
        for (command, name) in [
            (Command::Together, "Together"),
            (Command::Panels, "Panels"),
            (Command::Polar, "Polar"),
        ] {
            let on = state.is_on(command) == Some(true);
            if ui
                .selectable_label(on, name)
                .on_hover_text(command.name())
                .clicked()
            {
                intents.push(Intent::Do(command));
            }
        }
        let cartesian = state.view.layout != Layout::Polar;
        for (command, name) in [
            (Command::Logarithmic, "log"),
            (Command::TimesCosine, "× cos θ"),
            (Command::Residuals, "residuals"),
        ] {
            let mut on = state.is_on(command) == Some(true);
            let possible = cartesian || command == Command::TimesCosine;
            let box_ = ui.add_enabled(possible, Checkbox::new(&mut on, name));
            if box_.on_hover_text(command.name()).changed() {
                intents.push(Intent::Do(command));
            }
        }
        show_side(ui, state, intents);
        show_planes(ui, state, intents);
        if ui.button("Reset zoom").clicked() {
            intents.push(Intent::Do(Command::ResetZoom));
        }
    });
    let left_out = left_out(state);
    if !left_out.is_empty() {
        ui.weak(left_out);
    }
}

fn show_side(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let name = |side: &Side| match side {
        Side::Source => "theta > 0: source".to_owned(),
        Side::Forward => "theta > 0: forward".to_owned(),
    };
    let mut view = state.view;
    let combo = ComboBox::from_id_salt("side").width(110.0);
    let sides = [Side::Source, Side::Forward];
    let shown = choose(ui, combo, &mut view.theta_positive, sides, name);
    named(shown, egui::Role::ComboBox, "positive side");
    if view != state.view {
        intents.push(Intent::View(view));
    }
}

/// The planes of view, where there are others than that of incidence.
fn show_planes(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let Some(sample) = state.active_sample() else {
        return;
    };
    let planes = &sample.scan().planes;
    if planes.iter().all(|plane| *plane == 0.0) {
        return;
    }
    let name = |azimuth: &f64| {
        let other = degrees(azimuth + std::f64::consts::PI);
        format!("phi = {} / {other}", degrees(*azimuth))
    };
    let mut view = state.view;
    let combo = ComboBox::from_id_salt("plane").width(130.0);
    let planes = planes.iter().copied();
    let shown = choose(ui, combo, &mut view.azimuth, planes, name);
    named(shown, egui::Role::ComboBox, "plane of view");
    if view != state.view {
        intents.push(Intent::View(view));
    }
}

/// What of the readings the plot does not show, in words.
fn left_out(state: &State) -> String {
    let (mut drawn, mut in_plane, mut all) = (0, 0, 0);
    let (mut not_positive, mut negative) = (0, 0);
    for sample in state.visible() {
        if let Some(selection) = state.shown.selection(sample.scan_id()) {
            drawn += selection.shown();
            in_plane += selection.all();
            not_positive += selection.not_positive();
            negative += selection.negative();
        }
        let shown = sample.scan().incidences.iter().filter(|i| i.shown);
        all += shown.map(|i| i.readings).sum::<usize>();
    }
    let mut words = Vec::new();
    let mut tell = |count: usize, what: String| {
        if count > 0 {
            words.push(what);
        }
    };
    let out = all.saturating_sub(in_plane);
    tell(
        out,
        format!("{} out of this plane", counted(out, "reading")),
    );
    tell(
        in_plane - drawn,
        format!(
            "{drawn} of {in_plane} readings drawn: the first, lowest and highest of each column of \
             points"
        ),
    );
    match (state.view.layout, state.view.scale) {
        (Layout::Polar, _) => tell(
            negative,
            format!(
                "{} < 0 cannot be shown as a radius",
                counted(negative, "reading")
            ),
        ),
        (_, Scale::Logarithmic) => tell(
            not_positive,
            format!(
                "{} <= 0 cannot be shown on a logarithmic axis",
                counted(not_positive, "reading")
            ),
        ),
        (_, Scale::Linear) => {}
    }
    words.join("; ")
}
