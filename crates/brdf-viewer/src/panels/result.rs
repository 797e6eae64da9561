//! The card of the result: how well the model describes the sample, warnings, and the model that
//! suffices.

use brdf_fit::format::{counted, two_digits};
use brdf_fit::report::Report;
use brdf_fit::{Quality, Verdict, rms_percent};
use egui::{Button, Color32, Frame, Label, RichText, Ui};

use crate::intent::{Command, Intent};
use crate::state::State;
use crate::state::sample::Sample;
use crate::theme;

/// Draws the card of the active sample.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let Some(sample) = state.active_sample() else {
        return;
    };
    let quality = quality(state, sample);
    let colour = quality.map_or(ui.visuals().weak_text_color(), |quality| {
        theme::quality_colour(quality, theme::ground(ui.ctx()))
    });
    let frame = Frame::group(ui.style()).stroke((1.5, colour));
    frame.show(ui, |ui| {
        ui.set_min_width(ui.available_width());
        show_quality(ui, state, sample, quality, colour);
        show_notes(ui, sample);
        if let Some(report) = &sample.scan().last_fit {
            show_warnings(ui, report);
            show_verdict(ui, report, sample, intents);
        }
        show_pin(ui, state, intents);
    });
}

/// The quality of the current parameters; that of the fit, where they are those of the fit.
pub(super) fn quality(state: &State, sample: &Sample) -> Option<Quality> {
    let fit = sample
        .scan()
        .current_fit()
        .and_then(|report| report.fit.as_ref());
    fit.map(Quality::of).or_else(|| {
        let errors = state.derived.errors(sample.scan_id())?.ok()?;
        Some(Quality::of_rms(rms_percent(errors.e_percent)))
    })
}

fn show_quality(
    ui: &mut Ui,
    state: &State,
    sample: &Sample,
    quality: Option<Quality>,
    colour: Color32,
) {
    let scan = sample.scan();
    match quality {
        Some(quality) => {
            let text = format!("{}: {quality}", quality.word());
            ui.add(Label::new(RichText::new(text).color(colour).strong()).wrap());
        }
        None if scan.reading_count() == 0 => {
            ui.label("Theory without readings.");
        }
        None => {}
    }
    let fit = scan.current_fit().and_then(|report| report.fit.as_ref());
    let shown = state.derived.errors(sample.scan_id());
    match (fit, shown) {
        (Some(fit), _) => {
            ui.label(error_text(fit.e_percent));
        }
        (None, Some(Ok(errors))) => {
            ui.label(error_text(errors.e_percent));
        }
        (None, Some(Err(reason))) if scan.reading_count() > 0 => {
            ui.label(format!("E is not available: {reason}"));
        }
        _ => {}
    }
    let waiting = state
        .fit_run
        .as_ref()
        .is_some_and(|run| run.is_running() && run.is_waiting_for(sample.scan_id()));
    let text = match (&scan.last_fit, fit) {
        (None, _) if scan.reading_count() == 0 => "",
        (None, _) if waiting => "Fitting; the curves show the start values.",
        (None, _) => "Not fitted: the curves show the start values.",
        (Some(report), None) if !scan.uses_readings_of(report) => {
            "The choice of readings has changed since the fit."
        }
        (Some(_), None) => "The parameters have changed since the fit.",
        _ => "",
    };
    if !text.is_empty() {
        ui.weak(text);
    }
}

fn error_text(e_percent: f64) -> String {
    let rms = two_digits(rms_percent(e_percent));
    let e = two_digits(e_percent);
    format!("rms error {rms} % (E = {e} %)")
}

/// What the numbers rest on.
fn show_notes(ui: &mut Ui, sample: &Sample) {
    let scan = sample.scan();
    let warning = ui.visuals().warn_fg_color;
    if let Some(error) = &scan.fit_error {
        ui.colored_label(warning, "The last fit failed.")
            .on_hover_text(error);
    }
    if scan.assumes_n() {
        let n = scan.parameters.values.n;
        ui.label(format!("n = {n} is assumed: the file states none."));
    }
    if scan.table.is_some() {
        ui.label(format!(
            "The fit is of all bins of the table; the plot shows {} of them, as a goniometer scans.",
            scan.reading_count()
        ));
    }
    let left_out = scan.left_out().len();
    if left_out > 0 {
        ui.label(format!(
            "{} left out by choice.",
            counted(left_out, "reading")
        ));
    }
}

fn show_warnings(ui: &mut Ui, report: &Report) {
    let colour = ui.visuals().warn_fg_color;
    for warning in &report.warnings {
        let text = RichText::new(format!("Warning: {warning}")).color(colour);
        ui.add(Label::new(text).wrap());
    }
}

/// The model that suffices, with a button that takes it.
fn show_verdict(ui: &mut Ui, report: &Report, sample: &Sample, intents: &mut Vec<Intent>) {
    let assessment = report.assessment.as_ref();
    let Some(verdict) = assessment.and_then(|assessment| assessment.verdict.as_ref()) else {
        return;
    };
    ui.add(Label::new(short_verdict(verdict)).wrap())
        .on_hover_text(verdict.to_string());
    let current = sample.scan().parameters.model;
    let Some(model) = verdict.model.filter(|model| *model != current) else {
        return;
    };
    let button = ui.button(format!("Use {model}"));
    let hint = format!("Fit {model}: {}", model.description());
    if button.on_hover_text(hint).clicked() {
        intents.push(Intent::UseModel(model));
    }
}

/// The verdict in one clause; the whole one is its tooltip.
fn short_verdict(verdict: &Verdict) -> String {
    let within = two_digits(verdict.within_percent);
    match verdict.model {
        Some(model) => format!("{model} suffices: predicts an unseen incidence within {within} %."),
        None => format!(
            "No model predicts an unseen incidence: the best, {}, errs by {within} %.",
            verdict.best
        ),
    }
}

fn show_pin(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    ui.horizontal(|ui| {
        for command in [Command::Pin, Command::UnpinAll] {
            let enabled = state.is_enabled(command);
            if command == Command::UnpinAll && !enabled {
                continue;
            }
            let button = ui.add_enabled(enabled, Button::new(command.name()).small());
            let hint = "Keep these curves as dashed lines, to compare others with them";
            if button.on_hover_text(hint).clicked() {
                intents.push(Intent::Command(command));
            }
        }
    });
}
