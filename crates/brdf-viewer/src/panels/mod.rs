//! The parts of the window, a file each: they draw the state and answer with intents.

pub mod dialog;
pub mod drop;
pub mod fit;
pub mod menu;
pub mod messages;
pub mod parameters;
pub mod results;
pub mod samples;
pub mod status;
pub mod theme;

use egui::{Response, Role, WidgetInfo};

/// Gives a control its accessible name where its picture has no words.
pub(crate) fn named(response: Response, kind: Role, name: &str) -> Response {
    response.widget_info(|| WidgetInfo::labeled(kind, response.enabled(), name));
    response
}

/// An angle in degrees, without the digits that come from radians.
pub(crate) fn degrees(radians: f64) -> String {
    format!("{}°", (radians.to_degrees() * 100.0).round() / 100.0)
}
