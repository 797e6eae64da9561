//! The search of scans with gaps or with weights of their own, from the scalar products of each scan.

use brdf_core::ModelParameters;
use nalgebra::{DMatrix, DMatrixView};
use pulp::{Simd, WithSimd};

use super::along::Along;
use super::plan::BatchPlan;
use crate::model::{FAINT, FEW_READINGS, Grid, PLAIN, ReducedModel, faint};
use crate::objective::{
    LobeColumns, Objective, PROCESSOR, ProfileSums, demand_for_lobe, dot_of, solve_for,
};
use crate::solver::descent::{Descent, Rows};

/// The number of scans that are searched together.
pub(super) const BLOCK: usize = 64;

/// The scans of a block are filled up to a multiple of this: the products of a few columns have other sums.
const FULL: usize = 8;

/// The largest number of minima of the grid from which a scan descends.
const MOST_MINIMA: usize = 8;

/// Where several parameters are searched, minima that are higher than the lowest one by more than this
/// fraction of the readings' squares are not followed.
const WORSE: f64 = 0.02;

/// The same where k1 alone is searched: a minimum between two widths is not much lower than the grid.
const WORSE_ALONG_K1: f64 = 0.01;

/// Minima that are no deeper than this fraction of the readings' squares are rounding, except the lowest.
const ROUNDING: f64 = 1e-14;

/// A lobe's column is parallel to the diffuse one where the square of its rest is less than this fraction.
const COLLINEAR: f64 = 1e-14;

/// The columns of the grid and their products, for scans of any weights.
#[derive(Debug, Clone)]
pub(super) struct OwnTable {
    grid: Grid,
    /// u of each point of the grid, one row for each.
    lobes: DMatrix<f64>,
    /// u u of each point, and below them u a.
    products: DMatrix<f64>,
}

/// A scan with its own weights.
pub(super) struct OwnScan {
    /// y with these weights, of unit length.
    pub(super) y: Vec<f64>,
    /// The roots of the weights of its rows, 0 for a reading that was not taken.
    pub(super) factors: Vec<f64>,
    /// The diffuse column times these roots.
    pub(super) diffuse: Vec<f64>,
}

impl OwnScan {
    /// A scan whose y is not of unit length yet, and the number of its readings.
    pub(super) fn new(plan: &BatchPlan, readings: &[f64], weights: &[f64]) -> (Self, usize) {
        let rows = plan.factors.len();
        let mut scan = Self {
            y: Vec::with_capacity(rows),
            factors: Vec::with_capacity(rows),
            diffuse: Vec::with_capacity(rows),
        };
        let (_, a) = plan.objective.fixed_columns();
        let mut used = 0;
        let rows = plan.factors.iter().zip(a).zip(plan.objective.readings());
        for ((factor, a), &reading) in rows {
            let (value, weight) = (readings[reading], weights[reading]);
            let taken = !value.is_nan() && weight > 0.0 && *factor > 0.0;
            let own = if taken { weight.sqrt() } else { 0.0 };
            scan.factors.push(own);
            scan.diffuse.push(own * a);
            scan.y.push(if taken { own * factor * value } else { 0.0 });
            used += usize::from(taken);
        }
        (scan, used)
    }

    /// Divides y by its length, given its largest value. Its length.
    pub(super) fn normalise(&mut self, largest: f64) -> f64 {
        for y in &mut self.y {
            *y /= largest;
        }
        let length = super::basis::norm(&self.y);
        for y in &mut self.y {
            *y /= length;
        }
        largest * length
    }

    pub(super) fn rows(&self) -> Rows<'_> {
        Rows {
            y: &self.y,
            factors: Some(&self.factors),
        }
    }
}

impl OwnTable {
    pub(super) fn new(objective: &Objective, model: ReducedModel) -> Self {
        let grid = Grid::new(model, objective.n(), objective.count(), 1);
        let column = |i| objective.lobe_column(&with_lobe(grid.at(i)));
        let columns: Vec<Vec<f64>> = (0..grid.len()).map(column).collect();
        let (_, a) = objective.fixed_columns();
        let points = columns.len();
        Self {
            lobes: DMatrix::from_fn(points, a.len(), |i, row| columns[i][row]),
            products: DMatrix::from_fn(2 * points, a.len(), |i, row| {
                let u = columns[i % points][row];
                u * if i < points { u } else { a[row] }
            }),
            grid,
        }
    }
}

/// The search of some scans.
pub(super) struct OwnSearch<'a> {
    plan: &'a BatchPlan,
    table: &'a OwnTable,
    /// Along k1 with the weights that the search there knows: whether there is a diffuse part.
    along_k1: Option<bool>,
    /// u u and u a of each point, one column for each scan, and u y.
    products: DMatrix<f64>,
    measured: DMatrix<f64>,
    /// E of each point of the grid.
    errors: Vec<f64>,
    /// The demand for a lobe at each point.
    demands: Vec<f64>,
}

