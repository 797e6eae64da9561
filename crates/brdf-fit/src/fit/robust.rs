//! Fits that a few bad readings cannot pull away: Huber's and Tukey's loss instead of the square.

use std::fmt;
use std::str::FromStr;

use brdf_core::ModelParameters;
use serde::{Deserialize, Serialize};

use super::error::FitError;
use crate::model::Parameter;
use crate::objective::{Objective, ROUNDING};
use crate::progress::Progress;
use crate::solver::polish;

/// Beyond so many standard deviations Huber's loss grows linearly: 95 % as efficient as least
/// squares where the errors are normal (Huber 1981).
const HUBER: f64 = 1.345;

/// Beyond so many standard deviations Tukey's loss is constant: 95 % as efficient as least squares
/// where the errors are normal (Beaton and Tukey 1974). Readings beyond it are called rejected.
pub const REJECTED: f64 = 4.685;

/// The median of the absolute value of a normal variable of standard deviation 1.
const NORMAL_MEDIAN: f64 = 0.674_489_75;

/// Weights are refined so many times at the most.
const MOST_ROUNDS: usize = 200;

/// The weights have settled when no parameter moves by more than this fraction.
const SETTLED: f64 = 1e-9;

/// A loss that grows less than the square for large residuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Loss {
    /// Square near zero, linear beyond 1.345 standard deviations.
    Huber,
    /// Constant beyond 4.685 standard deviations.
    Tukey,
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Huber => "huber",
            Self::Tukey => "tukey",
        })
    }
}

impl FromStr for Loss {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "huber" => Ok(Self::Huber),
            "tukey" => Ok(Self::Tukey),
            _ => Err(format!("\"{text}\": expected huber or tukey")),
        }
    }
}

impl Loss {
    /// The derivative of weight times deviations by the deviations.
    fn slope(self, deviations: f64) -> f64 {
        let x = deviations.abs();
        match self {
            Self::Huber => f64::from(u8::from(x < HUBER)),
            Self::Tukey if x < REJECTED => {
                let u2 = (x / REJECTED).powi(2);
                (1.0 - u2) * (1.0 - 5.0 * u2)
            }
            Self::Tukey => 0.0,
        }
    }

    /// The weight of a reading whose residual is so many standard deviations.
    fn weight(self, deviations: f64) -> f64 {
        let x = deviations.abs();
        match self {
            Self::Huber => (HUBER / x).min(1.0),
            Self::Tukey if x < REJECTED => (1.0 - (x / REJECTED).powi(2)).powi(2),
            Self::Tukey => 0.0,
        }
    }
}

/// What a robust fit did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RobustFit {
    /// The loss.
    pub loss: Loss,
    /// Standard deviation of the residuals by their median: of sqrt(g) (f - f_model) cos theta, as
    /// a fraction of the root of the denominator of E.
    pub scale: f64,
    /// E of the plain least squares fit, in percent.
    pub least_squares_e_percent: f64,
    /// What E over the degrees of freedom is to be multiplied by to have the variance of the terms,
    /// now that the weights follow the residuals: Huber's covariance of an M-estimate.
    pub variance_factor: f64,
    /// How many readings weigh less than 1/2 by the loss.
    pub reduced: usize,
    /// The readings that are more than 4.685 standard deviations off, the farthest first.
    pub rejected: Vec<Rejected>,
}

/// A reading that a robust fit rejects.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Rejected {
    /// Its index among the readings of the scan.
    pub reading: usize,
    /// How many standard deviations it is off: measured less model.
    pub deviations: f64,
}

/// The minimum under a loss next to that of least squares, by least squares that are weighted anew
/// with the residuals until nothing moves; the objective with the last weights; and what it did.
///
/// The scale is the median of the absolute residuals, by which a normal variable has the standard
/// deviation 1. Tukey's loss has several minima: it starts from Huber's and keeps its scale.
pub(crate) fn fit_robustly(
    objective: &Objective,
    loss: Loss,
    start: ModelParameters,
    free: &[Parameter],
    progress: &Progress<'_>,
) -> Result<(ModelParameters, Objective, RobustFit), FitError> {
    let (mut at, mut weighted, mut scale) =
        reweighted_fit(objective, Loss::Huber, start, free, None, progress)?;
    if loss == Loss::Tukey {
        let scale_of_huber = Some(scale);
        (at, weighted, scale) =
            reweighted_fit(objective, loss, at, free, scale_of_huber, progress)?;
    }
    let deviations = |(r, _): (f64, f64)| if scale > 0.0 { -r / scale } else { 0.0 };
    let deviations: Vec<f64> = objective
        .residuals(&at)
        .into_iter()
        .map(deviations)
        .collect();
    let mut rejected: Vec<Rejected> = deviations
        .iter()
        .zip(objective.readings())
        .filter(|(deviations, _)| deviations.abs() > REJECTED)
        .map(|(&deviations, &reading)| Rejected {
            reading,
            deviations,
        })
        .collect();
    rejected.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
    let reduced = deviations.iter().filter(|d| loss.weight(**d) < 0.5).count();
    let robust = RobustFit {
        loss,
        scale,
        variance_factor: variance_factor(loss, &deviations),
        least_squares_e_percent: 100.0 * objective.error(&start),
        reduced,
        rejected,
    };
    Ok((at, weighted, robust))
}

