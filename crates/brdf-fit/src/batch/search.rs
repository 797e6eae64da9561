//! The search of all scans of a block for their global optimum, in the basis of the plan.

#![expect(
    clippy::inline_always,
    reason = "a function that is not inlined is not compiled for the present processor"
)]

use nalgebra::{DMatrix, DMatrixView};
use pulp::{Simd, WithSimd};

use super::cell::{Cell, Line};
use super::table::{Angle, Table};
use crate::model::{FAINT, PLAIN, faint};
use crate::objective::PROCESSOR;

/// The number of scans that are searched together.
pub(super) const BLOCK: usize = 64;

/// The largest number of maxima of the grid that are followed.
const MOST_MAXIMA: usize = 16;

/// The largest number of maxima from which descents start.
const MOST_STARTS: usize = 8;

/// The same for few readings.
const MOST_STARTS_OF_FEW: usize = 32;

/// Where the explained squares differ by less than this fraction, they are equal: the maxima of a plain
/// are its rounding.
const ROUNDING: f64 = 1e-14;

/// Maxima whose explained squares differ by less than this fraction of all squares are told apart by
/// exact values.
const ALIKE: f64 = 1e-10;

/// The largest number of steps towards a maximum between two widths.
const MOST_STEPS: usize = 60;

/// Where several parameters are searched, maxima whose rest is larger than this multiple of the smallest
/// one ...
const WORSE: f64 = 8.0;

/// ... and than this fraction of all squares more are not followed: a minimum between the points of the
/// grid is not much lower than they are.
const MUCH: f64 = 2e-3;

/// The scalar products of the scans of a block, and the memory that they need.
pub(super) struct Search<'a> {
    table: &'a Table,
    /// The coordinates of each scan in the basis, one column for each.
    coordinates: DMatrix<f64>,
    /// The scalar product of each scan with v of each point of the grid, one column for each scan.
    beside: DMatrix<f64>,
    explained: Vec<f64>,
}

/// A width of a scan, and the part of its squares that the model explains there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    /// The index of the point of the grid.
    pub(super) point: usize,
    /// k1, n and p.
    pub(super) at: [f64; 3],
    pub(super) explained: f64,
}

impl Found {
    /// The only point of a model without a lobe.
    pub(super) fn without_lobe(n: f64) -> Self {
        Self {
            point: 0,
            at: [1.0, n, 1.0],
            explained: 0.0,
        }
    }
}

impl<'a> Search<'a> {
    pub(super) fn new(table: &'a Table) -> Self {
        let points = table.angles.len();
        Self {
            table,
            coordinates: DMatrix::zeros(table.dimension(), BLOCK),
            beside: DMatrix::zeros(points, BLOCK),
            explained: vec![0.0; points],
        }
    }

    /// Projects the readings of a block, one column for each scan.
    pub(super) fn project(&mut self, readings: &[f64]) {
        let table = self.table;
        let scans = DMatrixView::from_slice(readings, table.projection.ncols(), BLOCK);
        self.coordinates.gemm(1.0, &table.projection, &scans, 0.0);
        self.beside
            .gemm(1.0, &table.directions, &self.coordinates, 0.0);
    }

    /// The optima of scan `i` of the block, of squares `squares` in all: the best one, and those that
    /// explain as much within [`ALIKE`]. Where several parameters are searched, they are the starts of
    /// descents.
    pub(super) fn optima(&mut self, i: usize, squares: f64, to: &mut Vec<Found>) {
        PROCESSOR.dispatch(Optima {
            search: self,
            i,
            squares,
            to,
        });
    }

    #[inline(always)]
    fn find(&mut self, i: usize, squares: f64, to: &mut Vec<Found>) {
        to.clear();
        let table = self.table;
        let dimension = table.dimension();
        let coordinates = &self.coordinates.as_slice()[dimension * i..dimension * (i + 1)];
        let points = table.angles.len();
        let beside = &self.beside.as_slice()[points * i..points * (i + 1)];
        let diffuse = if table.has_diffuse {
            coordinates[0]
        } else {
            0.0
        };
        for ((explained, angle), beside) in self.explained.iter_mut().zip(&table.angles).zip(beside)
        {
            *explained = angle.explained(diffuse, *beside);
        }
        if table.cells.is_empty() {
            self.starts(diffuse, beside, squares, to);
            return;
        }
        self.follow(diffuse, beside, coordinates, squares, to);
        let best = to.iter().map(|found| found.explained).fold(0.0, f64::max);
        let alike = |found: &Found| (ALIKE + 4.0 * table.cells[found.point].error) * squares;
        to.retain(|found| found.explained >= best - alike(found));
    }