impl<'a> OwnSearch<'a> {
    pub(super) fn new(plan: &'a BatchPlan) -> Self {
        let table = plan.own();
        // Where the columns of the plan are no polynomials between two widths, E may have minima there that
        // no slope at the widths shows.
        let is_smooth = plan.table.as_ref().is_some_and(|table| table.is_smooth);
        let along_k1 = match plan.model.fixed_weights() {
            _ if !is_smooth => None,
            [None, None] => Some(true),
            [None, Some(0.0)] => Some(false),
            _ => None,
        };
        let points = table.grid.len();
        Self {
            plan,
            table,
            along_k1,
            products: DMatrix::zeros(0, 0),
            measured: DMatrix::zeros(0, 0),
            errors: vec![0.0; points],
            demands: vec![0.0; points],
        }
    }

    /// The scalar products of some scans with the columns of the grid.
    pub(super) fn project(&mut self, scans: &[OwnScan]) {
        let table = self.table;
        let rows = table.lobes.ncols();
        let columns = scans.len().next_multiple_of(FULL);
        let mut weights = vec![0.0; rows * columns];
        let mut weighted = vec![0.0; rows * columns];
        for (i, scan) in scans.iter().enumerate() {
            let at = i * rows..(i + 1) * rows;
            let to = weights[at.clone()].iter_mut().zip(&mut weighted[at]);
            for ((weight, weighted), (y, factor)) in to.zip(scan.y.iter().zip(&scan.factors)) {
                *weight = factor * factor;
                *weighted = factor * y;
            }
        }
        self.products = &table.products * DMatrixView::from_slice(&weights, rows, columns);
        self.measured = &table.lobes * DMatrixView::from_slice(&weighted, rows, columns);
    }

    /// The optimum of scan `i`, of `used` readings.
    pub(super) fn optimum(
        &mut self,
        i: usize,
        scan: &OwnScan,
        used: usize,
        columns: &mut LobeColumns,
    ) -> ModelParameters {
        match self.along_k1 {
            // Few readings are nearly interpolated: their E may have minima between the widths of the grid.
            Some(has_diffuse) if used >= FEW_READINGS => {
                self.along_k1(i, scan, has_diffuse, columns)
            }
            _ => self.descended(i, scan),
        }
    }

    /// The optimum by descents along all nonlinear parameters.
    fn descended(&mut self, i: usize, scan: &OwnScan) -> ModelParameters {
        let points = self.table.grid.len();
        let fixed = self.plan.model.fixed_weights();
        let (aa, ay) = (
            dot_of(&scan.diffuse, &scan.diffuse),
            dot_of(&scan.diffuse, &scan.y),
        );
        let mut plain = f64::INFINITY;
        for (j, error) in self.errors.iter_mut().enumerate() {
            let (uu, ua) = (self.products[(j, i)], self.products[(points + j, i)]);
            let uy = self.measured[(j, i)];
            let sums = ProfileSums { uu, ua, uy, aa, ay };
            self.demands[j] = demand_for_lobe(fixed[1], &sums);
            let k2;
            (k2, _, *error) = solve_for(fixed, &sums);
            if k2 == 0.0 {
                plain = *error;
            }
        }
        self.lowest(plain, scan.rows())
    }

    /// The optimum along k1 alone.
    fn along_k1(
        &mut self,
        i: usize,
        scan: &OwnScan,
        has_diffuse: bool,
        columns: &mut LobeColumns,
    ) -> ModelParameters {
        let points = self.table.grid.len();
        let products = &self.products.as_slice()[2 * points * i..2 * points * (i + 1)];
        let (squares, mixed) = products.split_at(points);
        let plain = PROCESSOR.dispatch(OfGrid {
            scan,
            has_diffuse,
            squares,
            mixed,
            measured: &self.measured.as_slice()[points * i..points * (i + 1)],
            errors: &mut self.errors,
            demands: &mut self.demands,
        });
        let [_, n, p] = self.table.grid.at(0);
        let along = Along::new(self.plan, scan, [n, p], has_diffuse);
        let best = self
            .followed(plain)
            .into_iter()
            .map(|point| {
                let widths = &self.table.grid.axes[0];
                along.lowest_near(widths, &self.errors, point, columns)
            })
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let k1 = best.map_or(self.table.grid.at(0)[0], |(k1, _)| k1);
        with_lobe([k1, n, p])
    }

