//! The rows of the objective: what depends on the readings, their angles and weights alone.

use std::borrow::Cow;
use std::f64::consts::PI;
use std::ops::{Range, RangeInclusive};
use std::sync::Arc;

use brdf_core::Family;
use brdf_core::shadowing::{Shadowing as _, VGroove};
use serde::{Deserialize, Serialize};

use super::angles::{AngleColumns, AngleRows, Angles};
use super::error::ObjectiveError;
use super::weights::Weights;
use crate::format::in_degrees;
use crate::model::Parameter;
use crate::scan::Measurements;

/// Range of the largest weighted reading, in 1/sr, for which all squares and their products stay
/// well within the range of `f64`. It is far wider than that of any BRDF.
pub(crate) const SIZES: RangeInclusive<f64> = 1e-30..=1e30;

/// The largest number of folds of cross-validation and resampling: more incidences than this are
/// left out, or drawn, several at a time.
pub const MOST_FOLDS: usize = 24;

/// E as a function of the parameters, for one set of readings and one family of models:
///
/// ```text
/// E = sum g (f_meas - f_model)^2 cos^2 theta / sum g (f_meas cos theta)^2
///   = sum (y - kD a - k2 u)^2
/// ```
///
/// (eq. 5 of Li, Yan and Wu 2002, with the weight g = g1(psi) g2(theta) and those of [`Weights`]).
/// The columns are y = w `f_meas`, a = w/pi and u = a f(alpha)/f(0) R0(gamma) G/(cos psi cos theta),
/// with w = sqrt(g) cos theta / sqrt(sum g (f_meas cos theta)^2). What does not depend on the
/// parameters is computed once.
///
/// The rows are sorted by incidence angle, in ascending order. What depends on their directions alone is
/// shared with the objectives that are made from this one by other weights or by leaving out the last
/// incidences: it takes three quarters of the memory.
#[derive(Debug, Clone)]
pub struct Objective {
    pub(super) family: Family,
    /// The refractive index of the Fresnel factors.
    pub(super) n: f64,
    /// y.
    pub(super) measured: Vec<f64>,
    /// a.
    pub(super) diffuse: Vec<f64>,
    /// a, multiplied by G/(cos psi cos theta) where the shadowing does not depend on k1.
    pub(super) shadowed: Vec<f64>,
    pub(super) directions: Arc<Directions>,
    /// w sigma, if every reading has a standard deviation.
    pub(super) noise: Option<Vec<f64>>,
    pub(super) segments: Vec<Segment>,
    /// a a and a y, summed over all rows.
    pub(super) diffuse_squared: f64,
    pub(super) diffuse_measured: f64,
}

/// What depends on the directions of the rows alone. There may be more rows than those of an objective,
/// which are then the first.
#[derive(Debug, Default)]
pub(super) struct Directions {
    /// R0(gamma).
    pub(super) fresnel: Vec<f64>,
    pub(super) angles: AngleColumns,
    /// The index of the reading of each row; empty for condensed rows.
    pub(super) readings: Vec<usize>,
}

impl Directions {
    /// Directions without Fresnel factors, which [`with_fresnel`](Self::with_fresnel) adds.
    pub(super) fn with_capacity(rows: usize) -> Self {
        Self {
            fresnel: Vec::new(),
            angles: AngleColumns::with_capacity(rows),
            readings: Vec::with_capacity(rows),
        }
    }

    /// The same with the Fresnel factors at a refractive index.
    pub(super) fn with_fresnel(self, n: f64) -> Self {
        let fresnel = self.angles.rows(0..self.angles.len()).fresnel(n);
        Self { fresnel, ..self }
    }
}

/// The rows of one incidence.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Segment {
    pub(crate) psi: f64,
    pub(crate) rows: Range<usize>,
    /// The number of readings that the rows represent.
    pub(crate) readings: usize,
    /// How many of these readings have zero weight.
    pub(super) zero_weight: usize,
}

impl Segment {
    /// The number of readings that influence E.
    pub(crate) fn used(&self) -> usize {
        self.readings - self.zero_weight
    }
}

/// E of one incidence: numerator and denominator of eq. (5) are summed over its readings only.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct IncidenceError {
    /// Incidence angle in degrees.
    pub psi_deg: f64,
    /// The number of readings.
    pub readings: usize,
    /// E in percent; `None` if all its readings are zero or have zero weight.
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

