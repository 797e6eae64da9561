//! The error objective E of eq. (5), with its derivatives by the parameters.

mod condensed;
pub mod weights;

use std::ops::{Range, RangeInclusive};

use brdf_core::facet::{Beckmann, Ellipsoid, FacetDistribution, Ggx, Power};
use brdf_core::fresnel::Dielectric;
use brdf_core::shadowing::{Shadowing, Smith, VGroove};
use brdf_core::{Family, Geometry, GeometryError, ModelParameters};
use nalgebra::DMatrix;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::format::in_degrees;
use crate::model::Parameter;
use crate::objective::weights::Weights;
use crate::scan::Measurements;

/// Sizes of the largest weighted reading for which all squares and their products stay well within
/// the range of numbers; far beyond any BRDF.
const SIZES: RangeInclusive<f64> = 1e-30..=1e30;

/// More incidences than this are left out several at a time.
pub const MOST_FOLDS: usize = 24;

/// E below which only rounding is left, as a fraction.
pub(crate) const ROUNDING: f64 = 1e-20;

/// So many readings are evaluated together: their columns stay in the nearest cache.
const BLOCK: usize = 32;

/// From so many readings on, incidences are evaluated side by side: for the 112 of a usual scan, the
/// threads alone took as long as the fit.
const SIDE_BY_SIDE_FROM: usize = 1 << 13;

/// E as a function of the parameters, for one set of readings and one family of models:
///
/// ```text
/// E = sum g (f_meas - f_model)^2 cos^2 theta / sum g (f_meas cos theta)^2
///   = sum (y - kD a - k2 u)^2
/// ```
///
/// What does not depend on the parameters is computed once for each reading: with
/// w = sqrt(g) cos theta / sqrt(sum g (f_meas cos theta)^2), y = w `f_meas` and a = w/pi; and
/// u = a f(alpha)/f(0) R0(gamma) G/(cos psi cos theta). (Eq. 5 of Li, Yan and Wu 2002.)
///
/// The readings stand in the order of their incidences, which are ascending.
#[derive(Debug, Clone)]
pub struct Objective {
    family: Family,
    /// The index that `fresnel` belongs to.
    n: f64,
    measured: Vec<f64>,
    diffuse: Vec<f64>,
    /// a, with G/(cos psi cos theta) where that does not depend on k1.
    shadowed: Vec<f64>,
    fresnel: Vec<f64>,
    angles: Vec<Angles>,
    /// w sigma, where every reading has a standard deviation.
    noise: Option<Vec<f64>>,
    segments: Vec<Segment>,
    /// Which reading each row is.
    readings: Vec<usize>,
    /// The sums that do not depend on the parameters.
    diffuse_squared: f64,
    diffuse_measured: f64,
}

/// What the terms of the model need of the angles of a reading.
#[derive(Debug, Clone, Copy)]
struct Angles {
    tan2_alpha: f64,
    sec_alpha: f64,
    cos_psi: f64,
    cos_theta: f64,
    cos_gamma: f64,
    sin2_gamma: f64,
}

impl Angles {
    fn of(geometry: &Geometry) -> Self {
        Self {
            tan2_alpha: geometry.tan2_alpha(),
            sec_alpha: geometry.sec_alpha(),
            cos_psi: geometry.cos_psi(),
            cos_theta: geometry.cos_theta(),
            cos_gamma: geometry.cos_gamma(),
            sin2_gamma: geometry.sin2_gamma(),
        }
    }
}

/// The rows of one incidence.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Segment {
    pub(crate) psi: f64,
    pub(crate) rows: Range<usize>,
    /// How many readings the rows stand for.
    pub(crate) readings: usize,
    /// How many of them have a weight of zero.
    zero_weight: usize,
}

/// E of one incidence by itself: numerator and denominator of eq. (5) over its readings only.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct IncidenceError {
    /// Incidence angle in degrees.
    pub psi_deg: f64,
    /// How many readings there are.
    pub readings: usize,
    /// E in percent; `None` where all its readings are zero, or weigh nothing.
    pub e_percent: Option<f64>,
}

impl IncidenceError {
    /// E of the readings of a segment, in percent.
    pub(crate) fn new(segment: &Segment, e_percent: Option<f64>) -> Self {
        Self {
            psi_deg: in_degrees(segment.psi),
            readings: segment.readings,
            e_percent,
        }
    }
}

/// E and what a step of Gauss and Newton needs: half the gradient of E, J^T r, and half its
/// approximate Hessian, J^T J.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalEquations<const P: usize> {
    /// E.
    pub error: f64,
    /// J^T r, half the gradient of E.
    pub gradient: nalgebra::SVector<f64, P>,
    /// J^T J.
    pub matrix: nalgebra::SMatrix<f64, P, P>,
}