    /// The points of the grid near which the optimum may lie, E without a lobe being `plain`.
    fn followed(&self, plain: f64) -> Vec<usize> {
        let errors = &self.errors;
        let lowest = errors.iter().copied().fold(f64::INFINITY, f64::min);
        let beyond = |i: usize| errors.get(i).copied().unwrap_or(f64::INFINITY);
        let is_minimum = |&i: &usize| {
            let here = errors[i];
            let (left, right) = (beyond(i.wrapping_sub(1)), beyond(i + 1));
            here <= lowest + WORSE_ALONG_K1
                && here < left
                && here <= right
                && (here == lowest || here < left.min(right) - ROUNDING)
        };
        let mut points: Vec<usize> = (0..errors.len()).filter(is_minimum).collect();
        points.sort_by(|a, b| errors[*a].total_cmp(&errors[*b]));
        points.truncate(MOST_MINIMA);
        points.extend(self.faint(plain - lowest));
        points
    }

    /// Points next to which a faint lobe may lie, where the grid has gained `gained` by lobes.
    fn faint(&self, gained: f64) -> Vec<usize> {
        let demand = |i: usize| self.demands[i];
        let adjacent = |i: usize| self.table.grid.adjacent(i);
        faint(demand, adjacent, self.demands.len(), gained, FAINT)
    }

    /// The lowest of the minima below those of the grid, E without a lobe being `plain`.
    fn lowest(&self, plain: f64, rows: Rows<'_>) -> ModelParameters {
        let (grid, errors) = (&self.table.grid, &self.errors);
        let lowest = errors.iter().copied().fold(f64::INFINITY, f64::min);
        let worse = if grid.is_along_k1() {
            WORSE_ALONG_K1
        } else {
            WORSE
        };
        let is_minimum = |&i: &usize| {
            errors[i] <= lowest + worse
                && grid
                    .adjacent(i)
                    .all(|j| errors[i] < errors[j] || (errors[i] == errors[j] && i < j))
        };
        let mut minima: Vec<usize> = (0..errors.len()).filter(is_minimum).collect();
        minima.sort_by(|a, b| errors[*a].total_cmp(&errors[*b]));
        minima.truncate(MOST_MINIMA);
        for i in 0..minima.len() {
            let is_plain = |j: usize| errors[j] <= errors[minima[i]] * (1.0 + PLAIN);
            let widest = grid.widest_of_plain(minima[i], is_plain);
            if !minima.contains(&widest) {
                minima.push(widest);
            }
        }
        minima.extend(self.faint(plain - lowest));
        let descent = Descent {
            objective: &self.plan.objective,
            model: self.plan.model,
        };
        let starts = minima.into_iter().map(|i| with_lobe(grid.at(i)));
        descent
            .lowest(starts, rows)
            .map_or(with_lobe(grid.at(0)), |(at, _)| at)
    }
}

/// E of each point of the grid with the best weights, and the demand for a lobe there; E without a lobe.
struct OfGrid<'a> {
    scan: &'a OwnScan,
    has_diffuse: bool,
    squares: &'a [f64],
    mixed: &'a [f64],
    measured: &'a [f64],
    errors: &'a mut [f64],
    demands: &'a mut [f64],
}

impl WithSimd for OfGrid<'_> {
    type Output = f64;

    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a function that is not inlined is not compiled for the present processor"
    )]
    fn with_simd<V: Simd>(self, _: V) -> f64 {
        let OwnScan { y, diffuse, .. } = self.scan;
        let (aa, ay) = if self.has_diffuse {
            (dot_of(diffuse, diffuse), dot_of(diffuse, y))
        } else {
            (1.0, 0.0)
        };
        let per_square = 1.0 / aa;
        let of_diffuse = ay * per_square;
        let positive = |x: f64| if x > 0.0 { x } else { 0.0 };
        let plain = positive(ay) * of_diffuse;
        let rows = self.squares.iter().zip(self.mixed).zip(self.measured);
        let to = self.errors.iter_mut().zip(self.demands);
        for ((error, demand), ((uu, ua), uy)) in to.zip(rows) {
            let ua = if self.has_diffuse { *ua } else { 0.0 };
            let rest = uu - ua * ua * per_square;
            let along = uy - ua * of_diffuse;
            // Comparisons rather than `max`: they become vector code.
            let is_apart = rest > COLLINEAR * uu;
            let safe = if is_apart { rest } else { 1.0 };
            let both = ay * of_diffuse + along * along / safe;
            let lobe = positive(*uy);
            let alone = lobe * lobe / if *uu > 0.0 { *uu } else { 1.0 };
            // kD < 0 where the lobe takes more than there is.
            let without_diffuse = ay * rest < ua * along || !is_apart;
            let with_lobe = if without_diffuse { alone } else { both };
            let has_lobe = if is_apart { along > 0.0 } else { alone > plain };
            *error = 1.0 - if has_lobe { with_lobe } else { plain };
            *demand = if ay > 0.0 {
                along / safe.sqrt()
            } else {
                *uy / if *uu > 0.0 { uu.sqrt() } else { 1.0 }
            };
        }
        1.0 - plain
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
