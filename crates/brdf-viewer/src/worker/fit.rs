//! Fits scans one after the other.

use std::ops::ControlFlow;

use brdf_fit::report::{Depth, ModelChoice, Report};
use brdf_fit::{Observer, Step};

use super::events::EventSender;
use super::panics::catch_panics;
use crate::cancel::CancelFlag;
use crate::job::{Event, FitJob};
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
pub(super) fn fit_all(jobs: Vec<FitJob>, depth: Depth, closing: &CancelFlag, events: &EventSender) {
    for job in jobs {
        let observer = FitObserver {
            scan: job.scan,
            cancel: [&job.cancel, closing],
            events,
        };
        if observer.is_cancelled() {
            continue;
        }
        let result = catch_panics(|| {
            let choice = ModelChoice::Given;
            Report::observed(&job.measurements, &job.options, choice, depth, &observer).0
        });
        if observer.is_cancelled() {
            continue;
        }
        events.send(match result {
            Ok(report) => Event::Fitted(job.scan, Box::new(report)),
            Err(error) => {
                let source = &job.measurements.source;
                Event::FitAborted(job.scan, format!("{source}: {error}"))
            }
        });
    }
    events.send(Event::FitsEnded);
}
