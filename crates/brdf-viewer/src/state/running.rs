//! The fits: started, followed, cancelled, taken over.

use std::sync::Arc;

use brdf_fit::report::Report;

use super::State;
use super::fitting::{FitRun, Progress, Scope, Stages};
use super::sample::{Sample, ScanId};
use super::turning::settled;
use crate::job::{FitJob, Job};

impl State {
    /// The scans within a scope.
    pub(super) fn scans_of(&self, scope: Scope) -> Vec<ScanId> {
        let active = self.active_sample().map(Sample::scan_id);
        let is_chosen = |id: &ScanId| match scope {
            Scope::Wavelength => Some(*id) == active,
            Scope::Sample => Some(id.sample) == active.map(|active| active.sample),
            Scope::All => true,
        };
        let all = self.samples.iter().flat_map(Sample::scan_ids);
        all.filter(is_chosen).collect()
    }

    /// Those of them that have readings.
    pub(super) fn scans_to_fit(&self, scope: Scope) -> Vec<ScanId> {
        let mut scans = self.scans_of(scope);
        scans.retain(|id| self.scan(*id).is_some_and(|scan| scan.readings() > 0));
        scans
    }

    pub(super) fn fit(&mut self, stages: Stages, scope: Scope) {
        if self.is_fitting() {
            return;
        }
        self.settle();
        let scans = self.scans_to_fit(scope);
        let Some(run) = FitRun::new(&scans) else {
            return;
        };
        let job = |(scan, stop)| {
            let of = self.scan(scan)?;
            Some(FitJob {
                scan,
                measurements: Arc::clone(&of.measurements),
                options: self.choice.options(&of.knobs, stages),
                stop,
            })
        };
        let jobs = run.stops().filter_map(job).collect();
        self.run = Some(run);
        self.start(Job::Fit(jobs, self.choice.depth()));
    }

    pub(super) fn cancel(&mut self) {
        if let Some(run) = self.run.as_mut().filter(|run| run.is_running()) {
            run.cancel();
        }
    }

    /// Takes over a fit that has ended, well or not.
    pub(super) fn fitted(&mut self, scan: ScanId, report: Report) {
        if let Some(error) = &report.error {
            let wavelength = report.wavelength_um;
            let wavelength = wavelength.map_or_else(String::new, |w| format!(", {w} um"));
            let failure = format!("{}{wavelength}: {error}", report.file);
            self.not_fitted(scan, failure);
            return;
        }
        self.settle();
        let Some(steps) = self.run.as_mut().and_then(|run| run.end(scan, None)) else {
            return;
        };
        let Some(of) = self.scan_mut(scan) else {
            return;
        };
        of.take(report);
        of.steps = steps;
        let change = settled(scan, of);
        self.history.push(change.into_iter().collect());
    }

    /// Takes over that a fit has failed.
    pub(super) fn not_fitted(&mut self, scan: ScanId, failure: String) {
        let run = self.run.as_mut();
        if run.and_then(|run| run.end(scan, Some(&failure))).is_none() {
            return;
        }
        if let Some(of) = self.scan_mut(scan) {
            of.failure = Some(failure.clone());
        }
        self.print_error(failure);
    }

    pub(super) fn fits_ended(&mut self) {
        // Where all samples of a run are closed, nothing is left of it.
        self.run = self.run.take().filter(|run| run.jobs() > 0);
        let Some(run) = &mut self.run else {
            return;
        };
        let (done, jobs) = (run.fitted(), run.jobs());
        let seconds = run.started.elapsed().as_secs_f64();
        run.progress = if run.done() < jobs {
            Progress::Cancelled
        } else {
            Progress::Done
        };
        self.status = if run.progress == Progress::Cancelled {
            format!("fit cancelled: {done} of {jobs} were done")
        } else {
            format!("{done} of {jobs} fitted in {seconds:.2} s")
        };
    }
}
