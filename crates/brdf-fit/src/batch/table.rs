//! The columns of a model on the grid of its widths, indices and exponents, in a basis that all scans of
//! a plan share.

use brdf_core::ModelParameters;
use nalgebra::DMatrix;

use super::basis::{Basis, norm, remove};
use super::cell::Cell;
use crate::model::{FEW_READINGS, Grid, Parameter, ReducedModel};
use crate::objective::{Objective, dot_of as dot};

/// What the basis leaves of a column where the search ends in it: rounding in E.
const FINE: f64 = 1e-12;

/// What the basis leaves of a column where the search only chooses the starts of descents.
const COARSE: f64 = 1e-4;

/// Fewer rows than this are represented finely: it costs nothing, and a model may nearly interpolate
/// them.
const FEW_ROWS: usize = 32;

/// The error of a cell up to which its maxima are those of the columns, and its k1 that of the minimum of E.
const INTERPOLATED: f64 = 3e-12;

/// The error of all cells up to which the columns have no features between the widths of the grid.
const SMOOTH: f64 = 1e-9;

/// Columns that represent those between the widths of the grid, for each step.
const SAMPLES: usize = 4;

/// A lobe below this fraction of the diffuse column at all readings is none: its squares underflow.
const TINY: f64 = 1e-150;

/// The smallest angle between a lobe's column and the diffuse one at which they are told apart.
const COLLINEAR: f64 = 1e-7;

/// The unit column of a lobe in the plane that it spans with the diffuse column a' of unit length:
/// cos p a' + sin p v, with v orthogonal to a'. A model without a diffuse part has p = pi/2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Angle {
    pub(super) cos: f64,
    pub(super) sin: f64,
}

impl Angle {
    /// The part of the readings' squares that the model explains with the best weights: `diffuse` is the
    /// scalar product of the readings and a', `beside` that with v.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a function that is not inlined is not compiled for the present processor"
    )]
    pub(super) fn explained(self, diffuse: f64, beside: f64) -> f64 {
        let Self { cos, sin } = self;
        // Comparisons rather than `max`: they become vector code.
        let positive = |x: f64| if x > 0.0 { x } else { 0.0 };
        let lobe = positive(diffuse * cos + beside * sin);
        let without_lobe = positive(diffuse);
        let both = diffuse * diffuse + beside * beside;
        let explained = if diffuse * sin < beside * cos {
            lobe * lobe
        } else {
            both
        };
        if beside > 0.0 {
            explained
        } else {
            without_lobe * without_lobe
        }
    }

    /// The [demand for a lobe](crate::objective::demand_for_lobe).
    pub(super) fn demand(self, diffuse: f64, beside: f64) -> f64 {
        if diffuse > 0.0 {
            beside
        } else {
            diffuse * self.cos + beside * self.sin
        }
    }
}

/// The tables of a plan.
#[derive(Debug, Clone)]
pub(super) struct Table {
    pub(super) grid: Grid,
    /// The basis, times the factor of each reading, in the order of the readings: one row for each
    /// column of the basis. Where the model has a diffuse part, the first one is a'.
    pub(super) projection: DMatrix<f64>,
    pub(super) has_diffuse: bool,
    /// The angle of each point of the grid.
    pub(super) angles: Vec<Angle>,
    /// v of each point, one row for each.
    pub(super) directions: DMatrix<f64>,
    /// The columns around each point, where k1 alone is searched.
    pub(super) cells: Vec<Cell>,
    /// Whether the columns have no features between the widths: not where several parameters are searched.
    pub(super) is_smooth: bool,
    pub(super) has_few_readings: bool,
    /// The largest second derivative of v and of the unit column of the lobe along ln k1, in steps.
    pub(super) curvature: f64,
}

/// Evaluates unit columns of lobes.
pub(super) struct Lobes<'a> {
    objective: &'a Objective,
    diffuse: Option<Vec<f64>>,
}

