//! Nelder and Mead's simplex method within bounds.
//!
//! argmin's simplex knows no bounds, so it moves in coordinates that have none: sqrt(k2),
//! sqrt(kD) and ln(k1). It stops when its corners have nearly the same E, which also happens to a
//! simplex that has collapsed somewhere else than at a minimum; so a fresh simplex starts where
//! the last one stopped, until one brings nothing.

use argmin::core::{
    CostFunction, Error, IterState, KV, Problem, Solver, State as _, TerminationReason,
    TerminationStatus,
};
use argmin::solver::neldermead::NelderMead as Simplex;
use brdf_core::Parameters;
use nalgebra::Vector3;

use super::Ending;
use crate::criterion::Criterion;

/// A simplex has converged when the standard deviation of E over its corners is below this, as a
/// fraction of E. (argmin's tolerance is absolute; so it is set anew for each simplex.)
const SPREAD_TOLERANCE: f64 = 1e-13;

/// The absolute spread of E below which it is rounding alone, E being a fraction of 1.
const SPREAD_FLOOR: f64 = 1e-24;

/// A fresh simplex has brought nothing when E fell by less than this fraction.
const RESTART_GAIN: f64 = 1e-9;

/// E over coordinates without bounds: k2 = x0^2, kD = x1^2, k1 = exp(x2).
#[derive(Debug, Clone, Copy)]
pub struct Unbounded<'a> {
    criterion: &'a Criterion,
    k1_range: (f64, f64),
}

impl<'a> Unbounded<'a> {
    /// E of the criterion, infinite where k1 is out of its range.
    pub fn new(criterion: &'a Criterion, k1_range: (f64, f64)) -> Self {
        Self {
            criterion,
            k1_range,
        }
    }

    /// The coordinates of parameters, k1 brought into its range.
    pub fn to_coordinates(&self, parameters: Parameters) -> Vector3<f64> {
        let k1 = parameters.k1.clamp(self.k1_range.0, self.k1_range.1);
        Vector3::new(parameters.k2.sqrt(), parameters.kd.sqrt(), k1.ln())
    }

    /// The parameters of coordinates.
    pub fn to_parameters(&self, x: &Vector3<f64>) -> Parameters {
        Parameters {
            k2: x[0] * x[0],
            kd: x[1] * x[1],
            k1: x[2].exp().clamp(self.k1_range.0, self.k1_range.1),
        }
    }
}

impl CostFunction for Unbounded<'_> {
    type Param = Vector3<f64>;
    type Output = f64;

    fn cost(&self, x: &Vector3<f64>) -> Result<f64, Error> {
        let k1 = x[2].exp();
        // The clamped start may be a rounding outside the range.
        let inside = (self.k1_range.0 * 0.999..=self.k1_range.1 * 1.001).contains(&k1);
        let error = self.criterion.error(&self.to_parameters(x));
        Ok(if inside && error.is_finite() {
            error
        } else {
            f64::INFINITY
        })
    }
}

/// The solver: argmin's simplex, started afresh until that brings nothing.
#[derive(Clone)]
pub struct NelderMead {
    simplex: Simplex<Vector3<f64>, f64>,
    start: Vector3<f64>,
    steps: Vector3<f64>,
    /// E where the simplex in use started.
    error_at_start: f64,
    ending: Option<Ending>,
}

type State = IterState<Vector3<f64>, (), (), (), (), f64>;

impl NelderMead {
    /// A solver that starts with a simplex of the given steps along each coordinate.
    pub fn new(start: Vector3<f64>, steps: Vector3<f64>) -> Self {
        Self {
            simplex: simplex(start, steps),
            start,
            steps,
            error_at_start: f64::INFINITY,
            ending: None,
        }
    }

    /// Why the solver stopped; `None` while it runs, or when its iterations were used up.
    pub fn ending(&self) -> Option<Ending> {
        self.ending
    }

