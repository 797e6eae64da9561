//! Files that are dropped onto the window.

use egui::{Align2, Color32, Context, Id, LayerId, Order, TextStyle};

use crate::events::EventSender;
use crate::intent::Intent;
use crate::platform::Files;
use crate::platform::current::CurrentFiles;

/// The intents for dropped files; others follow as events. While files are dragged over the window, a hint
/// is shown.
pub fn intents(ctx: &Context, events: EventSender) -> Vec<Intent> {
    if ctx.input(|input| !input.raw.hovered_files.is_empty()) {
        show_hint(ctx);
    }
    let dropped = ctx.input(|input| input.raw.dropped_files.clone());
    CurrentFiles::take_dropped(dropped, events)
}

fn show_hint(ctx: &Context) {
    let layer = LayerId::new(Order::Foreground, Id::unique("drop"));
    let painter = ctx.layer_painter(layer);
    let window = ctx.content_rect();
    painter.rect_filled(window, 0.0, Color32::from_black_alpha(160));
    painter.text(
        window.center(),
        Align2::CENTER_CENTER,
        "Drop to open",
        TextStyle::Heading.resolve(&ctx.global_style()),
        Color32::WHITE,
    );
}
