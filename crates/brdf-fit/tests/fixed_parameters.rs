//! Fits with fixed parameters.

use brdf_core::{Family, ModelParameters, Parameters};
use brdf_fit::synthetic::scan;
use brdf_fit::{
    Depth, Fit, FitOptions, FixedParameters, Loss, Measurements, Method, Model, ModelChoice,
    NoObserver, Objective, Parameter, ReducedModel, RefractiveIndex, Report, Weights, best_weights,
    fit,
};
use proptest::prelude::*;

fn rippled(ripple: f64) -> Measurements {
    let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
    let mut readings = scan(truth, 1.5).readings().to_vec();
    for (i, reading) in readings.iter_mut().enumerate() {
        reading.brdf *= 1.0 + ripple * (2.4 * i as f64).sin();
    }
    Measurements::new("test", readings).unwrap()
}

fn options(model: Model, fixed: FixedParameters) -> FitOptions {
    FitOptions {
        model,
        fixed,
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    }
}

fn fitted(model: Model, fixed: FixedParameters) -> Fit {
    fit(&rippled(0.1), &options(model, fixed)).unwrap()
}

fn fixing(parameter: Parameter, value: f64) -> FixedParameters {
    FixedParameters::none().with(parameter, value)
}

#[test]
fn text_and_json_are_read_back() {
    let fixed: FixedParameters = "K1=0.2, kd = 5e-2".parse().unwrap();
    assert_eq!(fixed, fixing(Parameter::Kd, 0.05).with(Parameter::K1, 0.2));
    assert_eq!(fixed.to_string(), "kD = 0.05, k1 = 0.2");
    let json = serde_json::to_string(&fixed).unwrap();
    assert_eq!(json, r#"{"kd":0.05,"k1":0.2}"#);
    assert_eq!(
        serde_json::from_str::<FixedParameters>(&json).unwrap(),
        fixed
    );
    for (text, message) in [
        ("k3=1", "is not a parameter"),
        ("k1", "expected NAME=VALUE"),
        ("k1=wide", "expected NAME=VALUE"),
        ("k1=1,k1=2", "given twice"),
    ] {
        let error = text.parse::<FixedParameters>().unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
    }
}

#[test]
fn options_without_held_parameters_are_written_as_before() {
    let plain = options(Model::Three, FixedParameters::none());
    let json = serde_json::to_string(&plain).unwrap();
    assert!(!json.contains("held"));
    assert_eq!(serde_json::from_str::<FitOptions>(&json).unwrap(), plain);
    let fixed = options(Model::PowerN, fixing(Parameter::P, 0.5));
    let json = serde_json::to_string(&fixed).unwrap();
    assert!(json.contains(r#""held":{"p":0.5}"#));
    assert_eq!(serde_json::from_str::<FitOptions>(&json).unwrap(), fixed);
    assert_eq!(fixed.free(), Model::ThreeN.free());
}

#[test]
fn a_parameter_that_cannot_be_fixed_is_a_usage_error() {
    for (model, parameter, value, message) in [
        (
            Model::Three,
            Parameter::N,
            1.6,
            "n cannot be fixed: model three fits k2, kD, k1",
        ),
        (
            Model::Lambert,
            Parameter::K1,
            0.2,
            "k1 cannot be fixed: model lambert fits kD",
        ),
        (
            Model::Three,
            Parameter::K1,
            2e3,
            "k1 = 2000 cannot be fixed: expected a number from",
        ),
        (
            Model::Three,
            Parameter::K2,
            -0.1,
            "expected a number of at least 0",
        ),
        (
            Model::Three,
            Parameter::Kd,
            f64::INFINITY,
            "kD = inf cannot be fixed",
        ),
        (
            Model::Three,
            Parameter::K1,
            f64::NAN,
            "k1 = NaN cannot be fixed",
        ),
    ] {
        let error = fit(&rippled(0.1), &options(model, fixing(parameter, value))).unwrap_err();
        assert!(
            error.is_usage() && error.to_string().contains(message),
            "{error}"
        );
    }
}

/// With width and index fixed, E has its one minimum in closed form.
#[test]
fn the_best_weights_at_a_held_width_are_those_of_the_closed_form() {
    let scan = rippled(0.1);
    for (method, k1) in [
        (Method::LevenbergMarquardt, 0.35),
        (Method::NelderMead, 0.35),
        (Method::LevenbergMarquardt, 1e-3),
    ] {
        let fixed = fixing(Parameter::K1, k1);
        let found = fit(
            &scan,
            &FitOptions {
                stage1: Some(method),
                stage2: Some(method),
                ..options(Model::Three, fixed)
            },
        )
        .unwrap();
        let objective = Objective::new(&scan, Family::Paper, 1.5, &found.options.weights).unwrap();
        let exact = best_weights(&objective, Model::Three.into(), found.at());
        assert_eq!(found.parameters.k1, k1);
        assert!((found.e_percent / (100.0 * exact.error) - 1.0).abs() < 1e-9);
        assert!((found.parameters.k2 / exact.parameters.k2 - 1.0).abs() < 1e-4);
        assert!((found.parameters.kd - exact.parameters.kd).abs() < 1e-6);
    }
}

#[test]
fn one_weight_held_leaves_the_best_of_the_other() {
    let scan = rippled(0.1);
    let weights = Weights::default();
    let objective = Objective::new(&scan, Family::Paper, 1.5, &weights).unwrap();
    for (weight, other) in [
        (Parameter::K2, Parameter::Kd),
        (Parameter::Kd, Parameter::K2),
    ] {
        let model = ReducedModel::new(Model::Three, fixing(weight, 0.15));
        let at = fitted(Model::Three, FixedParameters::none()).at();
        let best = best_weights(&objective, model, at);
        assert_eq!(weight.of(&best.parameters), 0.15);
        assert!((objective.error(&best.parameters) - best.error).abs() < 1e-13);
        for factor in [0.99, 1.01] {
            let mut moved = best.parameters;
            other.set(&mut moved, factor * other.of(&best.parameters));
            assert!(objective.error(&moved) > best.error);
        }
    }
}

#[test]
fn the_search_with_a_held_weight_finds_what_a_hurried_stage_misses() {
    let fixed = fixing(Parameter::K2, 0.3);
    let start = ModelParameters::three(Parameters::new(1.0, 1.0, 50.0).unwrap(), 1.5);
    let hurried = FitOptions {
        start: Some(start),
        max_iterations: 1,
        ..options(Model::Three, fixed)
    };
    let scan = rippled(0.0);
    let found = fit(&scan, &hurried).unwrap();
    assert!(found.global_check.as_ref().unwrap().lower_minimum_taken);
    assert_eq!(
        (found.initial.parameters.k2, found.parameters.k2),
        (0.3, 0.3)
    );
    assert!((found.parameters.k1 / 0.2 - 1.0).abs() < 1e-5, "{found:?}");
    let profile = found.global_check.unwrap().profile;
    assert!(profile.iter().all(|point| point.parameters.k2 == 0.3));
}

#[test]
fn where_all_is_held_e_is_evaluated_and_nothing_is_uncertain() {
    let fixed = FixedParameters::none()
        .with(Parameter::K2, 0.25)
        .with(Parameter::Kd, 0.12)
        .with(Parameter::K1, 0.3);
    let scan = rippled(0.1);
    let (report, error) = Report::new(&scan, &options(Model::Three, fixed), Depth::Assessed);
    assert_eq!(error, None);
    let fit = report.fit.clone().unwrap();
    let objective = Objective::new(&scan, Family::Paper, 1.5, &fit.options.weights).unwrap();
    let e = 100.0 * objective.error(&fit.at());
    assert_eq!((fit.e_percent, fit.stage2.unwrap().iterations), (e, 0));
    assert_eq!((fit.at().k2, fit.at().kd, fit.at().k1), (0.25, 0.12, 0.3));
    assert_eq!(fit.degrees_of_freedom(), fit.readings);
    assert_eq!(report.uncertainty, None);
    assert!(
        report
            .text()
            .contains("fixed: k2 = 0.25, kD = 0.12, k1 = 0.3")
    );
}

#[test]
fn every_part_of_a_report_keeps_what_is_held() {
    let fixed = fixing(Parameter::K1, 0.25).with(Parameter::N, 1.6);
    let options = FitOptions {
        robust: Some(Loss::Huber),
        energy_limit: Some(1.4),
        ..options(Model::PowerN, fixed)
    };
    let (report, error) = Report::new(&rippled(0.1), &options, Depth::Compared);
    assert_eq!(error, None);
    let fit = report.fit.unwrap();
    assert_eq!((fit.at().k1, fit.n), (0.25, 1.6));
    let free = [Parameter::K2, Parameter::Kd, Parameter::P];
    let estimated = report.uncertainty.unwrap().estimates;
    assert!(estimated.iter().map(|e| e.parameter).eq(free));
    let assessment = report.assessment.unwrap();
    assert!(!assessment.sensitivity.is_empty());
    for without in &assessment.sensitivity {
        assert_eq!((without.parameters.k1, without.parameters.n), (0.25, 1.6));
    }
    assert_eq!(assessment.models.len(), Model::ALL.len());
    for candidate in assessment.models {
        for (parameter, value) in fixed.within(candidate.model).iter() {
            assert_eq!(
                parameter.of(&candidate.parameters),
                value,
                "{}",
                candidate.model
            );
            assert!(candidate.estimates.iter().all(|e| e.parameter != parameter));
        }
    }
}

#[test]
fn a_chosen_model_holds_what_it_has() {
    let options = options(Model::Three, fixing(Parameter::K1, 0.3));
    let (report, error) = Report::observed(
        &rippled(0.02),
        &options,
        ModelChoice::Auto,
        Depth::Fit,
        &NoObserver,
    );
    assert_eq!(error, None);
    let fit = report.fit.unwrap();
    assert!(fit.model() == Model::Lambert || fit.parameters.k1 == 0.3);
}

#[test]
fn fixed_weights_that_violate_energy_conservation_are_an_error() {
    let bright = |fixed| FitOptions {
        energy_limit: Some(1.4),
        ..options(Model::Three, fixed)
    };
    let error = fit(&rippled(0.1), &bright(fixing(Parameter::Kd, 1.2))).unwrap_err();
    assert!(
        error.is_usage() && error.to_string().contains("exceeds 1"),
        "{error}"
    );
    for fixed in [fixing(Parameter::K2, 0.9), fixing(Parameter::Kd, 0.9)] {
        let found = fit(&rippled(0.1), &bright(fixed)).unwrap();
        let brdf = brdf_core::AnyBrdf::new(Family::Paper, &found.at()).unwrap();
        let rho = brdf.hemispherical_reflectance(1.4, 1e-6).unwrap();
        assert!(rho < 1.0 + 1e-4, "{fixed}: {rho}");
        assert_eq!(fixed.within(Model::Three), found.options.fixed);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn holding_never_lowers_e_and_at_the_optimum_changes_nothing(
        which in 0..5_usize, factor in 0.5..2.0_f64, with_n in any::<bool>(),
    ) {
        let model = if with_n { Model::PowerN } else { Model::Three };
        let parameter = model.free()[which % model.free().len()];
        let free = fitted(model, FixedParameters::none());
        let at = parameter.of(&free.at());
        let (lowest, highest) = parameter.range();
        let other = fitted(model, fixing(parameter, (factor * at).clamp(lowest, highest)));
        prop_assert!(other.e_percent >= free.e_percent * (1.0 - 1e-9));
        let same = fitted(model, fixing(parameter, at));
        prop_assert!((same.e_percent / free.e_percent - 1.0).abs() < 1e-9);
    }
}
