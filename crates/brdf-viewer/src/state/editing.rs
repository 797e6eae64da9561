//! Editing: the active sample, its parameters, and undo and redo.

use std::collections::BTreeSet;

use brdf_fit::{Model, Parameter};

use super::State;
use super::angle_range::End;
use super::fit_settings::{Scope, Stages};
use super::history::{Change, Edited};
use super::id::{SampleId, ScanId};
use super::parameters::EditedParameters;
use super::sample::Sample;

impl State {
    /// Ends a change of the parameters, or of the limit of stage 1, which becomes one step of the
    /// history.
    pub fn commit(&mut self) {
        let Some(sample) = self.active_sample_mut() else {
            return;
        };
        let id = sample.scan_id();
        let change = sample.scan_mut().commit(id);
        let limit = self.commit_stage1_limit(id);
        self.history.push(change.into_iter().chain(limit).collect());
    }

    fn commit_stage1_limit(&mut self, scan: ScanId) -> Option<Change> {
        let after = self.fit_settings.stage1_limit_deg;
        let before = self.committed_stage1_limit_deg.replace(after)?;
        (before != after).then_some(Change {
            scan,
            before: Edited::Stage1Limit(before),
            after: Edited::Stage1Limit(after),
        })
    }

    pub(super) fn activate(&mut self, id: SampleId) {
        if self.sample(id).is_some() {
            self.commit();
            self.active = Some(id);
            self.select_plane_with_readings();
        }
    }

    pub(super) fn select_wavelength(&mut self, id: SampleId, wavelength: usize) {
        self.commit();
        self.change(id, |sample| {
            if wavelength < sample.scans.len() {
                sample.current = wavelength;
            }
        });
        self.select_plane_with_readings();
    }

    /// Selects another plane if the current one contains no readings of the active sample.
    fn select_plane_with_readings(&mut self) {
        let Some(planes) = self.active_sample().map(|s| s.scan().planes.clone()) else {
            return;
        };
        let is_current = |plane: &f64| (plane - self.view.azimuth).abs() < 1e-6;
        if !planes.is_empty() && !planes.iter().any(is_current) {
            self.view.azimuth = planes[0];
        }
    }

    pub(super) fn set_parameters(&mut self, parameters: EditedParameters) {
        if let Some(sample) = self.active_sample_mut() {
            sample.scan_mut().parameters = parameters;
        }
    }

    /// Sets the model of scans. Parameters that both models have keep their values.
    pub(super) fn set_model(&mut self, model: Model, scope: Scope) {
        self.commit();
        let mut changes = Vec::new();
        for id in self.scans_in(scope) {
            changes.extend(self.scan_mut(id).and_then(|scan| {
                scan.parameters.model = model;
                scan.parameters.values = model.start(scan.parameters.values);
                scan.commit(id)
            }));
        }
        self.history.push(changes);
    }

    pub(super) fn reset(&mut self, parameter: Parameter) {
        if let Some(sample) = self.active_sample_mut() {
            let scan = sample.scan_mut();
            let fitted = parameter.of(&scan.fitted_parameters().values);
            parameter.set(&mut scan.parameters.values, fitted);
        }
    }

    pub(super) fn reset_all(&mut self) {
        if let Some(sample) = self.active_sample_mut() {
            let scan = sample.scan_mut();
            scan.parameters = scan.fitted_parameters();
            self.commit();
        }
    }

    pub(super) fn undo(&mut self) {
        self.commit();
        if let Some(changes) = self.history.undo() {
            self.restore(&changes, |change| &change.before);
        }
    }

    pub(super) fn redo(&mut self) {
        if let Some(changes) = self.history.redo() {
            self.restore(&changes, |change| &change.after);
        }
    }

