//! What the statements about the errors need of each reading: its value by the model, its residual,
//! its influence on the parameters, and the patch and the incidence that it belongs to.

use std::f64::consts::PI;

use brdf_core::ModelParameters;
use nalgebra::DMatrix;

use super::variance_components::{Patch, Terms, WHITE};
use crate::fit::Solution;
use crate::model::Parameter;
use crate::scan::{Measurement, Measurements};

/// J^T J, its columns scaled to length 1, counts as singular when its smallest eigenvalue is below
/// this.
const SMALLEST_EIGENVALUE: f64 = 1e-12;

/// The width of a patch in the plane of incidence, in radians: 20 deg.
const PATCH: f64 = 20.0 * PI / 180.0;

/// The width of a patch in azimuth, outside the plane of incidence, in radians: 30 deg.
const AZIMUTH_PATCH: f64 = 30.0 * PI / 180.0;

/// The two ways in which the views of an incidence are divided into patches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Grid {
    /// A patch is centred on the mirror direction.
    Centred,
    /// An edge of two patches is at the mirror direction.
    Edged,
}

impl Grid {
    pub(super) const BOTH: [Self; 2] = [Self::Centred, Self::Edged];

    fn offset(self) -> f64 {
        match self {
            Self::Centred => 0.5,
            Self::Edged => 0.0,
        }
    }
}

/// The source of the variances of independent errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Source {
    /// The residuals: a constant, one in proportion to |mu|, and one in proportion to mu^2.
    Residuals,
    /// The standard deviations that the scan states, with a factor.
    Stated,
}

/// The readings of non-zero weight of a fit, in the order of the objective.
#[derive(Debug, Clone)]
pub(super) struct Readings<const P: usize> {
    /// The rms of the model's values of f_r cos theta, in 1/sr.
    pub(super) rms: f64,
    /// (sum w J J^T)^-1, in squares of the parameters over squares of f_r cos theta.
    pub(super) bread: [[f64; P]; P],
    /// sum w J r, r = measured less model.
    pub(super) score: [f64; P],
    rows: Vec<Row<P>>,
    /// The number of incidences.
    pub(super) incidences: usize,
    /// The number of incidences with at least three readings.
    pub(super) full_incidences: usize,
}

#[derive(Debug, Clone)]
struct Row<const P: usize> {
    size: f64,
    residual: f64,
    slopes: [f64; P],
    influence: [f64; P],
    white: [f64; WHITE],
    incidence: usize,
    view: View,
}

/// Where the view lies, for the division into patches.
#[derive(Debug, Clone, Copy)]
enum View {
    /// The signed angle from the mirror direction in the plane of incidence.
    InPlane(f64),
    /// Zenith angle and azimuth.
    Outside(f64, f64),
}

impl View {
    fn patch(self, grid: Grid) -> (i64, i64) {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "angles of a few rad are a few patches"
        )]
        let cell = |angle: f64, width: f64| (angle / width + grid.offset()).floor() as i64;
        match self {
            Self::InPlane(angle) => (cell(angle, PATCH), 0),
            Self::Outside(zenith, azimuth) => (cell(zenith, PATCH), cell(azimuth, AZIMUTH_PATCH)),
        }
    }
}

/// The view of each reading: by the signed angle where the whole scan lies in the plane of incidence,
/// else by zenith and azimuth.
fn views(readings: &[Measurement]) -> Vec<View> {
    let in_plane: Option<Vec<View>> = readings
        .iter()
        .map(|reading| {
            let theta = reading.in_plane_theta()?;
            Some(View::InPlane(theta + reading.psi))
        })
        .collect();
    in_plane.unwrap_or_else(|| readings.iter().map(outside).collect())
}

fn outside(reading: &Measurement) -> View {
    let half_turn = if reading.theta < 0.0 { PI } else { 0.0 };
    let azimuth = (reading.phi + half_turn).rem_euclid(2.0 * PI);
    View::Outside(reading.theta.abs(), azimuth)
}

