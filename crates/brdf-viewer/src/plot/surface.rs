//! The surface under light: a ball and a plate for each of up to two samples.

use std::sync::Arc;

use egui::{
    Color32, ColorImage, Rect, Response, Sense, TextureHandle, TextureOptions, Ui, Vec2,
    WidgetInfo, pos2, vec2,
};

use super::navigation::arrow_presses;
use crate::intent::Intent;
use crate::state::State;
use crate::state::solid::SolidView;
use crate::state::solid::derived::Pane;

/// The angle in degrees by which a drag of one point or a key moves the lamp.
const DEG_PER_POINT: f64 = 0.5;
const DEG_PER_KEY: f64 = 5.0;

/// The number of pixels along a picture is a multiple of this, so that it is not made anew in each frame
/// while a panel is resized.
const STEP: f32 = 32.0;

/// The least and the largest number of pixels along a picture.
const SIDES: [f32; 2] = [64.0, 512.0];

/// The height of a ball and the plate below it, in units of their width.
const HEIGHT: f32 = 1.5;

/// Draws the surface.
pub(super) fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    ui.weak(state.surface_caption());
    let panes: Vec<&Pane> = state.derived_solid.panes().collect();
    if panes.is_empty() {
        ui.centered_and_justified(|ui| {
            ui.label("No surface: a parameter is outside the domain of the model.");
        });
        return;
    }
    ui.columns(panes.len(), |columns| {
        for (i, (ui, pane)) in columns.iter_mut().zip(&panes).enumerate() {
            ui.vertical_centered(|ui| {
                ui.strong(&pane.name);
                ui.weak(&pane.note);
                let width = side(ui.available_size());
                if i == 0 {
                    request_side(ui, state, width, intents);
                }
                show_ball(ui, state, pane, i, width, intents);
                show_plate(ui, pane, i, width);
            });
        }
    });
}

/// The width in points of pictures that fit into a size.
fn side(size: Vec2) -> f32 {
    size.x.min(size.y / HEIGHT - 4.0).max(32.0)
}

fn request_side(ui: &Ui, state: &State, width: f32, intents: &mut Vec<Intent>) {
    let pixels = (width * ui.ctx().pixels_per_point() / STEP).ceil() * STEP;
    let side = pixels.clamp(SIDES[0], SIDES[1]) as usize;
    if side != state.surface_side {
        intents.push(Intent::SurfaceSide(side));
    }
}

fn show_ball(
    ui: &mut Ui,
    state: &State,
    pane: &Pane,
    index: usize,
    width: f32,
    intents: &mut Vec<Intent>,
) {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(width), Sense::click_and_drag());
    let name = format!("ball of {}", pane.name);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &name));
    paint(ui, rect, index, 0, pane);
    let view = state.solid;
    let moved = if response.double_clicked() {
        SolidView {
            lamp_deg: SolidView::default().lamp_deg,
            ..view
        }
    } else {
        view.with_lamp_moved(lamp_move(ui, &response))
    };
    if moved != view {
        intents.push(Intent::Solid(moved));
    }
}

/// How far the mouse and the keys move the lamp in this frame, in degrees to the right and upwards.
fn lamp_move(ui: &Ui, response: &Response) -> [f64; 2] {
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    let drag = response.drag_delta();
    let mut by = [drag.x, -drag.y].map(|points| f64::from(points) * DEG_PER_POINT);
    if response.has_focus() {
        let [right, up] = arrow_presses(ui, response);
        by[0] += DEG_PER_KEY * right;
        by[1] += DEG_PER_KEY * up;
    }
    by
}

fn show_plate(ui: &mut Ui, pane: &Pane, index: usize, width: f32) {
    let (rect, response) = ui.allocate_exact_size(vec2(width, 0.5 * width), Sense::hover());
    let name = format!("plate of {}", pane.name);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &name));
    paint(ui, rect, index, 1, pane);
}

/// Paints a picture. Its texture is changed only if the picture has.
fn paint(ui: &Ui, rect: Rect, pane_index: usize, part: usize, pane: &Pane) {
    let id = egui::Id::unique(("picture of a surface", pane_index, part));
    let known = ui.data(|data| data.get_temp::<(u64, TextureHandle)>(id));
    let texture = match known {
        Some((revision, texture)) if revision == pane.revision => texture,
        Some((_, mut texture)) => {
            texture.set(image(pane, part), TextureOptions::LINEAR);
            texture
        }
        None => {
            let name = format!("surface {pane_index} {part}");
            ui.ctx()
                .load_texture(name, image(pane, part), TextureOptions::LINEAR)
        }
    };
    let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    ui.painter().image(texture.id(), rect, all, Color32::WHITE);
    ui.data_mut(|data| data.insert_temp(id, (pane.revision, texture)));
}

fn image(pane: &Pane, part: usize) -> Arc<ColorImage> {
    Arc::clone(&pane.pictures[part])
}
