//! Fits under the energy constraint: the surface reflects no more light than it receives.

use argmin::core::{CostFunction, Error, Executor, State as _};
use argmin::solver::neldermead::NelderMead;
use brdf_core::{AnyBrdf, Family, ModelParameters};
use nalgebra::DVector;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::error::FitError;
use super::grid_search::GridSearch;
use crate::format::in_degrees;
use crate::model::{Parameter, ReducedModel};
use crate::objective::{Objective, ProfileSums, solve_for};
use crate::progress::{Cancelled, Progress};
use crate::solver::SolverError;
use crate::solver::observed::Observed;

/// The default limit of the energy constraint, an incidence angle in degrees.
pub const DEFAULT_LIMIT_DEG: f64 = 85.0;

/// The number of steps of the incidence angle in which the largest reflectance, a smooth function of
/// the angle, is searched.
const STEPS: u32 = 17;

/// The steps at which the search begins. Most lobes reflect most at the limit.
const FEW_STEPS: [usize; 5] = [17, 13, 9, 4, 0];

/// Relative tolerance of the reflectances.
const TOLERANCE: f64 = 1e-5;

/// The number of points of the grid from which simplices start.
const STARTS: usize = 6;

/// Relative tolerance of the reflectances by which the points of the grid are ranked.
const ROUGH: f64 = 0.03;

/// The number of points of the grid that are ranked together.
const RANKED_AT_ONCE: usize = 64;

/// The rounding of E, a fraction, at a point of the grid.
const ROUNDING: f64 = 1e-9;

/// A simplex has converged when E over its corners differs by less than this fraction of E.
const SPREAD: f64 = 1e-12;

/// The largest number of successive simplices, and of iterations of each.
const SIMPLICES: usize = 3;
const ITERATIONS: u64 = 150;

/// The effect of the energy constraint on a fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EnergyConstraint {
    /// The incidence angle up to which rho(psi) <= 1 is required, in degrees.
    pub limit_deg: f64,
    /// The parameters without the constraint.
    pub free: ModelParameters,
    /// E without the constraint in percent.
    pub free_e_percent: f64,
    /// Whether the constraint changes the fit.
    pub binding: bool,
}

/// The minimum of E under rho(psi) <= 1 for all psi up to the limit, in radians; `best` is the
/// minimum without the constraint.
///
/// For given k1, n and p the reflectance is k2 s(psi) + kD, so that the constraint is
/// k2 S + kD <= 1 with S the largest s up to the limit, and the best weights under it are known in
/// closed form. The points of the grid are ranked by E with these weights and an approximate S at the
/// limit; simplices with the exact S start from the best points.
pub(crate) fn constrain_energy(
    objective: &Objective,
    model: ReducedModel,
    best: &ModelParameters,
    limit: f64,
    progress: &Progress<'_>,
) -> Result<ModelParameters, FitError> {
    let bounded = Bounded {
        objective,
        model,
        limit,
        axes: axes(model),
        fixed: *best,
        progress,
    };
    if bounded.largest_reflectance(best) <= 1.0 {
        return Ok(*best);
    }
    let mut lowest = bounded.best_weights(best);
    let starts = if bounded.axes.is_empty() {
        Vec::new()
    } else {
        bounded.best_points()?
    };
    let descents = starts.par_iter().map(|start| bounded.descend(start));
    for found in descents.collect::<Result<Vec<_>, _>>()? {
        if found.1 < lowest.1 {
            lowest = found;
        }
    }
    if lowest.1.is_finite() {
        Ok(lowest.0)
    } else {
        Err(FitError::FixedAboveEnergy(in_degrees(limit)))
    }
}

/// The parameters other than the weights.
fn axes(model: ReducedModel) -> Vec<Parameter> {
    let weights = [Parameter::K2, Parameter::Kd];
    let free = model.free().iter().copied();
    free.filter(|parameter| !weights.contains(parameter))
        .collect()
}

