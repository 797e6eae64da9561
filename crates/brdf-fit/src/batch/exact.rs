//! The last pass: the best weights, E and standard errors from exact columns.

use brdf_core::ModelParameters;
use nalgebra::SMatrix;
use pulp::{Simd, WithSimd};

use super::plan::BatchPlan;
use crate::model::{K1_RANGE, Parameter, ReducedModel};
use crate::objective::{Objective, PROCESSOR, ProfileSums, dot_of, solve_for};
use crate::solver::descent::{Products, Rows};

/// A lobe below this fraction of the readings is their rounding.
const NO_LOBE: f64 = 1e-15;

/// The best weights for y of unit length at the given k1, n and p, and E as a fraction, from residuals.
pub(super) fn best_weights(
    plan: &BatchPlan,
    at: ModelParameters,
    rows: Rows<'_>,
    lobe: &mut Vec<f64>,
) -> (ModelParameters, f64) {
    plan.objective.fill_lobe(&at, lobe);
    PROCESSOR.dispatch(Weigh {
        plan,
        at,
        rows,
        lobe,
    })
}

/// [`best_weights`] with the lobe's column, in whose place the residuals are left.
struct Weigh<'a> {
    plan: &'a BatchPlan,
    at: ModelParameters,
    rows: Rows<'a>,
    lobe: &'a mut [f64],
}

impl WithSimd for Weigh<'_> {
    type Output = (ModelParameters, f64);

    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a function that is not inlined is not compiled for the present processor"
    )]
    fn with_simd<V: Simd>(self, _: V) -> Self::Output {
        let Self {
            plan,
            at,
            rows,
            lobe,
        } = self;
        let (_, a) = plan.objective.fixed_columns();
        let own;
        let a = match rows.factors {
            None => a,
            Some(factors) => {
                lobe.iter_mut()
                    .zip(factors)
                    .for_each(|(u, factor)| *u *= factor);
                own = a
                    .iter()
                    .zip(factors)
                    .map(|(a, factor)| a * factor)
                    .collect::<Vec<f64>>();
                &own
            }
        };
        let sums = ProfileSums {
            uu: dot_of(lobe, lobe),
            ua: dot_of(lobe, a),
            uy: dot_of(lobe, rows.y),
            aa: dot_of(a, a),
            ay: dot_of(a, rows.y),
        };
        let fixed = plan.model.fixed_weights();
        let (mut k2, mut kd, _) = solve_for(fixed, &sums);
        if k2 * sums.uu.sqrt() <= NO_LOBE && plan.model.frees(Parameter::K2) {
            (k2, kd, _) = solve_for([Some(0.0), fixed[1]], &sums);
        }
        for ((u, a), y) in lobe.iter_mut().zip(a).zip(rows.y) {
            *u = k2 * *u + kd * a - y;
        }
        (ModelParameters { k2, kd, ..at }, dot_of(lobe, lobe))
    }
}

/// The standard errors of k2, kD, k1, n and p for constant noise; NaN for those that are not free or are
/// at an end of their range.
pub(super) fn standard_errors(
    objective: &Objective,
    model: ReducedModel,
    at: &ModelParameters,
    error: f64,
    readings: usize,
    rows: Rows<'_>,
) -> [f64; 5] {
    let mut errors = [f64::NAN; 5];
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
        return errors;
    }
    let derivatives = [used[2], used[3], used[4]];
    let products = Products::at(objective, at, derivatives, rows);
    // Parameters that are left out keep the unit matrix.
    let scale = |i: usize| if i < 2 { 1.0 } else { at.k2 };
    let matrix = |i: usize, j: usize| products.of(i, j) * scale(i) * scale(j);
    // With unit diagonal, so that the sizes of the columns do not matter.
    let roots: [f64; 5] = std::array::from_fn(|i| if used[i] { matrix(i, i).sqrt() } else { 1.0 });
    let unit = SMatrix::<f64, 5, 5>::from_fn(|i, j| match (used[i] && used[j], i == j) {
        (true, _) => matrix(i, j) / (roots[i] * roots[j]),
        (false, true) => 1.0,
        (false, false) => 0.0,
    });
    let Some(inverse) = unit.cholesky().map(|factors| factors.inverse()) else {
        return errors;
    };
    let variance = error / left as f64;
    for i in (0..5).filter(|i| used[*i]) {
        errors[i] = (variance * inverse[(i, i)]).sqrt() / roots[i];
    }
    errors
}
