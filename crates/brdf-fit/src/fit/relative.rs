//! The fit with the weights of relative errors, from the model itself.
//!
//! Weights from the readings pull kD down: a reading that errs low gets too large a weight. The first
//! round takes them from the readings, the others from the model of the round before.

use brdf_core::ModelParameters;
use serde::{Deserialize, Serialize};

use super::error::FitError;
use super::grid_search::GridSearch;
use crate::model::ReducedModel;
use crate::objective::Objective;
use crate::progress::Progress;
use crate::solver::polish;

/// The number of rounds, the first of which takes the weights from the readings.
const ROUNDS: usize = 3;

/// The result of a fit of relative errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RelativeFit {
    /// The parameters that minimise E of eq. (5).
    pub least_squares: ModelParameters,
    /// E of eq. (5) there, in percent.
    pub least_squares_e_percent: f64,
}

/// A fit of relative errors: the parameters, the objective with the last weights, and the grid search
/// with the objective of the first round that it searched.
pub(crate) struct Relative {
    pub(crate) at: ModelParameters,
    pub(crate) objective: Objective,
    pub(crate) searched: Objective,
    pub(crate) search: GridSearch,
}

/// Minimises the objective with the weights of relative errors, from the lowest point of its own grid
/// search on.
pub(crate) fn fit_relatively(
    objective: &Objective,
    model: ReducedModel,
    progress: &Progress<'_>,
) -> Result<Relative, FitError> {
    let searched = objective.relative(None)?;
    let search = GridSearch::new(&searched, model, progress)?;
    let lowest = search.whole().lowest().parameters;
    let mut at = polish(&searched, lowest, model.free(), progress)?;
    let mut last = None;
    for _ in 1..ROUNDS {
        // The weights of a large scan are freed before others take their place.
        drop(last.take());
        let weighted = last.insert(objective.relative(Some(&at))?);
        at = polish(weighted, at, model.free(), progress)?;
    }
    Ok(Relative {
        at,
        objective: last.unwrap_or_else(|| searched.clone()),
        searched,
        search,
    })
}

#[cfg(test)]
mod tests {
    use brdf_core::Parameters;

    use crate::fit::FitOptions;
    use crate::fit::fit;
    use crate::objective::weights::{AssumedErrors, Weights};
    use crate::scan::synthetic::scan;
    use crate::scan::{Measurements, RefractiveIndex};

    #[test]
    fn an_exact_scan_has_the_same_fit_and_a_distorted_one_a_smaller_relative_error() {
        let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
        let exact = scan(truth, 1.5);
        let options = |errors| FitOptions {
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            weights: Weights {
                errors,
                ..Weights::default()
            },
            ..FitOptions::default()
        };
        let relative = fit(&exact, &options(AssumedErrors::Relative)).unwrap();
        for (found, expected) in [
            (relative.parameters.k2, truth.k2),
            (relative.parameters.kd, truth.kd),
            (relative.parameters.k1, truth.k1),
        ] {
            assert!(
                (found - expected).abs() < 1e-6 * expected,
                "{found} {expected}"
            );
        }
        let mut readings = exact.readings().to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= 1.0 + 0.2 * (i as f64).sin();
        }
        let distorted = Measurements::new("test", readings).unwrap();
        let constant = fit(&distorted, &options(AssumedErrors::Constant)).unwrap();
        let relative = fit(&distorted, &options(AssumedErrors::Relative)).unwrap();
        let found = relative.relative.unwrap();
        assert_eq!(found.least_squares.parameters(), constant.parameters);
        assert!(relative.e_percent > found.least_squares_e_percent);
        let error = |fit: &crate::Fit| {
            let brdf = brdf_core::AnyBrdf::new(fit.model().family(), &fit.at()).unwrap();
            let squares = distorted.readings().iter().map(|reading| {
                (brdf.value(&reading.geometry().unwrap()) / reading.brdf - 1.0).powi(2)
            });
            squares.sum::<f64>()
        };
        assert!(error(&relative) < error(&constant));
    }
}
