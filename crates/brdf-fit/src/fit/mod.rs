//! The fit in the two stages of Li, Yan and Wu (2002), with a check against the global optimum.
//!
//! [`FitProblem`] validates a scan and builds the objective; [`fit`] solves it. The stages start from
//! the paper's initial values ([`start`]); the check searches the exact profile of E over the width
//! ([`grid_search`]); the weights of relative errors ([`relative`]), a robust loss ([`robust`]) and the
//! energy constraint ([`energy`]) follow where the options ask for them.

pub(crate) mod energy;
mod error;
mod first_stage;
mod global_check;
pub(crate) mod grid_search;
mod options;
mod problem;
pub(crate) mod relative;
mod result;
pub(crate) mod robust;
mod solution;
pub(crate) mod start;

pub use error::FitError;
pub use options::FitOptions;
pub use problem::FitProblem;
pub use result::{FORMAT_VERSION, Fit, GlobalCheck, OwnAndAll, Stage, rms_percent};
pub(crate) use solution::Solution;

use crate::progress::{NoObserver, Observer};
use crate::scan::Measurements;

/// Fits a model to a scan of one wavelength: see [`FitProblem::solve`].
///
/// # Errors
///
/// Those of [`FitProblem::new`] and [`FitProblem::solve`].
pub fn fit(measurements: &Measurements, options: &FitOptions) -> Result<Fit, FitError> {
    fit_observed(measurements, options, &NoObserver)
}

/// [`fit`], which reports each iteration to `observer`. The observer may cancel the fit.
///
/// # Errors
///
/// Those of [`fit`], and [`FitError::Cancelled`].
pub fn fit_observed(
    measurements: &Measurements,
    options: &FitOptions,
    observer: &dyn Observer,
) -> Result<Fit, FitError> {
    FitProblem::new(measurements, options)?.solve(observer)
}

/// [`fit_observed`], with the objects that further inference starts from.
pub(crate) fn fit_scan(
    measurements: &Measurements,
    options: &FitOptions,
    observer: &dyn Observer,
) -> Result<Solution, FitError> {
    FitProblem::new(measurements, options)?.into_solution(observer)
}
