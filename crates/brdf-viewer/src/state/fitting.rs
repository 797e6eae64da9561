//! Starting and cancelling fits, and taking over their results.

use std::sync::Arc;

use brdf_fit::report::Report;

use super::State;
use super::fit_run::{FitRun, Progress};
use super::fit_settings::{Scope, Stages};
use super::id::{SampleId, ScanId};
use crate::job::{FitJob, FitJobs, Job};

impl State {
    /// The scans within a scope that have readings.
    pub(super) fn scans_to_fit(&self, scope: Scope) -> Vec<ScanId> {
        let mut scans = self.scans_in(scope);
        scans.retain(|id| self.can_be_fitted(*id));
        scans
    }

    fn can_be_fitted(&self, id: ScanId) -> bool {
        self.scan(id).is_some_and(|scan| scan.used_count() > 0)
    }

    /// Starts the fits that the user asks for. Fits that the opening of files started are interrupted,
    /// and continued afterwards.
    pub(super) fn fit(&mut self, stages: Stages, scope: Scope) {
        if self.is_fitting_on_request() {
            return;
        }
        self.commit();
        let scans = self.scans_to_fit(scope);
        if scans.is_empty() {
            return;
        }
        if let Some(run) = self.fit_run.as_mut().filter(|run| run.is_running()) {
            let waiting = run.waiting().filter(|scan| !scans.contains(scan));
            self.to_fit = waiting.chain(std::mem::take(&mut self.to_fit)).collect();
            run.cancel();
        }
        self.start_run(&scans, stages, false);
    }

    /// Fits the scans of a sample that has been opened, the current one first.
    pub(super) fn fit_opened(&mut self, id: SampleId) {
        if !self.fit_settings.on_opening {
            return;
        }
        let Some(sample) = self.sample(id) else {
            return;
        };
        let current = sample.scan_id();
        let others = sample.scan_ids().filter(|scan| *scan != current);
        let all: Vec<ScanId> = std::iter::once(current).chain(others).collect();
        let unfitted = |id: &ScanId| self.scan(*id).is_some_and(|scan| scan.last_fit.is_none());
        let all: Vec<ScanId> = all.into_iter().filter(unfitted).collect();
        self.to_fit.extend(all);
        self.continue_automatic_fits();
    }

    /// Starts the fits of opened scans, unless another run is going on.
    fn continue_automatic_fits(&mut self) {
        if self.is_fitting() {
            return;
        }
        let waiting = std::mem::take(&mut self.to_fit);
        let open = waiting.into_iter().filter(|id| self.can_be_fitted(*id));
        let scans: Vec<ScanId> = open.collect();
        self.start_run(&scans, Stages::Both, true);
    }

    fn start_run(&mut self, scans: &[ScanId], stages: Stages, automatic: bool) {
        let number = self.next_run;
        let Some(run) = FitRun::new(number, automatic, scans) else {
            return;
        };
        self.next_run += 1;
        let job = |(id, cancel)| {
            let scan = self.scan(id)?;
            Some(FitJob {
                scan: id,
                measurements: Arc::clone(scan.used()),
                left_out: scan.left_out().iter().copied().collect(),
                table: scan.table.clone(),
                options: self.fit_settings.options(&scan.parameters, stages),
                cancel,
            })
        };
        let fits = run.cancel_flags().filter_map(job).collect();
        self.fit_run = Some(run);
        self.start(Job::Fit(FitJobs {
            run: number,
            fits,
            depth: self.fit_settings.depth(),
        }));
    }

    pub(super) fn cancel(&mut self) {
        self.to_fit.clear();
        if let Some(run) = self.fit_run.as_mut().filter(|run| run.is_running()) {
            run.cancel();
        }
    }

    /// Takes over the parameters of a fit, of which the analysis is not complete.
    pub(super) fn take_found(&mut self, id: ScanId, report: Report) {
        let run = self.fit_run.as_ref();
        let Some(automatic) = run
            .filter(|run| run.is_waiting_for(id))
            .map(|run| run.automatic)
        else {
            return;
        };
        self.adopt(id, report, automatic);
    }

    /// Takes over the report of a fit, which contains the fit or its error.
    pub(super) fn take_report(&mut self, id: ScanId, report: Report) {
        if let Some(error) = &report.error {
            let wavelength = report.wavelength_um;
            let wavelength = wavelength.map_or_else(String::new, |w| format!(", {w} µm"));
            let error = format!("{}{wavelength}: {error}", report.file);
            self.take_fit_error(id, error);
            return;
        }
        let automatic = self.fit_run.as_ref().is_some_and(|run| run.automatic);
        let Some(convergence) = self.fit_run.as_mut().and_then(|run| run.finish(id, None)) else {
            return;
        };
        self.adopt(id, report, automatic);
        if let Some(scan) = self.scan_mut(id) {
            scan.convergence = convergence;
        }
    }

    /// Stores a fit and makes its parameters the current ones, as a step of the history. A fit that the
    /// user has not asked for is no such step, and does not replace parameters that were edited
    /// meanwhile.
    fn adopt(&mut self, id: ScanId, report: Report, automatic: bool) {
        self.commit();
        let Some(scan) = self.scan_mut(id) else {
            return;
        };
        if !automatic {
            scan.has_unsaved_work = true;
            scan.adopt_fit(report);
            let change = scan.commit(id);
            self.history.push(change.into_iter().collect());
        } else if scan.is_edited() {
            scan.keep_fit(report);
        } else {
            scan.adopt_fit(report);
            scan.committed = scan.parameters;
        }
    }

    /// Takes over the error message of a fit that has failed.
    pub(super) fn take_fit_error(&mut self, id: ScanId, error: String) {
        let run = self.fit_run.as_mut();
        if run.and_then(|run| run.finish(id, Some(&error))).is_none() {
            return;
        }
        if let Some(scan) = self.scan_mut(id) {
            scan.fit_error = Some(error.clone());
        }
        self.report_error(error);
    }

    /// Takes over that the worker has ended all fits of a run.
    pub(super) fn end_run(&mut self, number: u64) {
        if self.fit_run.as_ref().is_none_or(|run| run.number != number) {
            return;
        }
        // A run is empty if all of its samples were closed.
        self.fit_run = self.fit_run.take().filter(|run| run.fit_count() > 0);
        if let Some(run) = &mut self.fit_run {
            let (fitted, count) = (run.fitted_count(), run.fit_count());
            let seconds = run.started.elapsed().as_secs_f64();
            if run.ended_count() < count {
                run.progress = Progress::Cancelled;
                self.status = format!("fit cancelled: {fitted} of {count} completed");
            } else {
                run.progress = Progress::Done;
                self.status = format!("{fitted} of {count} fitted in {seconds:.2} s");
            }
        }
        self.continue_automatic_fits();
    }
}
