//! The measurement of all ways to fit a scan, and their comparison with the reference.

use brdf_core::ModelParameters;

use super::error::TradeoffError;
use super::result::{Alternative, FitTradeoff, Measured, OfParameter, Outcome, Reference};
use super::timing::{self, median};
use super::trials::{Trial, reference_options, trials};
use crate::fit::FitOptions;
use crate::fit::{FitError, FitProblem, Solution, fit_scan};
use crate::inference::{Estimate, Tests, Uncertainty};
use crate::model::Parameter;
use crate::objective::{Objective, ROUNDING};
use crate::progress::{Cancelled, NoObserver, Phase, Progress};
use crate::scan::Measurements;
use crate::tradeoff::pareto::pareto;

/// An excess of E below this is zero: rounding makes E of the same minimum differ by as much.
const SAME: f64 = 1e-9;

/// Fits one wavelength of a scan in many ways and compares them with the full procedure: methods, one
/// stage or both, with and without the global check, fewer readings and incidences, few iterations.
///
/// Methods, global check and number of iterations vary; all other options, such as the model, n,
/// weights, start, limit of stage 1 and loss, are those of `options`. The tolerances of the solvers
/// are fixed at the rounding of E, so that the number of iterations takes their place. Times are
/// those of the fit on one thread, without the selection of its readings.
///
/// Parameters and E are the same in every run; times and the Pareto front are not.
///
/// # Errors
///
/// The full procedure fails, or the thread for the fits cannot be started. The error of any other
/// alternative is part of the result.
pub fn fit_tradeoff(
    scan: &Measurements,
    options: &FitOptions,
) -> Result<FitTradeoff, TradeoffError> {
    let thread = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let thread = thread.map_err(|error| TradeoffError::Thread(error.to_string()))?;
    thread.install(|| compare(scan, options))
}

fn compare(scan: &Measurements, options: &FitOptions) -> Result<FitTradeoff, TradeoffError> {
    let options = reference_options(options);
    let fitted = fit_scan(scan, &options, &NoObserver)?;
    let reference = Reference::of(scan, &fitted).map_err(FitError::from)?;
    // E as that of the reference, without the weights of a robust loss.
    let fit = &fitted.fit;
    let least_squares = FitOptions {
        robust: None,
        ..options.clone()
    };
    let all = FitProblem::new(scan, &least_squares)?.into_objective();
    let trials = trials(scan, &options, fit.n);
    let times = timing::times(&trials, Trial::run);
    let runs = trials.iter().zip(times);
    let mut alternatives: Vec<Alternative> = runs
        .map(|(trial, times)| measured(trial, times, &all, &reference))
        .collect();
    rank(&mut alternatives);
    Ok(FitTradeoff {
        source: scan.source.clone(),
        sample: scan.metadata.get("sample").map(ToOwned::to_owned),
        wavelength_um: fit.wavelength_um,
        reference,
        alternatives,
    })
}

impl Reference {
    fn of(scan: &Measurements, fitted: &Solution) -> Result<Self, Cancelled> {
        let fit = &fitted.fit;
        let progress = Progress::new(&NoObserver, Phase::Uncertainty);
        let uncertainty = Uncertainty::of_fit(scan, fitted, Tests::Omitted, &progress)?;
        // The standard errors of a fit without residuals are those of rounding.
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

    /// The shifts of parameters from the reference, in standard errors.
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

/// The result of one trial, with E over all readings.
fn measured(trial: &Trial, times: Vec<f64>, all: &Objective, reference: &Reference) -> Alternative {
    let result = trial.run();
    let (stages, readings, incidences) = match &result {
        Ok(found) => (found.stages, found.readings, found.incidences),
        Err(_) => trial.requested(),
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

/// Sets excess E and Pareto front of all alternatives that succeeded.
fn rank(alternatives: &mut [Alternative]) {
    let measured = || alternatives.iter().map(Alternative::measured);
    let best = measured().flatten().map(|m| m.e_percent);
    let best = best.fold(f64::INFINITY, f64::min);
    let points: Vec<(f64, f64)> = measured()
        .map(|measured| {
            measured.map_or((f64::NAN, f64::NAN), |m| {
                (m.seconds, excess(m.e_percent, best))
            })
        })
        .collect();
    let front = pareto(&points);
    for ((alternative, point), on_front) in alternatives.iter_mut().zip(points).zip(front) {
        if let Some(measured) = alternative.measured_mut() {
            (measured.excess_e, measured.pareto) = (point.1, on_front);
        }
    }
}

/// E / best E - 1, both in percent; values of E that are rounding alone count as equal.
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
    use crate::scan::{Measurement, RefractiveIndex};
    use crate::tradeoff::fitting::TrialError;

    fn options() -> FitOptions {
        FitOptions {
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            ..FitOptions::default()
        }
    }

    /// A scan with 3 % of ripple, which no parameter follows.
    fn rippled() -> Measurements {
        let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
        let mut readings = scan(truth, 1.5).readings().to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= 1.0 + 0.03 * (2.4 * i as f64).sin();
        }
        Measurements::new("rippled", readings).unwrap()
    }

    fn find<'a>(tradeoff: &'a FitTradeoff, name: &str) -> &'a Alternative {
        let mut all = tradeoff.alternatives.iter();
        all.find(|alternative| alternative.name == name).unwrap()
    }