/// The scalar products that the exact solution for k2 and kD needs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct ProfileSums {
    pub(crate) uu: f64,
    pub(crate) ua: f64,
    pub(crate) uy: f64,
    pub(crate) aa: f64,
    pub(crate) ay: f64,
}

/// Why E is not defined for a set of readings.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ObjectiveError {
    /// Weights by sigma, and a reading without one.
    #[error(
        "weights by 1/sigma^2 need the standard deviation of every reading (column sigma_per_sr)"
    )]
    NoSigma,
    /// Angles outside the model's domain, which no
    /// [validated](crate::Measurement::validated) reading has.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The squares of the readings, or of what they are divided by, leave the range of numbers.
    #[error("the largest weighted reading is {0:e} 1/sr: expected one between 1e-30 and 1e30 1/sr")]
    Size(f64),
    /// The denominator of E is zero.
    #[error("all readings are zero, or weigh nothing: E of eq. (5) is not defined")]
    AllZero,
}

/// Columns of a block of rows: y, a, u and the derivatives of u by k1, n and p. Rows beyond the
/// last are zero.
struct Block {
    y: [f64; BLOCK],
    a: [f64; BLOCK],
    u: [f64; BLOCK],
    by: [[f64; BLOCK]; 3],
}

impl Block {
    const EMPTY: Self = Self {
        y: [0.0; BLOCK],
        a: [0.0; BLOCK],
        u: [0.0; BLOCK],
        by: [[0.0; BLOCK]; 3],
    };

    /// Takes these rows, without their lobe yet, in place of those that were there.
    #[inline]
    fn take(&mut self, measured: &[f64], diffuse: &[f64]) {
        let rows = measured.len();
        self.y[..rows].copy_from_slice(measured);
        self.a[..rows].copy_from_slice(diffuse);
        if rows < BLOCK {
            let [by_k1, by_n, by_p] = &mut self.by;
            for column in [&mut self.y, &mut self.a, &mut self.u, by_k1, by_n, by_p] {
                column[rows..].fill(0.0);
            }
        }
    }
}

impl Objective {
    /// The objective over the measurements at the refractive index n.
    ///
    /// n is in the model's domain. Errors: a weight that cannot be had, readings whose E is not
    /// defined, and angles outside the domain.
    pub fn new(
        measurements: &Measurements,
        family: Family,
        n: f64,
        weights: &Weights,
    ) -> Result<Self, ObjectiveError> {
        let incidences = measurements.incidences();
        let weights = weights
            .of_all(measurements)
            .ok_or(ObjectiveError::NoSigma)?;
        let mut objective = Self::with_capacity(family, n, weights.len());
        for incidence in &incidences {
            let start = objective.len();
            for &i in &incidence.readings {
                let reading = &measurements.readings()[i];
                let geometry = reading.geometry()?;
                let w = weights[i].sqrt() * geometry.cos_theta();
                let a = w / std::f64::consts::PI;
                objective.measured.push(w * reading.brdf);
                objective.diffuse.push(a);
                objective.shadowed.push(match family {
                    Family::Smith | Family::Ggx => a,
                    _ => a * VGroove.over_cosines_at(&geometry),
                });
                objective.angles.push(Angles::of(&geometry));
                objective.readings.push(i);
                match (&mut objective.noise, reading.sigma) {
                    (Some(noise), Some(sigma)) => noise.push(w * sigma),
                    (noise, _) => *noise = None,
                }
            }
            objective.close_segment(incidence.psi, start);
        }
        objective.fresnel = objective.fresnel_column(n);
        objective.normalised()
    }

    /// The same E over the readings of a table in fewer rows, which are no readings: see
    /// [`condensed`]. Of other measurements, and where the shadowing depends on a parameter, each
    /// reading is a row.
    pub(crate) fn condensed(
        measurements: &Measurements,
        family: Family,
        n: f64,
        weights: &Weights,
    ) -> Result<Self, ObjectiveError> {
        let by_width = matches!(family, Family::Smith | Family::Ggx);
        if by_width || !measurements.is_table() {
            return Self::new(measurements, family, n, weights);
        }
        let weights = weights
            .of_all(measurements)
            .ok_or(ObjectiveError::NoSigma)?;
        let readings = measurements.readings();
        let row = |i: usize, geometry: &Geometry| {
            let w = weights[i].sqrt() * geometry.cos_theta();
            let a = w / std::f64::consts::PI;
            [
                a,
                a * VGroove.over_cosines_at(geometry),
                w * readings[i].brdf,
            ]
        };
        let incidences = measurements.incidences();
        let rows = condensed::rows(&incidences, readings, row)?;
        let mut objective = Self::with_capacity(family, n, 0);
        objective.noise = None;
        for (incidence, rows) in incidences.iter().zip(rows) {
            objective.append(incidence.psi, rows);
        }
        objective.fresnel = objective.fresnel_column(n);
        objective.normalised()
    }

