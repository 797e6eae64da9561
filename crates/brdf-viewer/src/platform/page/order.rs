//! What the page and the worker of the browser say to each other, in JSON.

use brdf_fit::report::{Depth, Report};
use brdf_fit::{FitOptions, Measurements, Step};
use serde::{Deserialize, Serialize};

use crate::job::FitJob;

/// A fit that the worker is to make.
#[derive(Deserialize)]
pub(super) struct Order {
    pub(super) measurements: Measurements,
    pub(super) options: FitOptions,
    pub(super) left_out: Vec<usize>,
    pub(super) depth: Depth,
}

/// The same, written from a job.
#[derive(Serialize)]
struct OrderOfJob<'a> {
    measurements: &'a Measurements,
    options: &'a FitOptions,
    left_out: &'a [usize],
    depth: Depth,
}

/// What the worker answers.
#[derive(Serialize, Deserialize)]
pub(super) enum Answer {
    /// It has started, and waits for orders.
    Ready,
    /// The fit made a step.
    Step(Step),
    /// The parameters are known; the analysis follows.
    Found(Box<Report>),
    /// The fit has ended with a report.
    Fitted(Box<Report>),
    /// The fit was ended by an internal error, and the error message.
    Aborted(String),
}

/// The order of a job.
///
/// # Errors
///
/// The readings cannot be written.
pub(super) fn order(job: &FitJob, depth: Depth) -> serde_json::Result<String> {
    serde_json::to_string(&OrderOfJob {
        measurements: &job.measurements,
        options: &job.options,
        left_out: &job.left_out,
        depth,
    })
}
