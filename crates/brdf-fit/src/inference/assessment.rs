//! The assessment of a fit: everything that is inferred from it beyond the uncertainty of its
//! parameters.

use std::collections::HashSet;

use serde::{Deserialize, Serialize};

use super::cross_validation::{CrossValidation, cross_validation};
use super::model_comparison::{Candidate, LeftOut, assessed_readings, compare, least_squares};
use super::physics::Physics;
use super::refit::{Refitter, Without, sensitivity};
use super::verdict::{Verdict, verdict};
use crate::fit::{Fit, FitError, FitOptions, fit_scan};
use crate::model::Model;
use crate::progress::{NoObserver, Observer, Phase, Progress};
use crate::scan::Measurements;

/// The assessment of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Assessment {
    /// The number of readings that are assessed: all, or about
    /// [`ASSESSED_READINGS`](super::ASSESSED_READINGS) of them
    /// ([`ASSESSED_BINS`](super::ASSESSED_BINS) of a table).
    pub readings: usize,
    /// E of the fit over the assessed readings, in percent.
    pub e_percent: f64,
    /// The fit without each incidence; empty where incidences are left out several at a time.
    #[serde(default)]
    pub sensitivity: Vec<Without>,
    /// The prediction of each incidence from the other incidences; `None` where nothing can be
    /// predicted, as with a single incidence.
    #[serde(rename = "prediction")]
    pub cross_validation: Option<CrossValidation>,
    /// Whether the fit is physically possible.
    pub physics: Physics,
    /// The models of the hierarchy, and the reference models where they were asked for.
    pub models: Vec<Candidate>,
    /// The models that cannot be fitted to this scan.
    pub left_out: Vec<LeftOut>,
    /// Which model of the hierarchy suffices; `None` where nothing can be predicted.
    pub verdict: Option<Verdict>,
}

/// Assesses a fit of the measurements and compares it with the models of the hierarchy; with
/// `compare` also with the reference models.
///
/// Cross-validation and models are those of least squares fits without the condition
/// rho(psi) <= 1; the sensitivity is that of the fit itself without this condition. Readings that a
/// robust fit rejects are left out of all of them. Models that cannot
/// be fitted, for too few readings or without a refractive index, are listed with the reason.
///
/// # Errors
///
/// The fit of the assessed readings fails.
///
/// # Examples
///
/// ```no_run
/// use brdf_fit::assess;
/// use brdf_fit::{FitOptions, Measurements, RefractiveIndex, fit};
///
/// let options = FitOptions {
///     refractive_index: Some(RefractiveIndex::Same(1.5)),
///     ..FitOptions::default()
/// };
/// for scan in Measurements::read_csv("data/measured/z307_on_aluminium.csv")?.by_wavelength() {
///     let assessment = assess(&scan, &fit(&scan, &options)?, false)?;
///     if let Some(verdict) = &assessment.verdict {
///         println!("{verdict}");
///     }
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn assess(
    measurements: &Measurements,
    fit: &Fit,
    compare: bool,
) -> Result<Assessment, FitError> {
    assess_observed(measurements, fit, compare, &NoObserver)
}

/// [`assess`], reporting each step to `observer`, which may cancel.
pub(crate) fn assess_observed(
    measurements: &Measurements,
    fit: &Fit,
    with_references: bool,
    observer: &dyn Observer,
) -> Result<Assessment, FitError> {
    let progress = Progress::begin(observer, Phase::Assessment)?;
    let accepted = accepted_readings(measurements, fit);
    let accepted = accepted.as_ref().unwrap_or(measurements);
    let scan = &assessed_readings(accepted, &fit.options);
    let models = if with_references {
        Model::ALL.as_slice()
    } else {
        Model::HIERARCHY.as_slice()
    };
    let options = least_squares(&fit.options);
    let (compared, diagnostics) = rayon::join(
        || compare(scan, models, &options, &progress),
        || Diagnostics::of(scan, &fit.options, &progress),
    );
    let (models, left_out) = compared?;
    let diagnostics = diagnostics?;
    // A fit stays within the ranges of its parameters, which the domain contains.
    let physics = Physics::of(fit.model(), &fit.at())
        .map_err(|error| FitError::Solver(format!("it left the model's domain: {error}")))?;
    Ok(Assessment {
        readings: scan.readings().len(),
        e_percent: diagnostics.e_percent,
        sensitivity: diagnostics.sensitivity,
        cross_validation: diagnostics.cross_validation,
        physics,
        verdict: verdict(&models),
        models,
        left_out,
    })
}

