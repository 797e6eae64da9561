//! The trade of fitting: what each way to fit a scan takes, how far its E is above the best, and
//! how far its parameters are from those of the whole fit.
//!
//! ```no_run
//! use brdf_fit::tradeoff::fitting::trade_fits;
//! use brdf_fit::{FitOptions, Measurements, RefractiveIndex};
//!
//! let options = FitOptions {
//!     refractive_index: Some(RefractiveIndex::Same(1.5)),
//!     ..FitOptions::default()
//! };
//! for scan in Measurements::read_csv("data/measured/z307_on_aluminium.csv")?.by_wavelength() {
//!     println!("{}", trade_fits(&scan, &options)?.text());
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The data flow one way: `trials` says what is tried, on the readings that `reduced` leaves, with
//! the stages or with `profile_alone`; `timing` runs it; tables and picture show what came out.

mod csv;
mod figure;
mod profile_alone;
mod reduced;
mod text;
mod timing;
mod trials;

use brdf_core::ModelParameters;
use serde::Serialize;

use crate::fit::{Fitted, ROUNDING, fit_scan};
use crate::inference::{Estimate, Uncertainty};
use crate::model::Parameter;
use crate::objective::Objective;
use crate::progress::{NoObserver, Phase, Progress};
use crate::scan::Measurements;
use crate::tradeoff::pareto::pareto;
use crate::{FitError, FitOptions};
use timing::median;
use trials::{Trial, reference_options, trials};

pub use csv::{FIT_TRADE_COLUMNS, write_fit_trades};

/// E within this fraction of the best is the best: two ways of summing the same minimum differ by
/// no more.
const SAME: f64 = 1e-9;

/// Ways to fit one wavelength of a scan, compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitTrade {
    /// The file, or where else the readings are from.
    pub source: String,
    /// The name of the sample, where the file says it.
    pub sample: Option<String>,
    /// Wavelength in micrometres, where the scan states one.
    pub wavelength_um: Option<f64>,
    /// The whole fit, with which the others are compared.
    pub reference: Reference,
    /// The ways; the first one is that of the reference.
    pub alternatives: Vec<Alternative>,
}

/// What the whole fit gives: Levenberg-Marquardt in both stages, and the global check.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reference {
    /// The fitted parameters.
    pub parameters: ModelParameters,
    /// The standard errors of the fitted ones.
    pub standard_errors: Vec<OfParameter>,
    /// E over all readings, in percent.
    pub e_percent: f64,
    /// How many readings there are.
    pub readings: usize,
    /// How many incidences there are.
    pub incidences: usize,
    /// Whether the global check took a lower minimum than that of the stages.
    pub lower_minimum_taken: bool,
}

/// A number that belongs to a fitted parameter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OfParameter {
    /// The parameter.
    pub parameter: Parameter,
    /// The number; `None` where the data give none, as for a parameter on its bound, or with E of
    /// nothing but rounding.
    pub value: Option<f64>,
}

/// One way to fit the scan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Alternative {
    /// What it does, in short.
    pub name: String,
    /// levenberg-marquardt, nelder-mead, one and the other, or profile.
    pub method: String,
    /// `both`, `all incidences only` or `stage 1 only`.
    pub stages: String,
    /// Whether the global check follows the stages.
    pub global_check: bool,
    /// Largest number of iterations of each stage.
    pub max_iterations: u64,
    /// How many readings it fits.
    pub readings: usize,
    /// How many incidences they belong to.
    pub incidences: usize,
    /// What came out.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// What came of one way to fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Outcome {
    /// A fit.
    Fitted(Box<Measured>),
    /// None.
    Failed {
        /// Why.
        error: String,
    },
}

/// The price and the worth of a fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measured {
    /// Time of the fit on one thread, the median of several runs, in seconds.
    pub seconds: f64,
    /// How many runs.
    pub runs: usize,
    /// E of its parameters over all readings of the scan, in percent.
    pub e_percent: f64,
    /// That E over the lowest E of all alternatives, less 1; zero below 1e-9, where two ways of
    /// summing the same minimum differ.
    pub excess_e: f64,
    /// Its parameters.
    pub parameters: ModelParameters,
    /// How far each fitted one is from that of the reference, in standard errors of the reference.
    pub shift_in_sigma: Vec<OfParameter>,
    /// Whether the last stage ended at a minimum of what it fits, instead of at its largest number
    /// of iterations.
    pub converged: bool,
    /// Why it ended.
    pub ended_by: String,
    /// Whether no alternative is faster and no further above the best E.
    pub pareto: bool,
}

impl Alternative {
    /// What was measured, where it is a fit.
    pub fn measured(&self) -> Option<&Measured> {
        match &self.outcome {
            Outcome::Fitted(measured) => Some(measured),
            Outcome::Failed { .. } => None,
        }
    }

    fn measured_mut(&mut self) -> Option<&mut Measured> {
        match &mut self.outcome {
            Outcome::Fitted(measured) => Some(measured),
            Outcome::Failed { .. } => None,
        }
    }
}