    /// Restores what was edited of scans. If none of them is visible, activates the first one, so
    /// that the user sees the effect.
    fn restore(&mut self, changes: &[Change], edited: impl Fn(&Change) -> &Edited) {
        for change in changes {
            match edited(change) {
                Edited::Stage1Limit(limit_deg) => {
                    self.fit_settings.stage1_limit_deg = *limit_deg;
                    self.committed_stage1_limit_deg = Some(*limit_deg);
                }
                Edited::Parameters(parameters) => {
                    if let Some(scan) = self.scan_mut(change.scan) {
                        scan.parameters = *parameters;
                        scan.committed = *parameters;
                    }
                }
                Edited::LeftOut(readings) => {
                    if let Some(scan) = self.scan_mut(change.scan) {
                        scan.leave_out(readings.clone());
                    }
                }
            }
        }
        let active = self.active_sample().filter(|sample| sample.visible);
        let active = active.map(Sample::scan_id);
        let of_all_scans = |change: &Change| matches!(change.before, Edited::Stage1Limit(_));
        let is_seen = |change: &Change| Some(change.scan) == active || of_all_scans(change);
        let is_seen = changes.iter().any(is_seen);
        if let Some(first) = changes.first().filter(|_| !is_seen) {
            self.show(first.scan);
        }
    }

    /// Leaves readings of a scan out of its fit, in place of those that were left out before.
    pub(super) fn leave_out(&mut self, id: ScanId, readings: BTreeSet<usize>) {
        self.commit();
        let Some(scan) = self.scan_mut(id) else {
            return;
        };
        let before = scan.left_out().clone();
        scan.leave_out(readings);
        let after = scan.left_out().clone();
        if before != after {
            scan.has_unsaved_work = true;
            self.history.push(vec![Change {
                scan: id,
                before: Edited::LeftOut(before),
                after: Edited::LeftOut(after),
            }]);
        }
    }

    /// Leaves all readings of an incidence out, or none of them.
    pub(super) fn use_incidence(&mut self, id: SampleId, incidence: usize, used: bool) {
        let Some(sample) = self.sample(id) else {
            return;
        };
        let (scan_id, scan) = (sample.scan_id(), sample.scan());
        let incidences = scan.measurements.incidences();
        let Some(incidence) = incidences.get(incidence) else {
            return;
        };
        let mut left_out = scan.left_out().clone();
        for reading in &incidence.readings {
            if used {
                left_out.remove(reading);
            } else {
                left_out.insert(*reading);
            }
        }
        self.leave_out(scan_id, left_out);
    }

    /// Moves an end of the view angles of a scan that its fit uses.
    pub(super) fn limit_angles(&mut self, id: ScanId, end: End, to_deg: f64) {
        let range = self.derived.angle_range(id).copied();
        if let (Some(range), Some(scan)) = (range, self.scan(id)) {
            let (all, left_out) = (&scan.measurements, scan.left_out());
            let moved = range.moved(end, to_deg, all, left_out, &self.view);
            self.leave_out(id, moved);
        }
    }

    /// Leaves readings out that are used, or uses them again if all of them are left out.
    pub(super) fn toggle_readings(&mut self, id: ScanId, readings: &[usize]) {
        let Some(scan) = self.scan(id) else {
            return;
        };
        let mut left_out = scan.left_out().clone();
        if readings.iter().all(|reading| left_out.contains(reading)) {
            left_out.retain(|reading| !readings.contains(reading));
        } else {
            left_out.extend(readings);
        }
        self.leave_out(id, left_out);
    }

    /// Takes the parameters of a model that the last fit of the active scan was compared with.
    pub(super) fn take_model(&mut self, model: Model) {
        let Some(sample) = self.active_sample_mut() else {
            return;
        };
        let scan = sample.scan_mut();
        let report = scan.last_fit.as_ref();
        let mut models = report.iter().flat_map(|report| &report.assessment);
        let found = models.find_map(|assessment| {
            let mut candidates = assessment.models.iter();
            candidates.find(|candidate| candidate.model == model)
        });
        let values = found.map_or_else(
            || model.start(scan.parameters.values),
            |candidate| candidate.parameters,
        );
        scan.parameters.model = model;
        scan.parameters.values = values;
        self.commit();
        self.fit(Stages::Both, Scope::Wavelength);
    }

    fn show(&mut self, scan: ScanId) {
        self.change(scan.sample, |sample| {
            sample.visible = true;
            sample.current = scan.wavelength;
        });
        self.active = Some(scan.sample);
    }
}
