//! A solved problem, with the objects that further inference starts from.

use std::borrow::Cow;

use super::error::FitError;
use super::grid_search::GridSearch;
use super::result::Fit;
use super::robust::RobustWeights;
use crate::objective::Objective;
use crate::objective::weights::AssumedErrors;
use crate::progress::{Cancelled, Progress};
use crate::scan::Measurements;

/// A solved problem, with the objects that further inference starts from.
#[derive(Debug)]
pub(crate) struct Solution {
    pub(crate) fit: Fit,
    /// The objective that was minimised, with the weights of relative errors and of a robust loss.
    pub(crate) objective: Objective,
    /// The last grid search; `None` where the check was left out.
    pub(super) search: Option<Searched>,
    /// The weights of a robust loss.
    pub(super) robust: Option<RobustWeights>,
}

/// A grid search, and its objective where that is not the one of the solution.
#[derive(Debug)]
pub(super) struct Searched {
    pub(super) search: GridSearch,
    pub(super) objective: Option<Objective>,
}

impl Solution {
    /// The fit alone.
    pub(crate) fn into_fit(self) -> Fit {
        self.fit
    }

    /// The grid search of the fit, or a new one where the check was left out.
    pub(crate) fn grid_search(
        &self,
        progress: &Progress<'_>,
    ) -> Result<Cow<'_, GridSearch>, Cancelled> {
        if let Some(searched) = &self.search {
            return Ok(Cow::Borrowed(&searched.search));
        }
        let model = self.fit.options.reduced_model();
        GridSearch::new(&self.objective, model, progress).map(Cow::Owned)
    }

    /// The objective of [`grid_search`](Self::grid_search).
    pub(crate) fn searched(&self) -> &Objective {
        let searched = self.search.as_ref();
        let own = searched.and_then(|searched| searched.objective.as_ref());
        own.unwrap_or(&self.objective)
    }

    /// The objective without the weights of a robust loss.
    pub(crate) fn without_loss(&self) -> &Objective {
        let robust = self.robust.as_ref();
        robust.map_or(&self.objective, |robust| &robust.objective)
    }

    /// The weights of a robust loss, one for each row.
    pub(crate) fn robust(&self) -> Option<&RobustWeights> {
        self.robust.as_ref()
    }

    /// The same fit with the objective of some of its readings, one row for each.
    pub(crate) fn over(&self, measurements: &Measurements) -> Result<Self, FitError> {
        let fit = self.fit.clone();
        let weights = &fit.options.weights;
        let family = fit.model().family();
        let mut objective = Objective::new(measurements, family, fit.n, weights)?;
        if weights.errors == AssumedErrors::Relative {
            objective = objective.relative(Some(&fit.at()))?;
        }
        Ok(Self {
            fit,
            objective,
            search: None,
            robust: None,
        })
    }
}