    /// Ends the rows of an incidence, each of which is a reading.
    fn close_segment(&mut self, psi: f64, start: usize) {
        let rows = start..self.len();
        let zero_weight = self.diffuse[rows.clone()].iter().filter(|&&a| a == 0.0);
        self.segments.push(Segment {
            psi,
            readings: rows.len(),
            zero_weight: zero_weight.count(),
            rows,
        });
    }

    /// The objective over some of the incidences: those whose index `keep` accepts.
    pub(crate) fn subset(&self, keep: impl Fn(usize) -> bool) -> Result<Self, ObjectiveError> {
        let segments = self.segments.iter().enumerate();
        let kept = segments.filter(|(i, _)| keep(*i));
        self.picked(kept.map(|(_, segment)| segment), 1)
    }

    /// The objective over at most about `limit` of the rows, evenly over each incidence.
    pub(crate) fn thinned(&self, limit: usize) -> Result<Self, ObjectiveError> {
        let step = self.len().div_ceil(limit);
        // Condensed rows come in threes, a triangle of each cell: the same row of each would stand
        // for no readings.
        let of_threes = self.readings.is_empty() && step.is_multiple_of(3);
        self.picked(self.segments.iter(), step + usize::from(of_threes))
    }

    /// The objective over every so many of the rows of the given incidences.
    fn picked<'a>(
        &self,
        segments: impl Iterator<Item = &'a Segment>,
        step: usize,
    ) -> Result<Self, ObjectiveError> {
        let mut objective = Self::with_capacity(self.family, self.n, self.len() / step);
        if self.noise.is_none() {
            objective.noise = None;
        }
        for segment in segments {
            let start = objective.len();
            for i in segment.rows.clone().step_by(step) {
                objective.measured.push(self.measured[i]);
                objective.diffuse.push(self.diffuse[i]);
                objective.shadowed.push(self.shadowed[i]);
                objective.fresnel.push(self.fresnel[i]);
                objective.angles.push(self.angles[i]);
                objective.readings.extend(self.readings.get(i));
                if let (Some(to), Some(from)) = (&mut objective.noise, &self.noise) {
                    to.push(from[i]);
                }
            }
            objective.close_segment(segment.psi, start);
            if let (1, Some(whole)) = (step, objective.segments.last_mut()) {
                (whole.readings, whole.zero_weight) = (segment.readings, segment.zero_weight);
            }
        }
        objective.normalised()
    }

    /// The objective with the weight of each row multiplied by a factor >= 0.
    pub(crate) fn reweighted(&self, factor: impl Fn(usize) -> f64) -> Result<Self, ObjectiveError> {
        let mut objective = self.clone();
        for i in 0..self.len() {
            let root = factor(i).sqrt();
            objective.measured[i] *= root;
            objective.diffuse[i] *= root;
            objective.shadowed[i] *= root;
            if let Some(noise) = &mut objective.noise {
                noise[i] *= root;
            }
        }
        objective.normalised()
    }

    /// How many readings have a weight of zero.
    pub fn zero_weight(&self) -> usize {
        self.segments
            .iter()
            .map(|segment| segment.zero_weight)
            .sum()
    }

    /// Whether more readings have a say than there are free parameters.
    pub(crate) fn suffices_for(&self, free: &[Parameter]) -> bool {
        self.count() - self.zero_weight() > free.len()
    }

    /// How many readings there are.
    pub fn count(&self) -> usize {
        self.segments.iter().map(|segment| segment.readings).sum()
    }

    /// How many rows there are: one for each reading, fewer for the readings of a table.
    pub(crate) fn len(&self) -> usize {
        self.measured.len()
    }

    /// The rows of each incidence, in ascending order.
    pub(crate) fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// How many folds the incidences are sorted into, to be left out or drawn together: incidence i
    /// is in fold i modulo their number. One each, unless there are very many.
    pub(crate) fn folds(&self) -> usize {
        self.segments.len().min(MOST_FOLDS)
    }

    /// Which reading each row is.
    pub(crate) fn readings(&self) -> &[usize] {
        &self.readings
    }

    /// w sigma of each row, where every reading has a standard deviation.
    pub(crate) fn noise(&self) -> Option<&[f64]> {
        self.noise.as_deref()
    }

    /// E, as a fraction (times 100: the paper's percent).
    pub fn error(&self, at: &ModelParameters) -> f64 {
        let mut error = 0.0;
        self.for_blocks(at, [false; 3], 0..self.len(), |_, block| {
            let r = residual(block, at);
            error += dot(&r, &r);
        });
        error
    }

    /// E of each incidence by itself, in ascending order.
    pub fn by_incidence(&self, at: &ModelParameters) -> Vec<IncidenceError> {
        self.error_and_by_incidence(at).1
    }

    /// E, as a fraction, and E of each incidence by itself: each reading is looked at once, the
    /// incidences of many side by side.
    pub fn error_and_by_incidence(&self, at: &ModelParameters) -> (f64, Vec<IncidenceError>) {
        let squares = |segment: &Segment| self.squares_of(at, segment);
        let squares: Vec<(f64, f64)> = if self.len() < SIDE_BY_SIDE_FROM {
            self.segments.iter().map(squares).collect()
        } else {
            self.segments.par_iter().map(squares).collect()
        };
        let error = squares.iter().map(|(above, _)| above).sum();
        let of = |(segment, (above, below)): (&Segment, (f64, f64))| {
            IncidenceError::new(segment, (below > 0.0).then(|| 100.0 * above / below))
        };
        (error, self.segments.iter().zip(squares).map(of).collect())
    }

    /// Numerator and denominator of E over one incidence.
    pub(crate) fn squares_of(&self, at: &ModelParameters, segment: &Segment) -> (f64, f64) {
        let (mut above, mut below) = (0.0, 0.0);
        self.for_blocks(at, [false; 3], segment.rows.clone(), |_, block| {
            let r = residual(block, at);
            above += dot(&r, &r);
            below += dot(&block.y, &block.y);
        });
        (above, below)
    }

    /// The terms under the sum of E before they are squared: model - measured and measured, for
    /// each row.
    pub(crate) fn residuals(&self, at: &ModelParameters) -> Vec<(f64, f64)> {
        self.residuals_of(at, 0..self.len())
    }

    /// The [`residuals`](Self::residuals) of some of the rows.
    pub(crate) fn residuals_of(&self, at: &ModelParameters, rows: Range<usize>) -> Vec<(f64, f64)> {
        let mut residuals = Vec::with_capacity(rows.len());
        self.for_blocks(at, [false; 3], rows, |rows, block| {
            let r = residual(block, at);
            residuals.extend(r.into_iter().zip(block.y).take(rows.len()));
        });
        residuals
    }

    /// E with J^T r and J^T J for the residuals r = model - measured, by the free parameters.
    pub fn normal_equations<const P: usize>(
        &self,
        at: &ModelParameters,
        free: &[Parameter; P],
    ) -> NormalEquations<P> {
        let mut equations = NormalEquations {
            error: 0.0,
            gradient: nalgebra::SVector::zeros(),
            matrix: nalgebra::SMatrix::zeros(),
        };
        self.for_blocks(at, derivatives_for(free), 0..self.len(), |_, block| {
            let r = residual(block, at);
            equations.error += dot(&r, &r);
            let columns: [&[f64; BLOCK]; P] = free.map(|parameter| column(block, parameter));
            for i in 0..P {
                equations.gradient[i] += dot(columns[i], &r);
                for j in 0..=i {
                    equations.matrix[(i, j)] += dot(columns[i], columns[j]);
                }
            }
        });
        let factors = free.map(|parameter| column_factor(at, parameter));
        for i in 0..P {
            equations.gradient[i] *= factors[i];
            for j in 0..=i {
                let value = equations.matrix[(i, j)] * (factors[i] * factors[j]);
                (equations.matrix[(i, j)], equations.matrix[(j, i)]) = (value, value);
            }
        }
        equations
    }

    /// The Jacobian of the residuals: a row for each reading, a column for each free parameter.
    pub(crate) fn jacobian(&self, at: &ModelParameters, free: &[Parameter]) -> DMatrix<f64> {
        let mut jacobian = DMatrix::zeros(self.len(), free.len());
        self.for_blocks(at, derivatives_for(free), 0..self.len(), |rows, block| {
            for (j, &parameter) in free.iter().enumerate() {
                let factor = column_factor(at, parameter);
                for (i, value) in rows.clone().zip(column(block, parameter)) {
                    jacobian[(i, j)] = value * factor;
                }
            }
        });
        jacobian
    }

    pub(crate) fn profile_sums(&self, at: &ModelParameters) -> ProfileSums {
        let mut sums = ProfileSums {
            aa: self.diffuse_squared,
            ay: self.diffuse_measured,
            ..ProfileSums::default()
        };
        self.for_blocks(at, [false; 3], 0..self.len(), |_, block| {
            sums.uu += dot(&block.u, &block.u);
            sums.ua += dot(&block.u, &block.a);
            sums.uy += dot(&block.u, &block.y);
        });
        sums
    }

    /// kD of the best Lambertian description, negative readings included.
    pub(crate) fn lambertian_weight(&self) -> f64 {
        self.diffuse_measured / self.diffuse_squared
    }

    /// R0(gamma) of each row at the refractive index n.
    pub(crate) fn fresnel_column(&self, n: f64) -> Vec<f64> {
        let fresnel = Dielectric::new(n);
        let relative = |angles: &Angles| fresnel.relative(angles.cos_gamma);
        self.angles.iter().map(relative).collect()
    }

    /// u of each row but for its Fresnel factor, at a width k1 and an exponent p.
    pub(crate) fn shape_column(&self, k1: f64, p: f64, shape: &mut Vec<f64>) {
        fn fill<F: FacetDistribution, S: Shadowing>(
            objective: &Objective,
            facet: F,
            shadowing: S,
            shape: &mut Vec<f64>,
        ) {
            shape.clear();
            shape.extend((0..objective.len()).map(|i| objective.shape(facet, shadowing, i)));
        }
        match self.family {
            Family::Paper => fill(self, Ellipsoid::new(k1), VGroove, shape),
            Family::Smith => fill(self, Ellipsoid::new(k1), Smith::new(k1), shape),
            Family::Power => fill(self, Power::new(k1, p), VGroove, shape),
            Family::Ggx => fill(self, Ggx::new(k1), Smith::new(k1), shape),
            Family::Beckmann => fill(self, Beckmann::new(k1), VGroove, shape),
        }
    }

    /// The columns y and a.
    pub(crate) fn fixed_columns(&self) -> (&[f64], &[f64]) {
        (&self.measured, &self.diffuse)
    }

    /// The index of the Fresnel factors that were computed beforehand.
    pub(crate) fn n(&self) -> f64 {
        self.n
    }

    #[inline]
    fn shape<F: FacetDistribution, S: Shadowing>(&self, facet: F, shadowing: S, i: usize) -> f64 {
        let angles = &self.angles[i];
        let shape = self.shadowed[i] * facet.relative(angles.tan2_alpha, angles.sec_alpha);
        if S::DEPENDS_ON_WIDTH {
            let (psi, theta) = (angles.cos_psi, angles.cos_theta);
            shape * shadowing.over_cosines(psi, theta, angles.tan2_alpha)
        } else {
            shape
        }
    }

    #[inline]
    fn shape_by_k1<F: FacetDistribution, S: Shadowing>(
        &self,
        facet: F,
        shadowing: S,
        i: usize,
    ) -> f64 {
        let angles = &self.angles[i];
        let (t, sec) = (angles.tan2_alpha, angles.sec_alpha);
        let slope = facet.derivative_k1(t, sec);
        if S::DEPENDS_ON_WIDTH {
            let (psi, theta) = (angles.cos_psi, angles.cos_theta);
            let by_facet = slope * shadowing.over_cosines(psi, theta, t);
            let by_shadowing =
                facet.relative(t, sec) * shadowing.over_cosines_derivative_k1(psi, theta, t);
            self.shadowed[i] * (by_facet + by_shadowing)
        } else {
            self.shadowed[i] * slope
        }
    }

    /// Evaluates u, and its derivatives by k1, n and p where asked for, block by block. The terms
    /// of the family are chosen here, outside the loop.
    fn for_blocks(
        &self,
        at: &ModelParameters,
        derivatives: [bool; 3],
        rows: Range<usize>,
        take: impl FnMut(Range<usize>, &Block),
    ) {
        let (k1, p) = (at.k1, at.p);
        match self.family {
            Family::Paper => {
                self.for_blocks_of(Ellipsoid::new(k1), VGroove, at.n, derivatives, rows, take);
            }
            Family::Smith => {
                let (facet, shadowing) = (Ellipsoid::new(k1), Smith::new(k1));
                self.for_blocks_of(facet, shadowing, at.n, derivatives, rows, take);
            }
            Family::Power => {
                self.for_blocks_of(Power::new(k1, p), VGroove, at.n, derivatives, rows, take);
            }
            Family::Ggx => {
                let (facet, shadowing) = (Ggx::new(k1), Smith::new(k1));
                self.for_blocks_of(facet, shadowing, at.n, derivatives, rows, take);
            }
            Family::Beckmann => {
                self.for_blocks_of(Beckmann::new(k1), VGroove, at.n, derivatives, rows, take);
            }
        }
    }

    fn for_blocks_of<F: FacetDistribution, S: Shadowing>(
        &self,
        facet: F,
        shadowing: S,
        n: f64,
        [by_k1, by_n, by_p]: [bool; 3],
        rows: Range<usize>,
        mut take: impl FnMut(Range<usize>, &Block),
    ) {
        let dielectric = Dielectric::new(n);
        let mut start = rows.start;
        let mut block = Block::EMPTY;
        let mut fresnel = [0.0; BLOCK];
        while start < rows.end {
            let range = start..(start + BLOCK).min(rows.end);
            block.take(&self.measured[range.clone()], &self.diffuse[range.clone()]);
            self.fill_fresnel(&dielectric, range.clone(), &mut fresnel);
            for (j, i) in range.clone().enumerate() {
                block.u[j] = self.shape(facet, shadowing, i) * fresnel[j];
            }
            if by_k1 {
                for (j, i) in range.clone().enumerate() {
                    block.by[0][j] = self.shape_by_k1(facet, shadowing, i) * fresnel[j];
                }
            }
            if by_n {
                for (j, i) in range.clone().enumerate() {
                    let Angles {
                        cos_gamma,
                        sin2_gamma,
                        ..
                    } = self.angles[i];
                    let slope = dielectric.relative_derivative_n(cos_gamma, sin2_gamma);
                    block.by[1][j] = self.shape(facet, shadowing, i) * slope;
                }
            }
            if by_p {
                for (j, i) in range.clone().enumerate() {
                    let Angles {
                        tan2_alpha,
                        sec_alpha,
                        ..
                    } = self.angles[i];
                    let slope = facet.derivative_p(tan2_alpha, sec_alpha);
                    block.by[2][j] = self.shadowed[i] * slope * fresnel[j];
                }
            }
            start = range.end;
            take(range, &block);
        }
    }

    /// R0(gamma) of some rows: as computed beforehand where the index is the same.
    fn fill_fresnel(&self, dielectric: &Dielectric, rows: Range<usize>, to: &mut [f64; BLOCK]) {
        if dielectric.n() == self.n {
            to[..rows.len()].copy_from_slice(&self.fresnel[rows]);
        } else {
            for (value, angles) in to.iter_mut().zip(&self.angles[rows]) {
                *value = dielectric.relative(angles.cos_gamma);
            }
        }
    }

    fn with_capacity(family: Family, n: f64, readings: usize) -> Self {
        let column = || Vec::with_capacity(readings);
        Self {
            family,
            n,
            measured: column(),
            diffuse: column(),
            shadowed: column(),
            fresnel: column(),
            angles: Vec::with_capacity(readings),
            noise: Some(column()),
            segments: Vec::new(),
            readings: Vec::with_capacity(readings),
            diffuse_squared: 0.0,
            diffuse_measured: 0.0,
        }
    }

    /// Divides by the denominator of E, and sums what does not depend on the parameters.
    fn normalised(mut self) -> Result<Self, ObjectiveError> {
        let largest = self
            .measured
            .iter()
            .fold(0.0_f64, |max, y| max.max(y.abs()));
        let weighed = [&self.measured, &self.diffuse, &self.shadowed];
        let finite = weighed.into_iter().flatten().all(|value| value.is_finite());
        if finite && largest == 0.0 {
            return Err(ObjectiveError::AllZero);
        }
        if !finite || !SIZES.contains(&largest) {
            return Err(ObjectiveError::Size(largest));
        }
        let squares = self.measured.iter().map(|y| (y / largest).powi(2));
        let norm = largest * squares.sum::<f64>().sqrt();
        let columns = [&mut self.measured, &mut self.diffuse, &mut self.shadowed];
        for value in columns.into_iter().chain(&mut self.noise).flatten() {
            *value /= norm;
        }
        let rows = self.diffuse.iter().zip(&self.measured);
        (self.diffuse_squared, self.diffuse_measured) =
            rows.fold((0.0, 0.0), |(aa, ay), (a, y)| (aa + a * a, ay + a * y));
        Ok(self)
    }
}

