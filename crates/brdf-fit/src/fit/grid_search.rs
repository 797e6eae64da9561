//! The exact minimum over k2 and kD for given other parameters, and the grid search over those, which
//! checks each fit against the global optimum.
//!
//! For a fixed width, index and exponent the model is linear in k2 and kD, so that E has one minimum
//! over k2 >= 0, kD >= 0, which is known in closed form. E at this minimum is the profile, a function
//! of k1 and, if they are free, of n and p. Its scalar products are stored for each fold of the
//! incidences: the profile of any choice of folds follows without evaluating the model again.

use std::borrow::Cow;

use brdf_core::ModelParameters;
use serde::{Deserialize, Serialize};

use crate::model::{FAINT, FEW_READINGS, Grid, PLAIN, Parameter, ReducedModel, faint};
use crate::objective::{Objective, ProfileSums, demand_for_lobe, solve_for};
use crate::progress::{Cancelled, Progress};

/// A search over n or p uses about this number of readings at most. The minima are refined with all
/// readings.
const SEARCHED_READINGS: usize = 2048;

/// A difference of E, as a fraction of the readings' squares, that is rounding.
const SAME: f64 = 1e-14;

/// The largest number of minima of the grid that are refined.
const MOST_MINIMA: usize = 8;

/// The same for few readings, which E determines little.
const MOST_MINIMA_OF_FEW: usize = 32;

/// A point of the profile: the best weights at the other parameters, and E with them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ProfilePoint {
    /// All parameters.
    pub parameters: ModelParameters,
    /// E as a fraction (in JSON `e_fraction`).
    #[serde(rename = "e_fraction")]
    pub error: f64,
}

/// The minimum of E over the free weights of a model, at the given other parameters.
pub fn best_weights(
    objective: &Objective,
    model: ReducedModel,
    at: ModelParameters,
) -> ProfilePoint {
    let (k2, kd, error) = solve_for(model.fixed_weights(), &objective.profile_sums(&at));
    ProfilePoint {
        parameters: ModelParameters { k2, kd, ..at },
        error,
    }
}

/// The scalar products at each point of the grid, for each fold of the incidences.
#[derive(Debug, Clone)]
pub(crate) struct GridSearch {
    /// k2 and kD where they are fixed.
    weights: [Option<f64>; 2],
    grid: Grid,
    /// uu, ua and uy, indexed by p, k1, n and fold; the fold varies fastest.
    lobe: Vec<[f64; 3]>,
    /// aa, ay, yy of each fold.
    fixed: Vec<[f64; 3]>,
    /// Whether E of the profile is that of the objective, not of a part of its rows.
    pub(crate) is_of_all_rows: bool,
    is_of_few_readings: bool,
}

/// The profile over some choice of the folds.
#[derive(Debug, Clone)]
pub(crate) struct Profile<'a> {
    search: &'a GridSearch,
    /// k2, kD and E, in the order of the grid.
    points: Vec<(f64, f64, f64)>,
    /// The demand for a lobe at each point.
    demands: Vec<f64>,
}

impl GridSearch {
    /// The grid search of a model with an objective. Each width is reported as a step.
    pub(crate) fn new(
        objective: &Objective,
        model: ReducedModel,
        progress: &Progress<'_>,
    ) -> Result<Self, Cancelled> {
        Self::of_density(objective, model, 1, progress)
    }

    /// The grid search with every second value of n and of p, where a fit does not depend on it alone.
    pub(crate) fn coarse(
        objective: &Objective,
        model: ReducedModel,
        progress: &Progress<'_>,
    ) -> Result<Self, Cancelled> {
        Self::of_density(objective, model, 2, progress)
    }

    /// Takes one of `step` values of n and of p.
    fn of_density(
        objective: &Objective,
        model: ReducedModel,
        step: usize,
        progress: &Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let several_axes = model.frees(Parameter::N) || model.frees(Parameter::P);
        if several_axes && objective.len() > SEARCHED_READINGS {
            // If E is not defined for the subset, for example because it is zero, all readings are used.
            if let Ok(thinned) = objective.thinned(SEARCHED_READINGS) {
                let search = Self::over(&thinned, model, step, progress)?;
                return Ok(Self {
                    is_of_all_rows: false,
                    ..search
                });
            }
        }
        Self::over(objective, model, step, progress)
    }

