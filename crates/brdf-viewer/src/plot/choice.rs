//! Choosing readings in the plot: a click on one, or a rectangle around several.

use egui::{Pos2, Rect, Stroke, StrokeKind};
use egui_plot::PlotResponse;

use super::context::{DrawnCurve, PlotContext};
use super::hover::{nearest_reading, on_screen};
use crate::intent::Intent;
use crate::state::id::ScanId;

/// Requests that the readings at the pointer are left out of the fit or used again: the nearest one
/// after a click, those in the rectangle after a drag.
pub(super) fn choose(
    context: &PlotContext,
    response: &PlotResponse<()>,
    curves: &[&DrawnCurve],
    position: impl Fn(&brdf_fit::plot::Reading) -> Option<[f64; 2]>,
) {
    if !context.state.choosing {
        return;
    }
    let pointer = &response.response;
    if pointer.clicked() {
        let at = pointer.interact_pointer_pos();
        let nearest = at.and_then(|at| nearest_reading(&response.transform, curves, &position, at));
        if let Some((_, drawn, reading)) = nearest {
            context.request(Intent::ToggleReadings(drawn.scan, vec![reading.index]));
        }
        return;
    }
    let Some(rectangle) = rectangle(response) else {
        return;
    };
    if !pointer.drag_stopped() {
        let visuals = &pointer.ctx.global_style().visuals;
        let painter = pointer.ctx.layer_painter(pointer.layer_id);
        let stroke = Stroke::new(1.5, visuals.strong_text_color());
        painter.rect_stroke(rectangle, 0.0, stroke, StrokeKind::Inside);
        return;
    }
    for (scan, readings) in readings_in(rectangle, response, curves, &position) {
        context.request(Intent::ToggleReadings(scan, readings));
    }
}

/// The rectangle from where the drag began to the pointer.
fn rectangle(response: &PlotResponse<()>) -> Option<Rect> {
    let pointer = &response.response;
    if !(pointer.dragged() || pointer.drag_stopped()) {
        return None;
    }
    let key = pointer.id.with("rectangle");
    let here = pointer.interact_pointer_pos()?;
    // The drag is recognised after the pointer has moved; when it ends, its origin is forgotten.
    let origin = pointer.ctx.input(|input| input.pointer.press_origin());
    let start = pointer.ctx.data_mut(|data| {
        if let Some(origin) = origin {
            data.insert_temp(key, origin);
        }
        data.get_temp::<Pos2>(key)
    })?;
    Some(Rect::from_two_pos(start, here).intersect(*response.transform.frame()))
}

/// The readings in a rectangle on the screen, by their scan.
fn readings_in(
    rectangle: Rect,
    response: &PlotResponse<()>,
    curves: &[&DrawnCurve],
    position: impl Fn(&brdf_fit::plot::Reading) -> Option<[f64; 2]>,
) -> Vec<(ScanId, Vec<usize>)> {
    let mut by_scan: Vec<(ScanId, Vec<usize>)> = Vec::new();
    for drawn in curves {
        let inside = drawn.curve.readings.iter().filter(|reading| {
            let at = position(reading).map(|at| on_screen(&response.transform, at));
            at.is_some_and(|at| rectangle.contains(at))
        });
        let indices = inside.map(|reading| reading.index);
        match by_scan.iter_mut().find(|(scan, _)| *scan == drawn.scan) {
            Some((_, readings)) => readings.extend(indices),
            None => by_scan.push((drawn.scan, indices.collect())),
        }
    }
    by_scan.retain(|(_, readings)| !readings.is_empty());
    by_scan
}
