//! What the statements about the errors need of each reading: its value by the model, its residual,
//! its influence on the parameters, and the patch and the incidence that it belongs to.

use std::f64::consts::PI;

use brdf_core::ModelParameters;
use nalgebra::DMatrix;

use super::variance_components::{INDEPENDENT, Patch, Term, Terms, WHITE, estimate};
use crate::fit::Solution;
use crate::format::in_degrees;
use crate::model::Parameter;
use crate::scan::{Measurement, Measurements};

/// J^T J, its columns scaled to length 1, counts as singular when its smallest eigenvalue is below
/// this.
const SMALLEST_EIGENVALUE: f64 = 1e-12;

/// The width of a patch in the plane of incidence, in degrees.
const PATCH_DEG: f64 = 20.0;

/// The width of a patch in azimuth, outside the plane of incidence, in degrees.
const AZIMUTH_PATCH_DEG: f64 = 30.0;

/// The least expected slope of a robust loss.
const LEAST_SLOPE: f64 = 0.05;

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
    term: Term<P>,
    /// The root of the weight of the reading in E.
    weight: f64,
    /// w (sum w J J^T)^-1 J.
    influence: [f64; P],
    incidence: usize,
    /// The index of the row in the objective.
    index: usize,
    view: View,
}

/// Where the view lies, for the division into patches: in degrees, in which the edges of patches and
/// the settings of a goniometer are round numbers.
#[derive(Debug, Clone, Copy)]
enum View {
    /// The signed angle from the mirror direction in the plane of incidence.
    InPlane(f64),
    /// Zenith angle and azimuth.
    Outside(f64, f64),
}

impl View {
    fn patch(self, grid: Grid) -> (i64, i64) {
        #[expect(clippy::cast_possible_truncation, reason = "angles are a few patches")]
        let cell = |angle: f64, width: f64| (angle / width + grid.offset()).floor() as i64;
        match self {
            Self::InPlane(angle) => (cell(angle, PATCH_DEG), 0),
            Self::Outside(zenith, azimuth) => {
                (cell(zenith, PATCH_DEG), cell(azimuth, AZIMUTH_PATCH_DEG))
            }
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
            Some(View::InPlane(in_degrees(theta) + in_degrees(reading.psi)))
        })
        .collect();
    in_plane.unwrap_or_else(|| readings.iter().map(outside).collect())
}

