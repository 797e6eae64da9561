//! The Nelder-Mead simplex method with bounds.
//!
//! The simplex of argmin has no bounds, so it moves in unbounded coordinates: sqrt(k2), sqrt(kD),
//! ln(k1), sqrt(n - 1) and ln(p). It stops when its corners have nearly the same E, which also
//! happens to a simplex that has collapsed away from a minimum. A new simplex therefore starts where
//! the last one stopped, until one does not lower E.

use argmin::core::{
    CostFunction, Error, IterState, KV, Problem, Solver, State as _, TerminationReason,
    TerminationStatus,
};
use argmin::solver::neldermead::NelderMead as Simplex;
use brdf_core::ModelParameters;
use nalgebra::SVector;

use super::{Problem as Free, Termination};
use crate::model::Parameter;

/// A simplex has converged when the standard deviation of E over its corners is below this, as a
/// fraction of E. The tolerance of argmin is absolute and is therefore set for each simplex.
const SPREAD_TOLERANCE: f64 = 1e-13;

/// The absolute spread of E, a fraction, below which it is only rounding.
const SPREAD_FLOOR: f64 = 1e-24;

/// A new simplex makes no progress if E falls by less than this fraction.
const RESTART_GAIN: f64 = 1e-9;

/// E over coordinates without bounds: k2 = x^2, kD = x^2, k1 = exp(x), n = 1 + x^2, p = exp(x).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unbounded<'a, const P: usize>(Free<'a, P>);

impl<'a, const P: usize> Unbounded<'a, P> {
    /// E of the problem; infinite if a parameter is above its range, or k1 or p below it.
    pub(crate) fn new(problem: Free<'a, P>) -> Self {
        Self(problem)
    }

    /// The coordinates of parameters, each clamped to its range.
    pub(crate) fn coordinates_of(&self, at: &ModelParameters) -> SVector<f64, P> {
        self.0.vector(|parameter| {
            let (lowest, highest) = parameter.range();
            let value = parameter.of(at).clamp(lowest, highest);
            match parameter {
                Parameter::K2 | Parameter::Kd => value.sqrt(),
                Parameter::N => (value - 1.0).sqrt(),
                Parameter::K1 | Parameter::P => value.ln(),
            }
        })
    }

    /// The parameters of coordinates, each clamped to its range.
    pub(crate) fn parameters_at(&self, x: &SVector<f64, P>) -> ModelParameters {
        let mut values = *x;
        for (value, parameter) in values.iter_mut().zip(self.0.free) {
            let (lowest, highest) = parameter.range();
            *value = of_coordinate(parameter, *value).clamp(lowest, highest);
        }
        self.0.parameters(&values)
    }

    /// The edges of the first simplex. A weight that starts at zero gets the step of a Lambertian
    /// surface, so that it can leave its bound.
    pub(crate) fn steps(&self) -> SVector<f64, P> {
        let weight = self.0.objective.lambertian_weight().abs().max(1e-12);
        self.0.vector(|parameter| match parameter {
            Parameter::K2 | Parameter::Kd => 0.5 * weight.sqrt(),
            Parameter::K1 => 1.0,
            Parameter::N => 0.3,
            Parameter::P => 0.5,
        })
    }

    fn is_inside(&self, x: &SVector<f64, P>) -> bool {
        x.iter().zip(self.0.free).all(|(x, parameter)| {
            let (lowest, highest) = parameter.range();
            let value = of_coordinate(parameter, *x);
            // Rounding may move the clamped start out of the range.
            (lowest * 0.999..=highest * 1.001).contains(&value)
        })
    }
}

fn of_coordinate(parameter: Parameter, x: f64) -> f64 {
    match parameter {
        Parameter::K2 | Parameter::Kd => x * x,
        Parameter::N => 1.0 + x * x,
        Parameter::K1 | Parameter::P => x.exp(),
    }
}

impl<const P: usize> CostFunction for Unbounded<'_, P> {
    type Param = SVector<f64, P>;
    type Output = f64;

    fn cost(&self, x: &SVector<f64, P>) -> Result<f64, Error> {
        let error = self.0.objective.error(&self.parameters_at(x));
        Ok(if self.is_inside(x) && error.is_finite() {
            error
        } else {
            f64::INFINITY
        })
    }
}

/// The simplex of argmin, restarted until a new simplex makes no progress.
#[derive(Clone)]
pub(crate) struct NelderMead<const P: usize> {
    simplex: Simplex<SVector<f64, P>, f64>,
    start: SVector<f64, P>,
    steps: SVector<f64, P>,
    /// E at the start of the current simplex.
    error_at_start: f64,
    termination: Option<Termination>,
}

type State<const P: usize> = IterState<SVector<f64, P>, (), (), (), (), f64>;

impl<const P: usize> NelderMead<P> {
    /// A solver whose first simplex has the given edges along the coordinates.
    pub(crate) fn new(start: SVector<f64, P>, steps: SVector<f64, P>) -> Self {
        Self {
            simplex: simplex(start, steps),
            start,
            steps,
            error_at_start: f64::INFINITY,
            termination: None,
        }
    }