    #[test]
    fn the_excess_of_rounding_is_zero() {
        assert_eq!(excess(1.0, 1.0), 0.0);
        assert_eq!(excess(1.0 + 1e-12, 1.0), 0.0);
        assert_eq!(excess(3.0, 2.0), 0.5);
        assert_eq!(excess(1e-28, 1e-30), 0.0);
        assert_eq!(excess(0.0, 0.0), 0.0);
    }

    #[test]
    fn every_model_can_be_compared() {
        for model in [Model::Lambert, Model::Specular, Model::Three, Model::ThreeN] {
            let options = options().with_model(model);
            let tradeoff = fit_tradeoff(&rippled(), &FitOptions { model, ..options }).unwrap();
            let first = tradeoff.alternatives[0].measured().unwrap();
            assert_eq!(first.e_percent, tradeoff.reference.e_percent, "{model}");
            assert_eq!(first.parameters, tradeoff.reference.parameters, "{model}");
            assert_eq!(first.shift_in_sigma.len(), model.free().len());
        }
    }

    #[test]
    fn the_profile_finds_the_best_width_to_its_grid_and_refined_exactly() {
        let tradeoff = fit_tradeoff(&rippled(), &options()).unwrap();
        let of = |name: &str| find(&tradeoff, name).measured().unwrap().excess_e;
        assert_eq!(of("profile, refined"), 0.0);
        assert!(of("profile") > 0.0);
    }

    #[test]
    fn alternatives_that_fail_are_listed_with_their_error() {
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
        let tradeoff = fit_tradeoff(&scan, &options()).unwrap();
        let error = |name: &str| match &find(&tradeoff, name).outcome {
            Outcome::Failed { error } => error.to_string(),
            Outcome::Fitted(_) => panic!("{name} is fitted"),
        };
        assert!(error("every 2nd reading").contains("3 readings: 3 free parameters"));
        assert!(error("every 2nd incidence").contains("has 1 incidence"));
        let json = serde_json::to_value(&tradeoff).unwrap();
        let listed = json["alternatives"].as_array().unwrap();
        assert!(listed.iter().any(|one| one["error"].is_string()));
    }

    #[test]
    fn the_profile_does_not_support_a_robust_loss() {
        let robust = FitOptions {
            robust: Some(Loss::Tukey),
            ..options()
        };
        let tradeoff = fit_tradeoff(&rippled(), &robust).unwrap();
        let profile = &find(&tradeoff, "profile").outcome;
        assert!(
            matches!(profile, Outcome::Failed { error } if *error == TrialError::ProfileOptions)
        );
        for measured in tradeoff
            .alternatives
            .iter()
            .filter_map(Alternative::measured)
        {
            assert!(measured.excess_e >= 0.0);
        }
    }

    #[test]
    fn a_scan_without_noise_has_no_shifts() {
        let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
        let tradeoff = fit_tradeoff(&scan(truth, 1.5), &options()).unwrap();
        let first = tradeoff.alternatives[0].measured().unwrap();
        assert!(first.shift_in_sigma.iter().all(|of| of.value.is_none()));
        assert_eq!(first.excess_e, 0.0);
    }

    #[test]
    fn a_scan_that_cannot_be_fitted_is_an_error() {
        let none = FitOptions::default();
        let error = fit_tradeoff(&rippled(), &none).unwrap_err();
        assert!(error.is_usage());
        let TradeoffError::Fit(error) = error else {
            panic!("{error}");
        };
        assert_eq!(error, FitError::NoRefractiveIndex(None));
        assert!(fit_tradeoff(&Measurements::default(), &options()).is_err());
    }
}
