//! The Levenberg-Marquardt method with bounds.
//!
//! Scaling and damping follow Moré ("The Levenberg-Marquardt algorithm: implementation and
//! theory", 1978) and Nielsen ("Damping parameter in Marquardt's method", 1999). The bounds are kept
//! by an active set: a parameter whose step would cross its bound is fixed there, and the step of
//! the other parameters is solved again. Clamping alone keeps the other components of the unbounded
//! step, which need not lower E at all.

use argmin::core::{Error, IterState, KV, Problem, Solver, TerminationReason, TerminationStatus};
use nalgebra::{SMatrix, SVector};

use super::Termination;
use crate::objective::NormalEquations;

/// A sum of squares with its normal equations.
pub(crate) trait LeastSquares<const P: usize> {
    /// E, J^T r and J^T J at the given parameters.
    fn normal_equations(&self, param: &SVector<f64, P>) -> NormalEquations<P>;
}

/// The gradient counts as zero when the cosine between the residuals and each column of their
/// Jacobian is below this; columns of parameters at an active bound are ignored.
const GRADIENT_TOLERANCE: f64 = 1e-9;

/// The step counts as zero below this, relative to the scaled parameters.
const STEP_TOLERANCE: f64 = 1e-15;

/// The solver stops when the linear model predicts a smaller relative reduction of E than this.
const REDUCTION_TOLERANCE: f64 = 1e-13;

/// Damping of the first step, relative to the scaled matrix.
const FIRST_DAMPING: f64 = 1e-3;

/// A step is accepted when E falls by at least this fraction of the predicted reduction.
const ACCEPTED_GAIN: f64 = 1e-4;

/// An argmin [`Solver`] for a [`LeastSquares`] problem, with one trial step in each iteration.
#[derive(Debug, Clone)]
pub(crate) struct LevenbergMarquardt<const P: usize> {
    lower: SVector<f64, P>,
    upper: SVector<f64, P>,
    damping: f64,
    damping_growth: f64,
    /// The squared scale of each parameter: the largest diagonal element of J^T J so far.
    scale: SVector<f64, P>,
    termination: Option<Termination>,
    here: Option<NormalEquations<P>>,
}

type State<const P: usize> = IterState<SVector<f64, P>, (), (), (), (), f64>;

impl<const P: usize> LevenbergMarquardt<P> {
    /// A solver that keeps each parameter within [lower, upper]. Bounds may be infinite.
    pub(crate) fn new(lower: SVector<f64, P>, upper: SVector<f64, P>) -> Self {
        Self {
            lower,
            upper,
            damping: FIRST_DAMPING,
            damping_growth: 2.0,
            scale: SVector::zeros(),
            termination: None,
            here: None,
        }
    }

    /// The reason of the termination; `None` while the solver runs and at the iteration limit.
    pub(crate) fn termination(&self) -> Option<Termination> {
        self.termination
    }

    /// Adopts the normal equations of a new point.
    fn arrive(&mut self, equations: NormalEquations<P>) {
        self.scale = self.scale.sup(&equations.matrix.diagonal());
        self.here = Some(equations);
    }

    /// The parameters that are free to move: those that the gradient does not push against a bound.
    fn free(&self, param: &SVector<f64, P>, gradient: &SVector<f64, P>) -> [bool; P] {
        std::array::from_fn(|j| {
            let held_below = param[j] <= self.lower[j] && gradient[j] >= 0.0;
            let held_above = param[j] >= self.upper[j] && gradient[j] <= 0.0;
            !held_below && !held_above
        })
    }

    /// The step within the bounds that minimises the damped quadratic model; `None` if its matrix is
    /// singular.
    ///
    /// A primal active-set method: it moves from a feasible step towards the minimum over the free
    /// parameters, fixes the first one that reaches its bound, and releases a fixed one when the model
    /// decreases towards the inside. Each step therefore predicts a lower E.
    fn step(
        &self,
        param: &SVector<f64, P>,
        equations: &NormalEquations<P>,
    ) -> Option<SVector<f64, P>> {
        let matrix = self.damped(&equations.matrix);
        let (lower, upper) = (self.lower - param, self.upper - param);
        let mut free = self.free(param, &equations.gradient);
        let mut step = SVector::zeros();
        // Each working set lowers the model, so that none repeats: there are at most 3^P.
        let working_sets = (0..P).fold(1, |count, _| 3 * count);
        for _ in 0..working_sets {
            let target = solve(&matrix, &equations.gradient, &free, &step)?;
            let way = target - step;
            let fraction = |j: usize| {
                let room = if way[j] < 0.0 {
                    lower[j] - step[j]
                } else {
                    upper[j] - step[j]
                };
                if free[j] && way[j] != 0.0 {
                    room / way[j]
                } else {
                    f64::INFINITY
                }
            };
            let first = (0..P).min_by(|&i, &j| fraction(i).total_cmp(&fraction(j)))?;
            if fraction(first) < 1.0 {
                step += way * fraction(first);
                step[first] = if way[first] < 0.0 {
                    lower[first]
                } else {
                    upper[first]
                };
                free[first] = false;
                continue;
            }
            step = target;
            let slope = equations.gradient + matrix * step;
            let falls_inside = |j: &usize| {
                let at_lower = step[*j] <= lower[*j] && slope[*j] < 0.0;
                let at_upper = step[*j] >= upper[*j] && slope[*j] > 0.0;
                !free[*j] && (at_lower || at_upper)
            };
            let Some(released) = (0..P).find(falls_inside) else {
                break;
            };
            free[released] = true;
        }
        Some(step)
    }

