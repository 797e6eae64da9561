//! The panel at the left: the samples with their colours and quality, and the wavelengths and
//! incidences of the active one.

use brdf_fit::format::counted;
use brdf_fit::plot::mark;
use egui::{Color32, Panel, RichText, Role, ScrollArea, TextStyle, Ui, vec2};

use super::{incidences, result, wavelengths};
use crate::intent::Intent;
use crate::platform::Host;
use crate::platform::current::CurrentHost;
use crate::plot::items::mark_at;
use crate::state::State;
use crate::state::sample::Sample;
use crate::theme;
use crate::widgets::named;

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let panel = Panel::left("samples")
        .default_size(215.0)
        .size_range(170.0..=380.0);
    panel.show(ui, |ui| {
        ui.add_space(4.0);
        ui.strong("Samples");
        if state.samples.is_empty() {
            ui.label("No sample is open. Drop a scan here, or use the menus File and Built-in.");
        }
        if let Some(note) = CurrentHost::NOTE {
            ui.weak(note);
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for sample in &state.samples {
                ui.push_id(sample.id, |ui| show_sample(ui, state, sample, intents));
            }
        });
    });
}

fn show_sample(ui: &mut Ui, state: &State, sample: &Sample, intents: &mut Vec<Intent>) {
    let active = state.active == Some(sample.id);
    ui.horizontal(|ui| {
        let mut visible = sample.visible;
        let name = format!("show {}", sample.name);
        let response = ui.checkbox(&mut visible, "");
        response.widget_info(|| egui::WidgetInfo::selected(Role::CheckBox, true, visible, &name));
        if response.on_hover_text(name).changed() {
            intents.push(Intent::ShowSample(sample.id, visible));
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let close = format!("close {}", sample.name);
            let button = named(ui.small_button("×"), Role::Button, &close);
            if button.on_hover_text(close).clicked() {
                intents.push(Intent::Close(sample.id));
            }
            show_quality(ui, state, sample);
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                show_key(ui, state, sample);
                show_name(ui, sample, active, intents);
            });
        });
    });
    if sample.has_changed_on_disk {
        ui.horizontal(|ui| {
            ui.colored_label(ui.visuals().warn_fg_color, "changed on disk");
            let name = format!("reload {}", sample.name);
            if named(ui.small_button("reload"), Role::Button, &name).clicked() {
                intents.push(Intent::Reload(sample.id));
            }
        });
    }
    if active {
        ui.indent("scan", |ui| show_scan(ui, state, sample, intents));
    }
}

/// The mark of how well the model describes a sample, at the wavelength that is shown.
fn show_quality(ui: &mut Ui, state: &State, sample: &Sample) {
    if let Some(quality) = result::quality(state, sample) {
        let colour = theme::quality_colour(quality, theme::ground(ui.ctx()));
        let mark = RichText::new(quality.word()).color(colour).strong();
        ui.label(mark).on_hover_text(quality.to_string());
    }
}

/// The colour and the mark of a sample, if there are several.
fn show_key(ui: &mut Ui, state: &State, sample: &Sample) {
    let Some(family) = state.family_of(sample) else {
        return;
    };
    let colour = theme::family_colour(family, theme::ground(ui.ctx()));
    let (_, rect) = ui.allocate_space(vec2(12.0, ui.spacing().interact_size.y));
    let key = mark_at(mark(Some(family), 0), rect.center(), 4.5, colour);
    ui.painter().add(key);
}

fn show_name(ui: &mut Ui, sample: &Sample, active: bool, intents: &mut Vec<Intent>) {
    let width = ui.available_width();
    let padding = 2.0 * ui.spacing().button_padding.x;
    let name = elided(ui, &sample.name, width - padding);
    let button = egui::Button::selectable(active, name);
    let response = ui.add_sized(vec2(width, ui.spacing().interact_size.y), button);
    let response = named(response, Role::Button, &sample.name);
    let hover = format!("{}\n{}\n{}", sample.name, sample.source, sample.description);
    if response.on_hover_text(hover.trim_end()).clicked() {
        intents.push(Intent::Activate(sample.id));
    }
}

/// A name shortened to a width by removing its middle, because similar names mostly differ at the
/// start or at the end.
fn elided(ui: &Ui, name: &str, width: f32) -> String {
    let font = TextStyle::Button.resolve(ui.style());
    let width_of = |text: String| {
        let galley = ui
            .painter()
            .layout_no_wrap(text, font.clone(), Color32::WHITE);
        galley.size().x
    };
    let letters: Vec<char> = name.chars().collect();
    let shortened = |count: usize| -> String {
        let end = count / 2;
        let start = letters[..count - end].iter();
        let end = letters[letters.len() - end..].iter();
        start.chain(&['…']).chain(end).collect()
    };
    if width_of(name.to_owned()) <= width {
        return name.to_owned();
    }
    let counts = (2..letters.len()).rev();
    let fitting = counts
        .map(shortened)
        .find(|text| width_of(text.clone()) <= width);
    fitting.unwrap_or_else(|| "…".to_owned())
}

fn show_scan(ui: &mut Ui, state: &State, sample: &Sample, intents: &mut Vec<Intent>) {
    wavelengths::show(ui, sample, intents);
    let scan = sample.scan();
    let left_out = scan.left_out().len();
    if left_out == 0 {
        ui.label(counted(scan.reading_count(), "reading"));
    } else {
        ui.horizontal(|ui| {
            let (used, all) = (scan.used_count(), counted(scan.reading_count(), "reading"));
            ui.label(format!("{used} of {all} used"));
            let button = named(ui.small_button("use all"), Role::Button, "use all readings");
            if button.clicked() {
                intents.push(Intent::UseAllReadings(sample.scan_id()));
            }
        });
    }
    incidences::show(ui, state, sample, intents);
    ui.add_space(6.0);
}
