//! Fits that are robust against outliers, with the loss of Huber or of Tukey instead of the square.

use std::fmt;
use std::str::FromStr;

use brdf_core::ModelParameters;
use serde::{Deserialize, Serialize};

use super::error::FitError;
use crate::format::ParseError;
use crate::model::Parameter;
use crate::objective::{Objective, ROUNDING};
use crate::progress::Progress;
use crate::solver::polish;

/// The number of standard deviations beyond which Huber's loss grows linearly. With it the estimate is
/// 95 % as efficient as least squares for normal errors (Huber, "Robust Statistics", 1981).
const HUBER: f64 = 1.345;

/// The number of standard deviations beyond which Tukey's loss is constant, and readings are called
/// rejected. With it the estimate is 95 % as efficient as least squares for normal errors (Beaton and
/// Tukey, Technometrics 16, 147, 1974).
pub const REJECTED: f64 = 4.685;

/// The median of the absolute value of a standard normal variable.
const NORMAL_MEDIAN: f64 = 0.674_489_75;

/// The largest number of reweightings.
const MOST_ROUNDS: usize = 200;

/// The weights have converged when no parameter changes by more than this fraction.
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
    type Err = ParseError;

    fn from_str(text: &str) -> Result<Self, ParseError> {
        match text {
            "huber" => Ok(Self::Huber),
            "tukey" => Ok(Self::Tukey),
            _ => Err(ParseError::new(format!(
                "\"{text}\": expected huber or tukey"
            ))),
        }
    }
}

impl Loss {
    /// The derivative of weight times deviation with respect to the deviation.
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

    /// The mean of [`slope`](Self::slope) over normal residuals of the given standard deviation, in
    /// standard deviations of the loss.
    pub(crate) fn expected_slope(self, deviation: f64) -> f64 {
        // Strips of equal width up to four standard deviations.
        const STRIPS: u32 = 160;
        let (mut sum, mut weights) = (0.0, 0.0);
        for i in 0..STRIPS {
            let z = 4.0 * (f64::from(i) + 0.5) / f64::from(STRIPS);
            let weight = (-0.5 * z * z).exp();
            sum += weight * self.slope(deviation * z);
            weights += weight;
        }
        sum / weights
    }

    /// The weight of a reading, from its residual in standard deviations.
    fn weight(self, deviations: f64) -> f64 {
        let x = deviations.abs();
        match self {
            Self::Huber => (HUBER / x).min(1.0),
            Self::Tukey if x < REJECTED => (1.0 - (x / REJECTED).powi(2)).powi(2),
            Self::Tukey => 0.0,
        }
    }
}

/// The result of a robust fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RobustFit {
    /// The loss.
    pub loss: Loss,
    /// The robust standard deviation of the residuals sqrt(g) (f - f_model) cos theta, from the median
    /// of their absolute values, as a fraction of the root of the denominator of E.
    pub scale: f64,
    /// E of the least squares fit in percent.
    pub least_squares_e_percent: f64,
    /// E over the readings that are not rejected, in percent; `None` where all are zero.
    #[serde(default)]
    pub accepted_e_percent: Option<f64>,
    /// The factor that converts E over the degrees of freedom into the variance of the residuals, where
    /// the weights depend on the residuals: Huber's covariance of an M-estimate.
    pub variance_factor: f64,
    /// The number of readings with a weight below 1/2.
    pub reduced: usize,
    /// The readings with residuals beyond 4.685 standard deviations, the largest first.
    pub rejected: Vec<Rejected>,
}

/// A reading that a robust fit rejects.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Rejected {
    /// The index of the reading in the scan.
    pub reading: usize,
    /// Measured less model, in standard deviations.
    pub deviations: f64,
}

