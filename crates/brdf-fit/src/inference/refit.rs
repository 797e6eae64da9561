//! Fits of some of the incidences of a scan, for cross-validation and for the bootstrap.

use brdf_core::ModelParameters;

use crate::fit::Solution;
use crate::fit::grid_search::GridSearch;
use crate::model::{Parameter, ReducedModel};
use crate::objective::Objective;
use crate::progress::{Cancelled, Progress};
use crate::solver::{polish, unless_cancelled};

/// A fit with everything that fits of some of its incidences need.
pub(super) struct Refitter<'a> {
    pub(super) objective: &'a Objective,
    pub(super) at: ModelParameters,
    /// The grid search, whose sums for each fold of the incidences give the lowest grid point of
    /// any choice of folds.
    search: GridSearch,
    model: ReducedModel,
    progress: &'a Progress<'a>,
}

impl<'a> Refitter<'a> {
    /// Takes the grid search of the global check, or searches where that was left out. Each width
    /// of a search and each iteration of a refit is reported.
    pub(super) fn new(fitted: &'a Solution, progress: &'a Progress<'a>) -> Result<Self, Cancelled> {
        let (objective, model) = (&fitted.objective, fitted.fit.options.reduced_model());
        let search = fitted.grid_search(progress)?;
        Ok(Self {
            objective,
            at: fitted.fit.at(),
            search,
            model,
            progress,
        })
    }

    /// The parameters that are fitted, in their order.
    pub(super) fn free(&self) -> &[Parameter] {
        self.model.free()
    }

    /// Reports one more step.
    pub(super) fn advance(&self) -> Result<(), Cancelled> {
        self.progress.advance()
    }

    /// The parameters at the lowest point of the grid, each fold of the incidences taken `times`.
    pub(super) fn lowest(&self, times: impl Fn(usize) -> f64) -> ModelParameters {
        self.search.profile(times).lowest().parameters
    }

    /// The minimum of an objective next to a point; `None` where the minimiser fails.
    pub(super) fn minimum(
        &self,
        objective: &Objective,
        from: ModelParameters,
    ) -> Result<Option<ModelParameters>, Cancelled> {
        unless_cancelled(polish(objective, from, self.free(), self.progress))
    }
}
