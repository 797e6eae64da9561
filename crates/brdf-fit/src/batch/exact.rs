//! The last pass: the best weights, E and standard errors from exact columns.

use brdf_core::ModelParameters;
use nalgebra::SMatrix;

use super::plan::BatchPlan;
use crate::model::{K1_RANGE, Parameter, ReducedModel};
use crate::objective::{LobeColumns, WithLobe, dot_of, solve_for};
use crate::solver::descent::{Products, Rows};

/// A lobe below this fraction of the readings is their rounding.
const NO_LOBE: f64 = 1e-15;

/// The number of running sums of the squares of residuals.
const LANES: usize = 8;

/// A scan with its best weights.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weighed {
    pub(super) at: ModelParameters,
    /// E as a fraction, from residuals.
    pub(super) error: f64,
    /// The scalar products of u, a and, where it was asked for, du/dk1.
    pub(super) products: Products,
}

/// The best weights for y of unit length at the given k1, n and p.
pub(super) fn best_weights(
    plan: &BatchPlan,
    at: ModelParameters,
    rows: Rows<'_>,
    diffuse: &[f64],
    by_k1: bool,
    columns: &mut LobeColumns,
) -> Weighed {
    let weigh = Weigh {
        model: plan.model,
        at,
        rows,
        diffuse,
        by_k1,
    };
    plan.objective.with_lobe(&at, by_k1, columns, weigh)
}

/// [`best_weights`] with the lobe's column. The diffuse column has the factors of the rows.
struct Weigh<'a> {
    model: ReducedModel,
    at: ModelParameters,
    rows: Rows<'a>,
    diffuse: &'a [f64],
    by_k1: bool,
}

impl WithLobe for Weigh<'_> {
    type Output = Weighed;

    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a function that is not inlined is not compiled for the present processor"
    )]
    fn with_lobe(self, u: &mut [f64], by_k1: &mut [f64]) -> Weighed {
        let Self {
            model,
            at,
            rows: Rows { y, factors },
            diffuse: a,
            ..
        } = self;
        if let Some(factors) = factors {
            multiply(u, factors);
        }
        let mut products = Products {
            measured: [dot_of(u, y), dot_of(a, y), 0.0, 0.0, 0.0],
            ..Products::default()
        };
        products.columns[0][0] = dot_of(u, u);
        products.columns[1][0] = dot_of(u, a);
        products.columns[1][1] = dot_of(a, a);
        if self.by_k1 {
            if let Some(factors) = factors {
                multiply(by_k1, factors);
            }
            products.columns[2][0] = dot_of(by_k1, u);
            products.columns[2][1] = dot_of(by_k1, a);
            products.columns[2][2] = dot_of(by_k1, by_k1);
        }
        let sums = products.sums();
        let fixed = model.fixed_weights();
        let (mut k2, mut kd, _) = solve_for(fixed, &sums);
        if k2 * sums.uu.sqrt() <= NO_LOBE && model.frees(Parameter::K2) {
            (k2, kd, _) = solve_for([Some(0.0), fixed[1]], &sums);
        }
        Weighed {
            at: ModelParameters { k2, kd, ..at },
            error: squares_of_residuals([k2, kd], u, a, y),
            products,
        }
    }
}

#[inline]
fn multiply(column: &mut [f64], factors: &[f64]) {
    for (x, factor) in column.iter_mut().zip(factors) {
        *x *= factor;
    }
}

/// The sum of the squares of k2 u + kD a - y.
#[inline]
fn squares_of_residuals([k2, kd]: [f64; 2], u: &[f64], a: &[f64], y: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (u, u_rest) = u.as_chunks::<LANES>();
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (y, y_rest) = y.as_chunks::<LANES>();
    for ((u, a), y) in u.iter().zip(a).zip(y) {
        for lane in 0..LANES {
            let rest = k2 * u[lane] + kd * a[lane] - y[lane];
            sums[lane] += rest * rest;
        }
    }
    let rest = u_rest.iter().zip(a_rest).zip(y_rest);
    let rest: f64 = rest.map(|((u, a), y)| (k2 * u + kd * a - y).powi(2)).sum();
    sums.iter().sum::<f64>() + rest
}

/// The standard errors of k2, kD, k1, n and p for constant noise; NaN for those that are not free or are
/// at an end of their range.
pub(super) fn standard_errors(
    plan: &BatchPlan,
    weighed: &Weighed,
    readings: usize,
    rows: Rows<'_>,
) -> [f64; 5] {
    let (model, at) = (plan.model, &weighed.at);
    let determined = |parameter: &Parameter| match parameter {
        Parameter::Kd => at.kd > 0.0,
        Parameter::K2 => at.k2 > 0.0,
        Parameter::K1 => at.k2 > 0.0 && K1_RANGE.0 < at.k1 && at.k1 < K1_RANGE.1,
        Parameter::N | Parameter::P => {
            let (lowest, highest) = parameter.range();
            let value = parameter.of(at);
            at.k2 > 0.0 && lowest < value && value < highest
        }
    };
    let used = Parameter::ALL.map(|p| model.frees(p) && determined(&p));
    let left = readings.saturating_sub(model.free().len());
    if used == [false; 5] || left == 0 {
        return [f64::NAN; 5];
    }
    let variance = weighed.error / left as f64;
    if plan.is_along_k1() {
        return errors::<3>(&weighed.products, at.k2, used, variance);
    }
    let derivatives = [used[2], used[3], used[4]];
    let products = Products::at(&plan.objective, at, derivatives, rows);
    errors::<5>(&products, at.k2, used, variance)
}

/// The roots of the diagonal of s^2 (J^T J)^-1 over those of the first D parameters that are used.
fn errors<const D: usize>(
    products: &Products,
    k2: f64,
    used: [bool; 5],
    variance: f64,
) -> [f64; 5] {
    let mut errors = [f64::NAN; 5];
    // Parameters that are left out keep the unit matrix.
    let scale = |i: usize| if i < 2 { 1.0 } else { k2 };
    let matrix = |i: usize, j: usize| products.of(i, j) * scale(i) * scale(j);
    // With unit diagonal, so that the sizes of the columns do not matter.
    let roots: [f64; D] = std::array::from_fn(|i| if used[i] { matrix(i, i).sqrt() } else { 1.0 });
    let unit = SMatrix::<f64, D, D>::from_fn(|i, j| match (used[i] && used[j], i == j) {
        (true, _) => matrix(i, j) / (roots[i] * roots[j]),
        (false, true) => 1.0,
        (false, false) => 0.0,
    });
    let Some(inverse) = unit.cholesky().map(|factors| factors.inverse()) else {
        return errors;
    };
    for i in (0..D).filter(|i| used[*i]) {
        errors[i] = (variance * inverse[(i, i)]).sqrt() / roots[i];
    }
    errors
}
