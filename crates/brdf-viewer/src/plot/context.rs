//! The data that all plots of a frame share.

use std::cell::RefCell;
use std::collections::BTreeSet;

use brdf_fit::plot::{Curve, MarkShape, Reading, value_range};
use egui::Color32;

use super::axis::Axis;
use super::items::MarkStyle;
use super::residual_rms;
use crate::intent::Intent;
use crate::state::State;
use crate::state::id::ScanId;
use crate::state::interface::ResidualKind;

/// A curve with its appearance.
pub struct DrawnCurve<'a> {
    /// The curve.
    pub curve: &'a Curve,
    /// Its scan.
    pub scan: ScanId,
    /// The name of its sample.
    pub sample: String,
    /// The colour.
    pub colour: Color32,
    /// The mark of its readings.
    pub mark: MarkShape,
    /// The indices of the readings that are left out of the fit.
    pub left_out: &'a BTreeSet<usize>,
    /// The theories that stay in the plot at this incidence, each with its index.
    pub ghosts: Vec<(usize, &'a Curve)>,
}

impl DrawnCurve<'_> {
    /// The appearance of its readings.
    pub fn mark_style(&self) -> MarkStyle {
        MarkStyle {
            mark: self.mark,
            colour: self.colour,
        }
    }
}

/// The data that all plots of a frame share.
pub struct PlotContext<'a> {
    /// The state.
    pub state: &'a State,
    /// The curves of all visible samples.
    pub curves: &'a [DrawnCurve<'a>],
    /// The axis of the BRDF.
    pub axis: Axis,
    /// The range of values of that axis, the same in all panels.
    pub range: (f64, f64),
    /// The root mean square of the residuals of the shown readings.
    pub residual_rms: f64,
    /// The largest absolute value on the axis of the residuals.
    pub residual_limit: f64,
    requests: RefCell<Vec<Intent>>,
}

impl<'a> PlotContext<'a> {
    /// The context of a frame.
    pub fn new(state: &'a State, curves: &'a [DrawnCurve<'a>]) -> Self {
        let scale = state.view.scale;
        let all = curves.iter().map(|drawn| drawn.curve);
        let rms = residual_rms(curves.iter().map(|drawn| drawn.curve));
        Self {
            state,
            curves,
            axis: scale.into(),
            range: value_range(all, scale).unwrap_or((0.001, 1.0)),
            residual_rms: rms,
            residual_limit: residual_limit(curves, state.interface.residuals, rms),
            requests: RefCell::default(),
        }
    }

    /// Requests an intent from within a plot.
    pub fn request(&self, intent: Intent) {
        self.requests.borrow_mut().push(intent);
    }

    /// Removes and returns the requested intents.
    pub fn take_requests(&self) -> Vec<Intent> {
        self.requests.take()
    }

    /// The residual of a reading in the form that the user has chosen.
    pub fn residual(&self, reading: &Reading) -> Option<f64> {
        self.state
            .interface
            .residuals
            .of(reading, self.residual_rms)
    }
}

/// A little more than the largest residual.
fn residual_limit(curves: &[DrawnCurve], kind: ResidualKind, rms: f64) -> f64 {
    let readings = curves.iter().flat_map(|drawn| &drawn.curve.readings);
    let residuals = readings.filter_map(|reading| kind.of(reading, rms));
    match 1.1 * residuals.map(f64::abs).fold(0.0, f64::max) {
        0.0 => 1.0,
        limit => limit,
    }
}
