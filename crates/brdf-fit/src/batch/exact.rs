//! The last pass: the best weights, E and standard errors from exact columns.

use brdf_core::ModelParameters;
use nalgebra::{DMatrix, DVector};

use super::plan::BatchPlan;
use crate::model::{K1_RANGE, Parameter, ReducedModel};
use crate::objective::{Objective, ProfileSums, solve_for};
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
    let BatchPlan {
        objective, model, ..
    } = plan;
    match &plan.fixed_index {
        Some(of_rows) => {
            lobe.resize(objective.len(), 0.0);
            of_rows.column(at.k1, at.p, lobe);
        }
        None => *lobe = objective.lobe_column(&at),
    }
    let (_, a) = objective.fixed_columns();
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
    let dot = crate::objective::dot_of;
    let sums = ProfileSums {
        uu: dot(lobe, lobe),
        ua: dot(lobe, a),
        uy: dot(lobe, rows.y),
        aa: dot(a, a),
        ay: dot(a, rows.y),
    };
    let fixed = model.fixed_weights();
    let (mut k2, mut kd, _) = solve_for(fixed, &sums);
    if k2 * sums.uu.sqrt() <= NO_LOBE && model.frees(Parameter::K2) {
        (k2, kd, _) = solve_for([Some(0.0), fixed[1]], &sums);
    }
    for ((u, a), y) in lobe.iter_mut().zip(a).zip(rows.y) {
        *u = k2 * *u + kd * a - y;
    }
    (ModelParameters { k2, kd, ..at }, dot(lobe, lobe))
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
    let free: Vec<Parameter> = model.free().iter().copied().filter(determined).collect();
    let left = readings.saturating_sub(model.free().len());
    if free.is_empty() || left == 0 {
        return errors;
    }
    let derivatives = [Parameter::K1, Parameter::N, Parameter::P].map(|p| free.contains(&p));
    let products = Products::at(objective, at, derivatives, rows);
    let place = |parameter: Parameter| Parameter::ALL.iter().position(|p| *p == parameter);
    let places: Vec<usize> = free
        .iter()
        .filter_map(|parameter| place(*parameter))
        .collect();
    let scale = |i: usize| if i < 2 { 1.0 } else { at.k2 };
    let matrix = DMatrix::from_fn(places.len(), places.len(), |i, j| {
        let (i, j) = (places[i], places[j]);
        products.of(i, j) * scale(i) * scale(j)
    });
    // With unit diagonal, so that the sizes of the columns do not matter.
    let roots = DVector::from_fn(places.len(), |i, _| matrix[(i, i)].sqrt());
    let unit = DMatrix::from_fn(places.len(), places.len(), |i, j| {
        matrix[(i, j)] / (roots[i] * roots[j])
    });
    let Some(inverse) = unit.cholesky().map(|factors| factors.inverse()) else {
        return errors;
    };
    let variance = error / left as f64;
    for (i, &place) in places.iter().enumerate() {
        errors[place] = (variance * inverse[(i, i)]).sqrt() / roots[i];
    }
    errors
}
