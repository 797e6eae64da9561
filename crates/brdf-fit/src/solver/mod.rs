//! The two minimisers, as argmin solvers that keep the parameters within their bounds.

pub(crate) mod descent;
mod error;
pub(crate) mod levenberg_marquardt;
pub(crate) mod nelder_mead;
pub(crate) mod observed;
mod valleys;

pub use error::SolverError;
pub(crate) use error::unless_cancelled;

use std::fmt;
use std::str::FromStr;

use argmin::core::{CostFunction, Error, Executor, Solver, State as _};
use brdf_core::ModelParameters;
use nalgebra::SVector;
use serde::{Deserialize, Serialize};

use crate::format::ParseError;
use crate::model::Parameter;
use crate::objective::{NormalEquations, Objective};
use crate::progress::Progress;
use levenberg_marquardt::{LeastSquares, LevenbergMarquardt};
use nelder_mead::{NelderMead, Unbounded};
use observed::{Observed, State};

/// The minimiser of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The Nelder-Mead simplex, which uses values of E only.
    NelderMead,
    /// The Levenberg-Marquardt method: damped Gauss-Newton steps from E and its derivatives.
    LevenbergMarquardt,
}

impl Method {
    /// `NM` or `LM`, as in the tables.
    pub fn short_name(self) -> &'static str {
        match self {
            Self::NelderMead => "NM",
            Self::LevenbergMarquardt => "LM",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Self::NelderMead => "nelder-mead",
            Self::LevenbergMarquardt => "levenberg-marquardt",
        })
    }
}

impl FromStr for Method {
    type Err = ParseError;

    fn from_str(text: &str) -> Result<Self, ParseError> {
        match text {
            "nelder-mead" | "nm" => Ok(Self::NelderMead),
            "levenberg-marquardt" | "lm" => Ok(Self::LevenbergMarquardt),
            _ => Err(ParseError::new(format!(
                "\"{text}\": expected nelder-mead (nm) or levenberg-marquardt (lm)"
            ))),
        }
    }
}

/// The reason of the termination of a minimiser.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Termination {
    /// The projected gradient of E is zero within rounding.
    GradientZero,
    /// The step is below the resolution of the parameters.
    StepTooSmall,
    /// E does not decrease by more than its rounding.
    NoFurtherReduction,
    /// A new simplex finds no lower E.
    SimplexConverged,
    /// The iteration limit is reached; the result need not be a minimum.
    IterationLimit,
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Self::GradientZero => "gradient zero",
            Self::StepTooSmall => "step too small",
            Self::NoFurtherReduction => "no further reduction",
            Self::SimplexConverged => "simplex converged",
            Self::IterationLimit => "iteration limit",
        })
    }
}

/// The result of a minimisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Minimum {
    /// The parameters at the minimum.
    pub parameters: ModelParameters,
    /// E at the minimum, as a fraction.
    pub error: f64,
    /// The number of iterations.
    pub iterations: u64,
    /// The number of evaluations of E, with or without derivatives.
    pub evaluations: u64,
    /// The reason of the termination.
    pub termination: Termination,
}

/// Minimises E over the free parameters from a starting point, each within its
/// [range](Parameter::range); the other parameters keep their values. Each iteration is reported to
/// the observer of `progress`, the start as iteration 0.
///
/// # Errors
///
/// The minimiser fails, or the observer cancels.
pub(crate) fn minimise(
    objective: &Objective,
    method: Method,
    start: ModelParameters,
    free: &[Parameter],
    max_iterations: u64,
    progress: &Progress<'_>,
) -> Result<Minimum, SolverError> {
    let run = Run {
        method,
        max_iterations,
        progress,
    };
    // From here on, the compiler knows the number of free parameters.
    let found = match *free {
        [] => evaluated(objective, start, progress)?,
        [a] => Problem::new(objective, start, [a]).minimise(&run)?,
        [a, b] => Problem::new(objective, start, [a, b]).minimise(&run)?,
        [a, b, c] => Problem::new(objective, start, [a, b, c]).minimise(&run)?,
        [a, b, c, d] => Problem::new(objective, start, [a, b, c, d]).minimise(&run)?,
        [a, b, c, d, e, ..] => Problem::new(objective, start, [a, b, c, d, e]).minimise(&run)?,
    };
    let parameters = onto_bounds(objective, free, found.parameters);
    Ok(Minimum {
        parameters,
        error: objective.error(&parameters),
        ..found
    })
}

/// Far more iterations than Levenberg-Marquardt takes from a point near a minimum.
const POLISH_ITERATIONS: u64 = 1000;

