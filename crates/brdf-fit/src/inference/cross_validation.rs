//! Leave-one-incidence-out cross-validation: how well the model predicts incidences that it was not
//! fitted to.

use brdf_core::ModelParameters;
use serde::{Deserialize, Serialize};

use super::refit::Refitter;
use crate::format::in_degrees;
use crate::objective::{IncidenceError, Objective, Segment};
use crate::progress::Cancelled;

/// An incidence with fewer readings is never left out for the relative prediction.
const FEWEST_READINGS: usize = 3;

/// The prediction of each incidence from a fit of the other incidences.
///
/// Each incidence is left out once, the model is fitted to the others, and the left-out readings
/// are compared with the prediction. The E of all predictions,
///
/// ```text
/// E = sum over incidences |y_i - f(fit of the others)_i|^2 / sum over incidences |y_i|^2,
/// ```
///
/// estimates the error of the model at incidences that were not measured. It assumes that the
/// incidences are independent of each other, not that the readings of one incidence are. (Stone,
/// "Cross-validatory choice and assessment of statistical predictions", Journal of the Royal
/// Statistical Society B 36, 111, 1974.)
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CrossValidation {
    /// E of the prediction of each incidence; `None` where the other incidences do not suffice for
    /// a fit, and where all readings of the incidence are zero.
    pub incidences: Vec<IncidenceError>,
    /// E of all predictions, in percent.
    pub e_percent: f64,
}

impl CrossValidation {
    /// The number of incidences that are predicted.
    pub fn count(&self) -> usize {
        let predicted = |incidence: &&IncidenceError| incidence.e_percent.is_some();
        self.incidences.iter().filter(predicted).count()
    }
}

/// Predicts each incidence from the fits without each fold; `None` where nothing can be predicted, as
/// with a single incidence.
///
/// More than [`MOST_FOLDS`](crate::objective::MOST_FOLDS) incidences are left out in that many
/// folds of several incidences each.
pub(super) fn cross_validation(
    objective: &Objective,
    fits: &[Option<ModelParameters>],
) -> Option<CrossValidation> {
    let (mut above, mut below) = (0.0, 0.0);
    let segments = objective.segments().iter().enumerate();
    let incidences = segments.map(|(i, segment)| {
        let others = fits[i % fits.len()].as_ref();
        let sums = others.map(|others| objective.squares_of(others, segment));
        if let Some((errors, readings)) = sums {
            above += errors;
            below += readings;
        }
        let percent = |(errors, readings): (f64, f64)| 100.0 * errors / readings;
        let sums = sums.filter(|(_, readings)| *readings > 0.0);
        // A prediction may be larger than any number.
        let error = sums.map(percent).filter(|error| error.is_finite());
        IncidenceError::new(segment, error)
    });
    let incidences = incidences.collect();
    let e_percent = 100.0 * above / below;
    e_percent.is_finite().then_some(CrossValidation {
        incidences,
        e_percent,
    })
}

/// The prediction of incidences by fits of relative errors to the other incidences, compared on a
/// logarithmic scale, in which each incidence counts once.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RelativePrediction {
    /// The predicted incidences, in ascending order.
    pub incidences: Vec<PredictedIncidence>,
    /// Readings that are not above zero, which have no logarithm.
    pub not_positive: usize,
}

/// The prediction of one incidence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PredictedIncidence {
    /// The incidence angle in degrees.
    pub psi_deg: f64,
    /// The rms of the logarithm of predicted over measured f_r; `None` where the model predicts zero.
    pub log_error: Option<f64>,
}

impl PredictedIncidence {
    fn log_of_error(&self) -> f64 {
        // An exact prediction is one of rounding.
        self.log_error
            .map_or(f64::INFINITY, |error| error.max(1e-12).ln())
    }

    /// The typical error of the prediction, exp(log error) - 1, in percent.
    pub fn within_percent(&self) -> f64 {
        100.0 * self.log_error.map_or(f64::INFINITY, f64::exp_m1)
    }
}

impl RelativePrediction {
    /// S, the mean over incidences of the logarithm of their errors.
    pub fn score(&self) -> f64 {
        let sum: f64 = self
            .incidences
            .iter()
            .map(PredictedIncidence::log_of_error)
            .sum();
        sum / self.incidences.len() as f64
    }

    /// The typical error of a prediction, exp(exp S) - 1, in percent.
    pub fn within_percent(&self) -> f64 {
        100.0 * self.score().exp().exp_m1()
    }