/// Model - measured of a block.
fn residual(block: &Block, at: &ModelParameters) -> [f64; BLOCK] {
    let mut residual = [0.0; BLOCK];
    for (j, r) in residual.iter_mut().enumerate() {
        *r = at.k2 * block.u[j] + at.kd * block.a[j] - block.y[j];
    }
    residual
}

/// The column of the Jacobian for a parameter, but for its factor.
fn column(block: &Block, parameter: Parameter) -> &[f64; BLOCK] {
    match parameter {
        Parameter::K2 => &block.u,
        Parameter::Kd => &block.a,
        Parameter::K1 => &block.by[0],
        Parameter::N => &block.by[1],
        Parameter::P => &block.by[2],
    }
}

/// What the column of a parameter is to be multiplied by.
fn column_factor(at: &ModelParameters, parameter: Parameter) -> f64 {
    match parameter {
        Parameter::K2 | Parameter::Kd => 1.0,
        Parameter::K1 | Parameter::N | Parameter::P => at.k2,
    }
}

/// Which derivatives of u the free parameters need: by k1, n and p.
fn derivatives_for(free: &[Parameter]) -> [bool; 3] {
    [Parameter::K1, Parameter::N, Parameter::P].map(|parameter| free.contains(&parameter))
}

/// A scalar product in four running sums, which do not wait for each other; the same on every
/// processor.
#[inline]
fn dot(x: &[f64; BLOCK], y: &[f64; BLOCK]) -> f64 {
    let mut sums = [0.0; 4];
    for (x, y) in x.as_chunks::<4>().0.iter().zip(y.as_chunks::<4>().0) {
        for lane in 0..4 {
            sums[lane] += x[lane] * y[lane];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

#[cfg(test)]
mod tests {
    use brdf_core::{AnyBrdf, Parameters, ThreeParameterBrdf};
    use proptest::prelude::*;

    use super::*;
    use crate::Measurement;
    use crate::scan::synthetic::scan;

    const N: f64 = 1.5;

    /// A scan whose readings are not those of the model.
    fn distorted_scan() -> Vec<Measurement> {
        let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
        let mut readings = scan(truth, N).readings().to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= 1.0 + 0.3 * (i as f64).sin();
            reading.sigma = Some(0.1 + 0.01 * (i % 7) as f64);
        }
        readings
    }

    fn of(readings: Vec<Measurement>, weights: &Weights) -> Result<Objective, ObjectiveError> {
        let scan = Measurements::new("test", readings).unwrap();
        Objective::new(&scan, Family::Paper, N, weights)
    }

    fn objective(weights: &Weights) -> Objective {
        of(distorted_scan(), weights).unwrap()
    }

    fn three(parameters: Parameters) -> ModelParameters {
        ModelParameters::three(parameters, N)
    }

    #[test]
    fn equals_eq_5_written_out() {
        let parameters = Parameters::new(0.2, 0.15, 0.3).unwrap();
        let brdf = ThreeParameterBrdf::new(parameters, N).unwrap();
        let weights = Weights {
            g1: "0=1,60=1,70=0.5".parse().unwrap(),
            by_sigma: true,
            ..Weights::default()
        };
        let (mut above, mut below) = (0.0, 0.0);
        for reading in distorted_scan() {
            let g = if reading.psi.to_degrees() > 65.0 {
                0.5
            } else {
                1.0
            } / reading.sigma.unwrap().powi(2);
            let difference = reading.brdf - brdf.value(&reading.geometry().unwrap());
            above += g * (difference * reading.theta.cos()).powi(2);
            below += g * (reading.brdf * reading.theta.cos()).powi(2);
        }
        let error = objective(&weights).error(&three(parameters));
        assert!((error / (above / below) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn residuals_and_subsets_add_up() {
        let at = three(Parameters::new(0.2, 0.15, 0.3).unwrap());
        let objective = objective(&Weights::default());
        let residuals = objective.residuals(&at);
        let sum: f64 = residuals.iter().map(|(r, _)| r * r).sum();
        assert!((sum / objective.error(&at) - 1.0).abs() < 1e-12);
        let some = objective.subset(|i| i % 3 == 0).unwrap();
        let (mut above, mut below) = (0.0, 0.0);
        for segment in objective.segments().iter().step_by(3) {
            for (r, y) in &residuals[segment.rows.clone()] {
                above += r * r;
                below += y * y;
            }
        }
        assert!((some.error(&at) / (above / below) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_incidences_add_up_to_e() {
        let at = three(Parameters::new(0.2, 0.15, 0.3).unwrap());
        let objective = objective(&Weights::default());
        let incidences = objective.by_incidence(&at);
        assert_eq!(incidences.len(), objective.segments().len());
        assert!(incidences.is_sorted_by(|a, b| a.psi_deg < b.psi_deg));
        let mut error = 0.0;
        for (incidence, segment) in incidences.iter().zip(objective.segments()) {
            let (_, readings) = objective.squares_of(&at, segment);
            error += 0.01 * incidence.e_percent.unwrap() * readings;
        }
        assert!((error / objective.error(&at) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_factor_on_a_weight_is_like_repeated_readings() {
        let at = three(Parameters::new(0.2, 0.15, 0.3).unwrap());
        let once = objective(&Weights::default());
        let twice = once.reweighted(|i| if i < 20 { 2.0 } else { 1.0 }).unwrap();
        let mut readings = distorted_scan();
        let repeated: Vec<Measurement> =
            once.readings()[..20].iter().map(|&i| readings[i]).collect();
        readings.extend(repeated);
        let expected = of(readings, &Weights::default()).unwrap().error(&at);
        assert!((twice.error(&at) / expected - 1.0).abs() < 1e-12);
    }

    #[test]
    fn every_family_has_the_residuals_of_its_brdf() {
        let at = ModelParameters {
            k2: 0.2,
            kd: 0.15,
            k1: 0.3,
            n: 1.8,
            p: 1.4,
        };
        let scan = Measurements::new("test", distorted_scan()).unwrap();
        for family in Family::ALL {
            // Neither with the index of the objective nor with another one.
            for n in [1.8, 1.5] {
                let objective = Objective::new(&scan, family, n, &Weights::default()).unwrap();
                let brdf = AnyBrdf::new(family, &at).unwrap();
                let rows = objective.residuals(&at);
                for (&i, (r, y)) in objective.readings().iter().zip(rows) {
                    let reading = &scan.readings()[i];
                    let ratio = brdf.value(&reading.geometry().unwrap()) / reading.brdf;
                    assert!(((r + y) / y - ratio).abs() < 1e-12 * ratio.abs());
                }
            }
        }
    }

    #[test]
    fn readings_without_any_weight_are_an_error() {
        let mut readings = distorted_scan();
        let g1 = "0=0".parse().unwrap();
        let zero_weight = of(
            readings.clone(),
            &Weights {
                g1,
                ..Weights::default()
            },
        );
        assert_eq!(zero_weight.unwrap_err(), ObjectiveError::AllZero);
        readings[3].sigma = None;
        let by_sigma = Weights {
            by_sigma: true,
            ..Weights::default()
        };
        assert_eq!(
            of(readings, &by_sigma).unwrap_err(),
            ObjectiveError::NoSigma
        );
    }

    #[test]
    fn readings_beyond_any_brdf_are_an_error() {
        for size in [1e-200, 1e-40, 1e40, 1e200] {
            let mut readings = distorted_scan();
            for reading in &mut readings {
                reading.brdf *= size;
            }
            let error = of(readings, &Weights::default()).unwrap_err();
            assert!(
                error.to_string().contains("expected one between"),
                "{error}"
            );
        }
    }

    proptest! {
        #[test]
        fn derivatives_agree_with_finite_differences(
            k2 in 0.01..2.0, kd in 0.01..1.0, log_k1 in -4.0..1.5_f64, n in 1.1..5.0, p in 0.3..5.0,
        ) {
            let scan = Measurements::new("test", distorted_scan()).unwrap();
            let at = [k2, kd, log_k1.exp(), n, p];
            let parameters = |x: [f64; 5]| ModelParameters { k2: x[0], kd: x[1], k1: x[2], n: x[3], p: x[4] };
            for family in Family::ALL {
                let objective = Objective::new(&scan, family, N, &Weights::default()).unwrap();
                let equations = objective.normal_equations(&parameters(at), &Parameter::ALL);
                prop_assert!((equations.error / objective.error(&parameters(at)) - 1.0).abs() < 1e-12);

                // Columns of the Jacobian by differences, and with them J^T r and J^T J.
                let residuals = |at| objective.residuals(&parameters(at)).iter().map(|(r, _)| *r).collect::<Vec<_>>();
                let columns: Vec<Vec<f64>> = (0..5).map(|j| {
                    let step = 1e-5 * at[j];
                    let moved = |sign: f64| { let mut moved = at; moved[j] += sign * step; residuals(moved) };
                    moved(1.0).iter().zip(moved(-1.0)).map(|(up, down)| (up - down) / (2.0 * step)).collect()
                }).collect();
                let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                let size = columns.iter().map(|c| dot(c, c)).fold(0.0, f64::max).sqrt();
                let r = residuals(at);
                for i in 0..5 {
                    let gradient = dot(&columns[i], &r);
                    let scale = size * dot(&r, &r).sqrt();
                    prop_assert!((equations.gradient[i] - gradient).abs() < 1e-6 * scale, "{family:?}");
                    for j in 0..5 {
                        let product = dot(&columns[i], &columns[j]);
                        let error = (equations.matrix[(i, j)] - product).abs();
                        prop_assert!(error < 1e-6 * size * size, "{family:?}");
                    }
                }
                let jacobian = objective.jacobian(&parameters(at), &Parameter::ALL);
                let difference = jacobian.transpose() * &jacobian - equations.matrix;
                prop_assert!(difference.norm() < 1e-12 * equations.matrix.norm());
            }
        }
    }
}