/// The minimum next to a point by Levenberg-Marquardt.
///
/// # Errors
///
/// Those of [`minimise`].
pub(crate) fn polish(
    objective: &Objective,
    from: ModelParameters,
    free: &[Parameter],
    progress: &Progress<'_>,
) -> Result<ModelParameters, SolverError> {
    let method = Method::LevenbergMarquardt;
    minimise(objective, method, from, free, POLISH_ITERATIONS, progress)
        .map(|minimum| minimum.parameters)
}

/// The result if no parameter is free.
fn evaluated(
    objective: &Objective,
    at: ModelParameters,
    progress: &Progress<'_>,
) -> Result<Minimum, SolverError> {
    let error = objective.error(&at);
    progress.advance_to(error, &at)?;
    Ok(Minimum {
        parameters: at,
        error,
        iterations: 0,
        evaluations: 1,
        termination: Termination::GradientZero,
    })
}

/// The settings of a minimisation.
struct Run<'a> {
    method: Method,
    max_iterations: u64,
    progress: &'a Progress<'a>,
}

/// E as a function of the free parameters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Problem<'a, const P: usize> {
    objective: &'a Objective,
    start: ModelParameters,
    free: [Parameter; P],
}

impl<'a, const P: usize> Problem<'a, P> {
    /// E over the free parameters; the other parameters are those of the start.
    pub(crate) fn new(
        objective: &'a Objective,
        start: ModelParameters,
        free: [Parameter; P],
    ) -> Self {
        Self {
            objective,
            start,
            free,
        }
    }

    fn vector(&self, of: impl Fn(Parameter) -> f64) -> SVector<f64, P> {
        SVector::from(self.free.map(of))
    }

    fn parameters(&self, vector: &SVector<f64, P>) -> ModelParameters {
        let mut at = self.start;
        for (parameter, value) in self.free.iter().zip(vector.iter()) {
            parameter.set(&mut at, *value);
        }
        at
    }

    fn minimise(self, run: &Run<'_>) -> Result<Minimum, SolverError> {
        match run.method {
            Method::NelderMead => self.by_nelder_mead(run),
            Method::LevenbergMarquardt => self.by_levenberg_marquardt(run),
        }
    }

    fn by_levenberg_marquardt(self, run: &Run<'_>) -> Result<Minimum, SolverError> {
        let start = self.vector(|parameter| parameter.of(&self.start));
        let solver = LevenbergMarquardt::new(
            self.vector(|parameter| parameter.range().0),
            self.vector(|parameter| parameter.range().1),
        );
        let (mut found, solver) = run.execute(self, solver, start, |x| self.parameters(x))?;
        found.termination = solver.termination().unwrap_or(found.termination);
        Ok(found)
    }

    fn by_nelder_mead(self, run: &Run<'_>) -> Result<Minimum, SolverError> {
        let problem = Unbounded::new(self);
        let start = problem.coordinates_of(&self.start);
        let solver = NelderMead::new(start, problem.steps());
        let parameters = |x: &_| problem.parameters_at(x);
        let (mut found, solver) = run.execute(problem, solver, start, parameters)?;
        found.termination = solver.termination().unwrap_or(found.termination);
        Ok(found)
    }
}

impl Run<'_> {
    /// Runs a solver over coordinates, which `parameters` converts to parameters.
    fn execute<const P: usize, O, S: Solver<O, State<SVector<f64, P>>>>(
        &self,
        problem: O,
        solver: S,
        start: SVector<f64, P>,
        parameters: impl Fn(&SVector<f64, P>) -> ModelParameters,
    ) -> Result<(Minimum, S), SolverError> {
        let notify = |x: &_, error| self.progress.advance_to(error, &parameters(x));
        let observed = Observed { solver, notify };
        let result = Executor::new(problem, observed)
            .configure(|state| state.param(start).max_iters(self.max_iterations))
            .ctrlc(false)
            .run()
            .map_err(|error| SolverError::from_argmin(&error))?;
        let state = result.state;
        let found = Minimum {
            parameters: parameters(state.get_best_param().unwrap_or(&start)),
            error: state.get_best_cost(),
            iterations: state.get_iter(),
            evaluations: result.problem.counts.values().sum(),
            termination: Termination::IterationLimit,
        };
        Ok((found, result.solver.solver))
    }
}