/// The readings that a robust fit does not reject; `None` where it rejects none.
fn accepted_readings(measurements: &Measurements, fit: &Fit) -> Option<Measurements> {
    let robust = fit
        .robust
        .as_ref()
        .filter(|robust| !robust.rejected.is_empty())?;
    let rejected: HashSet<usize> = robust.rejected.iter().map(|r| r.reading).collect();
    let accepted = (0..measurements.readings().len()).filter(|i| !rejected.contains(i));
    Some(measurements.kept(accepted))
}

/// What the assessed readings show about the fit of the chosen model.
struct Diagnostics {
    e_percent: f64,
    sensitivity: Vec<Without>,
    cross_validation: Option<CrossValidation>,
}

impl Diagnostics {
    fn of(
        scan: &Measurements,
        options: &FitOptions,
        progress: &Progress<'_>,
    ) -> Result<Self, FitError> {
        let own = FitOptions {
            energy_limit: None,
            ..options.clone()
        };
        let fitted = fit_scan(scan, &own, progress)?;
        let plain = least_squares(options);
        let refitter = Refitter::new(&fitted, progress)?;
        let fits = if plain == own {
            refitter.cross_validating()?
        } else {
            refitter.without_each_fold()?
        };
        let sensitivity = sensitivity(&fitted.objective, &fits);
        let cross_validation = if plain == own {
            cross_validation(&fitted.objective, &fits)
        } else {
            let fitted = fit_scan(scan, &plain, progress)?;
            let fits = Refitter::new(&fitted, progress)?.cross_validating()?;
            cross_validation(&fitted.objective, &fits)
        };
        Ok(Self {
            e_percent: fitted.fit.e_percent,
            sensitivity,
            cross_validation,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit;
    use crate::inference::ASSESSED_READINGS;
    use crate::inference::test_scans::{options, rippled};

    fn assessment(scan: &Measurements, compare: bool) -> Assessment {
        assess(scan, &fit(scan, &options()).unwrap(), compare).unwrap()
    }

    #[test]
    fn the_verdict_names_the_model_that_the_scan_was_computed_from() {
        for (parameters, n, expected) in [
            ([0.0, 0.3, 0.2], 1.5, Model::Lambert),
            ([0.3, 0.0, 0.2], 1.5, Model::Specular),
            ([0.3, 0.1, 0.2], 1.5, Model::Three),
            ([0.3, 0.1, 0.2], 1.2, Model::ThreeN),
        ] {
            let assessment = assessment(&rippled(parameters, n, 0.02), false);
            assert_eq!(assessment.verdict.unwrap().model, Some(expected));
            assert_eq!(assessment.models.len(), Model::HIERARCHY.len());
        }
    }

    #[test]
    fn a_comparison_contains_the_reference_models() {
        let assessment = assessment(&rippled([0.3, 0.1, 0.2], 1.3, 0.02), true);
        let models: Vec<Model> = assessment.models.iter().map(|c| c.model).collect();
        assert_eq!(models, Model::ALL);
    }

    #[test]
    fn one_incidence_predicts_nothing() {
        let one = rippled([0.3, 0.1, 0.2], 1.5, 0.02);
        let readings = one
            .readings()
            .iter()
            .filter(|r| r.psi == 0.0)
            .copied()
            .collect();
        let one = Measurements::new("test", readings).unwrap();
        let assessment = assessment(&one, false);
        assert_eq!(assessment.cross_validation, None);
        assert_eq!(assessment.verdict, None);
        assert!(assessment.sensitivity.is_empty());
    }

    #[test]
    fn a_large_scan_is_assessed_by_some_of_its_readings() {
        let mut readings = Vec::new();
        while readings.len() < 3 * ASSESSED_READINGS {
            readings.extend_from_slice(rippled([0.3, 0.1, 0.2], 1.5, 0.02).readings());
        }
        let scan = Measurements::new("test", readings).unwrap();
        let assessment = assessment(&scan, false);
        assert!(assessment.readings <= ASSESSED_READINGS);
        assert_eq!(assessment.cross_validation.unwrap().incidences.len(), 8);
    }
}
