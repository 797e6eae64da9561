//! The report of the fit as text: in short, and whole.

use brdf_fit::report::Section;
use egui::{Label, RichText, ScrollArea, Ui};

use crate::state::sample::Scan;

/// The sections of the report that the summary shows.
const SUMMARY: [&str; 8] = [
    "reading",
    "fit",
    "quality",
    "error",
    "parameters",
    "noise",
    "verdict",
    "warnings",
];

/// Draws what was read, how well the model describes it, and the parameters.
pub(super) fn show_summary(ui: &mut Ui, scan: &Scan) {
    show(ui, scan, |section| SUMMARY.contains(&section.title));
}

/// Draws everything that the command line prints.
pub(super) fn show_report(ui: &mut Ui, scan: &Scan) {
    show(ui, scan, |_| true);
}

fn show(ui: &mut Ui, scan: &Scan, is_shown: impl Fn(&Section) -> bool) {
    let warning = ui.visuals().warn_fg_color;
    let Some(report) = &scan.last_fit else {
        ui.label("Not fitted yet.");
        return;
    };
    if scan.fit_error.is_some() {
        ui.colored_label(
            warning,
            "The last fit failed: the text is of the previous fit.",
        );
    }
    if scan.current_fit().is_none() {
        let text = if scan.uses_readings_of(report) {
            "The parameters have changed since this fit."
        } else {
            "The choice of readings has changed since this fit."
        };
        ui.colored_label(warning, text);
    }
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        for section in report.sections().iter().filter(|section| is_shown(section)) {
            let text = RichText::new(section.text.trim_matches('\n')).monospace();
            ui.add(Label::new(text).extend());
            ui.add_space(4.0);
        }
    });
}
