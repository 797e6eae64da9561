//! A run of the worker over one or more fits: its queue, its progress and its errors.

use brdf_fit::{Part, Phase, Step};
use web_time::Instant;

use super::convergence::ConvergencePoint;
use super::id::{SampleId, ScanId};
use crate::cancel::CancelFlag;

/// The progress of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// The worker is fitting.
    Running,
    /// Cancellation was requested.
    Cancelling,
    /// The run was cancelled.
    Cancelled,
    /// All fits have ended.
    Done,
}

/// The fits that the worker is making, or made last.
#[derive(Debug, Clone)]
pub struct FitRun {
    /// The number of the run, which tells the end of this run from that of an earlier one.
    pub number: u64,
    /// Whether the run was started by the opening of files and not by the user.
    pub automatic: bool,
    queue: Vec<QueuedFit>,
    /// The error messages of failed fits.
    pub errors: Vec<String>,
    /// The scan that is being fitted, or was fitted last.
    pub scan: ScanId,
    /// The current phase of its fit.
    pub phase: Option<Phase>,
    /// The part of the phase that was begun last, where parts are counted.
    pub part: Option<Part>,
    /// The iterations of its stages so far.
    pub points: Vec<ConvergencePoint>,
    /// The progress of the run.
    pub progress: Progress,
    /// When the run was started.
    pub started: Instant,
}

/// A fit of the run.
#[derive(Debug, Clone)]
struct QueuedFit {
    scan: ScanId,
    cancel: CancelFlag,
    ended: bool,
}

impl FitRun {
    /// A run over scans that has just been started; `None` without any scan.
    pub fn new(number: u64, automatic: bool, scans: &[ScanId]) -> Option<Self> {
        let queued = |&scan: &ScanId| QueuedFit {
            scan,
            cancel: CancelFlag::default(),
            ended: false,
        };
        Some(Self {
            number,
            automatic,
            queue: scans.iter().map(queued).collect(),
            errors: Vec::new(),
            scan: *scans.first()?,
            phase: None,
            part: None,
            points: Vec::new(),
            progress: Progress::Running,
            started: Instant::now(),
        })
    }

    /// The scans, each with the flag that cancels its fit.
    pub fn cancel_flags(&self) -> impl Iterator<Item = (ScanId, CancelFlag)> {
        let all = self.queue.iter();
        all.map(|queued| (queued.scan, queued.cancel.clone()))
    }

    /// Whether the run fits a scan, or has fitted it.
    pub fn contains(&self, scan: ScanId) -> bool {
        self.queue.iter().any(|queued| queued.scan == scan)
    }

    /// Whether the fit of a scan has not ended.
    pub fn is_waiting_for(&self, scan: ScanId) -> bool {
        let mut queue = self.queue.iter();
        queue.any(|queued| queued.scan == scan && !queued.ended)
    }

    /// The scans whose fits have not ended.
    pub fn waiting(&self) -> impl Iterator<Item = ScanId> {
        let waiting = self.queue.iter().filter(|queued| !queued.ended);
        waiting.map(|queued| queued.scan)
    }

    /// The number of fits.
    pub fn fit_count(&self) -> usize {
        self.queue.len()
    }

    /// The number of fits that have ended, with or without an error.
    pub fn ended_count(&self) -> usize {
        self.queue.iter().filter(|queued| queued.ended).count()
    }

    /// The number of fits that have succeeded.
    pub fn fitted_count(&self) -> usize {
        self.ended_count() - self.errors.len()
    }

    /// Whether the worker is still fitting.
    pub fn is_running(&self) -> bool {
        matches!(self.progress, Progress::Running | Progress::Cancelling)
    }

    /// Requests cancellation of all fits.
    pub fn cancel(&mut self) {
        self.progress = Progress::Cancelling;
        for queued in &self.queue {
            queued.cancel.cancel();
        }
    }

    /// Cancels and removes the fits of a closed sample. The remaining fits continue.
    pub fn remove_sample(&mut self, sample: SampleId) {
        self.queue.retain(|queued| {
            let is_removed = queued.scan.sample == sample && !queued.ended;
            if is_removed {
                queued.cancel.cancel();
            }
            !is_removed
        });
    }

    /// Records a step of the fit of a scan.
    pub fn record(&mut self, scan: ScanId, step: &Step) {
        if !self.queue.iter().any(|queued| queued.scan == scan) {
            return;
        }
        if scan != self.scan {
            self.scan = scan;
            self.points.clear();
        }
        if self.phase.replace(step.phase) != Some(step.phase) {
            self.part = None;
        }
        self.part = step.part.or(self.part);
        if let Some(e_percent) = step.e_percent {
            self.points.push(ConvergencePoint {
                phase: step.phase,
                iteration: step.iteration,
                e_percent,
            });
        }
    }

    /// Marks the fit of a scan as ended, with its error message if it has failed, and returns its
    /// iterations. `None` if the run does not contain the scan, or its fit has ended before.
    pub fn finish(&mut self, scan: ScanId, error: Option<&str>) -> Option<Vec<ConvergencePoint>> {
        let mut queue = self.queue.iter_mut();
        let queued = queue.find(|queued| queued.scan == scan && !queued.ended)?;
        queued.ended = true;
        self.errors.extend(error.map(str::to_owned));
        Some(if self.scan == scan {
            std::mem::take(&mut self.points)
        } else {
            Vec::new()
        })
    }
}
