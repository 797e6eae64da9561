//! Fits of a scan without some of its incidences, for its sensitivity and for cross-validation.

use std::borrow::Cow;

use brdf_core::ModelParameters;
use serde::{Deserialize, Serialize};

use super::estimate::{Estimate, Knowledge};
use super::uncertainty::Uncertainty;
use crate::fit::Solution;
use crate::fit::grid_search::GridSearch;
use crate::format::in_degrees;
use crate::model::{Parameter, ReducedModel};
use crate::objective::Objective;
use crate::progress::{Cancelled, Part, Progress, Task};
use crate::solver::{polish, unless_cancelled};

/// An objective with everything that fits of some of its incidences need.
pub(super) struct Refitter<'a> {
    pub(super) objective: &'a Objective,
    /// The fit of all incidences.
    at: ModelParameters,
    /// The grid search, whose sums for each fold of the incidences give the lowest grid point of
    /// any choice of folds.
    search: Cow<'a, GridSearch>,
    model: ReducedModel,
    progress: &'a Progress<'a>,
}

impl<'a> Refitter<'a> {
    /// Takes the grid search of a fit, or searches where that was left out. Each width of a search
    /// and each iteration of a refit is reported.
    pub(super) fn new(fitted: &'a Solution, progress: &'a Progress<'a>) -> Result<Self, Cancelled> {
        Ok(Self {
            objective: &fitted.objective,
            at: fitted.fit.at(),
            search: fitted.grid_search(progress)?,
            model: fitted.fit.options.reduced_model(),
            progress,
        })
    }

    /// Searches an objective on the coarse grid. Its fit starts from the lowest point of the grid.
    pub(super) fn searching(
        objective: &'a Objective,
        model: ReducedModel,
        progress: &'a Progress<'a>,
    ) -> Result<Self, Cancelled> {
        let search = GridSearch::coarse(objective, model, progress)?;
        let lowest = search.whole().lowest().parameters;
        let polished = unless_cancelled(polish(objective, lowest, model.free(), progress))?;
        Ok(Self {
            objective,
            at: polished.unwrap_or(lowest),
            search: Cow::Owned(search),
            model,
            progress,
        })
    }

    /// The fits without each fold of the incidences; `None` where the other incidences do not suffice.
    pub(super) fn without_each_fold(&self) -> Result<Vec<Option<ModelParameters>>, Cancelled> {
        (0..self.objective.folds())
            .map(|fold| self.without(fold))
            .collect()
    }

    /// The [fits without each fold](Self::without_each_fold), each of which is reported as a part of the
    /// cross-validation.
    pub(super) fn cross_validating(&self) -> Result<Vec<Option<ModelParameters>>, Cancelled> {
        let count = self.objective.folds();
        let fit = |fold| {
            self.progress.begin_part(Part {
                task: Task::CrossValidation,
                number: fold + 1,
                count,
            })?;
            self.without(fold)
        };
        (0..count).map(fit).collect()
    }

    /// The parameters of a fit of all incidences except those of one fold; `None` where the others do
    /// not suffice.
    ///
    /// The minimiser starts from the lowest grid point of those incidences and from the fit of all
    /// incidences; the lower of the two minima is taken.
    pub(super) fn without(&self, left_out: usize) -> Result<Option<ModelParameters>, Cancelled> {
        self.progress.advance()?;
        let folds = self.objective.folds();
        let others = self.objective.subset(|i| i % folds != left_out).ok();
        let free = self.model.free();
        let Some(others) = others.filter(|others| others.suffices_for(free)) else {
            return Ok(None);
        };
        let times = |fold| if fold == left_out { 0.0 } else { 1.0 };
        let lowest = self.search.profile(times).lowest().parameters;
        let mut minima = Vec::with_capacity(2);
        for start in [lowest, self.at] {
            minima.extend(unless_cancelled(polish(
                &others,
                start,
                free,
                self.progress,
            ))?);
        }
        let by_error =
            |a: &ModelParameters, b: &ModelParameters| others.error(a).total_cmp(&others.error(b));
        Ok(minima.into_iter().min_by(by_error))
    }
}

/// The parameters of a fit without one incidence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Without {
    /// The incidence angle that is left out, in degrees.
    pub psi_deg: f64,
    /// The parameters.
    pub parameters: ModelParameters,
}

/// The fits without each incidence, where the others suffice; empty where incidences are left out
/// several at a time.
pub(super) fn sensitivity(objective: &Objective, fits: &[Option<ModelParameters>]) -> Vec<Without> {
    if fits.len() < objective.segments().len() {
        return Vec::new();
    }
    let segments = objective.segments().iter().zip(fits);
    segments
        .filter_map(|(segment, fit)| {
            Some(Without {
                psi_deg: in_degrees(segment.psi),
                parameters: (*fit)?,
            })
        })
        .collect()
}

/// A parameter that leaves its interval of 95 % where one incidence is left out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reliance {
    /// The parameter.
    pub parameter: Parameter,
    /// The incidence angle that it rests on, in degrees: of several, the one that moves it furthest.
    pub psi_deg: f64,
    /// The value of the parameter without that incidence.
    pub without: f64,
}

/// The parameters that rest on one incidence.
pub fn rests_on(uncertainty: &Uncertainty, sensitivity: &[Without]) -> Vec<Reliance> {
    let of_estimate = |estimate: &Estimate| {
        let Knowledge::Determined { interval_95, .. } = estimate.knowledge else {
            return None;
        };
        let parameter = estimate.parameter;
        let moved = |without: &Without| (parameter.of(&without.parameters) - estimate.value).abs();
        let outside = sensitivity
            .iter()
            .filter(|without| !interval_95.contains(parameter.of(&without.parameters)));
        let furthest = outside.max_by(|a, b| moved(a).total_cmp(&moved(b)))?;
        Some(Reliance {
            parameter,
            psi_deg: furthest.psi_deg,
            without: parameter.of(&furthest.parameters),
        })
    };
    uncertainty
        .estimates
        .iter()
        .filter_map(of_estimate)
        .collect()
}

/// The incidence whose removal moves a parameter by most standard errors.
pub fn most_influential<'a>(
    uncertainty: &Uncertainty,
    sensitivity: &'a [Without],
) -> Option<&'a Without> {
    let furthest = |without: &Without| {
        let moves = uncertainty.estimates.iter().filter_map(|estimate| {
            let moved = estimate.parameter.of(&without.parameters) - estimate.value;
            Some(moved.abs() / estimate.standard_error()?)
        });
        moves.fold(0.0, f64::max)
    };
    let largest = |a: &&Without, b: &&Without| furthest(a).total_cmp(&furthest(b));
    sensitivity.iter().max_by(largest)
}
