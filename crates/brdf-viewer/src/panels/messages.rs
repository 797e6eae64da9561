//! Errors and notes above the plot, until they are dismissed.

use egui::{Color32, Frame, Panel, RichText, ScrollArea, Ui};

use crate::intent::Intent;
use crate::state::State;
use crate::state::interface::{Message, Severity};

/// The largest height of all messages, in points.
const MOST_HEIGHT: f32 = 110.0;

/// Draws the messages, the latest first. Without messages there is no panel.
pub fn show(ui: &mut Ui, state: &State, intents: &mut Vec<Intent>) {
    if state.messages.is_empty() {
        return;
    }
    Panel::top("messages").resizable(false).show(ui, |ui| {
        if state.messages.len() > 1 && ui.button("Dismiss all").clicked() {
            intents.push(Intent::DismissAll);
        }
        ScrollArea::vertical()
            .max_height(MOST_HEIGHT)
            .min_scrolled_height(MOST_HEIGHT)
            .show(ui, |ui| {
                for (i, message) in state.messages.iter().enumerate().rev() {
                    if show_message(ui, message) {
                        intents.push(Intent::Dismiss(i));
                    }
                }
            });
    });
}

/// Draws a message, and returns whether it is dismissed.
fn show_message(ui: &mut Ui, message: &Message) -> bool {
    let (title, colour) = match message.severity {
        Severity::Error => ("Error", ui.visuals().error_fg_color),
        Severity::Note => ("Note", ui.visuals().warn_fg_color),
    };
    let frame = Frame::group(ui.style())
        .stroke((1.0, colour))
        .fill(Color32::TRANSPARENT);
    let shown = frame.show(ui, |ui| {
        ui.horizontal_top(|ui| {
            let dismissed = ui.button("Dismiss").clicked();
            ui.label(RichText::new(title).color(colour).strong());
            ui.add(egui::Label::new(&message.text).wrap());
            dismissed
        })
    });
    shown.inner.inner
}
