//! A fit by the profile of E alone, without a start, derivatives or stages.
//!
//! For given other parameters the optimal k2 and kD are known in closed form, so that the minimum of
//! E over them is a function of k1 (and of n and p where they are free). It is evaluated on the grid
//! of the global check. Where only k1 remains, it can be minimised between grid points by Brent's
//! method (Brent, "Algorithms for Minimization without Derivatives", Prentice-Hall 1973, chapter 5).

use argmin::core::{CostFunction, Error, Executor, State as _};
use argmin::solver::brent::BrentOpt;
use brdf_core::ModelParameters;

use super::error::TrialError;
use crate::fit::FitProblem;
use crate::fit::grid_search::{Profile, ProfilePoint, best_weights};
use crate::fit::{FitError, FitOptions};
use crate::model::{Parameter, ReducedModel};
use crate::objective::Objective;
use crate::progress::{NoObserver, Phase, Progress};
use crate::scan::{Measurements, RefractiveIndex};
use crate::solver::SolverError;

/// Tolerance of ln k1 in Brent's method; the relative error of E is about its square.
const WIDTH_TOLERANCE: f64 = 1e-8;

/// Largest number of iterations, far above what Brent's method needs within two steps of the grid.
const MOST_STEPS: u64 = 200;

/// How the minimum of the profile is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Depth {
    /// The lowest grid point.
    Grid,
    /// The minimum next to the lowest grid point.
    Refined,
}

/// The result of a fit by the profile.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    pub(super) parameters: ModelParameters,
    pub(super) ended_by: String,
}

/// Fits by the profile alone, at the refractive index n where that is not free.
///
/// # Errors
///
/// The profile does not support the options, E of the readings is not defined, or there are not more
/// readings of non-zero weight than free parameters.
pub(super) fn fit_by_profile(
    scan: &Measurements,
    options: &FitOptions,
    n: f64,
    depth: Depth,
) -> Result<Found, TrialError> {
    let model = options.reduced_model();
    check(options, model, depth)?;
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(n)),
        ..options.clone()
    };
    let problem = FitProblem::new(scan, &options)?;
    problem.check_count()?;
    let progress = Progress::new(&NoObserver, Phase::GlobalCheck);
    let search = problem.grid_search(&progress).map_err(FitError::from)?;
    let profile = search.whole();
    let widths = profile.along(Parameter::K1);
    let (lowest, then) = match depth {
        Depth::Grid => (profile.lowest(), ""),
        Depth::Refined => (
            refined(problem.objective(), model, &profile, &widths)?,
            ", then refined",
        ),
    };
    Ok(Found {
        parameters: lowest.parameters,
        ended_by: format!("{} widths searched{then}", widths.len()),
    })
}

fn check(options: &FitOptions, model: ReducedModel, depth: Depth) -> Result<(), TrialError> {
    if options.robust.is_some() || options.energy_limit.is_some() {
        return Err(TrialError::ProfileOptions);
    }
    let further = [Parameter::N, Parameter::P];
    let further = further
        .into_iter()
        .find(|&parameter| model.frees(parameter));
    match (depth, further) {
        (Depth::Refined, Some(parameter)) => Err(TrialError::ProfileNotRefined(parameter)),
        _ => Ok(()),
    }
}

/// The minimum next to the lowest of the widths along a profile.
fn refined(
    objective: &Objective,
    model: ReducedModel,
    profile: &Profile<'_>,
    widths: &[ProfilePoint],
) -> Result<ProfilePoint, FitError> {
    let lowest = (0..widths.len()).min_by(|&i, &j| widths[i].error.total_cmp(&widths[j].error));
    let Some(lowest) = lowest else {
        return Ok(profile.lowest());
    };
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
        .map_err(|error| SolverError::from_argmin(&error))?;
    let found = result
        .state
        .get_best_param()
        .map(|&log_k1| line.point(log_k1));
    let found = found.filter(|point| point.error < widths[lowest].error);
    Ok(found.unwrap_or(widths[lowest]))
}

/// The minimum of E over k2 and kD as a function of ln k1.
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

    fn found(options: &FitOptions, depth: Depth) -> Result<Found, TrialError> {
        let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
        fit_by_profile(&scan(truth, 1.5), options, 1.5, depth)
    }

    #[test]
    fn the_true_width_is_found_between_grid_points() {
        let options = FitOptions::default();
        let at = found(&options, Depth::Refined).unwrap().parameters;
        assert!((at.k1 / 0.2 - 1.0).abs() < 1e-6, "{at:?}");
        assert!((at.k2 / 0.3 - 1.0).abs() < 1e-6, "{at:?}");
        let grid = found(&options, Depth::Grid).unwrap().parameters;
        assert!((grid.k1 / 0.2).ln().abs() <= 0.25);
    }

    #[test]
    fn with_a_fixed_width_only_the_weights_are_fitted() {
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
    fn a_model_with_more_than_a_width_cannot_be_refined() {
        let options = FitOptions::default().with_model(Model::ThreeN);
        assert!(found(&options, Depth::Grid).is_ok());
        let error = found(&options, Depth::Refined).unwrap_err();
        assert_eq!(error, TrialError::ProfileNotRefined(Parameter::N));
        assert!(error.to_string().ends_with("n is free"), "{error}");
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
        assert_eq!(
            error.to_string(),
            "1 reading: 3 free parameters need at least 4"
        );
    }

    #[test]
    fn options_that_the_profile_does_not_support_are_an_error() {
        let options = FitOptions {
            energy_limit: Some(1.4),
            ..FitOptions::default()
        };
        let error = found(&options, Depth::Grid).unwrap_err();
        assert_eq!(error, TrialError::ProfileOptions);
        assert!(error.to_string().contains("rho <= 1"), "{error}");
    }
}
