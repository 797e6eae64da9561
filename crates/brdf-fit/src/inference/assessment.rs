//! What a fit is worth: its uncertainty, its prediction of what was not measured, whether it is
//! physically possible, and whether a smaller model would do.

use std::collections::HashSet;
use std::fmt;

use brdf_core::fresnel::Dielectric;
use brdf_core::{AnyBrdf, ModelParameters};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::fit::{Fit, FitError, FitOptions, fit_scan};
use crate::inference::cross_validation::{Prediction, Spread, bootstrap, leave_one_out};
use crate::inference::uncertainty::{Estimate, Uncertainty};
use crate::inference::warning::NOT_DESCRIBED_PERCENT;
use crate::model::Model;
use crate::progress::{Cancelled, NoObserver, Observer, Phase, Progress};
use crate::scan::Measurements;

/// The verdict takes a smaller model when the root mean square error of its prediction is not
/// larger than that of the best by more than this fraction.
pub const MARGIN: f64 = 0.1;

/// An assessment takes about so many readings at the most: it fits some hundred times.
pub const ASSESSED_READINGS: usize = 4096;

/// The same of a table, the channels of which are assessed one after the other.
pub const ASSESSED_BINS: usize = 2048;

/// Below this E nothing but rounding is left.
const ROUNDING_PERCENT: f64 = 1e-18;

/// Incidence angles of the table of reflectances, in degrees.
const PSI_DEG: [f64; 8] = [0.0, 15.0, 30.0, 45.0, 60.0, 70.0, 80.0, 85.0];

/// Relative tolerance of the reflectances.
const TOLERANCE: f64 = 1e-4;

/// What a fit is worth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Assessment {
    /// How many readings it rests on: all, or about [`ASSESSED_READINGS`] of them
    /// ([`ASSESSED_BINS`] of a table).
    pub readings: usize,
    /// E of the fit that is assessed, over the readings that it rests on, in percent.
    pub e_percent: f64,
    /// The spread of each parameter over bootstrap resamples of the incidences; empty where there
    /// are fewer than 3.
    pub bootstrap: Vec<Spread>,
    /// Each incidence predicted from the others; `None` where there is but one.
    pub prediction: Option<Prediction>,
    /// Whether the fit is physically possible.
    pub physics: Physics,
    /// The ladder of models, and the neighbours where they were asked for.
    pub models: Vec<Candidate>,
    /// The models that cannot be fitted to this scan.
    pub left_out: Vec<LeftOut>,
    /// Which model of the ladder suffices; `None` where nothing can be predicted.
    pub verdict: Option<Verdict>,
}

/// Energy and facet reflectance of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Physics {
    /// Directional-hemispherical reflectance over the incidence angle.
    pub reflectance: Vec<Reflectance>,
    /// The incidence from which the reflectance is above 1, in degrees, looked for up to 89 deg.
    pub violation_deg: Option<f64>,
    /// The facet reflectance at normal incidence that k2 implies.
    pub implied_facet_reflectance: f64,
    /// The one that the refractive index means, ((n - 1)/(n + 1))^2.
    pub fresnel_reflectance: f64,
}

/// The reflectance at one incidence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reflectance {
    /// Incidence angle in degrees.
    pub psi_deg: f64,
    /// rho(psi).
    pub rho: f64,
}

/// One model fitted to the scan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// The model.
    pub model: Model,
    /// Its parameters.
    pub parameters: ModelParameters,
    /// E over all readings, in percent.
    pub e_percent: f64,
    /// E of the prediction of each incidence from the others, in percent.
    pub predicted_e_percent: Option<f64>,
    /// How many incidences could be predicted: those whose others suffice for a fit.
    pub predicted_incidences: usize,
    /// Akaike's information objective with the correction for few readings, less that of the best:
    /// N ln E + 2 K + 2 K (K + 1)/(N - K - 1), K being the free parameters and the variance. It
    /// assumes that the terms under the sum of E err independently of each other, normally and
    /// alike; the readings of a scan rarely do, so that it favours large models.
    /// `None` where there are too few readings for it.
    pub aicc_above_best: Option<f64>,
    /// What the data say of each free parameter.
    pub estimates: Vec<Estimate>,
    /// The incidence from which the reflectance is above 1, in degrees.
    pub violation_deg: Option<f64>,
}

