//! The grid of the nonlinear parameters on which searches for the global optimum begin.

use super::{K1_RANGE, Parameter, ReducedModel};

/// The number of steps in ln k1, of 0.25 each, for scans of many readings. As a function of ln k1 the
/// paper's model has its nearest singularity at a distance of pi/2 in the complex plane, so that its
/// columns have no much narrower features.
const STEPS: u32 = 83;

/// Below this number of readings, the steps in ln k1 are a quarter as long: few readings are nearly
/// interpolated, and the small rest of E has narrower features than the columns.
pub(crate) const FEW_READINGS: usize = 24;

/// The refractive indices of the grid, denser at small values, where R0 changes most.
const INDICES: [f64; 14] = [
    1.0, 1.05, 1.12, 1.2, 1.3, 1.4, 1.5, 1.65, 1.85, 2.1, 2.5, 3.1, 4.2, 6.0,
];

/// The exponents of the grid, about equally spaced in their logarithm.
const EXPONENTS: [f64; 12] = [
    0.1, 0.16, 0.25, 0.4, 0.63, 1.0, 1.6, 2.5, 4.0, 6.3, 10.0, 16.0,
];

/// The grid of k1, n and p. In the order of its points, n varies fastest and p slowest.
#[derive(Debug, Clone)]
pub(crate) struct Grid {
    /// The values of k1, n and p.
    pub(crate) axes: [Vec<f64>; 3],
}

impl Grid {
    /// The grid of a model, for a number of readings. A parameter that is not free has one value: the
    /// fixed one, or for the refractive index `n`. Of n and p, one of `stride` values is taken.
    pub(crate) fn new(model: ReducedModel, n: f64, readings: usize, stride: usize) -> Self {
        let axis = |parameter, all: &[f64], stride| {
            if model.frees(parameter) {
                all.iter().copied().step_by(stride).collect()
            } else {
                vec![model.fixed(parameter).unwrap_or(n)]
            }
        };
        Self {
            axes: [
                axis(Parameter::K1, &widths(readings), 1),
                axis(Parameter::N, &INDICES, stride),
                axis(Parameter::P, &EXPONENTS, stride),
            ],
        }
    }

    /// The number of values of k1, n and p.
    pub(crate) fn counts(&self) -> [usize; 3] {
        self.axes.each_ref().map(Vec::len)
    }

    /// The number of points.
    pub(crate) fn len(&self) -> usize {
        self.counts().iter().product()
    }

    /// Whether k1 alone varies.
    pub(crate) fn is_along_k1(&self) -> bool {
        self.counts()[1..] == [1, 1]
    }

    /// The indices of a point on the axes.
    pub(crate) fn indices(&self, i: usize) -> [usize; 3] {
        let [k1, n, _] = self.counts();
        [i / n % k1, i % n, i / n / k1]
    }

    /// k1, n and p of a point.
    pub(crate) fn at(&self, i: usize) -> [f64; 3] {
        let [k1, n, p] = self.indices(i);
        [self.axes[0][k1], self.axes[1][n], self.axes[2][p]]
    }

    /// The adjacent points along each axis.
    pub(crate) fn adjacent(&self, i: usize) -> impl Iterator<Item = usize> + use<> {
        let [k1, n, p] = self.counts();
        let of_axes = [(i / n % k1, k1, n), (i % n, n, 1), (i / n / k1, p, n * k1)];
        of_axes.into_iter().flat_map(move |(index, count, stride)| {
            let below = (index > 0).then(|| i - stride);
            let above = (index + 1 < count).then(|| i + stride);
            below.into_iter().chain(above)
        })
    }

    /// The widest point, along k1 from a point, up to which all points belong to its plain.
    ///
    /// Far below the distance of the readings, the width of a lobe has no effect, and no slope leads out
    /// of there: descents start at the wide end as well.
    pub(crate) fn widest_of_plain(&self, start: usize, is_plain: impl Fn(usize) -> bool) -> usize {
        let [k1, n, _] = self.counts();
        let steps = k1 - 1 - self.indices(start)[0];
        let wider = (1..=steps).map(|step| start + step * n);
        wider.take_while(|i| is_plain(*i)).last().unwrap_or(start)
    }
}

/// Points without a lobe next to which a faint one may explain more of the readings' squares than the best
/// point of the grid, which explains `gained` beyond the best diffuse part; the most promising ones first.
///
/// There E is plain, and what the readings ask for, their [demand for a lobe](crate::objective::demand_for_lobe)
/// at each point, leads to one. `curvature` is the most by which the demand rises between two points.
pub(crate) fn faint<A: Iterator<Item = usize>>(
    demand: impl Fn(usize) -> f64,
    adjacent: impl Fn(usize) -> A,
    points: usize,
    gained: f64,
    curvature: f64,
) -> Vec<usize> {
    let least = gained.max(0.0).sqrt() - curvature;
    let is_faint = |&i: &usize| {
        let here = demand(i);
        let is_first_of_plain = |j: usize| demand(j) < here || demand(j) == here && i < j;
        least < here && here <= 0.0 && adjacent(i).all(is_first_of_plain)
    };
    let mut found: Vec<usize> = (0..points).filter(is_faint).collect();
    found.sort_by(|a, b| demand(*b).total_cmp(&demand(*a)));
    found.truncate(MOST_FAINT);
    found
}

/// The largest number of points next to which a faint lobe is looked for.
const MOST_FAINT: usize = 8;

/// Between two points of the grid, the demand for a lobe rises by less than this fraction of the length of the
/// readings.
pub(crate) const FAINT: f64 = 0.15;

/// The widths of the grid, from the lower to the upper end of their range.
fn widths(readings: usize) -> Vec<f64> {
    let steps = if readings < FEW_READINGS {
        4 * STEPS
    } else {
        STEPS
    };
    let span = (K1_RANGE.1 / K1_RANGE.0).ln();
    let width = |step| match step {
        0 => K1_RANGE.0,
        step if step == steps => K1_RANGE.1,
        _ => K1_RANGE.0 * (span * f64::from(step) / f64::from(steps)).exp(),
    };
    (0..=steps).map(width).collect()
}

/// On a plain, E differs from its lowest value by less than this fraction.
pub(crate) const PLAIN: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faint_lobes_are_looked_for_next_to_the_highest_demands_that_could_be_enough() {
        let demands = [-0.3, -0.02, -0.1, -0.1, -0.01, -0.2, 0.0, 0.0, 0.0];
        let adjacent = |i: usize| {
            let left = i.checked_sub(1).into_iter();
            left.chain((i + 1 < demands.len()).then_some(i + 1))
        };
        let of = |gained: f64| faint(|i| demands[i], adjacent, demands.len(), gained, 0.1);
        // A plain counts once, and what the grid has gained already needs more demand.
        assert_eq!(of(0.0), [6, 4, 1]);
        assert_eq!(of(0.085 * 0.085), [6, 4]);
        assert_eq!(of(0.1 * 0.1), Vec::<usize>::new());
    }
}