/// The weights of a robust fit, for the influence of each reading on its parameters.
#[derive(Debug, Clone)]
pub(crate) struct RobustWeights {
    /// The objective without the weights of the loss.
    pub(crate) objective: Objective,
    /// The weight of the loss of each row.
    pub(crate) weights: Vec<f64>,
    /// The loss.
    pub(crate) loss: Loss,
    /// The standard deviation of the loss, [`RobustFit::scale`].
    pub(crate) scale: f64,
    /// The mean derivative of weight times residual by the residual.
    pub(crate) mean_slope: f64,
}

/// The minimum under a robust loss next to that of least squares, by iteratively reweighted least
/// squares. Returns the parameters, the objective with the last weights, and a summary.
///
/// The scale is the median of the absolute residuals, normalised for normal errors. Tukey's loss has
/// several minima: its fit starts from that of Huber's loss and keeps its scale.
pub(crate) fn fit_robustly(
    objective: &Objective,
    loss: Loss,
    start: ModelParameters,
    free: &[Parameter],
    progress: &Progress<'_>,
) -> Result<(ModelParameters, Objective, RobustFit, RobustWeights), FitError> {
    let (mut at, mut weighted, mut scale) =
        reweighted_fit(objective, Loss::Huber, start, free, None, progress)?;
    if loss == Loss::Tukey {
        let scale_of_huber = Some(scale);
        (at, weighted, scale) =
            reweighted_fit(objective, loss, at, free, scale_of_huber, progress)?;
    }
    let deviation = |r: f64| if scale > 0.0 { -r / scale } else { 0.0 };
    let residuals = objective.residuals(&at);
    let deviations: Vec<f64> = residuals.iter().map(|(r, _)| deviation(*r)).collect();
    let accepted = residuals
        .iter()
        .filter(|(r, _)| deviation(*r).abs() <= REJECTED);
    let (above, below) = accepted.fold((0.0, 0.0), |(above, below), (r, y)| {
        (above + r * r, below + y * y)
    });
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
        accepted_e_percent: (below > 0.0).then(|| 100.0 * above / below),
        least_squares_e_percent: 100.0 * objective.error(&start),
        reduced,
        rejected,
    };
    let mean_slope = mean(&deviations, |d| loss.slope(d));
    let weights = RobustWeights {
        objective: objective.clone(),
        weights: deviations.iter().map(|&d| loss.weight(d)).collect(),
        loss,
        scale,
        mean_slope: if mean_slope > 0.0 { mean_slope } else { 1.0 },
    };
    Ok((at, weighted, robust, weights))
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
        // If the loss gives every reading zero weight, the last weights are kept.
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

fn mean(deviations: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    deviations.iter().map(|&d| of(d)).sum::<f64>() / deviations.len() as f64
}

/// [`RobustFit::variance_factor`]: the mean square of weight times deviation over the square of its
/// mean slope, relative to the value that weighted least squares implies.
fn variance_factor(loss: Loss, deviations: &[f64]) -> f64 {
    let influence = mean(deviations, |d| (loss.weight(d) * d).powi(2));
    let slope = mean(deviations, |d| loss.slope(d));
    let weighted =
        mean(deviations, |d| loss.weight(d) * d * d) / mean(deviations, |d| loss.weight(d));
    let factor = influence / (slope * slope) / weighted;
    if factor.is_finite() {
        factor.max(1.0)
    } else {
        1.0
    }
}

/// The standard deviation from the median of the absolute residuals of the readings with weight,
/// corrected for the number of free parameters.
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
    use crate::fit::{FitOptions, fit};
    use crate::scan::{Measurements, RefractiveIndex};
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

    #[test]
    fn the_expected_slope_of_huber_is_the_share_of_small_residuals() {
        // P(|z| < 1.345) of a standard normal variable, and of one twice as wide.
        for (deviation, expected) in [(1.0, 0.8214), (2.0, 0.4987)] {
            let found = Loss::Huber.expected_slope(deviation);
            assert!((found - expected).abs() < 0.01, "{found}");
        }
        assert_eq!(Loss::Huber.expected_slope(0.0), 1.0);
    }
}