impl Objective {
    /// The objective over the measurements at the refractive index n.
    ///
    /// n has to be in the domain of the model, [1, 1e5].
    ///
    /// # Errors
    ///
    /// A reading without a standard deviation where the weights need one, angles outside the domain
    /// of the model, and readings for which E is not defined.
    pub fn new(
        measurements: &Measurements,
        family: Family,
        n: f64,
        weights: &Weights,
    ) -> Result<Self, ObjectiveError> {
        let weighing = weights
            .weighing(measurements)
            .ok_or(ObjectiveError::NoSigma)?;
        let readings = measurements.readings().len();
        let mut objective = Self::with_capacity(family, n, readings);
        let mut directions = Directions::with_capacity(readings);
        for incidence in measurements.incidences() {
            let start = objective.len();
            for &i in &incidence.readings {
                let reading = &measurements.readings()[i];
                let geometry = reading.geometry()?;
                let w = weighing.weight(i).sqrt() * geometry.cos_theta();
                let a = w / PI;
                objective.measured.push(w * reading.brdf);
                objective.diffuse.push(a);
                objective.shadowed.push(match family {
                    Family::Smith | Family::Ggx => a,
                    _ => a * VGroove.over_cosines_at(&geometry),
                });
                directions.angles.push(Angles::new(&geometry));
                directions.readings.push(i);
                match (&mut objective.noise, reading.sigma) {
                    (Some(noise), Some(sigma)) => noise.push(w * sigma),
                    (noise, _) => *noise = None,
                }
            }
            objective.close_segment(incidence.psi, start);
        }
        objective.directions = Arc::new(directions.with_fresnel(n));
        objective.normalised()
    }

    /// Completes the rows of an incidence, each of which is a reading.
    pub(super) fn close_segment(&mut self, psi: f64, start: usize) {
        let rows = start..self.len();
        let zero_weight = self.diffuse[rows.clone()].iter().filter(|&&a| a == 0.0);
        self.segments.push(Segment {
            psi,
            readings: rows.len(),
            zero_weight: zero_weight.count(),
            rows,
        });
    }

    /// The number of readings with zero weight, which do not influence E.
    pub fn zero_weight(&self) -> usize {
        self.segments
            .iter()
            .map(|segment| segment.zero_weight)
            .sum()
    }

    /// Whether the readings that influence E outnumber the free parameters.
    pub(crate) fn suffices_for(&self, free: &[Parameter]) -> bool {
        self.count() - self.zero_weight() > free.len()
    }

    /// The number of readings.
    pub fn count(&self) -> usize {
        self.segments.iter().map(|segment| segment.readings).sum()
    }

    /// The number of rows: one for each reading, fewer where they are condensed.
    pub(crate) fn len(&self) -> usize {
        self.measured.len()
    }

    /// The rows of each incidence, in ascending order.
    pub(crate) fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// The number of folds of the incidences, which are left out or drawn together: incidence i is in
    /// fold i modulo this number. It is the number of incidences, but at most [`MOST_FOLDS`].
    pub(crate) fn folds(&self) -> usize {
        self.segments.len().min(MOST_FOLDS)
    }

    /// The index of the reading of each row; empty for condensed rows.
    pub(crate) fn readings(&self) -> &[usize] {
        let rows = self.directions.readings.len().min(self.len());
        &self.directions.readings[..rows]
    }

    /// w sigma of each row, if every reading has a standard deviation.
    pub(crate) fn noise(&self) -> Option<&[f64]> {
        self.noise.as_deref()
    }

    /// The columns y and a.
    pub(crate) fn fixed_columns(&self) -> (&[f64], &[f64]) {
        (&self.measured, &self.diffuse)
    }

    /// The root of the weight of each row in E, as a factor on f_r cos theta; 0 for a reading of zero
    /// weight.
    pub(crate) fn row_weights(&self) -> Vec<f64> {
        let rows = self
            .diffuse
            .iter()
            .zip(self.angles(0..self.len()).cos_theta);
        rows.map(|(a, cos_theta)| PI * a / cos_theta).collect()
    }

    /// The refractive index of the precomputed Fresnel factors.
    pub(crate) fn n(&self) -> f64 {
        self.n
    }

    /// R0(gamma) of each row at the refractive index n.
    pub(crate) fn fresnel_column(&self, n: f64) -> Cow<'_, [f64]> {
        if n == self.n {
            Cow::Borrowed(&self.directions.fresnel[..self.len()])
        } else {
            Cow::Owned(self.angles(0..self.len()).fresnel(n))
        }
    }

    /// The angles of some rows.
    pub(super) fn angles(&self, rows: Range<usize>) -> AngleRows<'_> {
        self.directions.angles.rows(rows)
    }

    /// An objective without rows and directions.
    pub(super) fn with_capacity(family: Family, n: f64, readings: usize) -> Self {
        let column = || Vec::with_capacity(readings);
        Self {
            family,
            n,
            measured: column(),
            diffuse: column(),
            shadowed: column(),
            directions: Arc::default(),
            noise: Some(column()),
            segments: Vec::new(),
            diffuse_squared: 0.0,
            diffuse_measured: 0.0,
        }
    }

    /// Divides by the denominator of E, and computes the sums that do not depend on the parameters.
    pub(super) fn normalised(mut self) -> Result<Self, ObjectiveError> {
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
