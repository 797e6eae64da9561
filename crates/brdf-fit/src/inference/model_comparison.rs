//! The comparison of models: every candidate fitted to the same readings, and the smallest model
//! that predicts well enough.

use std::fmt;

use brdf_core::{AnyBrdf, ModelParameters};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::cross_validation::leave_one_out;
use super::estimate::Estimate;
use super::physics::violation_deg;
use super::refit::Refitter;
use super::uncertainty::Uncertainty;
use crate::fit::{Fit, FitError, FitOptions, fit_scan};
use crate::model::Model;
use crate::progress::{Cancelled, Observer, Phase, Progress};
use crate::scan::Measurements;

/// By which fraction the root mean square prediction error of the model that suffices may exceed
/// that of the best model.
pub const VERDICT_MARGIN: f64 = 0.1;

/// Above this E a model does not describe a sample: its root mean square deviation is about a third
/// of the readings (the square root of 10 %). The paper's own fits have 1.7 ... 6.5 %.
pub const NOT_DESCRIBED_PERCENT: f64 = 10.0;

/// Largest number of readings of an assessment, approximately: it fits some hundred times.
pub const ASSESSED_READINGS: usize = 4096;

/// Largest number of readings of an assessment of a table, the channels of which are assessed one
/// after another.
pub const ASSESSED_BINS: usize = 2048;

/// Below this E, in percent, differences are those of rounding.
const ROUNDING_PERCENT: f64 = 1e-18;

/// One model fitted to the scan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// The model.
    pub model: Model,
    /// Its parameters.
    pub parameters: ModelParameters,
    /// E over all readings, in percent.
    pub e_percent: f64,
    /// E of the leave-one-incidence-out [cross-validation](super::CrossValidation), in percent;
    /// `None` where no incidence can be predicted.
    pub predicted_e_percent: Option<f64>,
    /// The number of incidences that are predicted: the other incidences suffice for a fit.
    pub predicted_incidences: usize,
    /// Akaike's information criterion, corrected for few readings, less that of the best candidate;
    /// `None` with too few readings for the correction.
    ///
    /// AICc = N ln E + 2 K + 2 K (K + 1)/(N - K - 1), with N readings of non-zero weight and K free
    /// parameters, that of the variance included. It assumes that the terms under the sum of E have
    /// independent normal errors of equal variance. The errors of a scan are rarely independent, so
    /// that it favours large models. (Akaike, IEEE Transactions on Automatic Control 19, 716, 1974;
    /// Hurvich and Tsai, Biometrika 76, 297, 1989.)
    pub aicc_above_best: Option<f64>,
    /// One estimate for each free parameter.
    pub estimates: Vec<Estimate>,
    /// The smallest incidence angle at which the hemispherical reflectance exceeds 1, in degrees;
    /// `None` where it does not up to 89 deg.
    pub violation_deg: Option<f64>,
}

/// A model that cannot be fitted to the scan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LeftOut {
    /// The model.
    pub model: Model,
    /// Why.
    pub reason: String,
}

/// Which model of the hierarchy suffices for a scan.
///
/// The candidates are compared by the E of their cross-validation. The smallest model suffices whose
/// root mean square error, the square root of E, exceeds that of the best by no more than [`VERDICT_MARGIN`].
/// A parameter that does not improve the prediction of other incidences is thus left out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The model that suffices; `None` where the E of the best prediction is above
    /// [`NOT_DESCRIBED_PERCENT`].
    pub model: Option<Model>,
    /// The model with the best prediction.
    pub best: Model,
    /// E of that prediction, in percent.
    pub best_e_percent: f64,
    /// [`VERDICT_MARGIN`].
    pub margin: f64,
}

/// The verdict as a clause.
impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(model) = self.model else {
            return write!(
                f,
                "no model of the hierarchy predicts incidences to which it is not fitted: the best, \
                 {}, has E = {:.3} %",
                self.best, self.best_e_percent
            );
        };
        write!(f, "{model} suffices ({})", model.description())?;
        if model == self.best {
            write!(f, "; no model of the hierarchy predicts better")
        } else {
            write!(
                f,
                ": it is the smallest model whose prediction error (root mean square) is at most \
                 {:.0} % larger than that of {}, the best",
                100.0 * self.margin,
                self.best
            )
        }
    }
}

