//! Starting and cancelling fits, and taking over their results.

use std::sync::Arc;

use brdf_fit::report::Report;

use super::State;
use super::fit_run::{FitRun, Progress};
use super::fit_settings::{Scope, Stages};
use super::id::ScanId;
use crate::job::{FitJob, Job};

impl State {
    /// The scans within a scope that have readings.
    pub(super) fn scans_to_fit(&self, scope: Scope) -> Vec<ScanId> {
        let mut scans = self.scans_in(scope);
        scans.retain(|id| self.scan(*id).is_some_and(|scan| scan.reading_count() > 0));
        scans
    }

    pub(super) fn fit(&mut self, stages: Stages, scope: Scope) {
        if self.is_fitting() {
            return;
        }
        self.commit();
        let Some(run) = FitRun::new(&self.scans_to_fit(scope)) else {
            return;
        };
        let job = |(id, cancel)| {
            let scan = self.scan(id)?;
            Some(FitJob {
                scan: id,
                measurements: Arc::clone(&scan.measurements),
                options: self.fit_settings.options(&scan.parameters, stages),
                cancel,
            })
        };
        let jobs = run.cancel_flags().filter_map(job).collect();
        self.fit_run = Some(run);
        self.start(Job::Fit(jobs, self.fit_settings.depth()));
    }

    pub(super) fn cancel(&mut self) {
        if let Some(run) = self.fit_run.as_mut().filter(|run| run.is_running()) {
            run.cancel();
        }
    }

    /// Takes over the report of a fit, which contains the fit or its error.
    pub(super) fn take_report(&mut self, id: ScanId, report: Report) {
        if let Some(error) = &report.error {
            let wavelength = report.wavelength_um;
            let wavelength = wavelength.map_or_else(String::new, |w| format!(", {w} um"));
            let error = format!("{}{wavelength}: {error}", report.file);
            self.take_fit_error(id, error);
            return;
        }
        self.commit();
        let Some(convergence) = self.fit_run.as_mut().and_then(|run| run.finish(id, None)) else {
            return;
        };
        let Some(scan) = self.scan_mut(id) else {
            return;
        };
        scan.adopt_fit(report);
        scan.convergence = convergence;
        let change = scan.commit(id);
        self.history.push(change.into_iter().collect());
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

    /// Takes over that the worker has ended all fits.
    pub(super) fn end_run(&mut self) {
        // A run is empty if all of its samples were closed.
        self.fit_run = self.fit_run.take().filter(|run| run.fit_count() > 0);
        let Some(run) = &mut self.fit_run else {
            return;
        };
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
}