    /// Follows the maxima of the grid along ln k1 that may lead to the largest one.
    #[inline(always)]
    fn follow(
        &self,
        diffuse: f64,
        beside: &[f64],
        coordinates: &[f64],
        squares: f64,
        to: &mut Vec<Found>,
    ) {
        let (table, explained) = (self.table, &self.explained);
        let largest = largest(explained);
        let gain = 0.25 * table.curvature * super::basis::norm(coordinates);
        let least = (largest.sqrt() - gain).max(0.0).powi(2);
        let is_maximum = |&(i, &value): &(usize, &f64)| {
            let left = if i == 0 {
                f64::NEG_INFINITY
            } else {
                explained[i - 1]
            };
            let right = explained.get(i + 1).copied().unwrap_or(f64::NEG_INFINITY);
            let lower = value - ROUNDING * largest;
            value >= least
                && (value > left && value >= right)
                && (value == largest || left < lower && right < lower)
        };
        let maxima = explained.iter().enumerate().filter(is_maximum);
        to.extend(maxima.map(|(i, _)| self.found(i)));
        self.add_ends_of_plains(squares, to);
        self.add_faint(diffuse, beside, gain, to);
        if to.len() > MOST_MAXIMA {
            to.sort_by(|a, b| b.explained.total_cmp(&a.explained));
            to.truncate(MOST_MAXIMA);
        }
        for found in to {
            let cell = &table.cells[found.point];
            let (t, explained) = highest(cell, &cell.of(coordinates), diffuse, found.explained);
            found.at[0] = cell.k1(t);
            found.explained = explained;
        }
    }

    /// The highest maxima of the grid over several parameters.
    #[inline(always)]
    fn starts(&self, diffuse: f64, beside: &[f64], squares: f64, to: &mut Vec<Found>) {
        let (table, explained) = (self.table, &self.explained);
        let largest = largest(explained);
        let rest = (squares - largest).max(0.0);
        // Few readings are nearly interpolated: a start that seems worse may lead to the optimum.
        let (least, most) = if table.has_few_readings {
            (0.0, MOST_STARTS_OF_FEW)
        } else {
            (squares - WORSE * rest - MUCH * squares, MOST_STARTS)
        };
        let [_, n, _] = table.grid.counts();
        let maximum = |&(i, &value): &(usize, &f64)| {
            // The neighbours along k1 decide most cases at once.
            value >= least
                && explained.get(i + n).is_none_or(|wider| value >= *wider)
                && table
                    .grid
                    .adjacent(i)
                    .all(|j| value > explained[j] || (value == explained[j] && i < j))
        };
        let maxima = explained.iter().enumerate().filter(maximum);
        to.extend(maxima.map(|(i, _)| self.between_widths(i)));
        to.sort_by(|a, b| b.explained.total_cmp(&a.explained));
        to.truncate(most);
        self.add_ends_of_plains(squares, to);
        self.add_faint(diffuse, beside, FAINT * squares.sqrt(), to);
    }

    /// A point of the grid.
    #[inline(always)]
    fn found(&self, point: usize) -> Found {
        Found {
            point,
            at: self.table.grid.at(point),
            explained: self.explained[point],
        }
    }

    /// A maximum of the grid, moved to the highest point of the parabola through it and its neighbours along
    /// ln k1.
    #[inline(always)]
    fn between_widths(&self, point: usize) -> Found {
        let mut found = self.found(point);
        let stride = self.table.grid.counts()[1];
        let neighbours = point.checked_sub(stride).zip(Some(point + stride));
        let Some((narrower, wider)) = neighbours.filter(|(_, wider)| *wider < self.explained.len())
        else {
            return found;
        };
        let [below, above] = [narrower, wider].map(|i| self.explained[i]);
        let bend = below - 2.0 * found.explained + above;
        let other = self.table.grid.at(wider)[0];
        if bend < 0.0 && other > found.at[0] {
            let steps = (0.5 * (below - above) / bend).clamp(-0.5, 0.5);
            found.at[0] *= (other / found.at[0]).powf(steps);
        }
        found
    }

