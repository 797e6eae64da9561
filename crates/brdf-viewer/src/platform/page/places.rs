//! Where the controls of the viewer are, for the tests of the page: by role and name, as the desktop tells
//! readers of the screen. A page asks for them by `?places` in its address.

use egui::accesskit::{Node, Rect};
use egui::{Context, FullOutput, Plugin};
use serde::Serialize;

use super::browser::document;

/// A control.
#[derive(Serialize)]
struct Place<'a> {
    role: String,
    name: &'a str,
    value: &'a str,
    disabled: bool,
    /// Left, top, right and bottom, in points.
    bounds: [f64; 4],
}

/// Keeps the attribute `data-places` of the canvas up to date.
#[derive(Debug)]
pub(super) struct Places {
    /// The identifier of the canvas.
    pub(super) canvas: &'static str,
}

impl Plugin for Places {
    fn debug_name(&self) -> &'static str {
        "places"
    }

    fn setup(&mut self, ctx: &Context) {
        ctx.enable_accesskit();
    }

    fn output_hook(&mut self, _: &Context, output: &mut FullOutput) {
        let Some(update) = output.platform_output.accesskit_update.take() else {
            return;
        };
        let places: Vec<Place> = update
            .nodes
            .iter()
            .filter_map(|(_, node)| place(node))
            .collect();
        let canvas = document().and_then(|document| document.get_element_by_id(self.canvas));
        if let (Some(canvas), Ok(text)) = (canvas, serde_json::to_string(&places)) {
            let _ = canvas.set_attribute("data-places", &text);
        }
    }
}

fn place(node: &Node) -> Option<Place<'_>> {
    let Rect { x0, y0, x1, y1 } = node.bounds()?;
    Some(Place {
        role: format!("{:?}", node.role()),
        name: node.label().unwrap_or_default(),
        value: node.value().unwrap_or_default(),
        disabled: node.is_disabled(),
        bounds: [x0, y0, x1, y1],
    })
}
