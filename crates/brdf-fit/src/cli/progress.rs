//! The progress of a run, on standard error if that is a terminal.

use std::ops::ControlFlow;

use indicatif::{ProgressBar, ProgressStyle};

use crate::progress::{Observer, Step};

/// A bar that counts fits.
pub(super) fn bar(count: usize) -> ProgressBar {
    let bar = ProgressBar::new(count as u64);
    if let Ok(style) = ProgressStyle::with_template("fitting {bar:40} {pos}/{len} {msg}") {
        bar.set_style(style);
    }
    bar
}

/// Shows the phase of one fit beside the bar.
pub(super) struct PhaseMessage<'a> {
    pub(super) bar: &'a ProgressBar,
    /// The scan, as messages name it.
    pub(super) scan: String,
}

impl Observer for PhaseMessage<'_> {
    fn step(&self, step: &Step) -> ControlFlow<()> {
        if step.iteration == 0 {
            self.bar
                .set_message(format!("{}: {}", self.scan, step.phase));
        }
        ControlFlow::Continue(())
    }
}
