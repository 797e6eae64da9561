//! The two minimisers of a stage, as argmin solvers that keep the parameters within their bounds.

pub mod levenberg_marquardt;
pub mod nelder_mead;

use std::fmt;
use std::str::FromStr;

use argmin::core::{CostFunction, Error, Executor, State};
use brdf_core::Parameters;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::criterion::{Criterion, NormalEquations};
use levenberg_marquardt::{LeastSquares, LevenbergMarquardt};
use nelder_mead::{NelderMead, Unbounded};

/// The range of k1 in a fit. Far below the resolution of any goniometer at one end; at the other
/// the facet distribution no longer changes (its limit is sec alpha).
pub const K1_RANGE: (f64, f64) = (1e-6, 1e3);

/// How a stage minimises E.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Nelder and Mead's simplex: values of E only.
    NelderMead,
    /// Levenberg and Marquardt's damped Gauss-Newton steps: E and its derivatives.
    LevenbergMarquardt,
}

impl Method {
    /// NM or LM, as the tables have it.
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
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "nelder-mead" | "nm" => Ok(Self::NelderMead),
            "levenberg-marquardt" | "lm" => Ok(Self::LevenbergMarquardt),
            _ => Err(format!(
                "\"{text}\": expected nelder-mead (nm) or levenberg-marquardt (lm)"
            )),
        }
    }
}

/// Why a minimiser stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// The gradient of E, but for what a bound stops, is zero to rounding.
    GradientZero,
    /// The step became smaller than the parameters can show.
    StepTooSmall,
    /// E does not become smaller within its rounding.
    NoFurtherReduction,
    /// A fresh simplex found nothing lower.
    SimplexConverged,
    /// The number of iterations is used up: the result need not be a minimum.
    IterationLimit,
}

impl fmt::Display for Ending {
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

/// What a minimiser did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Minimum {
    /// Where it ended.
    pub parameters: Parameters,
    /// E there.
    pub error: f64,
    /// Its iterations.
    pub iterations: u64,
    /// How often E was evaluated, alone or with its derivatives.
    pub evaluations: u64,
    /// Why it stopped.
    pub ending: Ending,
}

/// Minimises E from a starting point, within k2 >= 0, kD >= 0 and [`K1_RANGE`].
pub fn minimise(
    criterion: &Criterion,
    method: Method,
    start: Parameters,
    max_iterations: u64,
) -> Result<Minimum, Error> {
    let found = match method {
        Method::NelderMead => by_nelder_mead(criterion, start, max_iterations)?,
        Method::LevenbergMarquardt => by_levenberg_marquardt(criterion, start, max_iterations)?,
    };
    let parameters = onto_bounds(criterion, found.parameters);
    Ok(Minimum {
        parameters,
        error: criterion.error(&parameters),
        ..found
    })
}

fn by_levenberg_marquardt(
    criterion: &Criterion,
    start: Parameters,
    max_iterations: u64,
) -> Result<Minimum, Error> {
    let solver = LevenbergMarquardt::new(
        Vector3::new(0.0, 0.0, K1_RANGE.0),
        Vector3::new(f64::INFINITY, f64::INFINITY, K1_RANGE.1),
    );
    let result = Executor::new(criterion, solver)
        .configure(|state| state.param(to_vector(start)).max_iters(max_iterations))
        .ctrlc(false)
        .run()?;
    let state = result.state;
    Ok(Minimum {
        parameters: to_parameters(state.get_best_param().unwrap_or(&to_vector(start))),
        error: state.get_best_cost(),
        iterations: state.get_iter(),
        evaluations: result.problem.counts.values().sum(),
        ending: result.solver.ending().unwrap_or(Ending::IterationLimit),
    })
}

