//! The wavelengths of a sample as a list: n, error and quality of each.

use brdf_fit::Quality;
use brdf_fit::format::two_digits;
use egui::{Button, Checkbox, Grid, RichText, Role, ScrollArea, Ui, WidgetInfo};

use crate::intent::Intent;
use crate::state::sample::{Sample, Scan};
use crate::theme;
use crate::widgets::named;

/// The largest height of the list in points.
const MOST_HEIGHT: f32 = 130.0;

/// Draws the list; a single wavelength is a line of text.
pub(super) fn show(ui: &mut Ui, sample: &Sample, intents: &mut Vec<Intent>) {
    if sample.scans.len() == 1 {
        if sample.scan().reading_count() > 0 {
            ui.label(format!("Wavelength {}", name(sample.scan())));
        }
        return;
    }
    ui.label(format!("{} wavelengths", sample.scans.len()));
    let height = ui.spacing().interact_size.y;
    ScrollArea::vertical()
        .id_salt("wavelengths")
        .max_height(MOST_HEIGHT)
        .show_rows(ui, height, sample.scans.len() + 1, |ui, rows| {
            Grid::new("wavelengths")
                .min_col_width(16.0)
                .num_columns(5)
                .spacing([8.0, 2.0])
                .show(ui, |ui| {
                    for row in rows {
                        match row.checked_sub(1) {
                            None => show_header(ui),
                            Some(i) => show_row(ui, sample, i, intents),
                        }
                        ui.end_row();
                    }
                });
        });
}

fn show_header(ui: &mut Ui) {
    for name in ["", "wavelength", "n", "rms %"] {
        ui.weak(name);
    }
}

fn show_row(ui: &mut Ui, sample: &Sample, i: usize, intents: &mut Vec<Intent>) {
    let scan = &sample.scans[i];
    let wavelength = name(scan);
    show_beside(ui, sample, i, scan, intents);
    let button = ui.add(Button::selectable(sample.current == i, &wavelength));
    let response = named(button, Role::Button, &format!("wavelength {wavelength}"));
    if response.clicked() {
        intents.push(Intent::Wavelength(sample.id, i));
    }
    ui.label(shortened(scan.parameters.values.n));
    let report = scan.last_fit.as_ref();
    let Some(fit) = report.and_then(|report| report.fit.as_ref()) else {
        ui.weak("not fitted");
        return;
    };
    ui.label(two_digits(fit.rms_percent()));
    let quality = Quality::of(fit);
    let colour = theme::quality_colour(quality, theme::ground(ui.ctx()));
    let word = RichText::new(quality.word()).color(colour);
    ui.label(word).on_hover_text(quality.to_string());
}

/// The check box that plots a wavelength beside the current one.
fn show_beside(ui: &mut Ui, sample: &Sample, i: usize, scan: &Scan, intents: &mut Vec<Intent>) {
    let is_current = sample.current == i;
    let mut beside = is_current || scan.is_beside;
    let check_box = ui.add_enabled(!is_current, Checkbox::without_text(&mut beside));
    let name = format!("plot {} as well", name(scan));
    let (enabled, selected) = (!is_current, beside);
    check_box.widget_info(|| WidgetInfo::selected(Role::CheckBox, enabled, selected, &name));
    if check_box.on_hover_text(name).changed() {
        intents.push(Intent::PlotBeside(sample.id, i, beside));
    }
}

/// A refractive index with three decimals at most.
fn shortened(n: f64) -> String {
    ((n * 1000.0).round() / 1000.0).to_string()
}

fn name(scan: &Scan) -> String {
    let wavelength = scan.wavelength_um();
    wavelength.map_or_else(|| "not stated".to_owned(), |w| format!("{w} µm"))
}
