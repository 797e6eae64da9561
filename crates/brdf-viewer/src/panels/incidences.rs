//! The incidences of a scan: colour and mark, whether each is shown and used in the fit, its readings
//! and its error.

use brdf_fit::format::two_digits;
use brdf_fit::plot::mark;
use brdf_fit::rms_percent;
use egui::{DragValue, Grid, Id, RichText, Role, Ui, WidgetInfo, vec2};

use crate::intent::Intent;
use crate::plot::items::mark_at;
use crate::state::State;
use crate::state::angle_range::End;
use crate::state::id::ScanId;
use crate::state::sample::{Sample, Usage};
use crate::theme;
use crate::widgets::{degrees, named};

/// Draws the list.
pub(super) fn show(ui: &mut Ui, state: &State, sample: &Sample, intents: &mut Vec<Intent>) {
    ui.horizontal(|ui| {
        ui.label("Incidence angles");
        for (name, label, visible) in [
            ("all", "show all incidences", true),
            ("none", "hide all incidences", false),
        ] {
            let button = named(ui.small_button(name), Role::Button, label);
            if button.on_hover_text(label).clicked() {
                intents.push(Intent::ShowAllIncidences(sample.id, visible));
            }
        }
    });
    Grid::new("incidences")
        .num_columns(5)
        .spacing([7.0, 3.0])
        .show(ui, |ui| show_rows(ui, state, sample, intents));
    if let Some(range) = state.active_angle_range() {
        ui.horizontal(|ui| {
            ui.label("θ in the fit");
            for end in End::BOTH {
                show_end(ui, sample.scan_id(), end, end.of(range.used), intents);
            }
        });
    }
}

/// The number box of an end of the view angles that the fit uses. It has its effect when the number is
/// complete, as one step of the history.
fn show_end(ui: &mut Ui, scan: ScanId, end: End, value_deg: f64, intents: &mut Vec<Intent>) {
    let key = Id::unique(("view angle", scan, end));
    let dragged = ui.data(|data| data.get_temp::<f64>(key));
    let mut shown = dragged.unwrap_or(value_deg);
    let number = DragValue::new(&mut shown).range(-90.0..=90.0).speed(0.5);
    let number = number.min_decimals(1).max_decimals(2).suffix("°");
    let response = ui.add(number.update_while_editing(false));
    let name = format!("{} view angle in the fit", end.word());
    let response = named(response, Role::SpinButton, &name);
    if response.dragged() {
        ui.data_mut(|data| data.insert_temp(key, shown));
    } else {
        ui.data_mut(|data| data.remove_temp::<f64>(key));
        // The box rounds what it shows, which alone is no change.
        if (shown - value_deg).abs() > 0.006 {
            intents.push(Intent::LimitAngles(scan, end, shown));
        }
    }
    response.on_hover_text(
        "Readings beyond these view angles are left out of the fit, at all incidences; of several \
         planes, those of the plane in the plot",
    );
}

fn show_rows(ui: &mut Ui, state: &State, sample: &Sample, intents: &mut Vec<Intent>) {
    let scan = sample.scan();
    let has_readings = scan.reading_count() > 0;
    show_header(ui, has_readings);
    let errors = state.derived.errors(sample.scan_id()).and_then(Result::ok);
    let ground = theme::ground(ui.ctx());
    let count = scan.incidences.iter().filter(|i| i.visible).count();
    let usage = scan.usage_of_incidences();
    let mut visible_before = 0;
    for (i, incidence) in scan.incidences.iter().enumerate() {
        let family = state.family_of(sample);
        let colour = if incidence.visible {
            visible_before += 1;
            theme::colour(family, visible_before - 1, count, ground)
        } else {
            ui.visuals().weak_text_color()
        };
        ui.horizontal(|ui| {
            let (_, rect) = ui.allocate_space(vec2(10.0, ui.spacing().interact_size.y));
            if incidence.visible {
                let shape = mark(family, visible_before - 1);
                ui.painter().add(mark_at(shape, rect.center(), 3.6, colour));
            }
            let mut visible = incidence.visible;
            let text = RichText::new(degrees(incidence.psi)).color(colour).strong();
            if ui.checkbox(&mut visible, text).changed() {
                intents.push(Intent::ShowIncidence(sample.id, i, visible));
            }
        });
        if has_readings {
            show_used(ui, sample, i, usage.get(i).copied(), intents);
            ui.label(incidence.readings.to_string());
            let error = errors.and_then(|errors| errors.of_incidence(incidence.psi));
            ui.label(error.map_or_else(String::new, |e| two_digits(rms_percent(e))));
        }
        ui.end_row();
    }
}

fn show_header(ui: &mut Ui, has_readings: bool) {
    ui.weak("    shown");
    if has_readings {
        ui.weak("used").on_hover_text("Used in the fit");
        ui.weak("readings");
        ui.weak("rms %")
            .on_hover_text("The rms error of this incidence");
    }
    ui.end_row();
}

/// The check box that uses the readings of an incidence, or leaves them out.
fn show_used(
    ui: &mut Ui,
    sample: &Sample,
    incidence: usize,
    usage: Option<Usage>,
    intents: &mut Vec<Intent>,
) {
    let mut used = usage != Some(Usage::None);
    let check_box = egui::Checkbox::without_text(&mut used);
    let response = ui.add(check_box.indeterminate(usage == Some(Usage::Some)));
    let psi = sample.scan().incidences[incidence].psi;
    let name = format!("use {} in the fit", degrees(psi));
    let selected = used;
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, selected, &name));
    if response.on_hover_text(name).changed() {
        // A click on an incidence of which some readings are left out uses all of them.
        let used = used || usage == Some(Usage::Some);
        intents.push(Intent::UseIncidence(sample.id, incidence, used));
    }
}
