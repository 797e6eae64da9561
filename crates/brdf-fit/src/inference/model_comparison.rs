//! The comparison of models: every candidate fitted to the same readings, and the smallest model
//! that predicts well enough.

use std::sync::atomic::{AtomicUsize, Ordering};

use brdf_core::{AnyBrdf, ModelParameters};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::cross_validation::{RelativePrediction, cross_validation, relative_prediction};
use super::estimate::Estimate;
use super::physics::violation_deg;
use super::refit::Refitter;
use super::uncertainty::{Tests, Uncertainty};
use super::verdict::verdict;
use crate::fit::{Fit, FitError, FitOptions, fit_scan};
use crate::model::Model;
use crate::objective::Objective;
use crate::objective::weights::{AssumedErrors, Weights};
use crate::progress::{Cancelled, Observer, Part, Phase, Progress, Task};
use crate::scan::Measurements;

/// Largest number of readings of an assessment, approximately: it fits some hundred times.
pub const ASSESSED_READINGS: usize = 4096;

/// Largest number of readings of an assessment of a table, the channels of which are assessed one
/// after another.
pub const ASSESSED_BINS: usize = 2048;

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
    /// The prediction of incidences by fits of relative errors, which the verdict is based on; `None`
    /// where a relative error is not defined.
    #[serde(default)]
    pub relative_prediction: Option<RelativePrediction>,
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
    let errors = match options.weights.errors {
        AssumedErrors::Relative => AssumedErrors::Constant,
        errors => errors,
    };
    FitOptions {
        energy_limit: None,
        robust: None,
        weights: Weights {
            errors,
            ..options.weights.clone()
        },
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
    let begun = AtomicUsize::new(0);
    let fit = |model: Model| {
        progress.begin_part(Part {
            task: Task::Model,
            number: begun.fetch_add(1, Ordering::Relaxed) + 1,
            count: models.len(),
        })?;
        try_candidate(scan, model, options, progress)
    };
    let fitted: Vec<_> = models
        .par_iter()
        .map(|&model| (model, fit(model)))
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
    Ok((candidates, left_out))
}

/// The model of the hierarchy that suffices for a scan, see [`Verdict`](super::Verdict); the paper's model where
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
    for (i, model) in Model::HIERARCHY.into_iter().enumerate() {
        progress.begin_part(Part {
            task: Task::Model,
            number: i + 1,
            count: Model::HIERARCHY.len(),
        })?;
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

/// Fits one model and predicts each incidence with it.
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
    let (fit, at) = (&fitted.fit, fitted.fit.at());
    let brdf = AnyBrdf::new(model.family(), &at).ok();
    let fits = Refitter::new(&fitted, progress)?.without_each_fold()?;
    let predicted = cross_validation(&fitted.objective, &fits);
    let uncertainty = Uncertainty::of_fit(scan, &fitted, Tests::Omitted, progress)?;
    Ok(Candidate {
        model,
        parameters: at,
        e_percent: fit.e_percent,
        predicted_e_percent: predicted.as_ref().map(|p| p.e_percent),
        predicted_incidences: predicted.map_or(0, |p| p.count()),
        relative_prediction: relative_errors(scan, fit, progress)?,
        estimates: uncertainty.estimates,
        violation_deg: brdf.as_ref().and_then(violation_deg),
    })
}

/// The prediction of incidences by fits of relative errors.
fn relative_errors(
    scan: &Measurements,
    fit: &Fit,
    progress: &Progress<'_>,
) -> Result<Option<RelativePrediction>, Cancelled> {
    let weights = Weights {
        errors: AssumedErrors::Constant,
        ..fit.options.weights.clone()
    };
    let objective = Objective::new(scan, fit.model().family(), fit.n, &weights)
        .and_then(|objective| objective.relative(None));
    let Ok(objective) = objective else {
        return Ok(None);
    };
    let refitter = Refitter::searching(&objective, fit.options.reduced_model(), progress)?;
    relative_prediction(&refitter).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inference::test_scans::{options, rippled};
    use crate::progress::NoObserver;

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
