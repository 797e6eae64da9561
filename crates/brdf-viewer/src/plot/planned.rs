//! The planned readings of a scan, as hollow marks on its theory.

use brdf_core::Geometry;
use brdf_fit::Side;
use brdf_fit::planning::Setting;
use egui::{Color32, Shape, Stroke};
use egui_plot::PlotTransform;

use super::axis::Axis;
use super::context::PlotContext;
use super::items::mark_outline;
use crate::state::sample::{Sample, Scan};

/// The planned readings of the active scan that are in the shown plane: the angle on the axis in degrees, and the
/// value of the theory there; with `psi` those of this incidence alone.
pub(super) fn points(context: &PlotContext, psi: Option<f64>) -> Vec<[f64; 2]> {
    let Some(scan) = context.state.active_sample().map(Sample::scan) else {
        return Vec::new();
    };
    let Some(plan) = scan.current_plan() else {
        return Vec::new();
    };
    let settings = plan.readings.iter().map(|reading| reading.setting);
    let shown = settings.filter(|setting| psi.is_none_or(|psi| (setting.psi - psi).abs() < 1e-3));
    shown
        .filter_map(|setting| point(context, scan, setting))
        .collect()
}

fn point(context: &PlotContext, scan: &Scan, setting: Setting) -> Option<[f64; 2]> {
    let view = &context.state.view;
    let Setting { psi, theta, phi } = setting;
    if (phi - view.azimuth).sin().abs() > 1e-3 {
        return None;
    }
    let brdf = scan.parameters.brdf()?;
    let geometry = Geometry::new(psi, theta, phi).ok()?;
    let value = view
        .quantity
        .of(brdf.value(&geometry), geometry.cos_theta());
    let theta = if (phi - view.azimuth).cos() < 0.0 {
        -theta
    } else {
        theta
    };
    let sign = if view.theta_positive == Side::Source {
        1.0
    } else {
        -1.0
    };
    Some([sign * theta.to_degrees(), value])
}

/// Draws the marks.
pub(super) fn draw(
    transform: &PlotTransform,
    axis: Axis,
    points: &[[f64; 2]],
    colour: Color32,
    shapes: &mut Vec<Shape>,
) {
    let stroke = Stroke::new(1.6, colour);
    for &[theta_deg, value] in points {
        if let Some(y) = axis.position(value) {
            shapes.extend(mark_outline(transform, [theta_deg, y], stroke));
        }
    }
}