fn by_nelder_mead(
    criterion: &Criterion,
    start: Parameters,
    max_iterations: u64,
) -> Result<Minimum, Error> {
    let problem = Unbounded::new(criterion, K1_RANGE);
    let start = problem.to_coordinates(start);
    // A weight that starts at zero must be able to leave it: a step as for a Lambertian surface.
    let weight_step = 0.5 * criterion.lambertian_weight().abs().sqrt().max(1e-6);
    let solver = NelderMead::new(start, Vector3::new(weight_step, weight_step, 1.0));
    let result = Executor::new(problem, solver)
        .configure(|state| state.max_iters(max_iterations))
        .ctrlc(false)
        .run()?;
    let state = result.state;
    Ok(Minimum {
        parameters: problem.to_parameters(state.get_best_param().unwrap_or(&start)),
        error: state.get_best_cost(),
        iterations: state.get_iter(),
        evaluations: result.problem.counts.values().sum(),
        ending: result.solver.ending().unwrap_or(Ending::IterationLimit),
    })
}

/// Puts a weight exactly on its bound where E does not become larger by that.
///
/// A minimiser comes as near to a bound as E can tell, and no nearer: to 1e-13 of E, or where E is
/// nothing but rounding to 1e-10 of the readings.
fn onto_bounds(criterion: &Criterion, best: Parameters) -> Parameters {
    [
        Parameters { kd: 0.0, ..best },
        Parameters { k2: 0.0, ..best },
    ]
    .into_iter()
    .filter(|bound| criterion.error(bound) <= criterion.error(&best) * (1.0 + 1e-13) + 1e-20)
    .min_by(|a, b| criterion.error(a).total_cmp(&criterion.error(b)))
    .unwrap_or(best)
}

fn to_vector(parameters: Parameters) -> Vector3<f64> {
    Vector3::new(parameters.k2, parameters.kd, parameters.k1)
}

fn to_parameters(vector: &Vector3<f64>) -> Parameters {
    Parameters {
        k2: vector[0],
        kd: vector[1],
        k1: vector[2],
    }
}

impl CostFunction for &Criterion {
    type Param = Vector3<f64>;
    type Output = f64;

    fn cost(&self, param: &Vector3<f64>) -> Result<f64, Error> {
        Ok(self.error(&to_parameters(param)))
    }
}

impl LeastSquares<3> for &Criterion {
    fn normal_equations(&self, param: &Vector3<f64>) -> NormalEquations<3> {
        Criterion::normal_equations(self, &to_parameters(param))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::scan;
    use crate::weights::Weights;

    const METHODS: [Method; 2] = [Method::NelderMead, Method::LevenbergMarquardt];

    fn criterion(truth: Parameters) -> Criterion {
        Criterion::new(scan(truth, 1.5).readings(), 1.5, &Weights::default()).unwrap()
    }

    #[test]
    fn both_methods_find_the_parameters_of_a_noise_free_scan() {
        let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
        let start = Parameters::new(1.0, 1.0, 1.0).unwrap();
        for method in METHODS {
            let found = minimise(&criterion(truth), method, start, 10_000).unwrap();
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
        let start = Parameters::new(1.0, 1.0, 1.0).unwrap();
        for method in METHODS {
            let specular = criterion(Parameters::new(0.3, 0.0, 0.2).unwrap());
            assert_eq!(
                minimise(&specular, method, start, 10_000)
                    .unwrap()
                    .parameters
                    .kd,
                0.0
            );
            let diffuse = criterion(Parameters::new(0.0, 0.3, 0.2).unwrap());
            let found = minimise(&diffuse, method, start, 10_000).unwrap();
            assert!(found.parameters.k2 < 1e-9, "{method}: {found:?}");
        }
    }

    #[test]
    fn the_iteration_limit_is_told() {
        let criterion = criterion(Parameters::new(0.3, 0.1, 0.2).unwrap());
        let start = Parameters::new(1.0, 1.0, 1.0).unwrap();
        for method in METHODS {
            let found = minimise(&criterion, method, start, 2).unwrap();
            assert_eq!(
                (found.iterations, found.ending),
                (2, Ending::IterationLimit)
            );
        }
    }
}
