//! The check of a fit against the global optimum.

use web_time::Instant;

use brdf_core::ModelParameters;

use super::error::FitError;
use super::grid_search::GridSearch;
use super::result::{GlobalCheck, Stage};
use crate::model::{Parameter, ReducedModel};
use crate::objective::{Objective, ROUNDING};
use crate::progress::{Observer, Phase, Progress};
use crate::solver::descent::{Descent, Rows};

/// A minimum counts as lower when E there is lower by more than this fraction: below it, two ways
/// of summing the same minimum differ.
const LOWER: f64 = 1e-9;

/// A descent from the result of the last stage that gains no more than this fraction of E ends in the
/// same minimum.
const LITTLE: f64 = 1e-5;

/// The outcome of the check; the parameters are those of the last stage where the check is left out
/// or finds nothing lower.
pub(super) struct Checked {
    pub(super) parameters: ModelParameters,
    pub(super) report: Option<GlobalCheck>,
    pub(super) search: Option<GridSearch>,
}

impl Checked {
    /// The outcome where the check is left out.
    pub(super) fn skipped(last: &Stage) -> Self {
        Self {
            parameters: last.parameters,
            report: None,
            search: None,
        }
    }
}

/// Searches for a minimum below that of the last stage, and takes it where there is one.
pub(super) fn check_globally(
    objective: &Objective,
    last: &Stage,
    model: ReducedModel,
    observer: &dyn Observer,
) -> Result<Checked, FitError> {
    let started = Instant::now();
    let progress = Progress::begin(observer, Phase::GlobalCheck)?;
    let search = GridSearch::new(objective, model, &progress)?;
    let profile = search.whole();
    let descent = Descent { objective, model };
    let (y, _) = objective.fixed_columns();
    let lowest_from = |start| descent.from(start, Rows { y, factors: None }).0;
    let is_lower = |error: f64, here: f64| error < here * (1.0 - LOWER) - ROUNDING;
    // In a flat valley, a minimiser of E ends where a step gains less than rounding. The little that a
    // descent gains there is no other minimum.
    let deepest = lowest_from(last.parameters);
    let [first, own] = [last.parameters, deepest].map(|at| objective.error(&at));
    let (mut parameters, mut here) = if is_lower(own, first) {
        (deepest, own)
    } else {
        (last.parameters, first)
    };
    let own_valley = if own >= first * (1.0 - LITTLE) {
        parameters
    } else {
        last.parameters
    };
    let several_axes = model.frees(Parameter::N) || model.frees(Parameter::P);
    for start in profile.starts() {
        progress.advance()?;
        // A stage that ended in this valley, at or below its grid point, has found its minimum. The steps
        // of n and p are too long for this conclusion.
        if !several_axes
            && profile.is_next_to(&start, &parameters)
            && here <= objective.error(&start.parameters)
        {
            continue;
        }
        let lowest = lowest_from(start.parameters);
        let error = objective.error(&lowest);
        if is_lower(error, here) {
            (parameters, here) = (lowest, error);
        }
    }
    let report = GlobalCheck {
        lower_minimum_taken: parameters != own_valley,
        stage2_e_percent: last.e_percent.own,
        profile: profile.along(Parameter::K1),
        profile_n: if model.frees(Parameter::N) {
            profile.along(Parameter::N)
        } else {
            Vec::new()
        },
        seconds: started.elapsed().as_secs_f64(),
    };
    Ok(Checked {
        parameters,
        report: Some(report),
        search: Some(search),
    })
}