    /// The mean over incidences of the difference of the logarithms of two errors, and its standard
    /// error.
    pub(super) fn difference(&self, other: &Self) -> (f64, f64) {
        let differences: Vec<f64> = self
            .incidences
            .iter()
            .zip(&other.incidences)
            .map(|(own, other)| own.log_of_error() - other.log_of_error())
            .collect();
        let count = differences.len() as f64;
        let mean = differences.iter().sum::<f64>() / count;
        let squares: f64 = differences.iter().map(|d| (d - mean).powi(2)).sum();
        (mean, (squares / (count - 1.0) / count).sqrt())
    }
}

/// Predicts each incidence of at least three readings from fits without it.
pub(super) fn relative_prediction(
    refitter: &Refitter<'_>,
) -> Result<RelativePrediction, Cancelled> {
    let objective = refitter.objective;
    let folds = objective.folds();
    let mut fits: Vec<Option<Option<ModelParameters>>> = vec![None; folds];
    let mut prediction = RelativePrediction {
        incidences: Vec::new(),
        not_positive: 0,
    };
    for (i, segment) in objective.segments().iter().enumerate() {
        if segment.used() < FEWEST_READINGS {
            continue;
        }
        let fold = i % folds;
        let fit = match fits[fold] {
            Some(fit) => fit,
            None => *fits[fold].insert(refitter.without(fold)?),
        };
        let Some(at) = fit else { continue };
        let (log_error, not_positive) = log_error(objective, segment, &at);
        prediction.not_positive += not_positive;
        prediction
            .incidences
            .extend(log_error.map(|error| PredictedIncidence {
                psi_deg: in_degrees(segment.psi),
                log_error: Some(error).filter(|error| error.is_finite()),
            }));
    }
    Ok(prediction)
}

/// The rms of ln(predicted/measured) over the readings of an incidence that are above zero, and the
/// number of the others.
fn log_error(
    objective: &Objective,
    segment: &Segment,
    at: &ModelParameters,
) -> (Option<f64>, usize) {
    let (mut squares, mut count, mut not_positive) = (0.0, 0_usize, 0);
    let (_, diffuse) = objective.fixed_columns();
    let weights = &diffuse[segment.rows.clone()];
    for ((r, y), weight) in objective
        .residuals_of(at, segment.rows.clone())
        .iter()
        .zip(weights)
    {
        if *weight == 0.0 {
            continue;
        }
        if *y > 0.0 {
            squares += ((r + y) / y).max(0.0).ln().powi(2);
            count += 1;
        } else {
            not_positive += 1;
        }
    }
    let error = (count > 0).then(|| (squares / count as f64).sqrt());
    (error, not_positive)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::fit_scan;
    use crate::inference::test_scans::{options, rippled};
    use crate::progress::{NoObserver, Phase, Progress};

    #[test]
    fn the_prediction_of_an_incidence_is_the_fit_of_the_scan_without_it() {
        let scan = rippled([0.3, 0.1, 0.2], 1.5, 0.02);
        let fitted = fit_scan(&scan, &options(), &NoObserver).unwrap();
        let progress = Progress::new(&NoObserver, Phase::Assessment);
        let refitter = Refitter::new(&fitted, &progress).unwrap();
        let fits = refitter.without_each_fold().unwrap();
        let found = cross_validation(&fitted.objective, &fits).unwrap();
        assert_eq!(found.count(), scan.incidences().len());
        let without: Vec<usize> = scan.incidences()[1..]
            .iter()
            .flat_map(|incidence| incidence.readings.iter().copied())
            .collect();
        let others = fit_scan(&scan.kept(without), &options(), &NoObserver).unwrap();
        let first = &fitted.objective.segments()[0];
        let (errors, readings) = fitted.objective.squares_of(&others.fit.at(), first);
        let e_percent = found.incidences[0].e_percent.unwrap();
        assert!((e_percent / (100.0 * errors / readings) - 1.0).abs() < 1e-6);
    }

    /// Ripples of 2 % in the readings are errors of about 1.4 % in the logarithm.
    #[test]
    fn the_relative_prediction_of_a_rippled_scan_is_as_large_as_its_ripples() {
        let scan = rippled([0.3, 0.1, 0.2], 1.5, 0.02);
        let fitted = fit_scan(&scan, &options(), &NoObserver).unwrap();
        let progress = Progress::new(&NoObserver, Phase::Assessment);
        let objective = fitted.objective.relative(None).unwrap();
        let model = fitted.fit.options.reduced_model();
        let refitter = Refitter::searching(&objective, model, &progress).unwrap();
        let found = relative_prediction(&refitter).unwrap();
        assert_eq!(found.incidences.len(), scan.incidences().len());
        assert_eq!(found.not_positive, 0);
        assert!((1.0..3.0).contains(&found.within_percent()), "{found:?}");
        assert_eq!(found.difference(&found), (0.0, 0.0));
    }
}