/// A model that cannot be fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LeftOut {
    /// The model.
    pub model: Model,
    /// Why.
    pub reason: String,
}

/// Which model of the ladder suffices.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The smallest model whose prediction is not worse than the best by more than the margin;
    /// `None` where even the best is no prediction.
    pub model: Option<Model>,
    /// The model of the ladder that predicts best.
    pub best: Model,
    /// E of its prediction, in percent.
    pub best_e_percent: f64,
    /// [`MARGIN`]: by which fraction the root mean square error may be larger.
    pub margin: f64,
}

/// The verdict as a sentence.
impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(model) = self.model else {
            return write!(
                f,
                "no model of the ladder predicts incidences it was not fitted to: the best, {}, \
                 with E = {:.3} %",
                self.best, self.best_e_percent
            );
        };
        write!(f, "{model} suffices ({})", model.description())?;
        if model == self.best {
            write!(f, "; no model of the ladder predicts better")
        } else {
            write!(
                f,
                ": it is the smallest whose prediction errs by no more than {:.0} % more (root \
                 mean square) than that of {}, the best",
                100.0 * self.margin,
                self.best
            )
        }
    }
}

impl Physics {
    /// The physics of a fitted model.
    ///
    /// `None` where the parameters are outside of the model's domain.
    pub fn of(model: Model, at: &ModelParameters) -> Option<Self> {
        let brdf = AnyBrdf::new(model.family(), at).ok()?;
        let reflectance = PSI_DEG.into_iter().filter_map(|psi_deg| {
            let rho = brdf.hemispherical_reflectance(psi_deg.to_radians(), TOLERANCE);
            Some(Reflectance {
                psi_deg,
                rho: rho.ok()?,
            })
        });
        Some(Self {
            reflectance: reflectance.collect(),
            violation_deg: violation_deg(&brdf),
            implied_facet_reflectance: brdf.implied_facet_reflectance(),
            fresnel_reflectance: Dielectric::new(at.n).normal_reflectance(),
        })
    }
}

fn violation_deg(brdf: &AnyBrdf) -> Option<f64> {
    brdf.energy_violation_angle().map(f64::to_degrees)
}

/// Assesses a fit of the measurements, and fits the ladder of models beside it; with `compare`
/// also the neighbours.
///
/// Prediction, bootstrap and models are those of least squares fits, free of the condition
/// rho(psi) <= 1; readings that a robust fit rejects are left out for all of them alike.
/// Models that cannot be fitted, for want of readings or of a refractive index, are named.
pub fn assess(
    measurements: &Measurements,
    fit: &Fit,
    compare: bool,
) -> Result<Assessment, FitError> {
    assess_observed(measurements, fit, compare, &NoObserver)
}

/// [`assess`], each step of which is told.
pub(crate) fn assess_observed(
    measurements: &Measurements,
    fit: &Fit,
    compare: bool,
    observer: &dyn Observer,
) -> Result<Assessment, FitError> {
    let progress = Progress::begin(observer, Phase::Assessment)?;
    let accepted = accepted_readings(measurements, fit);
    let accepted = accepted.as_ref().unwrap_or(measurements);
    let scan = &fit
        .options
        .fitted_readings(accepted)
        .thinned(assessed(measurements));
    let models = if compare {
        Model::ALL.as_slice()
    } else {
        Model::HIERARCHY.as_slice()
    };
    let options = plain(&fit.options);
    let (made, of_fit) = rayon::join(
        || {
            let rungs = models.par_iter();
            let rungs = rungs.map(|&model| (model, rung(scan, model, &options, &progress)));
            rungs.collect::<Vec<_>>()
        },
        || Worth::of(scan, &options, &progress),
    );
    let (rungs, left_out) = sorted(made)?;
    let worth = of_fit?;
    Ok(Assessment {
        readings: scan.readings().len(),
        e_percent: worth.e_percent,
        bootstrap: worth.bootstrap,
        prediction: worth.prediction,
        physics: Physics::of(fit.model(), &fit.at()).ok_or_else(|| {
            FitError::Solver("the fit ended outside of the model's domain".to_owned())
        })?,
        verdict: verdict(&rungs),
        models: rungs,
        left_out,
    })
}

