//! Files that are dropped onto the window.

use egui::{Align2, Color32, Context, Id, LayerId, Order, TextStyle};

use crate::intent::Intent;

/// The intents for dropped files. A file with an absolute path is read by the worker; others come
/// with their content. While files are dragged over the window, a hint is shown.
pub fn intents(ctx: &Context) -> Vec<Intent> {
    if ctx.input(|input| !input.raw.hovered_files.is_empty()) {
        show_hint(ctx);
    }
    let dropped = ctx.input(|input| input.raw.dropped_files.clone());
    let intents = dropped.iter().map(|file| {
        let path = file.path().to_owned();
        match file.bytes() {
            Ok(bytes) if !path.is_absolute() => {
                Intent::OpenBytes(path.display().to_string(), bytes)
            }
            _ => Intent::Open(vec![path]),
        }
    });
    intents.collect()
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
