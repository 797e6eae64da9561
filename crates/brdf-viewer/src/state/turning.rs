//! The parameters: turned, reset, taken back.

use brdf_fit::model::{Model, Parameter};

use super::State;
use super::fitting::Scope;
use super::history::Change;
use super::sample::{Knobs, Sample, Scan, ScanId};

impl State {
    pub(super) fn turn(&mut self, change: impl FnOnce(Knobs) -> Knobs) {
        if let Some(sample) = self.active_mut() {
            let scan = sample.scan_mut();
            scan.knobs = change(scan.knobs);
        }
    }

    /// Another model, with the parameters that it has in common with the one before.
    pub(super) fn choose_model(&mut self, model: Model, scope: Scope) {
        self.settle();
        let mut changes = Vec::new();
        for scan in self.scans_of(scope) {
            changes.extend(self.scan_mut(scan).and_then(|of| {
                of.knobs = Knobs {
                    model,
                    at: model.start(of.knobs.at),
                    ..of.knobs
                };
                settled(scan, of)
            }));
        }
        self.history.push(changes);
    }

    pub(super) fn reset(&mut self, parameter: Parameter) {
        let Some(fitted) = self.active_sample().map(|s| s.scan().fitted_knobs()) else {
            return;
        };
        self.turn(|mut knobs| {
            parameter.set(&mut knobs.at, parameter.of(&fitted.at));
            knobs
        });
    }

    pub(super) fn reset_all(&mut self) {
        if let Some(fitted) = self.active_sample().map(|s| s.scan().fitted_knobs()) {
            self.turn(|_| fitted);
            self.settle();
        }
    }

    /// Ends a change of the parameters: from here on it can be taken back as one.
    pub fn settle(&mut self) {
        let Some(sample) = self.active_mut() else {
            return;
        };
        let id = sample.scan_id();
        let change = settled(id, sample.scan_mut());
        self.history.push(change.into_iter().collect());
    }

    pub(super) fn undo(&mut self) {
        self.settle();
        if let Some(changes) = self.history.undo() {
            self.restore(&changes, |change| change.before);
        }
    }

    pub(super) fn redo(&mut self) {
        if let Some(changes) = self.history.redo() {
            self.restore(&changes, |change| change.after);
        }
    }

    /// Sets the parameters of scans, and shows one of them: a change that is not seen is not
    /// believed.
    fn restore(&mut self, changes: &[Change], knobs: impl Fn(&Change) -> Knobs) {
        for change in changes {
            if let Some(scan) = self.scan_mut(change.scan) {
                scan.knobs = knobs(change);
                scan.settled = scan.knobs;
            }
        }
        let active = self.active_sample().filter(|sample| sample.visible);
        let active = active.map(Sample::scan_id);
        let is_seen = changes.iter().any(|change| Some(change.scan) == active);
        if let Some(first) = changes.first().filter(|_| !is_seen) {
            self.show(first.scan);
        }
    }

    fn show(&mut self, scan: ScanId) {
        self.change(scan.sample, |sample| {
            sample.visible = true;
            sample.current = scan.wavelength;
        });
        self.active = Some(scan.sample);
    }
}

/// What has changed of a scan since the last finished change, which this one now is.
pub(super) fn settled(scan: ScanId, of: &mut Scan) -> Option<Change> {
    let before = std::mem::replace(&mut of.settled, of.knobs);
    (before != of.knobs).then_some(Change {
        scan,
        before,
        after: of.knobs,
    })
}