    /// J^T J with the damping on its diagonal.
    fn damped(&self, matrix: &SMatrix<f64, P, P>) -> SMatrix<f64, P, P> {
        let mut damped = *matrix;
        for i in 0..P {
            // A parameter that has had no effect so far keeps a unit scale and does not move.
            let scale = if self.scale[i] > 0.0 {
                self.scale[i]
            } else {
                1.0
            };
            damped[(i, i)] += self.damping * scale;
        }
        damped
    }

    fn gradient_is_zero(&self, param: &SVector<f64, P>, here: &NormalEquations<P>) -> bool {
        let free = self.free(param, &here.gradient);
        (0..P).filter(|&j| free[j]).all(|j| {
            let columns = (here.matrix[(j, j)] * here.error).sqrt();
            here.gradient[j].abs() <= GRADIENT_TOLERANCE * columns
        })
    }

    fn grow_damping(&mut self) {
        self.damping *= self.damping_growth;
        self.damping_growth *= 2.0;
    }
}

impl<const P: usize, O: LeastSquares<P>> Solver<O, State<P>> for LevenbergMarquardt<P> {
    fn name(&self) -> &'static str {
        "Levenberg-Marquardt within a box"
    }

    fn init(
        &mut self,
        problem: &mut Problem<O>,
        mut state: State<P>,
    ) -> Result<(State<P>, Option<KV>), Error> {
        let start = state
            .take_param()
            .ok_or_else(|| Error::msg("Levenberg-Marquardt needs a starting point"))?;
        let param = start.sup(&self.lower).inf(&self.upper);
        let equations =
            problem.problem("normal_equations_count", |p| Ok(p.normal_equations(&param)))?;
        self.arrive(equations);
        Ok((state.param(param).cost(equations.error), None))
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<O>,
        mut state: State<P>,
    ) -> Result<(State<P>, Option<KV>), Error> {
        let (Some(param), Some(here)) = (state.take_param(), self.here) else {
            return Err(Error::msg("Levenberg-Marquardt was not initialised"));
        };
        if self.gradient_is_zero(&param, &here) {
            self.termination = Some(Termination::GradientZero);
            return Ok((state.param(param).cost(here.error), None));
        }
        let Some(step) = self.step(&param, &here) else {
            self.grow_damping();
            return Ok((state.param(param).cost(here.error), None));
        };
        let promised = -step.dot(&(2.0 * here.gradient + here.matrix * step));
        let scaled = |v: &SVector<f64, P>| v.component_mul(v).dot(&self.scale).sqrt();
        if scaled(&step) <= STEP_TOLERANCE * scaled(&param) {
            self.termination = Some(Termination::StepTooSmall);
        } else if promised <= REDUCTION_TOLERANCE * here.error {
            self.termination = Some(Termination::NoFurtherReduction);
        }
        // Rounding of param + step must not cross the bounds.
        let trial = (param + step).sup(&self.lower).inf(&self.upper);
        let there =
            problem.problem("normal_equations_count", |p| Ok(p.normal_equations(&trial)))?;
        let gain = (here.error - there.error) / promised;
        if gain > ACCEPTED_GAIN {
            self.damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
            self.damping_growth = 2.0;
            self.arrive(there);
            Ok((state.param(trial).cost(there.error), None))
        } else {
            self.grow_damping();
            Ok((state.param(param).cost(here.error), None))
        }
    }

    fn terminate(&mut self, _state: &State<P>) -> TerminationStatus {
        match self.termination {
            Some(_) => TerminationStatus::Terminated(TerminationReason::SolverConverged),
            None => TerminationStatus::NotTerminated,
        }
    }
}

/// The minimum of the model over the free parameters; the other parameters keep their steps.
fn solve<const P: usize>(
    matrix: &SMatrix<f64, P, P>,
    gradient: &SVector<f64, P>,
    free: &[bool; P],
    step: &SVector<f64, P>,
) -> Option<SVector<f64, P>> {
    let mut reduced = SMatrix::<f64, P, P>::identity();
    let mut right = *step;
    for i in (0..P).filter(|&i| free[i]) {
        right[i] = -gradient[i];
        for j in 0..P {
            if free[j] {
                reduced[(i, j)] = matrix[(i, j)];
            } else {
                right[i] -= matrix[(i, j)] * step[j];
            }
        }
    }
    Some(reduced.cholesky()?.solve(&right))
}

