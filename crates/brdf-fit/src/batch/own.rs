//! The search of scans with gaps or with weights of their own, from the scalar products of each scan.

use brdf_core::ModelParameters;
use nalgebra::{DMatrix, DMatrixView};

use crate::model::{Grid, PLAIN, ReducedModel};
use crate::objective::{Objective, ProfileSums, solve_for};
use crate::solver::descent::{Descent, Rows};

/// The number of scans that are searched together.
pub(super) const BLOCK: usize = 32;

/// The largest number of minima of the grid from which a scan descends.
const MOST_MINIMA: usize = 8;

/// Where several parameters are searched, minima that are higher than the lowest one by more than this
/// fraction of the readings' squares are not followed.
const WORSE: f64 = 0.02;

/// The same where k1 alone is searched: a minimum between two widths is not much lower than the grid.
const WORSE_ALONG_K1: f64 = 0.01;

/// The columns of the grid and their products, for scans of any weights.
#[derive(Debug, Clone)]
pub(super) struct OwnTable {
    grid: Grid,
    /// u, u u and u a of each point of the grid, one row for each.
    lobes: DMatrix<f64>,
    squares: DMatrix<f64>,
    mixed: DMatrix<f64>,
}

/// A scan with its own weights: y of unit length with these weights.
pub(super) struct OwnScan {
    pub(super) y: Vec<f64>,
    /// The roots of the weights of its rows, 0 for a reading that was not taken.
    pub(super) factors: Vec<f64>,
}

impl OwnTable {
    pub(super) fn new(objective: &Objective, model: ReducedModel) -> Self {
        let grid = Grid::new(model, objective.n(), objective.count(), 1);
        let column = |i| objective.lobe_column(&with_lobe(grid.at(i)));
        let columns: Vec<Vec<f64>> = (0..grid.len()).map(column).collect();
        let (_, a) = objective.fixed_columns();
        let matrix = |of: &dyn Fn(f64, f64) -> f64| {
            DMatrix::from_fn(columns.len(), a.len(), |i, row| of(columns[i][row], a[row]))
        };
        Self {
            lobes: matrix(&|u, _| u),
            squares: matrix(&|u, _| u * u),
            mixed: matrix(&|u, a| u * a),
            grid,
        }
    }

    /// The optima of some scans.
    pub(super) fn optima(&self, descent: &Descent<'_>, scans: &[OwnScan]) -> Vec<ModelParameters> {
        let rows = self.lobes.ncols();
        let mut weights = vec![0.0; rows * scans.len()];
        let mut weighted = vec![0.0; rows * scans.len()];
        for (i, scan) in scans.iter().enumerate() {
            let at = i * rows..(i + 1) * rows;
            let to = weights[at.clone()].iter_mut().zip(&mut weighted[at]);
            for ((weight, weighted), (y, factor)) in to.zip(scan.y.iter().zip(&scan.factors)) {
                *weight = factor * factor;
                *weighted = factor * y;
            }
        }
        let view = |values| DMatrixView::from_slice(values, rows, scans.len());
        let squares = &self.squares * view(&weights);
        let mixed = &self.mixed * view(&weights);
        let measured = &self.lobes * view(&weighted);
        let (_, a) = descent.objective.fixed_columns();
        let one = |(i, scan): (usize, &OwnScan)| {
            let weights = &weights[i * rows..(i + 1) * rows];
            let weighted = &weighted[i * rows..(i + 1) * rows];
            let aa = a.iter().zip(weights).map(|(a, g)| a * a * g).sum();
            let ay = a.iter().zip(weighted).map(|(a, y)| a * y).sum();
            let fixed = descent.model.fixed_weights();
            let point = |j: usize| {
                let (uu, ua, uy) = (squares[(j, i)], mixed[(j, i)], measured[(j, i)]);
                solve_for(fixed, &ProfileSums { uu, ua, uy, aa, ay }).2
            };
            let errors: Vec<f64> = (0..self.lobes.nrows()).map(point).collect();
            let rows = Rows {
                y: &scan.y,
                factors: Some(&scan.factors),
            };
            self.lowest(descent, &errors, rows)
        };
        scans.iter().enumerate().map(one).collect()
    }

    /// The lowest of the minima below those of the grid.
    fn lowest(&self, descent: &Descent<'_>, errors: &[f64], rows: Rows<'_>) -> ModelParameters {
        let lowest = errors.iter().copied().fold(f64::INFINITY, f64::min);
        let worse = if self.grid.is_along_k1() {
            WORSE_ALONG_K1
        } else {
            WORSE
        };
        let is_minimum = |&i: &usize| {
            errors[i] <= lowest + worse
                && self
                    .grid
                    .adjacent(i)
                    .all(|j| errors[i] < errors[j] || (errors[i] == errors[j] && i < j))
        };
        let mut minima: Vec<usize> = (0..errors.len()).filter(is_minimum).collect();
        minima.sort_by(|a, b| errors[*a].total_cmp(&errors[*b]));
        minima.truncate(MOST_MINIMA);
        for i in 0..minima.len() {
            let is_plain = |j: usize| errors[j] <= errors[minima[i]] * (1.0 + PLAIN);
            let widest = self.grid.widest_of_plain(minima[i], is_plain);
            if !minima.contains(&widest) {
                minima.push(widest);
            }
        }
        let descents = minima
            .into_iter()
            .map(|i| descent.from(with_lobe(self.grid.at(i)), rows));
        let best = descents.min_by(|a, b| a.1.total_cmp(&b.1));
        best.map_or(with_lobe(self.grid.at(0)), |(at, _)| at)
    }
}

/// The lobe alone at a point of the grid.
fn with_lobe([k1, n, p]: [f64; 3]) -> ModelParameters {
    ModelParameters {
        k2: 1.0,
        kd: 0.0,
        k1,
        n,
        p,
    }
}