    fn over(
        objective: &Objective,
        model: ReducedModel,
        step: usize,
        progress: &Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let grid = Grid::new(model, objective.n(), objective.count(), step);
        let [widths, indices, exponents] = &grid.axes;
        let fresnel: Vec<Cow<'_, [f64]>> = indices
            .iter()
            .map(|&n| objective.fresnel_column(n))
            .collect();
        let (y, a) = objective.fixed_columns();
        let segments = objective.segments();
        let folds = objective.folds();
        let mut lobe = Vec::new();
        let mut shape = Vec::new();
        for &p in exponents {
            for &k1 in widths {
                progress.advance()?;
                let start = lobe.len();
                lobe.resize(start + fresnel.len() * folds, [0.0; 3]);
                for (i, segment) in segments.iter().enumerate() {
                    let rows = || segment.rows.clone();
                    objective.shape_column(k1, p, rows(), &mut shape);
                    let of_n = lobe[start..].chunks_mut(folds);
                    for (fresnel, sums) in fresnel.iter().zip(of_n) {
                        let products =
                            lobe_products(&shape, &fresnel[rows()], &a[rows()], &y[rows()]);
                        add(&mut sums[i % folds], &products, 1.0);
                    }
                }
            }
        }
        let mut fixed = vec![[0.0; 3]; folds];
        for (i, segment) in segments.iter().enumerate() {
            let (y, a) = (&y[segment.rows.clone()], &a[segment.rows.clone()]);
            let product = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum();
            let products = [product(a, a), product(a, y), product(y, y)];
            add(&mut fixed[i % folds], &products, 1.0);
        }
        Ok(Self {
            weights: model.fixed_weights(),
            grid,
            lobe,
            fixed,
            is_of_all_rows: true,
            is_of_few_readings: objective.count() < FEW_READINGS,
        })
    }

    /// The profile with each fold repeated `times` times.
    pub(crate) fn profile(&self, times: impl Fn(usize) -> f64) -> Profile<'_> {
        let times: Vec<f64> = (0..self.fixed.len()).map(times).collect();
        let sum = |products: &[[f64; 3]]| {
            let mut sum = [0.0; 3];
            for (products, times) in products.iter().zip(&times) {
                add(&mut sum, products, *times);
            }
            sum
        };
        let [aa, ay, yy] = sum(&self.fixed);
        let points = self.lobe.chunks(self.fixed.len()).map(|products| {
            let [uu, ua, uy] = sum(products);
            // E is normalised by the readings of the chosen folds.
            let [uu, ua, uy, aa, ay] = [uu, ua, uy, aa, ay].map(|product| product / yy);
            let sums = ProfileSums { uu, ua, uy, aa, ay };
            let demand = demand_for_lobe(self.weights[1], &sums);
            (solve_for(self.weights, &sums), demand)
        });
        let (points, demands) = points.unzip();
        Profile {
            search: self,
            points,
            demands,
        }
    }

    /// The profile over all incidences, each once.
    pub(crate) fn whole(&self) -> Profile<'_> {
        self.profile(|_| 1.0)
    }
}

