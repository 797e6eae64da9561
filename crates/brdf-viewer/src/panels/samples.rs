//! The samples at the left, each with its incidences: what is shown, in which colour, and how well
//! the theory describes it.

use brdf_fit::format::{counted, digits};
use brdf_fit::plot::mark;
use egui::{Color32, ComboBox, Grid, Panel, RichText, Role, ScrollArea, TextStyle, Ui, vec2};

use crate::intent::Intent;
use crate::plot::items::mark_at;
use crate::state::State;
use crate::state::sample::Sample;
use crate::theme;
use crate::widgets::{degrees, named};

/// Draws the samples.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let panel = Panel::left("samples")
        .default_size(215.0)
        .size_range(170.0..=380.0);
    panel.show(ui, |ui| {
        ui.add_space(4.0);
        ui.strong("Samples");
        if state.samples.is_empty() {
            ui.label("None is open. Drop a scan here, or see the menus File and Built-in.");
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
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                show_key(ui, state, sample);
                show_name(ui, sample, active, intents);
            });
        });
    });
    if active {
        ui.indent("scan", |ui| show_scan(ui, state, sample, intents));
    }
}

/// The colour and the mark that a sample is known by, where there are others.
fn show_key(ui: &mut Ui, state: &State, sample: &Sample) {
    let Some(family) = state.family_of(sample) else {
        return;
    };
    let colour = theme::family_colour(family, theme::ground(ui.ctx()));
    let (_, place) = ui.allocate_space(vec2(12.0, ui.spacing().interact_size.y));
    let key = mark_at(mark(Some(family), 0), place.center(), 4.5, colour);
    ui.painter().add(key);
}

fn show_name(ui: &mut Ui, sample: &Sample, active: bool, intents: &mut Vec<Intent>) {
    let room = ui.available_width();
    let padding = 2.0 * ui.spacing().button_padding.x;
    let name = elided(ui, &sample.name, room - padding);
    let button = egui::Button::selectable(active, name);
    let response = ui.add_sized(vec2(room, ui.spacing().interact_size.y), button);
    let response = named(response, Role::Button, &sample.name);
    let hover = format!("{}\n{}\n{}", sample.name, sample.source, sample.description);
    if response.on_hover_text(hover.trim_end()).clicked() {
        intents.push(Intent::Activate(sample.id));
    }
}

/// A name as it fits into a width: of a long one its start and its end, where names differ most.
fn elided(ui: &Ui, name: &str, room: f32) -> String {
    let font = TextStyle::Button.resolve(ui.style());
    let width = |text: String| {
        let galley = ui
            .painter()
            .layout_no_wrap(text, font.clone(), Color32::WHITE);
        galley.size().x
    };
    let letters: Vec<char> = name.chars().collect();
    let kept = |count: usize| -> String {
        let end = count / 2;
        let start = letters[..count - end].iter();
        let end = letters[letters.len() - end..].iter();
        start.chain(&['…']).chain(end).collect()
    };
    if width(name.to_owned()) <= room {
        return name.to_owned();
    }
    let counts = (2..letters.len()).rev();
    let fitting = counts.map(kept).find(|text| width(text.clone()) <= room);
    fitting.unwrap_or_else(|| "…".to_owned())
}

fn show_scan(ui: &mut Ui, state: &State, sample: &Sample, intents: &mut Vec<Intent>) {
    show_wavelengths(ui, sample, intents);
    let scan = sample.scan();
    ui.label(counted(scan.readings(), "reading"));
    ui.horizontal(|ui| {
        ui.label("Incidence psi");
        for (name, shown) in [("all", true), ("none", false)] {
            let word = format!("{name} incidences");
            let button = named(ui.small_button(name), Role::Button, &word);
            if button.clicked() {
                intents.push(Intent::ShowAllIncidences(sample.id, shown));
            }
        }
    });
    let errors = state.shown.errors(sample.scan_id()).and_then(Result::ok);
    let count = scan
        .incidences
        .iter()
        .filter(|incidence| incidence.shown)
        .count();
    let ground = theme::ground(ui.ctx());
    let mut place = 0;
    Grid::new("incidences")
        .num_columns(3)
        .spacing([10.0, 3.0])
        .show(ui, |ui| {
            if scan.readings() > 0 {
                ui.weak("psi");
                ui.weak("readings");
                ui.weak("E %");
                ui.end_row();
            }
            for (i, incidence) in scan.incidences.iter().enumerate() {
                let colour = if incidence.shown {
                    place += 1;
                    theme::colour(state.family_of(sample), place - 1, count, ground)
                } else {
                    ui.visuals().weak_text_color()
                };
                let mut shown = incidence.shown;
                let text = RichText::new(degrees(incidence.psi)).color(colour).strong();
                if ui.checkbox(&mut shown, text).changed() {
                    intents.push(Intent::ShowIncidence(sample.id, i, shown));
                }
                if incidence.readings > 0 {
                    ui.label(incidence.readings.to_string());
                }
                if let Some(e) = errors.and_then(|e| e.incidences.get(i)?.e_percent) {
                    ui.label(digits(e));
                }
                ui.end_row();
            }
        });
    ui.add_space(6.0);
}

fn show_wavelengths(ui: &mut Ui, sample: &Sample, intents: &mut Vec<Intent>) {
    let name = |i: usize| {
        let wavelength = sample.scans[i].wavelength_um();
        wavelength.map_or_else(|| "not stated".to_owned(), |w| format!("{w} um"))
    };
    if sample.scans.len() == 1 {
        if sample.scan().readings() > 0 {
            ui.label(format!("Wavelength {}", name(0)));
        }
        return;
    }
    let mut chosen = sample.current;
    let count = sample.scans.len();
    ui.horizontal(|ui| {
        let label = ui.label("Wavelength");
        ComboBox::from_id_salt("wavelength")
            .width(90.0)
            .show_index(ui, &mut chosen, count, name)
            .labelled_by(label.id);
    });
    if chosen != sample.current {
        intents.push(Intent::Wavelength(sample.id, chosen));
    }
}