fn outside(reading: &Measurement) -> View {
    let half_turn = if reading.theta < 0.0 { PI } else { 0.0 };
    let azimuth = (reading.phi + half_turn).rem_euclid(2.0 * PI);
    View::Outside(in_degrees(reading.theta.abs()), in_degrees(azimuth))
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
        let mut readings = Self::unweighted(measurements, fitted, at, parameters);
        let slopes = readings.loss_slopes(fitted);
        let (mut matrix, mut score) = (DMatrix::zeros(P, P), [0.0; P]);
        for (row, slope) in readings.rows.iter().zip(&slopes) {
            let weight = row.weight * row.weight;
            let derivatives = &row.term.slopes;
            for c in 0..P {
                score[c] += weight * derivatives[c] * row.term.residual;
                for d in 0..P {
                    matrix[(c, d)] += slope * weight * derivatives[c] * derivatives[d];
                }
            }
        }
        let bread = inverse(&matrix)?;
        readings.bread = std::array::from_fn(|c| std::array::from_fn(|d| bread[(c, d)]));
        readings.score = score;
        readings.normalise(source);
        Some(readings)
    }

    /// The readings of non-zero weight in units of f_r cos theta, without their influence.
    fn unweighted(
        measurements: &Measurements,
        fitted: &Solution,
        at: &ModelParameters,
        parameters: [Parameter; P],
    ) -> Self {
        let objective = fitted.without_loss();
        let jacobian = objective.jacobian(at, &parameters);
        let residuals = objective.residuals(at);
        let weights = objective.row_weights();
        let views = views(measurements.readings());
        let loss_weight = |i: usize| fitted.robust().map_or(1.0, |robust| robust.weights[i]);
        let mut readings = Self {
            rms: 0.0,
            bread: [[0.0; P]; P],
            score: [0.0; P],
            rows: Vec::with_capacity(residuals.len()),
            incidences: 0,
            full_incidences: 0,
        };
        for segment in objective.segments() {
            let before = readings.rows.len();
            for i in segment.rows.clone() {
                let (weight, damping) = (weights[i], loss_weight(i));
                if weight == 0.0 || damping == 0.0 {
                    continue;
                }
                let own = objective.readings()[i];
                let reading = &measurements.readings()[own];
                let (r, y) = residuals[i];
                let sigma = reading.sigma.unwrap_or(0.0) * reading.theta.cos();
                readings.rows.push(Row {
                    term: Term {
                        size: ((r + y) / weight).abs(),
                        residual: -r / weight * damping,
                        slopes: std::array::from_fn(|c| jacobian[(i, c)] / weight),
                        white: [sigma; WHITE],
                    },
                    weight,
                    influence: [0.0; P],
                    incidence: readings.incidences,
                    index: i,
                    view: views[own],
                });
            }
            let used = readings.rows.len() - before;
            readings.incidences += usize::from(used > 0);
            readings.full_incidences += usize::from(used >= 3);
        }
        readings
    }

    /// The expected derivative of a robust loss's weight times residual by the residual, of each
    /// reading, for normal errors of the size that independent errors t1 + t3 mu^2 have here. 1 without
    /// such a loss. The derivative at the residual itself says little: it is 0 or 1 for Huber's loss.
    fn loss_slopes(&self, fitted: &Solution) -> Vec<f64> {
        let Some(robust) = fitted.robust() else {
            return vec![1.0; self.rows.len()];
        };
        let squares: f64 = self.rows.iter().map(|row| row.term.size.powi(2)).sum();
        let rms = (squares / self.rows.len() as f64).sqrt();
        let term = |row: &Row<P>| {
            let size = row.term.size / rms;
            Term {
                size,
                // Without the weight of the loss.
                residual: row.term.residual / rms / robust.weights[row.index],
                slopes: row.term.slopes,
                white: [1.0, size, size * size],
            }
        };
        let terms = Terms {
            rows: self.rows.iter().map(term).collect(),
            patches: self
                .rows
                .iter()
                .enumerate()
                .map(|(i, row)| Patch {
                    rows: i..i + 1,
                    incidence: row.incidence,
                })
                .collect(),
            incidences: self.incidences,
        };
        let components = estimate(&terms, INDEPENDENT);
        self.rows
            .iter()
            .zip(&terms.rows)
            .map(|(row, term)| {
                let variance = components.white[0] + components.white[2] * term.white[2];
                let deviations = rms * variance.sqrt() * row.weight / robust.scale;
                robust.loss.expected_slope(deviations).max(LEAST_SLOPE)
            })
            .collect()
    }

    /// Divides by the rms of the model's values, and completes the influence and the variances.
    fn normalise(&mut self, source: Source) {
        let squares: f64 = self.rows.iter().map(|row| row.term.size.powi(2)).sum();
        self.rms = (squares / self.rows.len() as f64).sqrt();
        for row in &mut self.rows {
            let weight = row.weight * row.weight;
            row.influence = std::array::from_fn(|c| {
                let sum: f64 = (0..P).map(|d| self.bread[c][d] * row.term.slopes[d]).sum();
                weight * sum
            });
            let term = &mut row.term;
            term.size /= self.rms;
            term.residual /= self.rms;
            term.white = match source {
                Source::Residuals => [1.0, term.size, term.size * term.size],
                Source::Stated => [(term.white[0] / self.rms).powi(2), 0.0, 0.0],
            };
        }
    }

    /// The number of readings.
    pub(super) fn count(&self) -> usize {
        self.rows.len()
    }

    /// The size of each reading, and its squared residual over what it is expected to be for
    /// independent errors of constant size.
    pub(super) fn sizes_and_squares(&self) -> Vec<(f64, f64)> {
        let leverage =
            |row: &Row<P>| -> f64 { (0..P).map(|c| row.influence[c] * row.term.slopes[c]).sum() };
        self.rows
            .iter()
            .map(|row| {
                let expected = (1.0 - leverage(row)).max(f64::MIN_POSITIVE);
                (row.term.size, row.term.residual.powi(2) / expected)
            })
            .collect()
    }

    /// The readings sorted by the patches of a grid, with their influence on each parameter.
    pub(super) fn sorted(&self, grid: Grid) -> (Terms<P>, Vec<[f64; P]>) {
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
        let rows = || order.iter().map(|&(_, _, i)| &self.rows[i]);
        let terms = Terms {
            rows: rows().map(|row| row.term).collect(),
            patches,
            incidences: self.incidences,
        };
        (terms, rows().map(|row| row.influence).collect())
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