/// The readings that are assessed: those that a fit uses, thinned out to a limit.
pub(super) fn assessed_readings(measurements: &Measurements, options: &FitOptions) -> Measurements {
    let limit = if measurements.is_table() {
        ASSESSED_BINS
    } else {
        ASSESSED_READINGS
    };
    options.fitted_readings(measurements).thinned(limit)
}

/// The options with which models are compared: least squares, without the condition rho(psi) <= 1.
pub(super) fn least_squares(options: &FitOptions) -> FitOptions {
    FitOptions {
        energy_limit: None,
        robust: None,
        ..options.clone()
    }
}

/// Fits models to a scan in parallel: the candidates, and the models that cannot be fitted.
///
/// # Errors
///
/// The observer has cancelled the assessment.
pub(super) fn compare(
    scan: &Measurements,
    models: &[Model],
    options: &FitOptions,
    progress: &Progress<'_>,
) -> Result<(Vec<Candidate>, Vec<LeftOut>), Cancelled> {
    let fitted: Vec<_> = models
        .par_iter()
        .map(|&model| (model, try_candidate(scan, model, options, progress)))
        .collect();
    let (mut candidates, mut left_out) = (Vec::new(), Vec::new());
    for (model, candidate) in fitted {
        match candidate {
            Ok(candidate) => candidates.push(candidate),
            Err(FitError::Cancelled) => return Err(Cancelled),
            Err(error) => left_out.push(LeftOut {
                model,
                reason: error.to_string(),
            }),
        }
    }
    let best = candidates.iter().filter_map(|c| c.aicc_above_best);
    let best = best.fold(f64::INFINITY, f64::min);
    for candidate in &mut candidates {
        candidate.aicc_above_best = candidate.aicc_above_best.map(|aicc| aicc - best);
    }
    Ok((candidates, left_out))
}

/// The model of the hierarchy that suffices for a scan, see [`Verdict`]; the paper's model where
/// nothing can be predicted. Each step is reported to `observer`, which may cancel.
pub(crate) fn sufficient_model(
    measurements: &Measurements,
    options: &FitOptions,
    observer: &dyn Observer,
) -> Result<Model, Cancelled> {
    let progress = Progress::begin(observer, Phase::Assessment)?;
    let scan = assessed_readings(measurements, options);
    let options = least_squares(options);
    let mut candidates = Vec::new();
    for model in Model::HIERARCHY {
        let candidate = try_candidate(&scan, model, &options, &progress);
        match candidate {
            Err(FitError::Cancelled) => return Err(Cancelled),
            candidate => candidates.extend(candidate),
        }
    }
    Ok(verdict(&candidates)
        .and_then(|verdict| verdict.model)
        .unwrap_or(Model::Three))
}

/// Fits one model, with its AICc itself in place of the difference to the best.
fn try_candidate(
    scan: &Measurements,
    model: Model,
    options: &FitOptions,
    progress: &Progress<'_>,
) -> Result<Candidate, FitError> {
    let options = FitOptions {
        start: None,
        ..options.with_model(model)
    };
    let fitted = fit_scan(scan, &options, progress)?;
    let (fit, objective, at) = (&fitted.fit, &fitted.objective, fitted.fit.at());
    let brdf = AnyBrdf::new(model.family(), &at).ok();
    let predicted = leave_one_out(&Refitter::new(&fitted, progress)?)?;
    let (reduced_model, given_sigma) = (options.reduced_model(), options.weights.by_sigma);
    let uncertainty = Uncertainty::of(objective, reduced_model, &at, given_sigma, 1.0, progress)?;
    Ok(Candidate {
        model,
        parameters: at,
        e_percent: fit.e_percent,
        predicted_e_percent: predicted.as_ref().map(|p| p.e_percent),
        predicted_incidences: predicted.map_or(0, |p| p.count()),
        aicc_above_best: aicc(fit),
        estimates: uncertainty.estimates,
        violation_deg: brdf.as_ref().and_then(violation_deg),
    })
}

/// AICc: see [`Candidate::aicc_above_best`].
fn aicc(fit: &Fit) -> Option<f64> {
    let readings = (fit.readings - fit.zero_weight) as f64;
    let parameters = (fit.options.free().len() + 1) as f64;
    let spare = readings - parameters - 1.0;
    if spare <= 0.0 {
        return None;
    }
    let e = (0.01 * fit.e_percent).max(f64::MIN_POSITIVE);
    let correction = 2.0 * parameters * (parameters + 1.0) / spare;
    Some(readings * e.ln() + 2.0 * parameters + correction)
}

