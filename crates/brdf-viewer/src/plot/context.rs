//! The data that all plots of a frame share.

use brdf_fit::plot::{Curve, Layout, MarkShape, Scale, value_range};
use egui::Color32;

use super::axis::Axis;
use super::items::MarkStyle;
use crate::state::State;

/// A curve with its appearance.
pub struct DrawnCurve<'a> {
    /// The curve.
    pub curve: &'a Curve,
    /// The name of its sample.
    pub sample: &'a str,
    /// The colour.
    pub colour: Color32,
    /// The mark of its readings.
    pub mark: MarkShape,
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
    /// The largest absolute value on the axis of the residuals.
    pub residual_limit: f64,
}

impl<'a> PlotContext<'a> {
    /// The context of a frame.
    pub fn new(state: &'a State, curves: &'a [DrawnCurve<'a>]) -> Self {
        let scale = match state.view.layout {
            Layout::Polar => Scale::Linear,
            _ => state.view.scale,
        };
        let all = curves.iter().map(|drawn| drawn.curve);
        Self {
            state,
            curves,
            axis: scale.into(),
            range: value_range(all, scale).unwrap_or((0.001, 1.0)),
            residual_limit: residual_limit(curves),
        }
    }
}

/// A little more than the largest residual.
fn residual_limit(curves: &[DrawnCurve]) -> f64 {
    let readings = curves.iter().flat_map(|drawn| &drawn.curve.readings);
    let residuals = readings.map(|reading| reading.residual().abs());
    match 1.1 * residuals.fold(0.0, f64::max) {
        0.0 => 1.0,
        limit => limit,
    }
}
