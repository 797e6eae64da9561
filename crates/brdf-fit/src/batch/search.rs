//! The search of all scans of a block for their global optimum, in the basis of the plan.

#![expect(
    clippy::inline_always,
    reason = "a function that is not inlined is not compiled for the present processor"
)]

use nalgebra::{DMatrix, DMatrixView};
use pulp::{Simd, WithSimd};

use super::cell::{Cell, Line};
use super::table::{Angle, Table};
use crate::model::PLAIN;
use crate::objective::PROCESSOR;

/// The number of scans that are searched together.
pub(super) const BLOCK: usize = 64;

/// The largest number of maxima of the grid that are followed.
const MOST_MAXIMA: usize = 16;

/// The largest number of maxima from which descents start.
const MOST_STARTS: usize = 8;

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
    point: usize,
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
            self.starts(squares, to);
            return;
        }
        self.follow(diffuse, beside, coordinates, to);
        let best = to.iter().map(|found| found.explained).fold(0.0, f64::max);
        let alike = |found: &Found| (ALIKE + 4.0 * table.cells[found.point].error) * squares;
        to.retain(|found| found.explained >= best - alike(found));
    }

    /// Follows the maxima of the grid along ln k1 that may lead to the largest one.
    #[inline(always)]
    fn follow(&self, diffuse: f64, beside: &[f64], coordinates: &[f64], to: &mut Vec<Found>) {
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
        to.extend(maxima.map(|(i, &explained)| Found {
            point: i,
            at: table.grid.at(i),
            explained,
        }));
        // Where no width of the grid shows a lobe, one between them may, however faint it is.
        let plain = diffuse.max(0.0).powi(2);
        if largest <= plain {
            let is_faint = |&i: &usize| {
                let beyond = |i: usize| beside.get(i).copied().unwrap_or(f64::NEG_INFINITY);
                let highest = beyond(i.wrapping_sub(1)).max(beyond(i + 1));
                beside[i] > -gain && beside[i] >= highest
            };
            let known = to.len();
            for i in (0..beside.len()).filter(is_faint) {
                if to[..known].iter().all(|found| found.point != i) {
                    to.push(Found {
                        point: i,
                        at: table.grid.at(i),
                        explained: plain,
                    });
                }
            }
        }
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
    fn starts(&self, squares: f64, to: &mut Vec<Found>) {
        let (table, explained) = (self.table, &self.explained);
        let rest = (squares - largest(explained)).max(0.0);
        let least = squares - WORSE * rest - MUCH * squares;
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
        to.extend(maxima.map(|(i, &explained)| Found {
            point: i,
            at: table.grid.at(i),
            explained,
        }));
        to.sort_by(|a, b| b.explained.total_cmp(&a.explained));
        to.truncate(MOST_STARTS);
        for i in 0..to.len() {
            let Found {
                point,
                explained: here,
                ..
            } = to[i];
            let is_plain = |j: usize| explained[j] >= here - PLAIN * (squares - here);
            let widest = table.grid.widest_of_plain(point, is_plain);
            if to.iter().all(|found| found.point != widest) {
                to.push(Found {
                    point: widest,
                    at: table.grid.at(widest),
                    explained: explained[widest],
                });
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
    if beside <= 0.0 {
        // Without a lobe nothing changes: the way to one is upwards in the scalar product.
        return [diffuse.max(0.0).powi(2), beside1, beside2];
    }
    let [cos, cos1, cos2] = line.cos.at(t);
    let [sin, sin1, sin2] = line.sin.at(t);
    let angle = Angle { cos, sin };
    let explained = angle.explained(diffuse, beside);
    if diffuse * sin >= beside * cos {
        return [
            explained,
            beside * beside1,
            beside1 * beside1 + beside * beside2,
        ];
    }
    let lobe = diffuse * cos + beside * sin;
    if lobe <= 0.0 {
        return [0.0, 0.0, 0.0];
    }
    let slope = diffuse * cos1 + beside1 * sin + beside * sin1;
    let bend = diffuse * cos2 + beside2 * sin + 2.0 * beside1 * sin1 + beside * sin2;
    [explained, lobe * slope, slope * slope + lobe * bend]
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
