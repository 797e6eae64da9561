//! What panels and plots share: controls, their names, and how angles are written.

use egui::{ComboBox, Response, Role, Ui, WidgetInfo};

/// Gives a control its accessible name where its picture has no words.
pub(crate) fn named(response: Response, kind: Role, name: &str) -> Response {
    response.widget_info(|| WidgetInfo::labeled(kind, response.enabled(), name));
    response
}

/// An angle in degrees, without the digits that come from radians.
pub(crate) fn degrees(radians: f64) -> String {
    format!("{}°", (radians.to_degrees() * 100.0).round() / 100.0)
}

/// A box from which one of some values is chosen, with what each is called.
pub(crate) fn choose<T: PartialEq + Clone>(
    ui: &mut Ui,
    combo: ComboBox,
    value: &mut T,
    all: impl IntoIterator<Item = T>,
    name: impl Fn(&T) -> String,
) -> Response {
    let shown = combo.selected_text(name(value)).show_ui(ui, |ui| {
        for other in all {
            let words = name(&other);
            ui.selectable_value(value, other, words);
        }
    });
    shown.response
}