/// Moves a weight exactly onto its bound if this does not increase E.
///
/// A minimiser approaches a bound only as closely as E resolves: to 1e-13 of E, or to 1e-10 of the
/// readings if E is only rounding.
fn onto_bounds(
    objective: &Objective,
    free: &[Parameter],
    best: ModelParameters,
) -> ModelParameters {
    [Parameter::Kd, Parameter::K2]
        .into_iter()
        .filter(|weight| free.contains(weight))
        .map(|weight| {
            let mut bound = best;
            weight.set(&mut bound, 0.0);
            bound
        })
        .filter(|bound| objective.error(bound) <= objective.error(&best) * (1.0 + 1e-13) + 1e-20)
        .min_by(|a, b| objective.error(a).total_cmp(&objective.error(b)))
        .unwrap_or(best)
}

impl<const P: usize> CostFunction for Problem<'_, P> {
    type Param = SVector<f64, P>;
    type Output = f64;

    fn cost(&self, param: &SVector<f64, P>) -> Result<f64, Error> {
        Ok(self.objective.error(&self.parameters(param)))
    }
}

impl<const P: usize> LeastSquares<P> for Problem<'_, P> {
    fn normal_equations(&self, param: &SVector<f64, P>) -> NormalEquations<P> {
        self.objective
            .normal_equations(&self.parameters(param), &self.free)
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::{Family, Parameters};

    use super::*;
    use crate::model::Model;
    use crate::objective::weights::Weights;
    use crate::progress::{NoObserver, Phase};
    use crate::scan::synthetic::scan;

    const METHODS: [Method; 2] = [Method::NelderMead, Method::LevenbergMarquardt];

    fn objective(truth: Parameters) -> Objective {
        let scan = scan(truth, 1.5);
        Objective::new(&scan, Family::Paper, 1.5, &Weights::default()).unwrap()
    }

    /// The minimum over the paper's three parameters from k2 = kD = k1 = 1.
    fn minimum(objective: &Objective, method: Method, max_iterations: u64) -> Minimum {
        let one = Parameters::new(1.0, 1.0, 1.0).unwrap();
        let start = ModelParameters::three(one, 1.5);
        minimise(
            objective,
            method,
            start,
            Model::Three.free(),
            max_iterations,
            &Progress::new(&NoObserver, Phase::Stage1),
        )
        .unwrap()
    }

    #[test]
    fn both_methods_find_the_parameters_of_a_noise_free_scan() {
        let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
        for method in METHODS {
            let found = minimum(&objective(truth), method, 10_000);
            assert!(
                (found.parameters.k2 / truth.k2 - 1.0).abs() < 1e-6,
                "{method}: {found:?}"
            );
            assert!((found.parameters.kd / truth.kd - 1.0).abs() < 1e-6);
            assert!((found.parameters.k1 / truth.k1 - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn both_methods_end_exactly_on_a_bound() {
        for method in METHODS {
            let specular = objective(Parameters::new(0.3, 0.0, 0.2).unwrap());
            assert_eq!(minimum(&specular, method, 10_000).parameters.kd, 0.0);
            let diffuse = objective(Parameters::new(0.0, 0.3, 0.2).unwrap());
            let found = minimum(&diffuse, method, 10_000);
            assert!(found.parameters.k2 < 1e-9, "{method}: {found:?}");
        }
    }

    #[test]
    fn both_methods_find_the_same_minimum_of_every_model() {
        let mut readings = scan(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5)
            .readings()
            .to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= 1.0 + 0.1 * (2.4 * i as f64).sin();
        }
        let scan = crate::Measurements::new("test", readings).unwrap();
        for model in Model::ALL {
            let objective =
                Objective::new(&scan, model.family(), 1.5, &Weights::default()).unwrap();
            let start = ModelParameters {
                k2: 0.2,
                kd: 0.1,
                k1: 0.3,
                n: 1.6,
                p: 1.2,
            };
            let errors = METHODS.map(|method| {
                let start = model.start(start);
                let progress = Progress::new(&NoObserver, Phase::Stage1);
                minimise(&objective, method, start, model.free(), 10_000, &progress)
                    .unwrap()
                    .error
            });
            assert!(
                (errors[0] / errors[1] - 1.0).abs() < 1e-6,
                "{model}: {errors:?}"
            );
        }
    }

    #[test]
    fn the_iteration_limit_is_reported() {
        let objective = objective(Parameters::new(0.3, 0.1, 0.2).unwrap());
        for method in METHODS {
            let found = minimum(&objective, method, 2);
            assert_eq!(
                (found.iterations, found.termination),
                (2, Termination::IterationLimit)
            );
        }
    }
}
