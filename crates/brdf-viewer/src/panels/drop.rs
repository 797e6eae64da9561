//! Files that are dropped onto the window.

use egui::{Align2, Color32, Context, Id, LayerId, Order, TextStyle};

use crate::intent::Intent;

/// What was dropped. A file of the system is read where it is; what has no place of its own comes
/// with its bytes.
pub fn intents(ctx: &Context) -> Vec<Intent> {
    if ctx.input(|input| !input.raw.hovered_files.is_empty()) {
        say_that_it_can_be_dropped(ctx);
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

fn say_that_it_can_be_dropped(ctx: &Context) {
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