/// The largest reflectance s(psi) of the specular part alone with k2 = 1, over the steps of psi up to
/// the limit.
///
/// s is a smooth function of psi without narrow features: the largest of a few steps is followed upwards
/// to the largest of all.
fn largest_specular(family: Family, at: &ModelParameters, limit: f64) -> f64 {
    let mut known = [None; STEPS as usize + 1];
    let mut of = |step: usize| {
        *known[step].get_or_insert_with(|| {
            let psi = limit * step as f64 / f64::from(STEPS);
            specular(family, at, psi, TOLERANCE)
        })
    };
    let larger = |a: (usize, f64), b: (usize, f64)| if b.1 > a.1 { b } else { a };
    let few = FEW_STEPS.map(|step| (step, of(step)));
    let mut largest = few.into_iter().fold((0, 0.0), larger);
    loop {
        let (step, _) = largest;
        let beside = [step.checked_sub(1), Some(step + 1)].into_iter().flatten();
        let beside = beside.filter(|step| *step <= STEPS as usize);
        let next = beside.map(|step| (step, of(step))).fold(largest, larger);
        if next == largest {
            return largest.1;
        }
        largest = next;
    }
}

/// s(psi), the reflectance of the specular part alone with k2 = 1.
fn specular(family: Family, at: &ModelParameters, psi: f64, tolerance: f64) -> f64 {
    let unit = ModelParameters {
        k2: 1.0,
        kd: 0.0,
        ..*at
    };
    AnyBrdf::new(family, &unit)
        .ok()
        .and_then(|brdf| brdf.hemispherical_reflectance(psi, tolerance).ok())
        .unwrap_or(f64::INFINITY)
}

struct Bounded<'a> {
    objective: &'a Objective,
    model: ReducedModel,
    limit: f64,
    axes: Vec<Parameter>,
    /// The values of the parameters that are not on the axes.
    fixed: ModelParameters,
    progress: &'a Progress<'a>,
}

impl Bounded<'_> {
    fn largest_reflectance(&self, at: &ModelParameters) -> f64 {
        let specular = if at.k2 > 0.0 {
            largest_specular(self.model.family(), at, self.limit)
        } else {
            0.0
        };
        at.k2 * specular + at.kd
    }

    /// The best weights under the constraint with their E; infinite if fixed weights violate it.
    fn best_weights(&self, at: &ModelParameters) -> (ModelParameters, f64) {
        self.weights_below(at, largest_specular(self.model.family(), at, self.limit))
    }

    /// [`best_weights`](Self::best_weights) for a known largest reflectance.
    fn weights_below(&self, at: &ModelParameters, largest: f64) -> (ModelParameters, f64) {
        let sums = self.objective.profile_sums(at);
        let Some((k2, kd)) = weights_below(self.model.fixed_weights(), &sums, largest) else {
            return (*at, f64::INFINITY);
        };
        let bounded = ModelParameters { k2, kd, ..*at };
        (bounded, self.objective.error(&bounded))
    }

    /// The approximately lowest points of the grid under the constraint, in ascending order of E.
    ///
    /// The constraint raises E: once enough points are known, those with a larger E without it are none
    /// of the lowest, and their reflectances are not computed.
    fn best_points(&self) -> Result<Vec<ModelParameters>, Cancelled> {
        let search = GridSearch::new(self.objective, self.model, self.progress)?;
        let mut best: Vec<(ModelParameters, f64)> = Vec::new();
        for points in search.whole().ascending().chunks(RANKED_AT_ONCE) {
            let enough = best.get(STARTS - 1).zip(points.first());
            if search.is_of_all_rows
                && enough.is_some_and(|(last, next)| next.error > last.1 + ROUNDING)
            {
                break;
            }
            let bounded = points.par_iter().map(|point| {
                self.progress.advance()?;
                let at = point.parameters;
                let largest = specular(self.model.family(), &at, self.limit, ROUGH);
                Ok(self.weights_below(&at, largest))
            });
            best.extend(bounded.collect::<Result<Vec<_>, Cancelled>>()?);
            best.retain(|(_, error)| error.is_finite());
            best.sort_by(|a, b| a.1.total_cmp(&b.1));
            best.truncate(STARTS);
        }
        Ok(best.into_iter().map(|(at, _)| at).collect())
    }

    /// Runs simplices one after another until one makes no progress.
    fn descend(&self, start: &ModelParameters) -> Result<(ModelParameters, f64), SolverError> {
        let mut lowest = self.best_weights(start);
        for _ in 0..SIMPLICES {
            let next = self.simplex(&lowest.0, lowest.1)?;
            let gain = lowest.1 - next.1;
            if gain > 0.0 {
                lowest = next;
            }
            if gain <= 1e-9 * lowest.1 {
                break;
            }
        }
        Ok(lowest)
    }

    fn at(&self, x: &DVector<f64>) -> Option<ModelParameters> {
        let mut at = self.fixed;
        for (&parameter, &x) in self.axes.iter().zip(x.iter()) {
            let value = if parameter == Parameter::N {
                x
            } else {
                x.exp()
            };
            let (lowest, highest) = parameter.range();
            if !(lowest..=highest).contains(&value) {
                return None;
            }
            parameter.set(&mut at, value);
        }
        Some(at)
    }

    fn simplex(
        &self,
        start: &ModelParameters,
        error: f64,
    ) -> Result<(ModelParameters, f64), SolverError> {
        let axes = self.axes.iter();
        let start = DVector::from_iterator(
            self.axes.len(),
            axes.map(|&parameter| {
                let value = parameter.of(start);
                if parameter == Parameter::N {
                    value
                } else {
                    value.ln()
                }
            }),
        );
        let corner = |axis: usize| {
            let mut corner = start.clone();
            // The corner is moved towards the middle of the range, so that it lies within.
            corner[axis] += if self.axes[axis] == Parameter::N && start[axis] > 3.0 {
                -0.1
            } else {
                0.1
            };
            corner
        };
        let corners = std::iter::once(start.clone()).chain((0..self.axes.len()).map(corner));
        let solver = NelderMead::new(corners.collect())
            .with_sd_tolerance(SPREAD * error)
            .map_err(|error| SolverError::from_argmin(&error))?;
        let notify = |_: &_, _| self.progress.advance();
        let result = Executor::new(self, Observed { solver, notify })
            .configure(|state| state.max_iters(ITERATIONS))
            .ctrlc(false)
            .run()
            .map_err(|error| SolverError::from_argmin(&error))?;
        let best = result.state.get_best_param().unwrap_or(&start);
        let at = self.at(best).unwrap_or(self.fixed);
        Ok(self.best_weights(&at))
    }
}