/// The rungs of the ladder, and the models that could not be fitted.
///
/// Errors: the assessment was cancelled.
fn sorted(
    made: Vec<(Model, Result<Candidate, FitError>)>,
) -> Result<(Vec<Candidate>, Vec<LeftOut>), FitError> {
    let (mut rungs, mut left_out) = (Vec::new(), Vec::new());
    for (model, rung) in made {
        match rung {
            Ok(rung) => rungs.push(rung),
            Err(FitError::Cancelled) => return Err(FitError::Cancelled),
            Err(error) => left_out.push(LeftOut {
                model,
                reason: error.to_string(),
            }),
        }
    }
    let best = rungs.iter().filter_map(|rung| rung.aicc_above_best);
    let best = best.fold(f64::INFINITY, f64::min);
    for rung in &mut rungs {
        rung.aicc_above_best = rung.aicc_above_best.map(|aicc| aicc - best);
    }
    Ok((rungs, left_out))
}

/// What the readings that are assessed say of the fit of them.
struct Worth {
    e_percent: f64,
    bootstrap: Vec<Spread>,
    prediction: Option<Prediction>,
}

impl Worth {
    fn of(
        scan: &Measurements,
        options: &FitOptions,
        progress: &Progress<'_>,
    ) -> Result<Self, FitError> {
        let fitted = fit_scan(scan, options, progress)?;
        let search = fitted.grid_search(progress)?;
        let (model, at) = (options.reduced_model(), fitted.fit.at());
        Ok(Self {
            e_percent: fitted.fit.e_percent,
            bootstrap: bootstrap(&fitted.objective, &search, model, &at, progress)?,
            prediction: leave_one_out(&fitted.objective, &search, model, &at, progress)?,
        })
    }
}

/// How many readings are assessed at the most.
fn assessed(measurements: &Measurements) -> usize {
    if measurements.is_table() {
        ASSESSED_BINS
    } else {
        ASSESSED_READINGS
    }
}

/// The readings that a robust fit does not reject; `None` where none are rejected.
fn accepted_readings(measurements: &Measurements, fit: &Fit) -> Option<Measurements> {
    let robust = fit
        .robust
        .as_ref()
        .filter(|robust| !robust.rejected.is_empty())?;
    let rejected: HashSet<usize> = robust.rejected.iter().map(|r| r.reading).collect();
    let accepted = (0..measurements.readings().len()).filter(|i| !rejected.contains(i));
    Some(measurements.kept(accepted))
}

/// The options of an assessment: least squares, free of the condition rho(psi) <= 1.
fn plain(options: &FitOptions) -> FitOptions {
    FitOptions {
        energy_limit: None,
        robust: None,
        ..options.clone()
    }
}

/// The model of the ladder that suffices for a scan: see [`Verdict`]. The paper's where nothing can
/// be predicted.
pub(crate) fn sufficient_model(
    measurements: &Measurements,
    options: &FitOptions,
    observer: &dyn Observer,
) -> Result<Model, Cancelled> {
    let progress = Progress::begin(observer, Phase::Assessment)?;
    let scan = options
        .fitted_readings(measurements)
        .thinned(assessed(measurements));
    let options = plain(options);
    let mut rungs = Vec::new();
    for model in Model::HIERARCHY {
        match rung(&scan, model, &options, &progress) {
            Err(FitError::Cancelled) => return Err(Cancelled),
            rung => rungs.extend(rung),
        }
    }
    Ok(verdict(&rungs)
        .and_then(|verdict| verdict.model)
        .unwrap_or(Model::Three))
}

fn rung(
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
    let (fit, objective, search) = (
        &fitted.fit,
        &fitted.objective,
        fitted.grid_search(progress)?,
    );
    let (at, reduced_model) = (fit.at(), options.reduced_model());
    let brdf = AnyBrdf::new(model.family(), &at).ok();
    let prediction = leave_one_out(objective, &search, reduced_model, &at, progress)?;
    let given_sigma = options.weights.by_sigma;
    let uncertainty = Uncertainty::of(objective, reduced_model, &at, given_sigma, 1.0, progress)?;
    Ok(Candidate {
        model,
        parameters: at,
        e_percent: fit.e_percent,
        predicted_e_percent: prediction.as_ref().map(|p| p.e_percent),
        predicted_incidences: prediction.map_or(0, |p| p.count()),
        aicc_above_best: aicc(fit),
        estimates: uncertainty.estimates,
        violation_deg: brdf.as_ref().and_then(violation_deg),
    })
}

