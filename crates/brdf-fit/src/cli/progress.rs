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

/// Shows the phase of one fit, or the part of it, beside the bar.
pub(super) struct PhaseMessage<'a> {
    pub(super) bar: &'a ProgressBar,
    /// The scan, as messages name it.
    pub(super) scan: String,
}

impl Observer for PhaseMessage<'_> {
    fn step(&self, step: &Step) -> ControlFlow<()> {
        let begun = step.part.map(|part| part.to_string());
        let begun = begun.or_else(|| (step.iteration == 0).then(|| step.phase.to_string()));
        if let Some(begun) = begun {
            self.bar.set_message(format!("{}: {begun}", self.scan));
        }
        ControlFlow::Continue(())
    }
}