/// Fits one wavelength of a scan in many ways and compares them with the whole fit: methods, one
/// stage or both, with and without the global check, fewer readings and incidences, few iterations.
///
/// The model, n, weights, start, limit of stage 1, loss and the like are those of `options`; its
/// methods, its global check and its number of iterations are what is tried. The tolerances of the
/// solvers are fixed at the rounding of E and no option: the number of iterations stands for them.
/// Each time is that of one thread and holds the fit alone, not the choice of its readings.
///
/// Parameters and E are the same in every run; times, and with them the Pareto front, are not.
///
/// Errors: those of [`fit`](crate::fit) where the whole fit fails. What fails beside it is listed
/// with its error.
pub fn trade_fits(scan: &Measurements, options: &FitOptions) -> Result<FitTrade, FitError> {
    let thread = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let thread = thread.map_err(|error| FitError::Solver(error.to_string()))?;
    thread.install(|| compared(scan, options))
}

fn compared(scan: &Measurements, options: &FitOptions) -> Result<FitTrade, FitError> {
    let options = reference_options(options);
    let fitted = fit_scan(scan, &options, &NoObserver)?;
    let reference = Reference::of(&fitted)?;
    // Without the weights of a robust loss: E as the reference tells it.
    let fit = &fitted.fit;
    let all = Objective::condensed(scan, fit.model().family(), fit.n, &options.weights)?;
    let trials = trials(scan, &options, fit.n);
    let times = timing::times(&trials, Trial::run);
    let runs = trials.iter().zip(times);
    let mut alternatives: Vec<Alternative> = runs
        .map(|(trial, times)| measured(trial, times, &all, &reference))
        .collect();
    rank(&mut alternatives);
    Ok(FitTrade {
        source: scan.source.clone(),
        sample: scan.metadata.get("sample").map(ToOwned::to_owned),
        wavelength_um: fit.wavelength_um,
        reference,
        alternatives,
    })
}

impl Reference {
    fn of(fitted: &Fitted) -> Result<Self, FitError> {
        let fit = &fitted.fit;
        let progress = Progress::new(&NoObserver, Phase::Uncertainty);
        let uncertainty = Uncertainty::of_fit(fitted, &progress)?;
        // Errors of a fit without residuals are those of its rounding.
        let has_errors = fit.e_percent > 100.0 * ROUNDING;
        let standard_error = |&parameter: &Parameter| OfParameter {
            parameter,
            value: uncertainty
                .estimate(parameter)
                .and_then(Estimate::standard_error)
                .filter(|&error| has_errors && error > 0.0 && error.is_finite()),
        };
        let check = fit.global_check.as_ref();
        Ok(Self {
            parameters: fit.at(),
            standard_errors: fit.options.free().iter().map(standard_error).collect(),
            e_percent: fit.e_percent,
            readings: fit.readings,
            incidences: fit.incidences.len(),
            lower_minimum_taken: check.is_some_and(|check| check.lower_minimum_taken),
        })
    }

    /// How far parameters are from these, in standard errors.
    fn shifts(&self, at: &ModelParameters) -> Vec<OfParameter> {
        let shift = |of: &OfParameter| {
            let step = of.parameter.of(at) - of.parameter.of(&self.parameters);
            OfParameter {
                value: of.value.map(|error| step / error),
                ..*of
            }
        };
        self.standard_errors.iter().map(shift).collect()
    }
}

/// One way, measured over all readings.
fn measured(trial: &Trial, times: Vec<f64>, all: &Objective, reference: &Reference) -> Alternative {
    let result = trial.run();
    let (stages, readings, incidences) = match &result {
        Ok(found) => (found.stages, found.readings, found.incidences),
        Err(_) => trial.asked(),
    };
    let outcome = match result {
        Err(error) => Outcome::Failed { error },
        Ok(found) => Outcome::Fitted(Box::new(Measured {
            runs: times.len(),
            seconds: median(times),
            e_percent: 100.0 * all.error(&found.parameters),
            excess_e: 0.0,
            parameters: found.parameters,
            shift_in_sigma: reference.shifts(&found.parameters),
            converged: found.converged,
            ended_by: found.ended_by,
            pareto: false,
        })),
    };
    Alternative {
        name: trial.name.clone(),
        method: trial.method(),
        stages: stages.to_string(),
        global_check: trial.options.global_check,
        max_iterations: trial.options.max_iterations,
        readings,
        incidences,
        outcome,
    }
}

/// Compares all fits with the best of them.
fn rank(alternatives: &mut [Alternative]) {
    let measured = || alternatives.iter().map(Alternative::measured);
    let best = measured().flatten().map(|m| m.e_percent);
    let best = best.fold(f64::INFINITY, f64::min);
    let places: Vec<(f64, f64)> = measured()
        .map(|measured| {
            measured.map_or((f64::NAN, f64::NAN), |m| {
                (m.seconds, excess(m.e_percent, best))
            })
        })
        .collect();
    let front = pareto(&places);
    for ((alternative, place), on_front) in alternatives.iter_mut().zip(places).zip(front) {
        if let Some(measured) = alternative.measured_mut() {
            (measured.excess_e, measured.pareto) = (place.1, on_front);
        }
    }
}