impl Profile<'_> {
    fn point(&self, i: usize) -> ProfilePoint {
        let [k1, n, p] = self.search.grid.at(i);
        let (k2, kd, error) = self.points[i];
        let parameters = ModelParameters { k2, kd, k1, n, p };
        ProfilePoint { parameters, error }
    }

    /// The lowest point.
    pub(crate) fn lowest(&self) -> ProfilePoint {
        let errors = (0..self.points.len()).map(|i| (i, self.points[i].2));
        let lowest = errors.min_by(|a, b| a.1.total_cmp(&b.1));
        self.point(lowest.map_or(0, |(i, _)| i))
    }

    /// All points, the lowest first.
    pub(crate) fn ascending(&self) -> Vec<ProfilePoint> {
        let mut points: Vec<ProfilePoint> = (0..self.points.len()).map(|i| self.point(i)).collect();
        points.sort_by(|a, b| a.error.total_cmp(&b.error));
        points
    }

    /// Where descents start: the lowest local minima of the grid, in ascending order of E, then the wide
    /// ends of their plains, and the points next to which a faint lobe may lie.
    pub(crate) fn starts(&self) -> Vec<ProfilePoint> {
        let error = |i: usize| self.points[i].2;
        let grid = &self.search.grid;
        let minima = self.minima();
        let ends = minima.iter().filter_map(|&i| {
            let end = grid.widest_of_plain(i, |j| error(j) <= error(i) * (1.0 + PLAIN));
            (end != i).then_some(end)
        });
        let all = minima.iter().copied().chain(ends).chain(self.faint());
        all.map(|i| self.point(i)).collect()
    }

    /// The points next to which a faint lobe may lie.
    fn faint(&self) -> Vec<usize> {
        let without_lobe = self.points.iter().find(|(k2, ..)| *k2 == 0.0);
        let Some((_, _, plain)) = without_lobe.filter(|_| self.search.weights[0].is_none()) else {
            return Vec::new();
        };
        let grid = &self.search.grid;
        let adjacent = |i: usize| grid.adjacent(i);
        let gained = plain - self.lowest().error;
        let demand = |i: usize| self.demands[i];
        faint(demand, adjacent, self.points.len(), gained, FAINT)
    }

    /// The lowest local minima of the grid, in ascending order of E.
    fn minima(&self) -> Vec<usize> {
        let error = |i: usize| self.points[i].2;
        let is_minimum = |&i: &usize| {
            let mut adjacent = self.search.grid.adjacent(i);
            adjacent.all(|j| error(i) < error(j) || (error(i) == error(j) && i < j))
        };
        let mut minima: Vec<usize> = (0..self.points.len()).filter(is_minimum).collect();
        minima.sort_by(|a, b| error(*a).total_cmp(&error(*b)));
        // The minima of a plain are its rounding: they would take the place of others.
        let is_on_plain = |i: usize| {
            let mut adjacent = self.search.grid.adjacent(i);
            adjacent.all(|j| error(j) - error(i) <= SAME)
        };
        let mut is_first_of_plain = true;
        minima.retain(|&i| !is_on_plain(i) || std::mem::take(&mut is_first_of_plain));
        let most = if self.search.is_of_few_readings {
            MOST_MINIMA_OF_FEW
        } else {
            MOST_MINIMA
        };
        minima.truncate(most);
        minima
    }

    /// Whether parameters lie between the points that are adjacent to a point of the grid.
    pub(crate) fn is_next_to(&self, point: &ProfilePoint, at: &ModelParameters) -> bool {
        let parameters = [Parameter::K1, Parameter::N, Parameter::P];
        let axes = self.search.grid.axes.iter();
        axes.zip(parameters).all(|(axis, parameter)| {
            let (centre, value) = (parameter.of(&point.parameters), parameter.of(at));
            let i = axis.iter().position(|x| *x == centre).unwrap_or(0);
            let (low, high) = (axis[i.saturating_sub(1)], axis[(i + 1).min(axis.len() - 1)]);
            axis.len() == 1 || (low..=high).contains(&value)
        })
    }

    /// The lowest point of the profile at each value of k1, n or p.
    pub(crate) fn along(&self, parameter: Parameter) -> Vec<ProfilePoint> {
        let axis = match parameter {
            Parameter::N => 1,
            Parameter::P => 2,
            _ => 0,
        };
        let mut lowest: Vec<Option<usize>> = vec![None; self.search.grid.counts()[axis]];
        for i in 0..self.points.len() {
            let best = &mut lowest[self.search.grid.indices(i)[axis]];
            if best.is_none_or(|j| self.points[i].2 < self.points[j].2) {
                *best = Some(i);
            }
        }
        lowest
            .into_iter()
            .flatten()
            .map(|i| self.point(i))
            .collect()
    }
}

/// Adds `times` times the products to the sum.
fn add(sum: &mut [f64; 3], products: &[f64; 3], times: f64) {
    for (sum, product) in sum.iter_mut().zip(products) {
        *sum += times * product;
    }
}

/// uu, ua and uy over some rows, with u the shape times the Fresnel factor, in independent running
/// sums.
fn lobe_products(shape: &[f64], fresnel: &[f64], a: &[f64], y: &[f64]) -> [f64; 3] {
    const LANES: usize = 4;
    let mut sums = [[0.0; LANES]; 3];
    let [s, r, a, y] = [shape, fresnel, a, y].map(|column| column.as_chunks::<LANES>());
    for (((s, r), a), y) in s.0.iter().zip(r.0).zip(a.0).zip(y.0) {
        for lane in 0..LANES {
            let u = s[lane] * r[lane];
            sums[0][lane] += u * u;
            sums[1][lane] += u * a[lane];
            sums[2][lane] += u * y[lane];
        }
    }
    for (((s, r), a), y) in s.1.iter().zip(r.1).zip(a.1).zip(y.1) {
        let u = s * r;
        sums[0][0] += u * u;
        sums[1][0] += u * a;
        sums[2][0] += u * y;
    }
    sums.map(|lanes| (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]))
}

#[cfg(test)]
mod tests {
    use brdf_core::{Family, Parameters};
    use proptest::prelude::*;