/// See [`Candidate::aicc_above_best`].
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

fn verdict(rungs: &[Candidate]) -> Option<Verdict> {
    let ladder = rungs
        .iter()
        .filter(|rung| Model::HIERARCHY.contains(&rung.model));
    // Only predictions of the same incidences can be compared.
    let most = ladder.clone().map(|rung| rung.predicted_incidences).max()?;
    let ladder = ladder.filter(|rung| rung.predicted_incidences == most);
    let predicted: Vec<(Model, f64)> = ladder
        .filter_map(|rung| Some((rung.model, rung.predicted_e_percent?)))
        .collect();
    let best = predicted.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    // E is a square: its root may be larger by the margin.
    let limit = (best.1 * (1.0 + MARGIN).powi(2)).max(ROUNDING_PERCENT);
    let smallest = predicted.iter().find(|(_, e)| *e <= limit)?;
    Some(Verdict {
        model: (best.1 <= NOT_DESCRIBED_PERCENT).then_some(smallest.0),
        best: best.0,
        best_e_percent: best.1,
        margin: MARGIN,
    })
}

#[cfg(test)]
mod tests {
    use brdf_core::Parameters;

    use super::*;
    use crate::scan::synthetic::scan;
    use crate::{RefractiveIndex, fit};

    /// A scan of the model with 2 % of ripple.
    fn rippled(k2: f64, kd: f64, n: f64) -> Measurements {
        let truth = Parameters::new(k2, kd, 0.2).unwrap();
        let mut readings = scan(truth, n).readings().to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= 1.0 + 0.02 * (2.4 * i as f64).sin();
        }
        Measurements::new("test", readings).unwrap()
    }

    fn assessment(scan: &Measurements, compare: bool) -> Assessment {
        let options = FitOptions {
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            ..FitOptions::default()
        };
        assess(scan, &fit(scan, &options).unwrap(), compare).unwrap()
    }

    #[test]
    fn the_verdict_names_the_model_that_the_scan_was_made_of() {
        for (scan, expected) in [
            (rippled(0.0, 0.3, 1.5), Model::Lambert),
            (rippled(0.3, 0.0, 1.5), Model::Specular),
            (rippled(0.3, 0.1, 1.5), Model::Three),
            (rippled(0.3, 0.1, 1.2), Model::ThreeN),
        ] {
            let assessment = assessment(&scan, false);
            assert_eq!(assessment.verdict.unwrap().model, Some(expected));
            assert_eq!(assessment.models.len(), Model::HIERARCHY.len());
        }
    }

    #[test]
    fn a_free_parameter_never_raises_e() {
        let assessment = assessment(&rippled(0.3, 0.1, 1.3), true);
        let e = |model| {
            let mut rungs = assessment.models.iter();
            rungs.find(|rung| rung.model == model).unwrap().e_percent
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
    fn one_incidence_predicts_nothing() {
        let one = rippled(0.3, 0.1, 1.5);
        let readings = one
            .readings()
            .iter()
            .filter(|r| r.psi == 0.0)
            .copied()
            .collect();
        let one = Measurements::new("test", readings).unwrap();
        let assessment = assessment(&one, false);
        assert_eq!(assessment.prediction, None);
        assert_eq!(assessment.verdict, None);
        assert!(assessment.bootstrap.is_empty());
    }

    #[test]
    fn a_large_scan_is_assessed_by_some_of_its_readings() {
        let mut readings = Vec::new();
        while readings.len() < 3 * ASSESSED_READINGS {
            readings.extend_from_slice(rippled(0.3, 0.1, 1.5).readings());
        }
        let scan = Measurements::new("test", readings).unwrap();
        let assessment = assessment(&scan, false);
        assert!(assessment.readings <= ASSESSED_READINGS);
        assert_eq!(assessment.prediction.unwrap().incidences.len(), 8);
    }
}