/// E over the best, less 1; both in percent. E of nothing but rounding is as good as any other.
fn excess(e_percent: f64, best: f64) -> f64 {
    let rounding = 100.0 * ROUNDING;
    let excess = e_percent.max(rounding) / best.max(rounding) - 1.0;
    if excess < SAME { 0.0 } else { excess }
}

#[cfg(test)]
mod tests {
    use brdf_core::Parameters;

    use super::*;
    use crate::fit::robust::Loss;
    use crate::model::Model;
    use crate::scan::synthetic::scan;
    use crate::{Measurement, RefractiveIndex};

    fn options() -> FitOptions {
        FitOptions {
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            ..FitOptions::default()
        }
    }

    /// A scan with a ripple, as no model has it.
    fn rippled() -> Measurements {
        let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
        let mut readings = scan(truth, 1.5).readings().to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= 1.0 + 0.03 * (2.4 * i as f64).sin();
        }
        Measurements::new("rippled", readings).unwrap()
    }

    fn find<'a>(trade: &'a FitTrade, name: &str) -> &'a Alternative {
        let mut all = trade.alternatives.iter();
        all.find(|alternative| alternative.name == name).unwrap()
    }

    #[test]
    fn excess_of_rounding_is_none() {
        assert_eq!(excess(1.0, 1.0), 0.0);
        assert_eq!(excess(1.0 + 1e-12, 1.0), 0.0);
        assert_eq!(excess(3.0, 2.0), 0.5);
        assert_eq!(excess(1e-28, 1e-30), 0.0);
        assert_eq!(excess(0.0, 0.0), 0.0);
    }

    #[test]
    fn every_model_has_its_trade() {
        for model in [Model::Lambert, Model::Specular, Model::Three, Model::ThreeN] {
            let options = options().of_model(model);
            let trade = trade_fits(&rippled(), &FitOptions { model, ..options }).unwrap();
            let first = trade.alternatives[0].measured().unwrap();
            assert_eq!(first.e_percent, trade.reference.e_percent, "{model}");
            assert_eq!(first.parameters, trade.reference.parameters, "{model}");
            assert_eq!(first.shift_in_sigma.len(), model.free().len());
        }
    }

    #[test]
    fn the_profile_alone_finds_the_best_width_to_its_grid_and_between() {
        let trade = trade_fits(&rippled(), &options()).unwrap();
        let of = |name: &str| find(&trade, name).measured().unwrap().excess_e;
        assert_eq!(of("profile, refined"), 0.0);
        assert!(of("profile") > 0.0);
    }

    #[test]
    fn what_cannot_be_fitted_is_listed_with_its_reason() {
        let few = |psi_deg: f64, count: u32| {
            (0..count).map(move |i| Measurement {
                wavelength_um: None,
                psi: psi_deg.to_radians(),
                theta: (10.0 * f64::from(i) - 40.0).to_radians(),
                phi: 0.0,
                brdf: 0.1 + 0.01 * f64::from(i % 3),
                sigma: None,
            })
        };
        let scan = Measurements::new("few", few(10.0, 6).collect()).unwrap();
        let trade = trade_fits(&scan, &options()).unwrap();
        let error = |name: &str| match &find(&trade, name).outcome {
            Outcome::Failed { error } => error.clone(),
            Outcome::Fitted(_) => panic!("{name} is fitted"),
        };
        assert!(error("every 2nd reading").contains("3 readings: 3 free parameters"));
        assert!(error("every 2nd incidence").contains("has 1 incidence"));
        let json = serde_json::to_value(&trade).unwrap();
        let listed = json["alternatives"].as_array().unwrap();
        assert!(listed.iter().any(|one| one["error"].is_string()));
    }

    #[test]
    fn the_profile_knows_neither_another_loss_nor_energy() {
        let robust = FitOptions {
            robust: Some(Loss::Tukey),
            ..options()
        };
        let trade = trade_fits(&rippled(), &robust).unwrap();
        let profile = &find(&trade, "profile").outcome;
        assert!(matches!(profile, Outcome::Failed { error } if error.contains("robust")));
        for measured in trade.alternatives.iter().filter_map(Alternative::measured) {
            assert!(measured.excess_e >= 0.0);
        }
    }

    #[test]
    fn a_scan_without_noise_has_no_shifts() {
        let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
        let trade = trade_fits(&scan(truth, 1.5), &options()).unwrap();
        let first = trade.alternatives[0].measured().unwrap();
        assert!(first.shift_in_sigma.iter().all(|of| of.value.is_none()));
        assert_eq!(first.excess_e, 0.0);
    }

    #[test]
    fn what_cannot_be_fitted_at_all_is_an_error() {
        let none = FitOptions::default();
        let error = trade_fits(&rippled(), &none).unwrap_err();
        assert_eq!(error, FitError::NoRefractiveIndex(None));
        assert!(trade_fits(&Measurements::default(), &options()).is_err());
    }
}
