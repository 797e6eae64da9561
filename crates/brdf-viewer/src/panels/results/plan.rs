//! The readings to take next, and what they would change.

use brdf_fit::planning::{Advice, MeasurementPlan, error_percent, rounded_deg};
use egui::{Grid, ScrollArea, Ui};

use crate::intent::Intent;
use crate::state::State;
use crate::state::sample::Scan;

/// The names of the parameters whose errors are predicted.
const PARAMETERS: [&str; 4] = ["k2", "kD", "k1", "n - 1"];

/// Draws the buttons, the advice and the list.
pub(super) fn show(ui: &mut Ui, _: &State, scan: &Scan, intents: &mut Vec<Intent>) {
    let plan = scan.current_plan();
    ui.horizontal(|ui| {
        let has_readings = scan.used_count() > 0;
        let button = ui.add_enabled(has_readings, egui::Button::new("Suggest readings"));
        let about =
            "Chooses the readings that lower the error of f_r most, within the angles of this scan";
        if button.on_hover_text(about).clicked() {
            intents.push(Intent::Plan);
        }
        let has_list = plan.is_some_and(|plan| !plan.readings.is_empty());
        let copy = ui.add_enabled(has_list, egui::Button::new("Copy list"));
        if copy.on_hover_text("Copies the list as CSV").clicked() {
            intents.push(Intent::CopyPlan);
        }
    });
    let Some(plan) = plan else {
        ui.label("Which readings to take next, and whether any are worth their time.");
        return;
    };
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        // Of a model that fails, no prediction has a meaning.
        if !matches!(plan.advice, Advice::Fails { .. }) {
            ui.label(format!("{} over the scan's range of angles.", errors(plan)));
        }
        ui.label(format!("Advice: {}.", plan.advice));
        if !plan.readings.is_empty() {
            ui.label(changes(plan));
            show_list(ui, plan);
        }
    });
}

fn errors(plan: &MeasurementPlan) -> String {
    let now = error_percent(plan.now.error);
    match plan.cross_validated {
        Some(error) => format!(
            "Predicted error of f_r {now}, {} for each reading from the others",
            error_percent(error)
        ),
        None => format!("Predicted error of f_r {now}"),
    }
}

/// What the readings would change in the errors of the parameters.
fn changes(plan: &MeasurementPlan) -> String {
    let Some(last) = plan.readings.last() else {
        return String::new();
    };
    let pairs = plan.now.deviations.iter().zip(last.prediction.deviations);
    let each = PARAMETERS.iter().zip(pairs).map(|(name, (now, then))| {
        format!("{name} {} to {}", error_percent(*now), error_percent(then))
    });
    let each: Vec<String> = each.collect();
    format!("Standard errors: {}.", each.join(", "))
}

fn show_list(ui: &mut Ui, plan: &MeasurementPlan) {
    Grid::new("planned readings").striped(true).show(ui, |ui| {
        for heading in ["ψ, deg", "θ, deg", "φ, deg", "error of f_r"] {
            ui.strong(heading);
        }
        ui.end_row();
        for reading in &plan.readings {
            let setting = &reading.setting;
            for angle in [setting.psi, setting.theta, setting.phi] {
                ui.label(rounded_deg(angle));
            }
            ui.label(error_percent(reading.prediction.error));
            ui.end_row();
        }
    });
}
