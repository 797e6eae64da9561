//! Undo and redo of changes of the parameters, of the choice of readings and of the limit of stage 1.

use std::collections::BTreeSet;

use super::id::{SampleId, ScanId};
use super::parameters::EditedParameters;

/// The largest number of undo steps.
const MOST_STEPS: usize = 1000;

/// A finished change of a scan.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// The scan.
    pub scan: ScanId,
    /// What it was before the change.
    pub before: Edited,
    /// What it is after the change.
    pub after: Edited,
}

/// What the user edits of a scan.
#[derive(Debug, Clone, PartialEq)]
pub enum Edited {
    /// The parameters.
    Parameters(EditedParameters),
    /// The indices of the readings that are left out.
    LeftOut(BTreeSet<usize>),
    /// The largest incidence angle of stage 1 in degrees, a setting of all fits.
    Stage1Limit(f64),
}

/// The changes that can be undone and redone. A step may change several scans.
#[derive(Debug, Clone, Default)]
pub struct History {
    past: Vec<Vec<Change>>,
    future: Vec<Vec<Change>>,
}

impl History {
    /// Adds a step, unless it is empty. Changes that were undone can then no longer be redone.
    pub fn push(&mut self, changes: Vec<Change>) {
        if changes.is_empty() {
            return;
        }
        self.future.clear();
        self.past.push(changes);
        if self.past.len() > MOST_STEPS {
            self.past.remove(0);
        }
    }

    /// Moves the last step to those that can be redone, and returns its changes.
    pub fn undo(&mut self) -> Option<Vec<Change>> {
        let changes = self.past.pop()?;
        self.future.push(changes.clone());
        Some(changes)
    }

    /// Moves the step that was undone last back to the past, and returns its changes.
    pub fn redo(&mut self) -> Option<Vec<Change>> {
        let changes = self.future.pop()?;
        self.past.push(changes.clone());
        Some(changes)
    }

    /// Removes the changes of a closed sample.
    pub fn remove_sample(&mut self, sample: SampleId) {
        for steps in [&mut self.past, &mut self.future] {
            for changes in steps.iter_mut() {
                changes.retain(|change| change.scan.sample != sample);
            }
            steps.retain(|changes| !changes.is_empty());
        }
    }

    /// Whether there is a step to undo.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is a step to redo.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }
}
