//! Helpers shared by panels and plots: accessible names, combo boxes and angles as text.

use egui::{ComboBox, Response, Role, Ui, WidgetInfo};

/// Sets the accessible name of a control that has no text of its own.
pub(crate) fn named(response: Response, role: Role, name: &str) -> Response {
    response.widget_info(|| WidgetInfo::labeled(role, response.enabled(), name));
    response
}

/// An angle in degrees, rounded to 0.01° to remove the rounding error of the conversion.
pub(crate) fn degrees(radians: f64) -> String {
    format!("{}°", (radians.to_degrees() * 100.0).round() / 100.0)
}

/// A combo box that selects one of several values, each shown by its name.
pub(crate) fn choose<T: PartialEq + Clone>(
    ui: &mut Ui,
    combo: ComboBox,
    value: &mut T,
    all: impl IntoIterator<Item = T>,
    name: impl Fn(&T) -> String,
) -> Response {
    let shown = combo.selected_text(name(value)).show_ui(ui, |ui| {
        for other in all {
            let text = name(&other);
            ui.selectable_value(value, other, text);
        }
    });
    shown.response
}
