//! The channel through which jobs and dialogs send events to the window.

use std::sync::Arc;
use std::sync::mpsc::Sender;

use crate::job::Event;

/// Sends events, and wakes the window for each.
#[derive(Clone)]
pub struct EventSender {
    sender: Sender<Event>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl EventSender {
    /// Sends events into a channel, and calls `wake` after each.
    pub fn new(sender: Sender<Event>, wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self {
            sender,
            wake: Arc::new(wake),
        }
    }

    /// Sends an event. It is dropped if the window is closed.
    pub fn send(&self, event: Event) {
        let _ = self.sender.send(event);
        (self.wake)();
    }
}