    /// Adds the wide ends of the plains on which the points are.
    #[inline(always)]
    fn add_ends_of_plains(&self, squares: f64, to: &mut Vec<Found>) {
        for i in 0..to.len() {
            let (point, here) = (to[i].point, to[i].explained);
            let is_plain = |j: usize| self.explained[j] >= here - PLAIN * (squares - here);
            let widest = self.table.grid.widest_of_plain(point, is_plain);
            if to.iter().all(|found| found.point != widest) {
                to.push(self.found(widest));
            }
        }
    }

    /// Adds the points next to which a faint lobe may lie, where the widths of the grid show none, or hardly
    /// one; `curvature` is the most by which the demand for a lobe rises between them.
    #[inline(always)]
    fn add_faint(&self, diffuse: f64, beside: &[f64], curvature: f64, to: &mut Vec<Found>) {
        let table = self.table;
        let gained = largest(&self.explained) - diffuse.max(0.0).powi(2);
        if gained >= curvature * curvature {
            return;
        }
        let demand = |i: usize| table.angles[i].demand(diffuse, beside[i]);
        let adjacent = |i: usize| table.grid.adjacent(i);
        for i in faint(demand, adjacent, beside.len(), gained, curvature) {
            if to.iter().all(|found| found.point != i) {
                to.push(self.found(i));
            }
        }
    }
}

/// [`Search::optima`].
struct Optima<'a, 'b> {
    search: &'a mut Search<'b>,
    i: usize,
    squares: f64,
    to: &'a mut Vec<Found>,
}

impl WithSimd for Optima<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<V: Simd>(self, _: V) {
        self.search.find(self.i, self.squares, self.to);
    }
}

/// The largest value, in four independent running maxima.
#[inline(always)]
fn largest(values: &[f64]) -> f64 {
    let (chunks, rest) = values.as_chunks::<4>();
    let mut lanes = [0.0_f64; 4];
    for chunk in chunks {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane = if *value > *lane { *value } else { *lane };
        }
    }
    rest.iter().chain(&lanes).copied().fold(0.0, f64::max)
}

/// The explained squares at t of a cell, half their slope, and half the slope's slope.
///
/// The slope is continuous where one of the weights becomes zero.
#[inline(always)]
fn along(line: &Line, diffuse: f64, t: f64) -> [f64; 3] {
    let [beside, beside1, beside2] = line.beside.at(t);
    let has_diffuse = diffuse > 0.0;
    if has_diffuse && beside <= 0.0 {
        // Without a lobe nothing changes: the way to one is upwards in the scalar product.
        return [diffuse * diffuse, beside1, beside2];
    }
    let [cos, cos1, cos2] = line.cos.at(t);
    let [sin, sin1, sin2] = line.sin.at(t);
    let angle = Angle { cos, sin };
    if has_diffuse && diffuse * sin >= beside * cos {
        return [
            angle.explained(diffuse, beside),
            beside * beside1,
            beside1 * beside1 + beside * beside2,
        ];
    }
    let lobe = diffuse * cos + beside * sin;
    let slope = diffuse * cos1 + beside1 * sin + beside * sin1;
    let bend = diffuse * cos2 + beside2 * sin + 2.0 * beside1 * sin1 + beside * sin2;
    if lobe <= 0.0 {
        return [0.0, slope, bend];
    }
    [lobe * lobe, lobe * slope, slope * slope + lobe * bend]
}

/// The highest point of a cell whose centre is a maximum of the grid: Newton's method on the slope,
/// within a bracket that its sign narrows.
#[inline(always)]
fn highest(cell: &Cell, line: &Line, diffuse: f64, at_centre: f64) -> (f64, f64) {
    let [mut low, mut high] = cell.ends;
    let mut t = 0.0;
    let mut best = (0.0, at_centre);
    for _ in 0..MOST_STEPS {
        let [explained, slope, bend] = along(line, diffuse, t);
        if explained >= best.1 {
            best = (t, explained);
        }
        if slope > 0.0 {
            low = t;
        } else if slope < 0.0 {
            high = t;
        } else {
            break;
        }
        let newton = t - slope / bend;
        let next = if bend < 0.0 && newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - t).abs() < 1e-9 {
            break;
        }
        t = next;
    }
    best
}
