//! The state of a scan between two readings: what is known, what a further reading would change.

use brdf_core::Family;
use nalgebra::{DMatrix, DVector, Matrix4};

use super::belief::{Belief, LogReading, brdf, log_slopes, log_value};
use super::criterion::{Criterion, Field, OTHER_FAMILIES};
use super::errors::ErrorModel;
use super::prior::{Logs, Prior};
use super::scene_points::thinned;
use super::setting::{Setting, Site};
use crate::scan::Measurement;

/// The prior counts as this many readings for the scale of the errors.
const READINGS_OF_PRIOR: f64 = 2.0;

/// More readings are thinned where the work grows with their cube.
const MOST_FOR_SCALE: usize = 200;

/// No more readings are predicted from the others, each by a fit.
const MOST_LEFT_OUT: usize = 50;

/// The width of the lobe of GGX and Beckmann that resembles one of k1 = 1.
const SIMILAR_WIDTH: f64 = 1.5;

/// A reading above zero, at its site.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reading {
    pub(super) site: Site,
    pub(super) log: f64,
}

impl Reading {
    /// `None` for a reading that is not above zero, which has no logarithm.
    pub(super) fn new(reading: &Measurement) -> Option<Self> {
        let log = (reading.brdf > 0.0).then(|| reading.brdf.ln())?;
        let site = Site::new(Setting::from(reading))?;
        Some(Self { site, log })
    }

    fn log_reading(&self) -> LogReading {
        LogReading {
            geometry: self.site.geometry,
            log: self.log,
        }
    }
}

/// What the readings so far say.
pub(super) struct State {
    pub(super) prior: Prior,
    pub(super) error: ErrorModel,
    pub(super) readings: Vec<Reading>,
    pub(super) belief: Belief,
}

impl State {
    pub(super) fn new(prior: Prior, error: ErrorModel, readings: Vec<Reading>) -> Self {
        let start = Belief::of_prior(&prior);
        let mut state = Self {
            prior,
            error,
            readings,
            belief: start,
        };
        state.learn();
        state
    }

    /// Adds a reading.
    pub(super) fn add(&mut self, reading: Reading) {
        self.readings.push(reading);
        self.learn();
    }

    fn learn(&mut self) {
        let readings: Vec<LogReading> = self.readings.iter().map(Reading::log_reading).collect();
        if readings.is_empty() {
            return;
        }
        let error = self.error.variance().sqrt();
        let near = self.belief.mode;
        self.belief = Belief::new(&readings, Family::Paper, &self.prior, error, &near);
    }

    /// The settings of the readings.
    pub(super) fn settings(&self) -> Vec<Setting> {
        self.readings
            .iter()
            .map(|reading| reading.site.setting)
            .collect()
    }

