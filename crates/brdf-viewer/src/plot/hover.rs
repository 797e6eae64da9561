//! What the pointer is at: a reading is read out with the theory beside it.

use brdf_fit::plot::Reading;
use brdf_fit::words::digits;
use egui::{PopupAnchor, Pos2, Stroke, Tooltip};
use egui_plot::{PlotResponse, PlotTransform};

use super::Drawn;
use super::axis::Axis;
use crate::panels::degrees;
use crate::state::State;

/// A reading is meant when the pointer is within this of it, in points.
const NEAR: f32 = 14.0;

/// What all plots of a frame share.
pub struct Plots<'a> {
    /// What is loaded and chosen.
    pub state: &'a State,
    /// The curves.
    pub drawn: &'a [Drawn<'a>],
    /// The axis of the BRDF.
    pub axis: Axis,
}

impl<'a> Plots<'a> {
    /// The plots of a frame.
    pub fn new(state: &'a State, drawn: &'a [Drawn<'a>]) -> Self {
        Self {
            state,
            drawn,
            axis: state.view.scale.into(),
        }
    }
}

/// Rings the reading nearest to the pointer and reads it out. `place` says where a reading stands.
pub fn read_out(
    response: &PlotResponse<()>,
    drawn: &[&Drawn],
    place: impl Fn(&Reading) -> Option<[f64; 2]>,
) {
    let Some(pointer) = response.response.hover_pos() else {
        return;
    };
    let Some((at, drawn, reading)) = nearest(&response.transform, drawn, place, pointer) else {
        return;
    };
    let ctx = &response.response.ctx;
    let ring = Stroke::new(1.5, ctx.global_style().visuals.strong_text_color());
    let painter = ctx.layer_painter(response.response.layer_id);
    painter
        .with_clip_rect(*response.transform.frame())
        .circle_stroke(at, 6.0, ring);
    let tooltip = Tooltip::always_open(
        ctx.clone(),
        response.response.layer_id,
        response.response.id,
        PopupAnchor::Pointer,
    );
    tooltip.gap(14.0).show(|ui| ui.label(words(drawn, reading)));
}

fn nearest<'a>(
    transform: &PlotTransform,
    drawn: &'a [&'a Drawn<'a>],
    place: impl Fn(&Reading) -> Option<[f64; 2]>,
    pointer: Pos2,
) -> Option<(Pos2, &'a Drawn<'a>, &'a Reading)> {
    let mut best = None;
    let mut least = NEAR * NEAR;
    for one in drawn {
        for reading in &one.curve.readings {
            let Some([x, y]) = place(reading) else {
                continue;
            };
            let at = egui::pos2(
                transform.position_from_point_x(x),
                transform.position_from_point_y(y),
            );
            let distance = at.distance_sq(pointer);
            if distance < least {
                least = distance;
                best = Some((at, *one, reading));
            }
        }
    }
    best
}

/// What is read out.
fn words(drawn: &Drawn, reading: &Reading) -> String {
    let sigma = reading
        .sigma
        .map_or_else(String::new, |sigma| format!(" ± {}", digits(sigma)));
    format!(
        "{}\npsi {}, theta {:.2}°\nmeasured {}{sigma}\ntheory {}\ndifference {}",
        drawn.sample,
        degrees(drawn.curve.psi),
        reading.theta_deg,
        digits(reading.value),
        digits(reading.theory),
        digits(reading.residual()),
    )
}