    /// The reason of the termination; `None` while the solver runs and at the iteration limit.
    pub(crate) fn termination(&self) -> Option<Termination> {
        self.termination
    }

    /// Starts a new simplex, in the next direction and with the next size.
    fn place(
        &mut self,
        problem: &mut Problem<Unbounded<'_, P>>,
        state: State<P>,
    ) -> Result<State<P>, Error> {
        self.error_at_start = problem.cost(&self.start)?;
        let tolerance = SPREAD_TOLERANCE * self.error_at_start + SPREAD_FLOOR;
        self.simplex = simplex(self.start, self.steps).with_sd_tolerance(tolerance)?;
        Ok(self.simplex.init(problem, state)?.0)
    }
}

fn simplex<const P: usize>(
    start: SVector<f64, P>,
    steps: SVector<f64, P>,
) -> Simplex<SVector<f64, P>, f64> {
    let corner = |j: usize| {
        let mut corner = start;
        corner[j] += steps[j];
        corner
    };
    Simplex::new(std::iter::once(start).chain((0..P).map(corner)).collect())
}

impl<'a, const P: usize> Solver<Unbounded<'a, P>, State<P>> for NelderMead<P> {
    fn name(&self) -> &'static str {
        "Nelder-Mead within bounds"
    }

    fn init(
        &mut self,
        problem: &mut Problem<Unbounded<'a, P>>,
        state: State<P>,
    ) -> Result<(State<P>, Option<KV>), Error> {
        Ok((self.place(problem, state)?, None))
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<Unbounded<'a, P>>,
        state: State<P>,
    ) -> Result<(State<P>, Option<KV>), Error> {
        let converged = Solver::<Unbounded<'a, P>, State<P>>::terminate(&mut self.simplex, &state);
        if !converged.terminated() {
            return self.simplex.next_iter(problem, state);
        }
        let best = state.get_best_cost();
        if best >= self.error_at_start * (1.0 - RESTART_GAIN) {
            self.termination = Some(Termination::SimplexConverged);
            return Ok((state, None));
        }
        self.start = *state.get_best_param().unwrap_or(&self.start);
        // The direction is reversed, so that the new corners differ from those of the last simplex.
        self.steps *= -0.5;
        Ok((self.place(problem, state)?, None))
    }

    fn terminate(&mut self, _state: &State<P>) -> TerminationStatus {
        match self.termination {
            Some(_) => TerminationStatus::Terminated(TerminationReason::SolverConverged),
            None => TerminationStatus::NotTerminated,
        }
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::{Family, Parameters};
    use nalgebra::SVector;
    use proptest::prelude::*;

    use super::*;
    use crate::objective::Objective;
    use crate::objective::weights::Weights;
    use crate::scan::synthetic::scan;

    const START: ModelParameters = ModelParameters {
        k2: 0.1,
        kd: 0.1,
        k1: 0.1,
        n: 1.5,
        p: 1.0,
    };

    fn with_problem<T>(test: impl FnOnce(Unbounded<'_, 5>) -> T) -> T {
        let scan = scan(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5);
        let objective = Objective::new(&scan, Family::Power, 1.5, &Weights::default()).unwrap();
        test(Unbounded::new(Free::new(&objective, START, Parameter::ALL)))
    }

    #[test]
    fn no_coordinates_leave_the_bounds_with_a_finite_error() {
        with_problem(|problem| {
            for x in [-30.0, -13.9, 6.95, 800.0, f64::NAN] {
                for axis in [2, 4] {
                    let mut coordinates = SVector::<f64, 5>::repeat(0.5);
                    coordinates[axis] = x;
                    assert_eq!(problem.cost(&coordinates).unwrap(), f64::INFINITY);
                }
            }
            let beyond = SVector::<f64, 5>::from([0.5, 0.5, 0.5, 2.3, 0.5]);
            assert_eq!(problem.cost(&beyond).unwrap(), f64::INFINITY);
            for k1 in [1e-6, 1e3, 1e9] {
                let edge = problem.coordinates_of(&ModelParameters { k1, ..START });
                assert!(problem.cost(&edge).unwrap().is_finite());
                assert!(problem.parameters_at(&edge).k1 <= 1e3);
            }
        });
    }

    proptest! {
        #[test]
        fn coordinates_go_there_and_back(
            k2 in 0.0..10.0, kd in 0.0..10.0, log_k1 in -13.8..6.9_f64, n in 1.0..6.0, p in 0.1..16.0,
        ) {
            with_problem(|problem| {
                let there = ModelParameters { k2, kd, k1: log_k1.exp(), n, p };
                let back = problem.parameters_at(&problem.coordinates_of(&there));
                for parameter in Parameter::ALL {
                    let (there, back) = (parameter.of(&there), parameter.of(&back));
                    prop_assert!((back - there).abs() < 1e-14 * (1.0 + there));
                }
                Ok(())
            })?;
        }
    }
}