impl CostFunction for &Bounded<'_> {
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, x: &DVector<f64>) -> Result<f64, Error> {
        let error = self.at(x).map(|at| self.best_weights(&at).1);
        Ok(error
            .filter(|error| error.is_finite())
            .unwrap_or(f64::INFINITY))
    }
}

/// The best weights with k2 `largest` + kD <= 1: the unconstrained ones if they satisfy it, otherwise
/// the best ones on the boundary, since E is convex. `None` if fixed weights violate the constraint.
fn weights_below(fixed: [Option<f64>; 2], sums: &ProfileSums, largest: f64) -> Option<(f64, f64)> {
    let (k2, kd, _) = solve_for(fixed, sums);
    if k2 * largest + kd <= 1.0 {
        return Some((k2, kd));
    }
    match fixed {
        [Some(_), Some(_)] => None,
        [Some(k2), None] => {
            // A lobe with k2 = 0 reflects nothing for any shape.
            let specular = if k2 > 0.0 { k2 * largest } else { 0.0 };
            (specular <= 1.0).then_some((k2, 1.0 - specular))
        }
        [None, Some(kd)] => (kd <= 1.0).then_some(((1.0 - kd) / largest, kd)),
        [None, None] => {
            // With kD = 1 - k2 S, the term k2 (u - S a) describes y - a.
            let &ProfileSums { uu, ua, uy, aa, ay } = sums;
            let squared = uu - 2.0 * largest * ua + largest * largest * aa;
            let product = uy - ua - largest * ay + largest * aa;
            let k2 = (product / squared).clamp(0.0, 1.0 / largest);
            Some((k2, (1.0 - k2 * largest).max(0.0)))
        }
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use brdf_core::published::PUBLISHED;
    use proptest::prelude::*;

    use super::*;
    use crate::fit::{FitOptions, fit, fit_observed};
    use crate::model::Model;
    use crate::progress::{Observer, Phase, Step};
    use crate::scan::RefractiveIndex;
    use crate::scan::synthetic::scan;

    fn options(n: f64, limit_deg: Option<f64>, model: Model) -> FitOptions {
        FitOptions {
            model,
            refractive_index: Some(RefractiveIndex::Same(n)),
            energy_limit: limit_deg.map(f64::to_radians),
            ..FitOptions::default()
        }
    }

    #[test]
    fn sample_002_can_be_fitted_without_making_light() {
        let row = PUBLISHED[3];
        let scan = scan(row.parameters, row.n);
        let mut errors = Vec::new();
        for model in [Model::Specular, Model::Three, Model::ThreeN, Model::PowerN] {
            let free = fit(&scan, &options(row.n, None, model)).unwrap();
            let bound = fit(&scan, &options(row.n, Some(80.0), model)).unwrap();
            let energy = bound.energy.unwrap();
            assert!(energy.binding && energy.free_e_percent == free.e_percent);
            assert!(bound.e_percent > free.e_percent);
            let brdf = AnyBrdf::new(model.family(), &bound.at()).unwrap();
            let reflectance = |psi_deg: f64| {
                brdf.hemispherical_reflectance(psi_deg.to_radians(), 1e-6)
                    .unwrap()
            };
            let largest = (0..=80)
                .map(|psi| reflectance(f64::from(psi)))
                .fold(0.0, f64::max);
            assert!((largest - 1.0).abs() < 1e-3, "{model}: {largest}");
            errors.push(bound.e_percent);
        }
        // Each contains the one before.
        assert!(
            errors.is_sorted_by(|a, b| *b <= a * (1.0 + 1e-6)),
            "{errors:?}"
        );
    }

    /// By brute force over kD and k2 on the line and inside, for many widths.
    #[test]
    fn no_other_parameters_that_keep_energy_are_better() {
        let row = PUBLISHED[3];
        let scan = scan(row.parameters, row.n);
        let options = options(row.n, Some(80.0), Model::Three);
        let bound = fit(&scan, &options).unwrap();
        let objective = Objective::new(&scan, Family::Paper, row.n, &options.weights).unwrap();
        for step in 0..40 {
            let k1 = 0.05 * 1.12_f64.powi(step);
            let at = ModelParameters { k1, ..bound.at() };
            let largest = largest_specular(Family::Paper, &at, 80_f64.to_radians());
            for i in 0..=50 {
                let k2 = f64::from(i) / 50.0 / largest;
                for j in 0..=20 {
                    let kd = (1.0 - k2 * largest) * f64::from(j) / 20.0;
                    let other = objective.error(&ModelParameters { k2, kd, ..at });
                    assert!(other >= 0.01 * bound.e_percent * (1.0 - 1e-9));
                }
            }
        }
    }

    /// Counts the steps of the energy constraint.
    #[derive(Default)]
    struct Steps(AtomicUsize);

    impl Observer for Steps {
        fn step(&self, step: &Step) -> ControlFlow<()> {
            let counts = usize::from(step.phase == Phase::Energy);
            self.0.fetch_add(counts, Ordering::Relaxed);
            ControlFlow::Continue(())
        }
    }

    #[test]
    fn reflectances_are_computed_for_a_small_part_of_the_grid() {
        let row = PUBLISHED[3];
        let scan = scan(row.parameters, row.n);
        let steps = Steps::default();
        let options = options(row.n, Some(80.0), Model::PowerN);
        let bound = fit_observed(&scan, &options, &steps).unwrap();
        assert!(bound.energy.unwrap().binding);
        // The grid has 13,944 points.
        let steps = steps.0.into_inner();
        assert!(steps < 6000, "{steps}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn the_largest_reflectance_is_that_of_all_steps(
            log_k1 in -6.0..3.0_f64, n in 1.0..6.0, p in 0.1..16.0, limit_deg in 1.0..89.9_f64,
        ) {
            let at = ModelParameters { k2: 1.0, kd: 0.0, k1: log_k1.exp(), n, p };
            let limit = limit_deg.to_radians();
            for family in Family::ALL {
                let all = (0..=STEPS).map(|step| limit * f64::from(step) / f64::from(STEPS));
                let all = all.map(|psi| specular(family, &at, psi, TOLERANCE));
                // Reflectances that differ by less than their tolerance are equal.
                let (found, largest) = (largest_specular(family, &at, limit), all.fold(0.0, f64::max));
                prop_assert!(
                    (found / largest - 1.0).abs() < TOLERANCE,
                    "{found} {largest}"
                );
            }
        }
    }

    #[test]
    fn a_fit_that_keeps_energy_is_left_as_it_is() {
        let row = PUBLISHED[4];
        let scan = scan(row.parameters, row.n);
        let free = fit(&scan, &options(row.n, None, Model::Three)).unwrap();
        let bound = fit(&scan, &options(row.n, Some(60.0), Model::Three)).unwrap();
        assert_eq!(free.parameters, bound.parameters);
        assert!(!bound.energy.unwrap().binding);
    }
}