impl Lobes<'_> {
    /// The column of a lobe.
    fn column(&self, k1: f64, n: f64, p: f64) -> Vec<f64> {
        let at = ModelParameters {
            k2: 1.0,
            kd: 0.0,
            k1,
            n,
            p,
        };
        self.objective.lobe_column(&at)
    }

    /// The column of unit length.
    fn unit(&self, k1: f64, n: f64, p: f64) -> Vec<f64> {
        let mut column = self.column(k1, n, p);
        // The column of a narrow lobe without a reading at its peak is tiny, and its square underflows.
        let largest = column.iter().fold(0.0_f64, |max, u| max.max(*u));
        let (_, a) = self.objective.fixed_columns();
        if largest < TINY * a.iter().copied().fold(0.0, f64::max) {
            column.fill(0.0);
        } else if largest > 0.0 {
            for u in &mut column {
                *u /= largest;
            }
            let length = norm(&column);
            for u in &mut column {
                *u /= length;
            }
        }
        column
    }

    /// The angle and v of a unit column; `None` where it is parallel to the diffuse column.
    pub(super) fn beside(&self, k1: f64, n: f64, p: f64) -> Option<(Angle, Vec<f64>)> {
        let mut column = self.unit(k1, n, p);
        let has_lobe = column.iter().any(|u| *u != 0.0);
        let Some(diffuse) = self.diffuse.as_ref().filter(|_| has_lobe) else {
            return Some((Angle { cos: 0.0, sin: 1.0 }, column));
        };
        let cos = dot(&column, diffuse);
        remove(&mut column, diffuse);
        remove(&mut column, diffuse);
        let sin = norm(&column);
        if sin < COLLINEAR {
            return None;
        }
        for v in &mut column {
            *v /= sin;
        }
        Some((Angle { cos, sin }, column))
    }
}

impl Table {
    /// The tables of a model, whose rows have the given factors on their readings.
    ///
    /// `None` where a lobe of the model cannot be told from its diffuse part.
    pub(super) fn new(
        objective: &Objective,
        model: ReducedModel,
        factors: &[f64],
        readings: usize,
    ) -> Option<Self> {
        let (_, a) = objective.fixed_columns();
        let has_diffuse = model.frees(Parameter::Kd);
        let length = norm(a);
        let lobes = Lobes {
            objective,
            diffuse: has_diffuse.then(|| a.iter().map(|a| a / length).collect()),
        };
        let grid = Grid::new(model, objective.n(), objective.count(), 1);
        let (widths, [_, n, p]) = (&grid.axes[0], grid.at(0));
        let along_k1 = grid.is_along_k1();
        let lobe = |i| {
            let [k1, n, p] = grid.at(i);
            lobes.beside(k1, n, p)
        };
        let of_points: Vec<_> = (0..grid.len()).map(lobe).collect::<Option<_>>()?;
        let (angles, points): (Vec<Angle>, Vec<Vec<f64>>) = of_points.into_iter().unzip();
        let basis = if along_k1 {
            let at = |k1: f64| Some(lobes.beside(k1, n, p)?.1);
            let between = between(widths).into_iter().map(at);
            let mut represented: Vec<Vec<f64>> = between.collect::<Option<_>>()?;
            represented.extend_from_slice(&points);
            Basis::of(lobes.diffuse.as_deref(), &represented, FINE)
        } else {
            let few = objective.len() < FEW_ROWS;
            Basis::of(
                lobes.diffuse.as_deref(),
                &points,
                if few { FINE } else { COARSE },
            )
        };
        let coordinates: Vec<Vec<f64>> = points.iter().map(|v| basis.coordinates(v)).collect();
        let directions = DMatrix::from_fn(points.len(), basis.len(), |i, k| coordinates[i][k]);
        let at = |k1: f64| {
            let (angle, v) = lobes.beside(k1, n, p)?;
            Some((angle, basis.coordinates(&v)))
        };
        let cells = (0..widths.len())
            .filter(|_| along_k1)
            .map(|i| Cell::around(widths, i, at));
        let cells = cells.collect::<Option<Vec<_>>>()?;
        let error = cells.iter().map(|cell| cell.error).fold(0.0, f64::max);
        let mut projection = DMatrix::zeros(basis.len(), readings);
        for (k, column) in basis.columns.iter().enumerate() {
            for ((q, factor), &reading) in column.iter().zip(factors).zip(objective.readings()) {
                projection[(k, reading)] = q * factor;
            }
        }
        Some(Self {
            projection,
            has_diffuse,
            angles,
            directions,
            has_few_readings: objective.count() < FEW_READINGS,
            is_smooth: along_k1 && error < SMOOTH,
            curvature: cells.iter().map(Cell::curvature).fold(0.0, f64::max),
            cells,
            grid,
        })
    }

    /// Whether an optimum that the search finds next to a point is one of E within rounding.
    pub(super) fn is_accurate_at(&self, point: usize) -> bool {
        self.cells
            .get(point)
            .is_some_and(|cell| cell.error < INTERPOLATED)
    }

    /// The number of columns of the basis.
    pub(super) fn dimension(&self) -> usize {
        self.projection.nrows()
    }
}

/// Widths between those of the grid, at equal steps of their logarithm.
fn between(widths: &[f64]) -> Vec<f64> {
    let pairs = widths.windows(2).flat_map(|pair| {
        let step = (pair[1] / pair[0]).ln() / SAMPLES as f64;
        (1..SAMPLES).map(move |i| pair[0] * (step * i as f64).exp())
    });
    pairs.collect()
}
