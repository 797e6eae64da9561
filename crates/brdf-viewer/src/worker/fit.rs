//! Fits scans one after the other.

use std::borrow::Cow;
use std::ops::ControlFlow;

use brdf_fit::read::ReadError;
use brdf_fit::report::{Depth, ModelChoice, Report};
use brdf_fit::{FitOptions, Measurements, Observer, Step};

use super::panics::catch_panics;
use crate::cancel::CancelFlag;
use crate::events::EventSender;
use crate::job::{Event, FitJob, FitJobs};
use crate::state::id::ScanId;

/// Sends the steps of a fit as events, and cancels the fit.
struct FitObserver<'a> {
    scan: ScanId,
    cancel: [&'a CancelFlag; 2],
    events: &'a EventSender,
}

impl FitObserver<'_> {
    fn is_cancelled(&self) -> bool {
        self.cancel.iter().any(|flag| flag.is_cancelled())
    }
}

impl Observer for FitObserver<'_> {
    fn step(&self, step: &Step) -> ControlFlow<()> {
        self.events.send(Event::Step(self.scan, *step));
        if self.is_cancelled() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

/// Carries out fits, unless they are cancelled, and sends their results as events. `closing` cancels
/// all of them.
pub fn fit_all(jobs: FitJobs, closing: &CancelFlag, events: &EventSender) {
    for job in jobs.fits {
        let observer = FitObserver {
            scan: job.scan,
            cancel: [&job.cancel, closing],
            events,
        };
        if observer.is_cancelled() {
            continue;
        }
        let result = catch_panics(|| fit(&job, jobs.depth, &observer));
        if observer.is_cancelled() {
            continue;
        }
        let source = &job.measurements.source;
        events.send(match result {
            Ok(Ok(report)) => Event::Fitted(job.scan, Box::new(report)),
            Ok(Err(error)) => Event::FitAborted(job.scan, error.to_string()),
            Err(error) => Event::FitAborted(job.scan, format!("{source}: {error}")),
        });
    }
    events.send(Event::FitsEnded(jobs.run));
}

/// Fits a scan. Its parameters are sent before the analysis, which takes much longer than the fit.
///
/// # Errors
///
/// A table can no longer be read.
fn fit(job: &FitJob, depth: Depth, observer: &FitObserver) -> Result<Report, ReadError> {
    let measurements = match &job.table {
        Some(table) => table.measurements()?,
        None => Cow::Borrowed(&*job.measurements),
    };
    let send_found = |found: Report| {
        if !observer.is_cancelled() {
            let found = Box::new(found);
            observer.events.send(Event::Found(job.scan, found));
        }
    };
    let (options, left_out) = (&job.options, &job.left_out);
    Ok(report(
        &measurements,
        options,
        left_out,
        depth,
        observer,
        &send_found,
    ))
}

/// The report on a fit of readings. `send_found` takes the fit before its analysis, where there is one.
/// `left_out` are the indices of the readings of the scan that are not among these.
pub fn report(
    measurements: &Measurements,
    options: &FitOptions,
    left_out: &[usize],
    depth: Depth,
    observer: &dyn Observer,
    send_found: &dyn Fn(Report),
) -> Report {
    let of_scan = |report: Report| Report {
        left_out: left_out.to_vec(),
        ..report
    };
    let found = |found: &Report| {
        if depth > Depth::Fit {
            send_found(of_scan(found.clone()));
        }
    };
    let choice = ModelChoice::Given;
    let (report, _) =
        Report::observed_in_parts(measurements, options, choice, depth, observer, &found);
    of_scan(report)
}