/// The verdict on the candidates of the hierarchy, which are in ascending order of their size;
/// `None` where nothing is predicted.
pub(super) fn verdict(candidates: &[Candidate]) -> Option<Verdict> {
    let hierarchy = candidates
        .iter()
        .filter(|candidate| Model::HIERARCHY.contains(&candidate.model));
    // Only predictions of the same incidences are comparable.
    let most = hierarchy.clone().map(|c| c.predicted_incidences).max()?;
    let predicted: Vec<(Model, f64)> = hierarchy
        .filter(|candidate| candidate.predicted_incidences == most)
        .filter_map(|candidate| Some((candidate.model, candidate.predicted_e_percent?)))
        .collect();
    let best = predicted.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    // E is a mean square: the margin is one of its root.
    let limit = (best.1 * (1.0 + VERDICT_MARGIN).powi(2)).max(ROUNDING_PERCENT);
    let smallest = predicted.iter().find(|(_, e)| *e <= limit)?;
    Some(Verdict {
        model: (best.1 <= NOT_DESCRIBED_PERCENT).then_some(smallest.0),
        best: best.0,
        best_e_percent: best.1,
        margin: VERDICT_MARGIN,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inference::test_scans::{options, rippled};
    use crate::progress::NoObserver;

    fn candidate(model: Model, predicted_e_percent: f64, predicted_incidences: usize) -> Candidate {
        Candidate {
            model,
            parameters: ModelParameters {
                k2: 0.1,
                kd: 0.1,
                k1: 0.2,
                n: 1.5,
                p: 1.0,
            },
            e_percent: 1.0,
            predicted_e_percent: Some(predicted_e_percent),
            predicted_incidences,
            aicc_above_best: None,
            estimates: Vec::new(),
            violation_deg: None,
        }
    }

    #[test]
    fn the_smallest_model_within_the_margin_suffices() {
        let verdict = verdict(&[
            candidate(Model::Lambert, 5.0, 8),
            candidate(Model::Three, 1.2, 8),
            candidate(Model::ThreeN, 1.0, 8),
            candidate(Model::GgxN, 0.1, 8),
        ]);
        let verdict = verdict.unwrap();
        assert_eq!(verdict.model, Some(Model::Three));
        assert_eq!((verdict.best, verdict.best_e_percent), (Model::ThreeN, 1.0));
        assert!(
            verdict
                .to_string()
                .contains("at most 10 % larger than that of three+n")
        );
    }

    #[test]
    fn predictions_of_fewer_incidences_are_not_compared_and_bad_ones_do_not_suffice() {
        let verdict = verdict(&[
            candidate(Model::Lambert, 20.0, 8),
            candidate(Model::Three, 1.0, 7),
        ]);
        let verdict = verdict.unwrap();
        assert_eq!((verdict.model, verdict.best), (None, Model::Lambert));
        assert!(verdict.to_string().contains("E = 20.000 %"));
        assert_eq!(super::verdict(&[]), None);
    }

    #[test]
    fn a_free_parameter_never_raises_e() {
        let scan = rippled([0.3, 0.1, 0.2], 1.3, 0.02);
        let progress = Progress::new(&NoObserver, Phase::Assessment);
        let (candidates, left_out) = compare(&scan, &Model::ALL, &options(), &progress).unwrap();
        assert_eq!(left_out, []);
        let e = |model| {
            let mut all = candidates.iter();
            all.find(|c| c.model == model).unwrap().e_percent
        };
        for (smaller, larger) in [
            (Model::Lambert, Model::Three),
            (Model::Specular, Model::Three),
            (Model::Three, Model::ThreeN),
            (Model::ThreeN, Model::PowerN),
            (Model::Ggx, Model::GgxN),
            (Model::Beckmann, Model::BeckmannN),
        ] {
            assert!(e(larger) <= e(smaller) * (1.0 + 1e-9), "{larger} {smaller}");
        }
    }

    #[test]
    fn the_sufficient_model_is_the_one_that_the_scan_was_computed_from() {
        for (parameters, n, expected) in [
            ([0.0, 0.3, 0.2], 1.5, Model::Lambert),
            ([0.3, 0.1, 0.2], 1.2, Model::ThreeN),
        ] {
            let scan = rippled(parameters, n, 0.02);
            assert_eq!(
                sufficient_model(&scan, &options(), &NoObserver),
                Ok(expected)
            );
        }
    }
}
