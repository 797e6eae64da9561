//! The lobe of an incidence in three dimensions.

use egui::{Align2, FontId, Key, Rect, Response, Sense, Shape, Ui, WidgetInfo};

use super::navigation::{arrow_presses, presses};
use crate::intent::Intent;
use crate::solid::{Camera, Inks, LobeScene, mesh, project, texts};
use crate::state::State;
use crate::state::solid::SolidView;
use crate::theme;

/// The angle in radians by which a drag of one point turns the lobe.
const TURN_PER_POINT: f64 = 0.01;

/// The angle in radians by which a key turns the lobe.
const TURN_PER_KEY: f64 = 0.1;

/// How much a turn of the wheel by one point magnifies.
const ZOOM_PER_POINT: f64 = 0.003;

/// The factor by which a key magnifies.
const ZOOM_PER_KEY: f64 = 1.2;

/// The size of the text in points.
const TEXT: f32 = 12.0;

/// Draws the lobe.
pub(super) fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    ui.weak(state.lobe_caption());
    let Some(scene) = state.derived_solid.lobe() else {
        ui.centered_and_justified(|ui| {
            ui.label("No lobe: a parameter is outside the domain of the model.");
        });
        return;
    };
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    describe(&response, state);
    let camera = moved(ui, &response, state.solid.camera);
    if camera != state.solid.camera {
        intents.push(Intent::Solid(SolidView {
            camera,
            ..state.solid
        }));
    }
    paint(ui, rect, scene, &camera);
}

fn paint(ui: &Ui, rect: Rect, scene: &LobeScene, camera: &Camera) {
    let area = [rect.left(), rect.top(), rect.right(), rect.bottom()].map(f64::from);
    let inks = Inks::for_window(theme::ground(ui.ctx()));
    let projection = project(scene, camera, area, &inks);
    let painter = ui.painter().with_clip_rect(rect);
    painter.add(Shape::mesh(mesh(&projection)));
    let font = FontId::proportional(TEXT);
    let colour = ui.visuals().text_color();
    for (text, at) in texts(&projection) {
        painter.text(at, Align2::CENTER_CENTER, text, font.clone(), colour);
    }
}

fn describe(response: &Response, state: &State) {
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "BRDF lobe"));
    let caption = state.lobe_caption();
    let ctx = &response.ctx;
    ctx.accesskit_node_builder(response.id, |node| node.set_description(caption));
}

/// The camera after what the mouse and the keys do in this frame.
fn moved(ui: &Ui, response: &Response, camera: Camera) -> Camera {
    if response.double_clicked() {
        return Camera::default();
    }
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    let drag = response.drag_delta();
    let mut camera = camera;
    if drag != egui::Vec2::ZERO {
        let [x, y] = [drag.x, drag.y].map(|points| f64::from(points) * TURN_PER_POINT);
        camera = camera.turned(-x, y);
    }
    if response.hovered() {
        let (scroll, zoom) = ui.input(|input| (input.smooth_scroll_delta.y, input.zoom_delta()));
        if scroll != 0.0 || zoom != 1.0 {
            let factor = (f64::from(scroll) * ZOOM_PER_POINT).exp() * f64::from(zoom);
            camera = camera.zoomed(factor);
        }
    }
    if response.has_focus() {
        camera = by_keys(ui, response, camera);
    }
    camera
}

fn by_keys(ui: &Ui, response: &Response, camera: Camera) -> Camera {
    let [right, up] = arrow_presses(ui, response);
    let (yaw, pitch) = (-right, up);
    let zoom = presses(ui, Key::Plus) + presses(ui, Key::Equals) - presses(ui, Key::Minus);
    if yaw == 0.0 && pitch == 0.0 && zoom == 0.0 {
        return camera;
    }
    camera
        .turned(yaw * TURN_PER_KEY, pitch * TURN_PER_KEY)
        .zoomed(ZOOM_PER_KEY.powf(zoom))
}
