//! The wavelengths of a sample as a list: n, error and quality of each.

use brdf_fit::format::{digits, two_digits};
use brdf_fit::{Parameter, Quality};
use egui::{Button, RichText, Role, ScrollArea, TextStyle, Ui};

use crate::intent::Intent;
use crate::state::sample::{Sample, Scan};
use crate::theme;
use crate::widgets::{named, quality_mark};

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
    ui.label(
        RichText::new(row_text(["wavelength", "n", "rms %"]))
            .monospace()
            .weak()
            .small(),
    );
    let height = ui.text_style_height(&TextStyle::Body) + 2.0;
    ScrollArea::vertical()
        .id_salt("wavelengths")
        .max_height(MOST_HEIGHT)
        .show_rows(ui, height, sample.scans.len(), |ui, rows| {
            for (i, scan) in sample
                .scans
                .iter()
                .enumerate()
                .take(rows.end)
                .skip(rows.start)
            {
                show_row(ui, sample, i, scan, intents);
            }
        });
}

fn show_row(ui: &mut Ui, sample: &Sample, i: usize, scan: &Scan, intents: &mut Vec<Intent>) {
    let fit = scan
        .last_fit
        .as_ref()
        .and_then(|report| report.fit.as_ref());
    let n = digits(Parameter::N.of(&scan.parameters.values));
    let rms = fit.map_or_else(|| "-".to_owned(), |fit| two_digits(fit.rms_percent()));
    let wavelength = name(scan);
    let mut text = RichText::new(row_text([&wavelength, &n, &rms]))
        .monospace()
        .small();
    let quality = fit.map(Quality::of);
    if let Some(quality) = quality {
        let colour = theme::quality_colour(quality, theme::ground(ui.ctx()));
        text = RichText::new(format!("{} {}", text.text(), quality_mark(quality)))
            .monospace()
            .small()
            .color(colour);
    }
    let button = Button::selectable(sample.current == i, text);
    let response = named(
        ui.add(button),
        Role::Button,
        &format!("wavelength {wavelength}"),
    );
    let hint = quality.map_or_else(|| "not fitted".to_owned(), |quality| quality.to_string());
    if response.on_hover_text(hint).clicked() {
        intents.push(Intent::Wavelength(sample.id, i));
    }
}

fn row_text([wavelength, n, rms]: [&str; 3]) -> String {
    format!("{wavelength:<11}{n:>7}{rms:>7}")
}

fn name(scan: &Scan) -> String {
    let wavelength = scan.wavelength_um();
    wavelength.map_or_else(|| "not stated".to_owned(), |w| format!("{w} µm"))
}