    use super::*;
    use crate::model::{K1_RANGE, Model};
    use crate::objective::weights::Weights;
    use crate::progress::{NoObserver, Phase};
    use crate::scan::Measurements;
    use crate::scan::synthetic::scan;

    fn criterion_of(family: Family, k2: f64, kd: f64, k1: f64) -> Objective {
        let mut readings = scan(Parameters::new(k2, kd, k1).unwrap(), 1.5)
            .readings()
            .to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= 1.0 + 0.1 * (i as f64).sin();
        }
        let scan = Measurements::new("test", readings).unwrap();
        Objective::new(&scan, family, 1.5, &Weights::default()).unwrap()
    }

    fn objective(k2: f64, kd: f64, k1: f64) -> Objective {
        criterion_of(Family::Paper, k2, kd, k1)
    }

    fn search_of(objective: &Objective, model: Model) -> GridSearch {
        let progress = Progress::new(&NoObserver, Phase::GlobalCheck);
        GridSearch::new(objective, model.into(), &progress).unwrap()
    }

    fn at(k1: f64) -> ModelParameters {
        ModelParameters {
            k2: 0.0,
            kd: 0.0,
            k1,
            n: 1.5,
            p: 1.0,
        }
    }

    #[test]
    fn the_points_of_a_search_are_the_best_weights_there() {
        for model in Model::ALL {
            let objective = criterion_of(model.family(), 0.3, 0.1, 0.2);
            let search = search_of(&objective, model);
            let profile = search.whole();
            for i in (0..profile.points.len()).step_by(37) {
                let point = profile.point(i);
                let [k1, n, p] = search.grid.indices(i);
                let [widths, indices, _] = search.grid.counts();
                assert_eq!((p * widths + k1) * indices + n, i);
                let error = objective.error(&point.parameters);
                assert!((error - point.error).abs() < 1e-12, "{model}");
                let exact = best_weights(&objective, model.into(), point.parameters);
                assert!((exact.error - point.error).abs() < 1e-12, "{model}");
            }
        }
    }

    #[test]
    fn a_choice_of_incidences_is_the_profile_of_their_criterion() {
        let all = objective(0.3, 0.1, 0.2);
        let search = search_of(&all, Model::Three);
        let without = search.profile(|i| if i == 2 { 0.0 } else { 1.0 }).lowest();
        let subset = all.subset(|i| i != 2).unwrap();
        let expected = search_of(&subset, Model::Three).whole().lowest();
        assert_eq!(without.parameters.k1, expected.parameters.k1);
        assert!((without.error / expected.error - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_profile_without_a_minimum_ends_at_the_end_of_its_range() {
        // A peak between the readings: the narrower, the better.
        let mut readings = scan(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5)
            .readings()
            .to_vec();
        for reading in &mut readings {
            reading.brdf = if reading.theta == -reading.psi {
                1e3
            } else {
                0.1
            };
        }
        let scan = Measurements::new("test", readings).unwrap();
        let objective = Objective::new(&scan, Family::Paper, 1.5, &Weights::default()).unwrap();
        let search = search_of(&objective, Model::Three);
        let starts = search.whole().starts();
        assert_eq!(starts[0].parameters.k1, K1_RANGE.0);
    }

    proptest! {
        #[test]
        fn the_best_weights_are_the_best(
            k2 in 0.0..1.0, kd in 0.0..1.0, log_k1 in -3.0..0.5_f64, width in -5.0..2.0_f64,
            by_k2 in -0.5..0.5_f64, by_kd in -0.5..0.5_f64,
        ) {
            let objective = objective(k2 + 1e-3, kd, log_k1.exp());
            for model in [Model::Lambert, Model::Specular, Model::Three] {
                let best = best_weights(&objective, model.into(), at(width.exp()));
                let ModelParameters { k2, kd, .. } = best.parameters;
                prop_assert!(k2 >= 0.0 && kd >= 0.0);
                prop_assert!((objective.error(&best.parameters) - best.error).abs() < 1e-13);
                let by_k2 = if model.frees(Parameter::K2) { by_k2 } else { 0.0 };
                let by_kd = if model.frees(Parameter::Kd) { by_kd } else { 0.0 };
                let other = ModelParameters {
                    k2: (k2 + by_k2).max(0.0),
                    kd: (kd + by_kd).max(0.0),
                    ..best.parameters
                };
                prop_assert!(objective.error(&other) >= best.error - 1e-13);
            }
        }
    }
}