    /// A new simplex at the start, in the next direction and of the next size.
    fn place(
        &mut self,
        problem: &mut Problem<Unbounded<'_>>,
        state: State,
    ) -> Result<State, Error> {
        self.error_at_start = problem.cost(&self.start)?;
        let tolerance = SPREAD_TOLERANCE * self.error_at_start + SPREAD_FLOOR;
        self.simplex = simplex(self.start, self.steps).with_sd_tolerance(tolerance)?;
        Ok(self.simplex.init(problem, state)?.0)
    }
}

fn simplex(start: Vector3<f64>, steps: Vector3<f64>) -> Simplex<Vector3<f64>, f64> {
    let corner = |j: usize| {
        let mut corner = start;
        corner[j] += steps[j];
        corner
    };
    Simplex::new(vec![start, corner(0), corner(1), corner(2)])
}

impl<'a> Solver<Unbounded<'a>, State> for NelderMead {
    fn name(&self) -> &'static str {
        "Nelder-Mead within bounds"
    }

    fn init(
        &mut self,
        problem: &mut Problem<Unbounded<'a>>,
        state: State,
    ) -> Result<(State, Option<KV>), Error> {
        Ok((self.place(problem, state)?, None))
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<Unbounded<'a>>,
        state: State,
    ) -> Result<(State, Option<KV>), Error> {
        let converged = Solver::<Unbounded<'a>, State>::terminate(&mut self.simplex, &state);
        if !converged.terminated() {
            return self.simplex.next_iter(problem, state);
        }
        let best = state.get_best_cost();
        if best >= self.error_at_start * (1.0 - RESTART_GAIN) {
            self.ending = Some(Ending::SimplexConverged);
            return Ok((state, None));
        }
        self.start = *state.get_best_param().unwrap_or(&self.start);
        // The other way round, so that the new corners are not where the old ones came from.
        self.steps *= -0.5;
        Ok((self.place(problem, state)?, None))
    }

    fn terminate(&mut self, _state: &State) -> TerminationStatus {
        match self.ending {
            Some(_) => TerminationStatus::Terminated(TerminationReason::SolverConverged),
            None => TerminationStatus::NotTerminated,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::synthetic::scan;
    use crate::weights::Weights;

    fn with_criterion<T>(test: impl FnOnce(Unbounded<'_>) -> T) -> T {
        let scan = scan(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5);
        let criterion = Criterion::new(scan.readings(), 1.5, &Weights::default()).unwrap();
        test(Unbounded::new(&criterion, (1e-6, 1e3)))
    }

    #[test]
    fn no_coordinates_leave_the_bounds_with_a_finite_error() {
        with_criterion(|problem| {
            for x in [-30.0, -13.9, 6.95, 800.0, f64::NAN] {
                assert_eq!(
                    problem.cost(&Vector3::new(0.5, 0.5, x)).unwrap(),
                    f64::INFINITY
                );
            }
            for k1 in [1e-6, 1e3, 1e9] {
                let edge = problem.to_coordinates(Parameters {
                    k2: 0.1,
                    kd: 0.1,
                    k1,
                });
                assert!(problem.cost(&edge).unwrap().is_finite());
                assert!(problem.to_parameters(&edge).k1 <= 1e3);
            }
        });
    }

    proptest! {
        #[test]
        fn coordinates_go_there_and_back(k2 in 0.0..10.0, kd in 0.0..10.0, log_k1 in -13.8..6.9_f64) {
            with_criterion(|problem| {
                let there = Parameters { k2, kd, k1: log_k1.exp() };
                let back = problem.to_parameters(&problem.to_coordinates(there));
                prop_assert!((back.k2 - k2).abs() < 1e-14);
                prop_assert!((back.kd - kd).abs() < 1e-14);
                prop_assert!((back.k1 / there.k1 - 1.0).abs() < 1e-14);
                Ok(())
            })?;
        }
    }
}
