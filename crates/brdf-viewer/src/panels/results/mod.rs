//! The panel at the bottom: what the fit means, in tabs.

mod models;
mod plan;
mod plots;
mod residuals;
mod tables;
mod wavelengths;

use egui::{Panel, Ui};

use crate::intent::Intent;
use crate::state::State;
use crate::state::interface::ResultTab;

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    let height = ui.available_height();
    // The plot keeps at least half of the window.
    let most = (height * 0.45).max(120.0);
    let panel = Panel::bottom("results")
        .resizable(true)
        .default_size((0.25 * height).clamp(110.0, 240.0));
    panel.size_range(90.0..=most).show(ui, |ui| {
        // The height is set by the user and does not depend on the content.
        ui.take_available_height();
        ui.horizontal(|ui| {
            for tab in ResultTab::ALL {
                let on = state.interface.tab == tab;
                if ui.selectable_label(on, tab.name()).clicked() {
                    intents.push(Intent::Tab(tab));
                }
            }
        });
        let Some(sample) = state.active_sample() else {
            ui.label("No sample is open.");
            return;
        };
        match state.interface.tab {
            ResultTab::Summary => tables::show_summary(ui, sample.scan()),
            ResultTab::Report => tables::show_report(ui, sample.scan()),
            ResultTab::Models => models::show(ui, state, sample.scan(), intents),
            ResultTab::Wavelengths => wavelengths::show(ui, state, sample, intents),
            ResultTab::Residuals => residuals::show(ui, state, sample, intents),
            ResultTab::Convergence => {
                plots::show_convergence(ui, plots::convergence(state, sample));
            }
            ResultTab::Plan => plan::show(ui, state, sample.scan(), intents),
            ResultTab::Profile => plots::show_profile(ui, sample.scan()),
            ResultTab::Reflectance => {
                plots::show_reflectance(ui, state.derived.reflectance(sample.scan_id()));
            }
        }
    });
}
