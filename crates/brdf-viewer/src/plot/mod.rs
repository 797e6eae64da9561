//! The plot in the middle of the window: theory and measurement.

pub mod axis;
mod cartesian;
mod choice;
mod common;
pub mod context;
mod hover;
pub mod items;
mod limits;
mod lobe;
mod navigation;
mod planned;
mod polar;
pub mod radius;
mod solid_toolbar;
mod surface;
pub mod ticks;
mod toolbar;

use brdf_fit::plot::{Curve, Layout, mark};
use egui::{CentralPanel, Ui, Vec2};

use crate::intent::Intent;
use crate::platform::Host;
use crate::platform::current::CurrentHost;
use crate::state::State;
use crate::state::id::SampleId;
use crate::state::solid::Solid;
use crate::theme;
use context::{DrawnCurve, PlotContext};

pub use common::id;

/// Width of a column of readings, in points; less than a mark.
const COLUMN_WIDTH: f32 = 4.0;

/// The number of columns is a multiple of this, so that the readings are not selected anew in each
/// frame while a panel is resized.
const COLUMN_STEP: f32 = 32.0;

/// The largest number of columns.
const MOST_COLUMNS: f32 = 1024.0;

/// Draws the toolbar and the plot.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    CentralPanel::default().show(ui, |ui| {
        toolbar::show(ui, state, intents);
        let columns = columns(state, ui.available_size());
        if columns != state.columns {
            intents.push(Intent::PlotColumns(columns));
        }
        if state.visible().next().is_none() {
            show_hint(ui, state);
            return;
        }
        match state.solid.shown {
            Some(Solid::Lobe) => return lobe::show(ui, state, intents),
            Some(Solid::Surface) => return surface::show(ui, state, intents),
            None => {}
        }
        let curves = drawn_curves(ui, state);
        let context = PlotContext::new(state, &curves);
        match state.view.layout {
            Layout::Together => cartesian::together(ui, &context),
            Layout::Panels => cartesian::panels(ui, &context),
            Layout::Polar => polar::show(ui, &context),
        }
        intents.extend(context.take_requests());
    });
}

fn show_hint(ui: &mut Ui, state: &State) {
    ui.centered_and_justified(|ui| {
        ui.label(if state.samples.is_empty() {
            let note = CurrentHost::NOTE.unwrap_or_default();
            format!("Drop a scan here, or open one from the menu File or Built-in. {note}")
        } else {
            "All samples are hidden.".to_owned()
        });
    });
}

/// The number of columns of readings that fit into a plot within a size.
fn columns(state: &State, size: Vec2) -> usize {
    let width = match state.view.layout {
        Layout::Panels => size.x / cartesian::panel_columns(panel_count(state), size) as f32,
        Layout::Together | Layout::Polar => size.x,
    };
    let columns = (width / (COLUMN_WIDTH * COLUMN_STEP)).ceil() * COLUMN_STEP;
    columns.clamp(COLUMN_STEP, MOST_COLUMNS) as usize
}

/// The number of panels: one per incidence that is visible in any sample.
fn panel_count(state: &State) -> usize {
    let visible = state.visible();
    let mut psi: Vec<f64> = visible.flat_map(|s| s.scan().visible_psi()).collect();
    psi.sort_by(f64::total_cmp);
    psi.dedup_by(|b, a| cartesian::is_same_incidence(*a, *b));
    psi.len()
}

/// The curves of all plotted scans.
fn drawn_curves<'a>(ui: &Ui, state: &'a State) -> Vec<DrawnCurve<'a>> {
    let ground = theme::ground(ui.ctx());
    let mut all = Vec::new();
    for plotted in state.plotted() {
        let curves = state.derived.curves(plotted.id);
        let (sample, family) = (plotted.sample, plotted.family);
        let is_current = plotted.id == sample.scan_id();
        for (i, curve) in curves.iter().enumerate() {
            all.push(DrawnCurve {
                curve,
                scan: plotted.id,
                sample: sample.name_of(plotted.scan),
                colour: theme::colour(family, i, curves.len(), ground),
                mark: mark(family, i),
                left_out: plotted.scan.left_out(),
                ghosts: if is_current {
                    ghosts(state, sample.id, i)
                } else {
                    Vec::new()
                },
            });
        }
    }
    all
}

/// The ghosts of a sample at its visible incidence `i`, each with its index.
fn ghosts(state: &State, sample: SampleId, i: usize) -> Vec<(usize, &Curve)> {
    let ghosts = state.ghosts.iter().enumerate();
    ghosts
        .filter(|(_, ghost)| ghost.sample == sample)
        .filter_map(|(index, _)| Some((index, state.derived.ghost(index).get(i)?)))
        .collect()
}

/// The root mean square of the residuals of curves.
pub fn residual_rms<'a>(curves: impl Iterator<Item = &'a Curve>) -> f64 {
    let readings = curves.flat_map(|curve| &curve.readings);
    let (sum, count) = readings.fold((0.0, 0_u32), |(sum, count), reading| {
        (sum + reading.residual().powi(2), count + 1)
    });
    (sum / f64::from(count.max(1))).sqrt()
}
