//! The residuals against the measured value, which shows how the errors grow with it.

use egui::{Color32, Role, Ui};
use egui_plot::{HLine, PlotPoints, Points};

use super::plots::result_plot;
use crate::intent::Intent;
use crate::plot::axis::Axis;
use crate::state::State;
use crate::state::interface::ResidualKind;
use crate::state::sample::Sample;
use crate::theme;
use crate::widgets::{degrees, named};

/// Draws the choice of their form, and the plot of the shown readings.
pub(super) fn show(ui: &mut Ui, state: &State, sample: &Sample, intents: &mut Vec<Intent>) {
    let mut kind = state.interface.residuals;
    ui.horizontal(|ui| choose(ui, &mut kind));
    if kind != state.interface.residuals {
        intents.push(Intent::Residuals(kind));
    }
    let curves = state.derived.curves(sample.scan_id());
    let rms = crate::plot::residual_rms(curves.iter());
    let names = ["measured, 1/sr", kind.axis_name()];
    let plot = result_plot(
        "residuals over readings",
        [Axis::Logarithmic, Axis::Linear],
        names,
    );
    let ground = theme::ground(ui.ctx());
    let family = state.family_of(sample);
    let response = plot.show(ui, |plot_ui| {
        plot_ui.hline(HLine::new("0", 0.0).color(Color32::GRAY));
        for (i, curve) in curves.iter().enumerate() {
            let point = |reading: &brdf_fit::plot::Reading| {
                let x = Axis::Logarithmic.position(reading.value)?;
                Some([x, kind.of(reading, rms)?])
            };
            let points: Vec<[f64; 2]> = curve.readings.iter().filter_map(point).collect();
            let name = format!("ψ = {}", degrees(curve.psi));
            let colour = theme::colour(family, i, curves.len(), ground);
            plot_ui.points(
                Points::new(name, PlotPoints::from(points))
                    .radius(2.5)
                    .color(colour),
            );
        }
    });
    named(
        response.response,
        Role::Image,
        "plot of residuals over readings",
    );
}

/// The choice of the form of residuals.
pub(super) fn choose(ui: &mut Ui, kind: &mut ResidualKind) {
    for (value, name) in [
        (ResidualKind::Absolute, "absolute"),
        (ResidualKind::Relative, "relative"),
        (ResidualKind::InSigma, "in σ"),
    ] {
        ui.selectable_value(kind, value, name);
    }
}
