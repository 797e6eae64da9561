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
    past: Vec<Vec<Change>>,
    future: Vec<Vec<Change>>,
}

impl History {
    /// Remembers changes that were made as one. What was taken back before can no longer be done
    /// again.
    pub fn push(&mut self, changes: Vec<Change>) {
        if changes.is_empty() {
            return;
        }
        self.future.clear();
        self.past.push(changes);
        if self.past.len() > MOST {
            self.past.remove(0);
        }
    }

    /// The changes to take back.
    pub fn undo(&mut self) -> Option<Vec<Change>> {
        let changes = self.past.pop()?;
        self.future.push(changes.clone());
        Some(changes)
    }

    /// The changes to do again.
    pub fn redo(&mut self) -> Option<Vec<Change>> {
        let changes = self.future.pop()?;
        self.past.push(changes.clone());
        Some(changes)
    }

    /// Forgets the changes of a sample that is closed.
    pub fn forget(&mut self, sample: SampleId) {
        for side in [&mut self.past, &mut self.future] {
            for changes in side.iter_mut() {
                changes.retain(|change| change.scan.sample != sample);
            }
            side.retain(|changes| !changes.is_empty());
        }
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