#[cfg(test)]
mod tests {
    use argmin::core::Executor;
    use nalgebra::{Matrix2, Vector2};
    use proptest::prelude::*;

    use super::*;

    /// A linear problem: residuals L^T (x - centre), so that J^T J is the matrix L L^T.
    struct Quadratic {
        matrix: Matrix2<f64>,
        centre: Vector2<f64>,
    }

    impl LeastSquares<2> for Quadratic {
        fn normal_equations(&self, x: &Vector2<f64>) -> NormalEquations<2> {
            let away = x - self.centre;
            NormalEquations {
                error: 1.0 + away.dot(&(self.matrix * away)),
                gradient: self.matrix * away,
                matrix: self.matrix,
            }
        }
    }

    fn minimum(problem: Quadratic, start: Vector2<f64>) -> (Vector2<f64>, Option<Termination>) {
        let solver = LevenbergMarquardt::new(Vector2::zeros(), Vector2::new(4.0, f64::INFINITY));
        let result = Executor::new(problem, solver)
            .configure(|state| state.param(start).max_iters(200))
            .run()
            .unwrap();
        let best = argmin::core::State::get_best_param(&result.state)
            .copied()
            .unwrap();
        (best, result.solver.termination())
    }

    #[test]
    fn the_other_parameters_answer_to_a_bound() {
        // Strongly correlated: with x at its bound 0, y is best at 2 - 0.9 = 1.1, not at 2.
        let matrix = Matrix2::new(1.0, 0.9, 0.9, 1.0);
        let problem = Quadratic {
            matrix,
            centre: Vector2::new(-1.0, 2.0),
        };
        let (found, ending) = minimum(problem, Vector2::new(3.0, 3.0));
        assert_eq!(found[0], 0.0);
        assert!((found[1] - 1.1).abs() < 1e-7);
        assert_eq!(ending, Some(Termination::GradientZero));
    }

    /// With the first violated bound simply fixed, the step went to (4, 0), where E is larger.
    #[test]
    fn of_two_bounds_in_the_way_only_the_right_one_is_held() {
        let matrix = Matrix2::new(0.1, 0.074, 0.074, 0.1);
        let problem = Quadratic {
            matrix,
            centre: Vector2::new(4.54, -3.74),
        };
        let (found, _) = minimum(problem, Vector2::new(0.0, 0.2));
        assert_eq!(found[1], 0.0);
        assert!((found[0] - (4.54 - 0.74 * 3.74)).abs() < 1e-7);
    }

    #[test]
    fn a_bound_at_the_start_can_be_left() {
        let problem = Quadratic {
            matrix: Matrix2::identity(),
            centre: Vector2::new(1.0, 2.0),
        };
        let (found, _) = minimum(problem, Vector2::zeros());
        assert!((found - Vector2::new(1.0, 2.0)).norm() < 1e-7);
    }

    #[test]
    fn a_start_outside_the_box_is_brought_into_it() {
        let problem = Quadratic {
            matrix: Matrix2::identity(),
            centre: Vector2::new(9.0, 2.0),
        };
        let (found, _) = minimum(problem, Vector2::new(-5.0, 9.0));
        assert_eq!(found[0], 4.0);
    }

    #[test]
    fn a_parameter_without_effect_stays() {
        let matrix = Matrix2::new(1.0, 0.0, 0.0, 0.0);
        let problem = Quadratic {
            matrix,
            centre: Vector2::new(1.0, 7.0),
        };
        let (found, ending) = minimum(problem, Vector2::new(3.0, 3.0));
        assert!((found[0] - 1.0).abs() < 1e-7);
        assert_eq!(found[1], 3.0);
        assert!(ending.is_some());
    }

    proptest! {
        #[test]
        fn ends_where_no_step_within_the_box_goes_down(
            a in 0.1..10.0, b in 0.1..10.0, correlation in -0.99..0.99,
            x in -5.0..8.0, y in -5.0..5.0, from_x in 0.0..4.0, from_y in 0.0..9.0,
        ) {
            let c = correlation * f64::sqrt(a * b);
            let problem = Quadratic { matrix: Matrix2::new(a, c, c, b), centre: Vector2::new(x, y) };
            let (found, _) = minimum(problem, Vector2::new(from_x, from_y));
            prop_assert!((0.0..=4.0).contains(&found[0]) && found[1] >= 0.0);
            let problem = Quadratic { matrix: Matrix2::new(a, c, c, b), centre: Vector2::new(x, y) };
            let here = problem.normal_equations(&found);
            let cosine = |j: usize| here.gradient[j] / (here.matrix[(j, j)] * here.error).sqrt();
            for j in 0..2 {
                let at_lower = found[j] == 0.0;
                let at_upper = j == 0 && found[j] == 4.0;
                prop_assert!(at_lower || cosine(j) < 1e-6, "{} {}", j, cosine(j));
                prop_assert!(at_upper || cosine(j) > -1e-6, "{} {}", j, cosine(j));
            }
        }
    }
}