fn reweighted_fit(
    objective: &Objective,
    loss: Loss,
    start: ModelParameters,
    free: &[Parameter],
    fixed_scale: Option<f64>,
    progress: &Progress<'_>,
) -> Result<(ModelParameters, Objective, f64), FitError> {
    let mut at = start;
    let mut weighted = objective.clone();
    let mut scale = 0.0;
    for _ in 0..MOST_ROUNDS {
        let residuals = objective.residuals(&at);
        scale = fixed_scale.unwrap_or_else(|| median_scale(objective, &residuals, free.len()));
        if scale * scale * objective.len() as f64 <= ROUNDING {
            scale = 0.0;
            break;
        }
        // Where the loss takes every reading's say, the last weights stay.
        let Ok(next) = objective.reweighted(|row| loss.weight(residuals[row].0 / scale)) else {
            break;
        };
        if !next.suffices_for(free) {
            break;
        }
        weighted = next;
        let next = polish(&weighted, at, free, progress)?;
        let moved = free.iter().any(|parameter| {
            let (before, after) = (parameter.of(&at), parameter.of(&next));
            (after - before).abs() > SETTLED * before.abs().max(1e-12)
        });
        at = next;
        if !moved {
            break;
        }
    }
    Ok((at, weighted, scale))
}

/// See [`RobustFit::variance_factor`]: the mean square of weight times deviation over the square of
/// its mean slope, against what weighted least squares would take for it.
fn variance_factor(loss: Loss, deviations: &[f64]) -> f64 {
    let mean = |of: &dyn Fn(f64) -> f64| {
        deviations.iter().map(|&d| of(d)).sum::<f64>() / deviations.len() as f64
    };
    let influence = mean(&|d| (loss.weight(d) * d).powi(2));
    let slope = mean(&|d| loss.slope(d));
    let weighted = mean(&|d| loss.weight(d) * d * d) / mean(&|d| loss.weight(d));
    let factor = influence / (slope * slope) / weighted;
    if factor.is_finite() {
        factor.max(1.0)
    } else {
        1.0
    }
}

/// The standard deviation by the median of the absolute residuals of those that have a say, which
/// the free parameters have made smaller.
fn median_scale(objective: &Objective, residuals: &[(f64, f64)], free: usize) -> f64 {
    let (_, diffuse) = objective.fixed_columns();
    let rows = residuals.iter().zip(diffuse);
    let mut sizes: Vec<f64> = rows
        .filter(|(_, a)| **a > 0.0)
        .map(|((r, _), _)| r.abs())
        .collect();
    sizes.sort_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    let spare = sizes.len().saturating_sub(free).max(1) as f64;
    median / NORMAL_MEDIAN * (sizes.len() as f64 / spare).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FitOptions, Measurements, RefractiveIndex, fit};
    use brdf_core::Parameters;

    #[test]
    fn perfect_readings_are_not_rejected() {
        let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
        let scan = crate::scan::synthetic::scan(truth, 1.5);
        for loss in [Loss::Huber, Loss::Tukey] {
            let options = FitOptions {
                refractive_index: Some(RefractiveIndex::Same(1.5)),
                robust: Some(loss),
                ..FitOptions::default()
            };
            let fit = fit(&scan, &options).unwrap();
            assert_eq!(fit.robust.unwrap().rejected, []);
        }
    }

    #[test]
    fn a_few_bad_readings_are_rejected_and_do_not_move_the_fit() {
        let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
        let mut readings = crate::scan::synthetic::scan(truth, 1.5).readings().to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= 1.0 + 0.005 * (2.4 * i as f64).sin();
        }
        let bad = [20, 77, 130];
        for i in bad {
            readings[i].brdf *= 4.0;
        }
        let scan = Measurements::new("test", readings).unwrap();
        for loss in [None, Some(Loss::Huber), Some(Loss::Tukey)] {
            let options = FitOptions {
                refractive_index: Some(RefractiveIndex::Same(1.5)),
                robust: loss,
                ..FitOptions::default()
            };
            let fit = fit(&scan, &options).unwrap();
            let error = (fit.parameters.kd / 0.1 - 1.0).abs();
            let Some(robust) = fit.robust else {
                assert!(error > 0.02, "{error}");
                continue;
            };
            assert!(error < 0.01, "{loss:?}: {error}");
            for i in bad {
                assert!(
                    robust.rejected.iter().any(|rejected| rejected.reading == i),
                    "{i}"
                );
            }
            assert!(fit.e_percent > robust.least_squares_e_percent);
        }
    }
}
