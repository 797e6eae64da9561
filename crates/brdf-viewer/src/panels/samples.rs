//! The panel at the left: the samples with their incidences, colours and errors.

use brdf_fit::format::{counted, digits};
use brdf_fit::plot::mark;
use egui::{Color32, ComboBox, Grid, Panel, RichText, Role, ScrollArea, TextStyle, Ui, vec2};

use crate::intent::Intent;
use crate::plot::items::mark_at;
use crate::state::State;
use crate::state::sample::Sample;
use crate::theme;
use crate::widgets::{degrees, named};

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
    show_wavelengths(ui, sample, intents);
    ui.label(counted(sample.scan().reading_count(), "reading"));
    ui.horizontal(|ui| {
        ui.label("Incidence psi");
        for (name, label, visible) in [
            ("all", "show all incidences", true),
            ("none", "hide all incidences", false),
        ] {
            let button = named(ui.small_button(name), Role::Button, label);
            if button.clicked() {
                intents.push(Intent::ShowAllIncidences(sample.id, visible));
            }
        }
    });
    Grid::new("incidences")
        .num_columns(3)
        .spacing([10.0, 3.0])
        .show(ui, |ui| show_incidences(ui, state, sample, intents));
    ui.add_space(6.0);
}

/// The rows of the incidences: a check box, the number of readings, and E in percent.
fn show_incidences(ui: &mut Ui, state: &State, sample: &Sample, intents: &mut Vec<Intent>) {
    let scan = sample.scan();
    if scan.reading_count() > 0 {
        ui.weak("psi");
        ui.weak("readings");
        ui.weak("E %");
        ui.end_row();
    }
    let errors = state.derived.errors(sample.scan_id()).and_then(Result::ok);
    let ground = theme::ground(ui.ctx());
    let count = scan.incidences.iter().filter(|i| i.visible).count();
    let mut visible_before = 0;
    for (i, incidence) in scan.incidences.iter().enumerate() {
        let colour = if incidence.visible {
            visible_before += 1;
            let family = state.family_of(sample);
            theme::colour(family, visible_before - 1, count, ground)
        } else {
            ui.visuals().weak_text_color()
        };
        let mut visible = incidence.visible;
        let text = RichText::new(degrees(incidence.psi)).color(colour).strong();
        if ui.checkbox(&mut visible, text).changed() {
            intents.push(Intent::ShowIncidence(sample.id, i, visible));
        }
        if incidence.readings > 0 {
            ui.label(incidence.readings.to_string());
        }
        if let Some(e) = errors.and_then(|e| e.incidences.get(i)?.e_percent) {
            ui.label(digits(e));
        }
        ui.end_row();
    }
}

fn show_wavelengths(ui: &mut Ui, sample: &Sample, intents: &mut Vec<Intent>) {
    let name = |i: usize| {
        let wavelength = sample.scans[i].wavelength_um();
        wavelength.map_or_else(|| "not stated".to_owned(), |w| format!("{w} um"))
    };
    if sample.scans.len() == 1 {
        if sample.scan().reading_count() > 0 {
            ui.label(format!("Wavelength {}", name(0)));
        }
        return;
    }
    let mut selected = sample.current;
    let count = sample.scans.len();
    ui.horizontal(|ui| {
        let label = ui.label("Wavelength");
        ComboBox::from_id_salt("wavelength")
            .width(90.0)
            .show_index(ui, &mut selected, count, name)
            .labelled_by(label.id);
    });
    if selected != sample.current {
        intents.push(Intent::Wavelength(sample.id, selected));
    }
}
