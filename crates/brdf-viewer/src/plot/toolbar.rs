//! The toolbar above the plot: layout, axes, plane, and readings that are not shown.

use brdf_fit::Side;
use brdf_fit::format::counted;
use brdf_fit::plot::{Layout, Scale};
use egui::{Button, Checkbox, ComboBox, Shape, Stroke, Ui, vec2};

use super::items::dashes;
use super::solid_toolbar;
use crate::intent::{Command, Intent};
use crate::state::State;
use crate::state::interface::ResidualKind;
use crate::state::solid::Solid;
use crate::widgets::{choose, degrees, named};

/// Draws the toolbar, and below it a note on readings that are not shown.
pub(super) fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    ui.horizontal_wrapped(|ui| {
        // Narrow spacing, so that two lines suffice between both panels in the smallest window.
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.spacing_mut().button_padding.x = 3.0;
        show_layouts(ui, state, intents);
        match state.solid.shown {
            None => show_curve_controls(ui, state, intents),
            Some(Solid::Lobe) => solid_toolbar::show_lobe(ui, state, intents),
            Some(Solid::Surface) => solid_toolbar::show_surface(ui, state, intents),
        }
        if ui.button("Reset zoom").clicked() {
            intents.push(Intent::Command(Command::ResetZoom));
        }
    });
    if state.solid.shown == Some(Solid::Surface) {
        return;
    }
    show_ghosts(ui, state, intents);
    let note = not_shown(state);
    if !note.is_empty() && state.solid.shown.is_none() {
        ui.weak(note);
    }
}

fn show_curve_controls(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    show_options(ui, state, intents);
    show_residuals(ui, state, intents);
    show_side(ui, state, intents);
    show_planes(ui, state, intents);
    show_choosing(ui, state, intents);
    show_limits(ui, state, intents);
}

fn show_layouts(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    for (command, name) in [
        (Command::Together, "Together"),
        (Command::Panels, "Panels"),
        (Command::Polar, "Polar"),
        (Command::Lobe, "Lobe"),
        (Command::Surface, "Surface"),
    ] {
        let on = state.is_on(command) == Some(true);
        let label = ui.selectable_label(on, name);
        if label.on_hover_text(command.name()).clicked() {
            intents.push(Intent::Command(command));
        }
    }
}

fn show_options(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let is_cartesian = state.view.layout != Layout::Polar;
    for (command, name) in [
        (Command::Logarithmic, "log"),
        (Command::TimesCosine, "× cos θ"),
        (Command::Residuals, "residuals"),
    ] {
        let mut on = state.is_on(command) == Some(true);
        let enabled = is_cartesian || command != Command::Residuals;
        let check_box = ui.add_enabled(enabled, Checkbox::new(&mut on, name));
        if check_box.on_hover_text(command.name()).changed() {
            intents.push(Intent::Command(command));
        }
    }
}

/// The form of the residuals, if they are shown.
fn show_residuals(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    if !state.view.residuals || state.view.layout == Layout::Polar {
        return;
    }
    let name = |kind: &ResidualKind| match kind {
        ResidualKind::Absolute => "absolute".to_owned(),
        ResidualKind::Relative => "relative".to_owned(),
        ResidualKind::InSigma => "in σ".to_owned(),
    };
    let mut kind = state.interface.residuals;
    let combo = ComboBox::from_id_salt("residuals").width(70.0);
    let shown = choose(ui, combo, &mut kind, ResidualKind::ALL, name);
    named(shown, egui::Role::ComboBox, "form of the residuals");
    if kind != state.interface.residuals {
        intents.push(Intent::Residuals(kind));
    }
}

fn show_choosing(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let button = ui.selectable_label(state.choosing, "choose");
    let hint = "Leave readings out of the fit: click on one, or draw a rectangle around several";
    let button = named(button, egui::Role::Button, Command::ChooseReadings.name());
    if button.on_hover_text(hint).clicked() {
        intents.push(Intent::Command(Command::ChooseReadings));
    }
}

