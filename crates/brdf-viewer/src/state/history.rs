//! Undo and redo of what was turned.

use super::sample::{Knobs, SampleId, ScanId};

/// So many changes can be taken back.
const MOST: usize = 1000;

/// One finished change of the parameters of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// The scan.
    pub scan: ScanId,
    /// The parameters before it.
    pub before: Knobs,
    /// The parameters after it.
    pub after: Knobs,
}

/// The changes that were made, and those that were taken back.
#[derive(Debug, Clone, Default)]
pub struct History {
    past: Vec<Change>,
    future: Vec<Change>,
}

impl History {
    /// Remembers a change. What was taken back before can no longer be done again.
    pub fn push(&mut self, change: Change) {
        self.future.clear();
        self.past.push(change);
        if self.past.len() > MOST {
            self.past.remove(0);
        }
    }

    /// The change to take back.
    pub fn undo(&mut self) -> Option<Change> {
        let change = self.past.pop()?;
        self.future.push(change);
        Some(change)
    }

    /// The change to do again.
    pub fn redo(&mut self) -> Option<Change> {
        let change = self.future.pop()?;
        self.past.push(change);
        Some(change)
    }

    /// Forgets the changes of a sample that is closed.
    pub fn forget(&mut self, sample: SampleId) {
        self.past.retain(|change| change.scan.sample != sample);
        self.future.retain(|change| change.scan.sample != sample);
    }

    /// Whether there is a change to take back.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is a change to do again.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }
}
