//! A fit by the profile alone: no start, no derivatives, no stages.
//!
//! For given other parameters the best k2 and kD are known in closed form, so that E is a function
//! of k1 (and of n and p where they are free). It is searched over the grid of the global check,
//! and where k1 is all that is left, minimised between two widths of the grid by Brent's method.

use argmin::core::{CostFunction, Error, Executor, State as _};
use argmin::solver::brent::BrentOpt;
use brdf_core::ModelParameters;

use crate::fit::grid_search::{ProfilePoint, Search, best_weights};
use crate::model::{Parameter, ReducedModel};
use crate::objective::Objective;
use crate::progress::{NoObserver, Phase, Progress};
use crate::scan::Measurements;
use crate::{FitError, FitOptions};

/// Brent's method ends when ln k1 is known to about this: E is then known to its square.
const WIDTH_TOLERANCE: f64 = 1e-8;

/// Far more steps than Brent's method takes within two steps of the grid.
const MOST_STEPS: u64 = 200;

/// How far the profile is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Depth {
    /// The lowest point of the grid.
    Grid,
    /// The minimum next to it.
    Refined,
}

/// What the profile came to.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    pub(super) parameters: ModelParameters,
    pub(super) ended_by: String,
}

/// Fits by the profile alone, at the refractive index n where that is not free.
///
/// Errors: options that the profile cannot follow, and readings whose E is not defined.
pub(super) fn fit_by_profile(
    scan: &Measurements,
    options: &FitOptions,
    n: f64,
    depth: Depth,
) -> Result<Found, String> {
    let model = options.reduced_model();
    check(options, model, depth)?;
    let objective = Objective::condensed(scan, model.family(), n, &options.weights)
        .map_err(|error| error.to_string())?;
    if !objective.suffices_for(model.free()) {
        let count = objective.count() - objective.zero_weight();
        let parameters = model.free().len();
        return Err(FitError::TooFewReadings { count, parameters }.to_string());
    }
    let progress = Progress::new(&NoObserver, Phase::GlobalCheck);
    let search = Search::new(&objective, model, &progress).map_err(|error| error.to_string())?;
    let profile = search.whole();
    let widths = profile.along(Parameter::K1);
    let (lowest, how) = match depth {
        Depth::Grid => (profile.lowest(), ""),
        Depth::Refined => (refined(&objective, model, &widths)?, " and between them"),
    };
    Ok(Found {
        parameters: lowest.parameters,
        ended_by: format!("{} widths searched{how}", widths.len()),
    })
}

fn check(options: &FitOptions, model: ReducedModel, depth: Depth) -> Result<(), String> {
    if options.robust.is_some() || options.energy_limit.is_some() {
        return Err("the profile has neither a robust loss nor rho <= 1".to_owned());
    }
    let further = [Parameter::N, Parameter::P];
    let further = further
        .into_iter()
        .find(|&parameter| model.frees(parameter));
    match (depth, further) {
        (Depth::Refined, Some(parameter)) => Err(format!(
            "the profile is refined over k1 alone, and {parameter} is free"
        )),
        _ => Ok(()),
    }
}

/// The minimum next to the lowest of the widths.
fn refined(
    objective: &Objective,
    model: ReducedModel,
    widths: &[ProfilePoint],
) -> Result<ProfilePoint, String> {
    let lowest = (0..widths.len()).min_by(|&i, &j| widths[i].error.total_cmp(&widths[j].error));
    let lowest = lowest.ok_or("the profile has no points")?;
    let log_k1 = |i: usize| widths[i].parameters.k1.ln();
    let from = log_k1(lowest.saturating_sub(1));
    let to = log_k1((lowest + 1).min(widths.len() - 1));
    if from == to {
        return Ok(widths[lowest]);
    }
    let line = Line {
        objective,
        model,
        at: widths[lowest].parameters,
    };
    let solver = BrentOpt::new(from, to).set_tolerance(f64::EPSILON.sqrt(), WIDTH_TOLERANCE);
    let result = Executor::new(line, solver)
        .configure(|state| state.max_iters(MOST_STEPS))
        .ctrlc(false)
        .run()
        .map_err(|error| error.to_string())?;
    let found = result
        .state
        .get_best_param()
        .map(|&log_k1| line.point(log_k1));
    let found = found.filter(|point| point.error < widths[lowest].error);
    Ok(found.unwrap_or(widths[lowest]))
}

/// E of the best weights as a function of ln k1.
#[derive(Clone, Copy)]
struct Line<'a> {
    objective: &'a Objective,
    model: ReducedModel,
    at: ModelParameters,
}

impl Line<'_> {
    fn point(&self, log_k1: f64) -> ProfilePoint {
        let k1 = log_k1.exp();
        best_weights(
            self.objective,
            self.model,
            ModelParameters { k1, ..self.at },
        )
    }
}

impl CostFunction for Line<'_> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, log_k1: &f64) -> Result<f64, Error> {
        Ok(self.point(*log_k1).error)
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::Parameters;

    use super::*;
    use crate::model::{FixedParameters, Model};
    use crate::objective::weights::Weights;
    use crate::scan::synthetic::scan;

    fn found(options: &FitOptions, depth: Depth) -> Result<Found, String> {
        let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
        fit_by_profile(&scan(truth, 1.5), options, 1.5, depth)
    }

    #[test]
    fn the_truth_is_found_between_the_widths() {
        let options = FitOptions::default();
        let at = found(&options, Depth::Refined).unwrap().parameters;
        assert!((at.k1 / 0.2 - 1.0).abs() < 1e-6, "{at:?}");
        assert!((at.k2 / 0.3 - 1.0).abs() < 1e-6, "{at:?}");
        let grid = found(&options, Depth::Grid).unwrap().parameters;
        assert!((grid.k1 / 0.2).ln().abs() <= 0.25);
    }

    #[test]
    fn a_held_width_leaves_the_weights() {
        let options = FitOptions {
            fixed: FixedParameters::none().with(Parameter::K1, 0.2),
            ..FitOptions::default()
        };
        for depth in [Depth::Grid, Depth::Refined] {
            let at = found(&options, depth).unwrap().parameters;
            assert_eq!(at.k1, 0.2);
            assert!((at.kd / 0.1 - 1.0).abs() < 1e-9, "{at:?}");
        }
    }

    #[test]
    fn a_model_with_more_than_a_width_has_the_grid_alone() {
        let options = FitOptions::default().of_model(Model::ThreeN);
        assert!(found(&options, Depth::Grid).is_ok());
        let error = found(&options, Depth::Refined).unwrap_err();
        assert!(error.ends_with("n is free"), "{error}");
    }

    /// A table has fewer rows than readings; the error counts readings.
    #[test]
    fn a_table_with_too_few_weighted_readings_is_an_error_with_their_number() {
        let mut table = scan(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5);
        table.incidence_class = Some(0.1);
        let options = FitOptions {
            weights: Weights {
                mask_source: 149.9_f64.to_radians(),
                ..Weights::default()
            },
            ..FitOptions::default()
        };
        let error = fit_by_profile(&table, &options, 1.5, Depth::Grid).unwrap_err();
        assert_eq!(error, "1 reading: 3 free parameters need at least 4");
    }

    #[test]
    fn what_the_profile_does_not_have_is_said() {
        let options = FitOptions {
            energy_limit: Some(1.4),
            ..FitOptions::default()
        };
        let error = found(&options, Depth::Grid).unwrap_err();
        assert!(error.contains("rho <= 1"), "{error}");
    }
}
