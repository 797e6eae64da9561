//! The middle of the window: theory against experiment.

pub mod cartesian;
pub mod hover;
pub mod items;
pub mod polar;
pub mod toolbar;

use brdf_fit::plot::{Curve, Layout, MarkShape, mark};
use egui::{CentralPanel, Color32, Id, Ui};

use crate::intent::Intent;
use crate::state::State;
use crate::theme;
use crate::widgets::degrees;

/// A curve with how it looks.
pub struct Drawn<'a> {
    /// The curve.
    pub curve: &'a Curve,
    /// The name of its sample.
    pub sample: &'a str,
    /// Its colour.
    pub colour: Color32,
    /// The mark of its readings.
    pub mark: MarkShape,
}

impl Drawn<'_> {
    /// How its readings look.
    pub fn look(&self) -> items::Look {
        items::Look {
            mark: self.mark,
            colour: self.colour,
        }
    }
}

/// Draws the plot.
pub fn show(ui: &mut Ui, state: &mut State, intents: &mut Vec<Intent>) {
    CentralPanel::default().show(ui, |ui| {
        toolbar::show(ui, state, intents);
        state.columns = columns(state, ui.available_size());
        if state.visible().next().is_none() {
            ui.centered_and_justified(|ui| {
                ui.label(if state.samples.is_empty() {
                    "Drop a scan here, or open one: File > Open, or Built-in."
                } else {
                    "All samples are hidden."
                });
            });
            return;
        }
        let all = drawn(ui, state);
        let plot = hover::Plots::new(state, &all);
        match state.view.layout {
            Layout::Together => cartesian::together(ui, &plot),
            Layout::Panels => cartesian::panels(ui, &plot),
            Layout::Polar => polar::show(ui, &plot),
        }
    });
}

/// So many columns of readings the plot can show: one is four points wide, less than a mark. It
/// grows in steps, so that the drag of a border does not thin anew in every frame.
fn columns(state: &State, size: egui::Vec2) -> usize {
    const STEP: f32 = 32.0;
    let width = match state.view.layout {
        Layout::Panels => size.x / cartesian::columns(incidences(state), size) as f32,
        Layout::Together | Layout::Polar => size.x,
    };
    ((width / (4.0 * STEP)).ceil() * STEP).clamp(STEP, 1024.0) as usize
}

/// How many panels there are: one for each incidence of all samples that are shown.
fn incidences(state: &State) -> usize {
    let mut psi: Vec<f64> = state.visible().flat_map(|s| s.scan().shown_psi()).collect();
    psi.sort_by(f64::total_cmp);
    psi.dedup_by(|b, a| (*b - *a).to_degrees() < 0.05);
    psi.len()
}

/// The curves of all samples that are shown.
fn drawn<'a>(ui: &Ui, state: &'a State) -> Vec<Drawn<'a>> {
    let ground = theme::ground(ui.ctx());
    let mut all = Vec::new();
    for sample in state.visible() {
        let curves = state.shown.curves(sample.scan_id());
        let family = state.family_of(sample);
        for (i, curve) in curves.iter().enumerate() {
            all.push(Drawn {
                curve,
                sample: &sample.name,
                colour: theme::colour(family, i, curves.len(), ground),
                mark: mark(family, i),
            });
        }
    }
    all
}

/// The id of a plot. Each way of looking has its own, with its own zoom.
pub fn id(state: &State, name: &str) -> Id {
    Id::unique((name, state.view.scale as u8, state.view.quantity as u8))
}

/// The title of an incidence.
pub fn title(psi: f64) -> String {
    format!("psi = {}", degrees(psi))
}