impl<const P: usize> Readings<P> {
    /// The readings of a fit with the derivatives by some of its parameters; `None` where the readings
    /// do not distinguish these.
    ///
    /// Each row of the objective has to be a reading of the measurements.
    pub(super) fn new(
        measurements: &Measurements,
        fitted: &Solution,
        at: &ModelParameters,
        parameters: [Parameter; P],
        source: Source,
    ) -> Option<Self> {
        let objective = fitted.without_loss();
        let loss_weight = |i: usize| fitted.robust().map_or(1.0, |robust| robust.weights[i]);
        let mean_slope = fitted.robust().map_or(1.0, |robust| robust.mean_slope);
        let jacobian = objective.jacobian(at, &parameters);
        let residuals = objective.residuals(at);
        let weights = objective.row_weights();
        let views = views(measurements.readings());
        let mut rows = Vec::with_capacity(residuals.len());
        let (mut matrix, mut score) = (DMatrix::zeros(P, P), [0.0; P]);
        let mut weighted = Vec::with_capacity(residuals.len());
        let (mut full_incidences, mut incidences) = (0, 0);
        for segment in objective.segments() {
            let before = rows.len();
            for i in segment.rows.clone() {
                let (scale, damping) = (weights[i], loss_weight(i));
                if scale == 0.0 || damping == 0.0 {
                    continue;
                }
                let reading = objective.readings()[i];
                let slopes: [f64; P] = std::array::from_fn(|c| jacobian[(i, c)] / scale);
                let residual = -residuals[i].0 / scale * damping;
                let weight = scale * scale;
                for c in 0..P {
                    score[c] += weight * slopes[c] * residual;
                    for d in 0..P {
                        matrix[(c, d)] += weight * slopes[c] * slopes[d];
                    }
                }
                weighted.push(weight);
                rows.push(Row {
                    size: ((residuals[i].0 + residuals[i].1) / scale).abs(),
                    residual,
                    slopes,
                    influence: [0.0; P],
                    white: [measurements.readings()[reading].sigma.unwrap_or(0.0)
                        * measurements.readings()[reading].theta.cos(); WHITE],
                    incidence: incidences,
                    view: views[reading],
                });
            }
            if rows.len() > before {
                incidences += 1;
                full_incidences += usize::from(rows.len() - before >= 3);
            }
        }
        let bread = inverse(&matrix)? / mean_slope;
        let bread: [[f64; P]; P] =
            std::array::from_fn(|c| std::array::from_fn(|d| bread[(c, d)]));
        let squares: f64 = rows.iter().map(|row| row.size * row.size).sum();
        let rms = (squares / rows.len() as f64).sqrt();
        for (row, weight) in rows.iter_mut().zip(weighted) {
            row.influence = std::array::from_fn(|c| {
                weight * (0..P).map(|d| bread[c][d] * row.slopes[d]).sum::<f64>()
            });
            row.size /= rms;
            row.residual /= rms;
            row.white = match source {
                Source::Residuals => [1.0, row.size, row.size * row.size],
                Source::Stated => [(row.white[0] / rms).powi(2), 0.0, 0.0],
            };
        }
        Some(Self {
            rms,
            bread,
            score,
            rows,
            incidences,
            full_incidences,
        })
    }

    /// The number of readings.
    pub(super) fn count(&self) -> usize {
        self.rows.len()
    }

    /// The size of each reading, and its squared residual over what it is expected to be for
    /// independent errors of constant size.
    pub(super) fn sizes_and_squares(&self) -> Vec<(f64, f64)> {
        let leverage = |row: &Row<P>| -> f64 {
            (0..P).map(|c| row.influence[c] * row.slopes[c]).sum()
        };
        self.rows
            .iter()
            .map(|row| {
                let expected = (1.0 - leverage(row)).max(f64::MIN_POSITIVE);
                (row.size, row.residual * row.residual / expected)
            })
            .collect()
    }

    /// The readings sorted by the patches of a grid, with their influence on each parameter.
    pub(super) fn sorted(&self, grid: Grid) -> (Terms<P>, [Vec<f64>; P]) {
        let mut order: Vec<(usize, (i64, i64), usize)> = self
            .rows
            .iter()
            .enumerate()
            .map(|(i, row)| (row.incidence, row.view.patch(grid), i))
            .collect();
        order.sort_unstable();
        let mut patches: Vec<Patch> = Vec::new();
        let mut last = None;
        for (i, &(incidence, cell, _)) in order.iter().enumerate() {
            match patches.last_mut() {
                Some(patch) if last == Some((incidence, cell)) => patch.rows.end = i + 1,
                _ => patches.push(Patch {
                    rows: i..i + 1,
                    incidence,
                }),
            }
            last = Some((incidence, cell));
        }
        let column = |of: &dyn Fn(&Row<P>) -> f64| -> Vec<f64> {
            order.iter().map(|&(_, _, i)| of(&self.rows[i])).collect()
        };
        let terms = Terms {
            size: column(&|row| row.size),
            residual: column(&|row| row.residual),
            slopes: std::array::from_fn(|c| column(&|row| row.slopes[c])),
            white: std::array::from_fn(|k| column(&|row| row.white[k])),
            patches,
            incidences: self.incidences,
        };
        let influence = std::array::from_fn(|c| column(&|row| row.influence[c]));
        (terms, influence)
    }
}

/// The inverse of J^T J; `None` where it is singular.
///
/// The columns of J are scaled to length 1 first, so that the units of the parameters do not affect
/// the condition of the matrix.
fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let scale: Vec<f64> = matrix.diagonal().iter().map(|d| d.sqrt()).collect();
    // Without any parameter there is no covariance.
    if scale.is_empty() || scale.iter().any(|s| !(*s > 0.0 && s.is_finite())) {
        return None;
    }
    let scaled = |m: &DMatrix<f64>| {
        DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| {
            m[(i, j)] / (scale[i] * scale[j])
        })
    };
    let correlation = scaled(matrix);
    if correlation.symmetric_eigenvalues().min() < SMALLEST_EIGENVALUE {
        return None;
    }
    Some(scaled(&correlation.cholesky()?.inverse()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_of_a_badly_scaled_matrix_is_exact_and_of_a_singular_one_is_none() {
        let matrix = DMatrix::from_row_slice(2, 2, &[4e12, 1e6, 1e6, 1.0]);
        let product = inverse(&matrix).unwrap() * &matrix;
        assert!((product - DMatrix::identity(2, 2)).norm() < 1e-8);
        let singular = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 4.0]);
        assert_eq!(inverse(&singular), None);
        assert_eq!(inverse(&DMatrix::zeros(0, 0)), None);
    }
}
