//! Identifiers, titles, accessible descriptions and the zoom reset of plots.

use egui::{Id, Ui};
use egui_plot::{Plot, PlotResponse};

use super::context::DrawnCurve;
use crate::state::State;
use crate::widgets::degrees;

/// The id of a plot. It depends on the scale and the quantity, so that each has its own zoom.
pub fn id(state: &State, name: &str) -> Id {
    Id::unique((name, state.view.scale as u8, state.view.quantity as u8))
}

/// The title of an incidence.
pub(super) fn title(psi: f64) -> String {
    format!("ψ = {}", degrees(psi))
}

/// Resets the zoom of a plot if the user has requested it since the last frame.
pub(super) fn reset_on_demand<'a>(ui: &Ui, state: &State, name: &str, plot: Plot<'a>) -> Plot<'a> {
    let key = id(state, name).with("resets");
    let seen = ui.data(|data| data.get_temp::<u64>(key)).unwrap_or(0);
    if seen == state.zoom_resets {
        return plot;
    }
    ui.data_mut(|data| data.insert_temp(key, state.zoom_resets));
    plot.reset()
}

/// Sets the accessible name and description of a plot.
pub(super) fn describe(response: &PlotResponse<()>, name: &str, curves: &[&DrawnCurve]) {
    let readings: usize = curves.iter().map(|drawn| drawn.curve.readings.len()).sum();
    let description = format!("{} curves, {readings} readings", curves.len());
    response
        .response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
    let ctx = &response.response.ctx;
    ctx.accesskit_node_builder(response.response.id, |node| {
        node.set_description(description);
    });
}