    /// The sites of a criterion: the readings, and then the candidates.
    pub(super) fn field(&self, scene: &[Site], candidates: &[Site]) -> Field<'_> {
        let own = self.readings.iter().map(|reading| reading.site);
        let sites: Vec<Site> = own.chain(candidates.iter().copied()).collect();
        let others = OTHER_FAMILIES.map(|family| (family, similar(family, &self.belief.mode)));
        Field::new(&self.error, scene, &sites, &self.belief, &others)
    }

    /// The criterion with the readings so far chosen.
    pub(super) fn criterion<'a>(&self, field: &'a Field<'a>) -> Criterion<'a> {
        let read = self.readings.len();
        let samples = self.belief.samples();
        let mut criterion = Criterion::new(field, &self.prior, &samples, read);
        for site in 0..read {
            criterion.choose(site);
        }
        criterion
    }

    /// The factor by which the errors are larger than the error model has them: the root of
    ///
    /// ```text
    /// s^2 = (2 + r^T (K^-1 - K^-1 J (J^T K^-1 J + P)^-1 J^T K^-1) r)/(2 + N - 4)
    /// ```
    ///
    /// with the residuals r of ln f_r and their covariance K: the prior says 1, as two readings would.
    pub(super) fn scale(&self, field: &Field<'_>) -> f64 {
        let count = self.readings.len();
        if count <= 4 {
            return 1.0;
        }
        let used = self.thinned(MOST_FOR_SCALE);
        let Some(squares) = self.weighted_squares(field, &used) else {
            return 1.0;
        };
        let degrees = READINGS_OF_PRIOR + used.len() as f64 - 4.0;
        ((READINGS_OF_PRIOR + squares) / degrees).sqrt()
    }

    /// The indices of at most so many readings, evenly.
    fn thinned(&self, most: usize) -> Vec<usize> {
        let all: Vec<usize> = (0..self.readings.len()).collect();
        thinned(&all, most)
    }

    fn weighted_squares(&self, field: &Field<'_>, used: &[usize]) -> Option<f64> {
        let count = used.len();
        let covariance = DMatrix::from_fn(count, count, |i, k| {
            if i == k {
                field.variance(used[i])
            } else {
                field.covariance(used[i], used[k])
            }
        });
        let factor = covariance.cholesky()?;
        let brdf = brdf(Family::Paper, &self.belief.mode);
        let residuals = DVector::from_fn(count, |i, _| {
            let reading = &self.readings[used[i]];
            reading.log - log_value(&brdf, &reading.site.geometry)
        });
        let slopes = DMatrix::from_fn(count, 4, |i, k| {
            log_slopes(&brdf, &self.readings[used[i]].site.geometry)[k]
        });
        let weighted = factor.solve(&residuals);
        let inner = slopes.transpose() * factor.solve(&slopes);
        let precision = self.prior.deviation.map(|x| x.powi(-2));
        let inner = Matrix4::from_fn(|i, k| inner[(i, k)]) + Matrix4::from_diagonal(&precision);
        let along = slopes.transpose() * &weighted;
        let along = Logs::from_fn(|k, _| along[k]);
        let taken_up = along.dot(&(inner.try_inverse()? * along));
        Some((residuals.dot(&weighted) - taken_up).max(0.0))
    }

    /// The root mean square of ln(predicted/measured), each reading being predicted from the others; `None`
    /// with fewer than six readings.
    pub(super) fn cross_validated(&self) -> Option<f64> {
        if self.readings.len() < 6 {
            return None;
        }
        let left_out = self.thinned(MOST_LEFT_OUT).into_iter();
        let squares: Vec<f64> = left_out.map(|i| self.without(i).powi(2)).collect();
        Some((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
    }

    /// ln(measured/predicted) of a reading by the others.
    fn without(&self, left_out: usize) -> f64 {
        let others = self
            .readings
            .iter()
            .enumerate()
            .filter(|(i, _)| *i != left_out);
        let others: Vec<LogReading> = others.map(|(_, reading)| reading.log_reading()).collect();
        let error = self.error.variance().sqrt();
        let belief = Belief::near(
            &others,
            Family::Paper,
            &self.prior,
            error,
            &self.belief.mode,
        );
        let own = &self.readings[left_out];
        own.log - log_value(&brdf(Family::Paper, &belief.mode), &own.site.geometry)
    }

    /// The root mean square of the residuals r, for which the prior counts as two readings and the parameters as four:
    ///
    /// ```text
    /// m^2 = (2 v + sum r^2)/(2 + N - 4),     v the variance of the error of a reading.
    /// ```
    pub(super) fn misfit(&self) -> f64 {
        let squares: f64 = self.residuals().iter().map(|r| r * r).sum();
        let of_prior = READINGS_OF_PRIOR * self.error.variance();
        let degrees = READINGS_OF_PRIOR + self.readings.len() as f64 - 4.0;
        ((of_prior + squares) / degrees.max(READINGS_OF_PRIOR)).sqrt()
    }

    /// ln(measured/model) of each reading.
    pub(super) fn residuals(&self) -> Vec<f64> {
        let brdf = brdf(Family::Paper, &self.belief.mode);
        let each = self.readings.iter();
        each.map(|reading| reading.log - log_value(&brdf, &reading.site.geometry))
            .collect()
    }
}

/// The parameters of another family whose lobe resembles that of the model.
fn similar(family: Family, at: &Logs) -> Logs {
    let mut similar = *at;
    if matches!(family, Family::Ggx | Family::Beckmann) {
        similar[2] += SIMILAR_WIDTH.ln();
    }
    similar
}