fn show_limits(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let enabled = state.is_enabled(Command::Limits);
    let label = Button::selectable(state.interface.limits, "limits");
    let button = ui.add_enabled(enabled, label);
    let hint = "Show the limits of the fit, which can be dragged: the range of view angles, and the \
                largest ψ of stage 1";
    let button = named(button, egui::Role::Button, Command::Limits.name());
    let button = button.on_disabled_hover_text("The form Together shows the limits of the fit");
    if button.on_hover_text(hint).clicked() {
        intents.push(Intent::Command(Command::Limits));
    }
}

/// The names of the theories that stay in the plot, with their dashes.
fn show_ghosts(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    if state.ghosts.is_empty() {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        let colour = ui.visuals().text_color();
        for (i, ghost) in state.ghosts.iter().enumerate() {
            let (_, rect) = ui.allocate_space(vec2(34.0, ui.spacing().interact_size.y));
            let (dash, gap) = dashes(i);
            let ends = [rect.left_center(), rect.right_center()];
            let line = Shape::dashed_line(&ends, Stroke::new(1.6, colour), dash, gap);
            ui.painter().extend(line);
            ui.label(&ghost.name);
            let name = format!("unpin {}", ghost.name);
            if named(ui.small_button("×"), egui::Role::Button, &name).clicked() {
                intents.push(Intent::Unpin(i));
            }
        }
    });
}

fn show_side(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let name = |side: &Side| match side {
        Side::Source => "θ > 0: source".to_owned(),
        Side::Forward => "θ > 0: forward".to_owned(),
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

/// The planes of view, if there are others than the plane of incidence.
fn show_planes(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let Some(sample) = state.active_sample() else {
        return;
    };
    let planes = &sample.scan().planes;
    if planes.iter().all(|plane| *plane == 0.0) {
        return;
    }
    let name = |azimuth: &f64| {
        let opposite = degrees(azimuth + std::f64::consts::PI);
        format!("φ = {} / {opposite}", degrees(*azimuth))
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

/// Numbers of readings of the visible incidences.
#[derive(Default)]
struct Counts {
    all: usize,
    in_plane: usize,
    drawn: usize,
    not_positive: usize,
    negative: usize,
}

impl Counts {
    fn new(state: &State) -> Self {
        let mut counts = Self::default();
        for plotted in state.plotted() {
            if let Some(selection) = state.derived.selection(plotted.id) {
                counts.drawn += selection.shown();
                counts.in_plane += selection.all();
                counts.not_positive += selection.not_positive();
                counts.negative += selection.negative();
            }
            let visible = plotted.scan.incidences.iter().filter(|i| i.visible);
            counts.all += visible.map(|i| i.readings).sum::<usize>();
        }
        counts
    }
}

/// The number of incidences of visible samples that are not shown.
fn hidden_incidences(state: &State) -> usize {
    let incidences = state.visible().flat_map(|sample| &sample.scan().incidences);
    incidences.filter(|incidence| !incidence.visible).count()
}

/// The numbers of readings that the plot does not show, and why; empty if it shows all of them.
fn not_shown(state: &State) -> String {
    let counts = Counts::new(state);
    let mut notes = Vec::new();
    let hidden = hidden_incidences(state);
    if hidden > 0 {
        notes.push(format!("{} hidden", counted(hidden, "incidence")));
    }
    let outside = counts.all.saturating_sub(counts.in_plane);
    if outside > 0 {
        notes.push(format!(
            "{} outside this plane",
            counted(outside, "reading")
        ));
    }
    let Counts {
        drawn, in_plane, ..
    } = counts;
    if drawn < in_plane {
        notes.push(format!(
            "{drawn} of {in_plane} readings drawn: the first, lowest and highest in each column of \
             the plot"
        ));
    }
    let (count, reason) = match (state.view.layout, state.view.scale) {
        (Layout::Polar, Scale::Linear) => (counts.negative, "< 0 cannot be shown as a radius"),
        (_, Scale::Logarithmic) => (
            counts.not_positive,
            "<= 0 cannot be shown on a logarithmic axis",
        ),
        (_, Scale::Linear) => (0, ""),
    };
    if count > 0 {
        notes.push(format!("{} {reason}", counted(count, "reading")));
    }
    notes.join("; ")
}
