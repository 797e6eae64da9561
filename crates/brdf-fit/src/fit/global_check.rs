//! The check of a fit against the global optimum.

use std::time::Instant;

use brdf_core::ModelParameters;

use super::error::FitError;
use super::grid_search::GridSearch;
use super::result::{GlobalCheck, Stage};
use crate::model::{Parameter, ReducedModel};
use crate::objective::{Objective, ROUNDING};
use crate::progress::{Observer, Phase, Progress};
use crate::solver::polish;

/// A minimum counts as lower when E there is lower by more than this fraction: below it, two ways
/// of summing the same minimum differ.
const LOWER: f64 = 1e-9;

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
    let mut parameters = last.parameters;
    for minimum in profile.minima() {
        // A stage that ended in this valley, at or below its grid point, has found its minimum.
        let here = objective.error(&parameters);
        if profile.is_next_to(&minimum, &parameters) && here <= objective.error(&minimum.parameters)
        {
            continue;
        }
        let polished = polish(objective, minimum.parameters, model.free(), &progress)?;
        if objective.error(&polished) < here * (1.0 - LOWER) - ROUNDING {
            parameters = polished;
        }
    }
    let report = GlobalCheck {
        lower_minimum_taken: parameters != last.parameters,
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
