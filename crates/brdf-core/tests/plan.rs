//! Tests of the choice of an evaluator for a scene, at a million points that the choice did not use.

use brdf_core::scene::{Azimuth, Coordinates, Domain, Plan, Probe, Refusal, Scene};
use brdf_core::{AnyBrdf, Family, ModelParameters};
use proptest::prelude::*;

const FRESH: usize = 1_000_000;

fn any_brdf() -> impl Strategy<Value = AnyBrdf> {
    let log_k1 = 0.003_f64.ln()..5.0_f64.ln();
    let weights = (
        prop_oneof![1 => Just(0.0), 9 => 1e-3..3.0],
        prop_oneof![1 => Just(0.0), 9 => 1e-3..1.0],
    );
    (0..5_usize, weights, log_k1, 1.01..4.0, 0.3..3.0).prop_map(
        |(family, (k2, kd), log_k1, n, p)| {
            let k1 = log_k1.exp();
            AnyBrdf::new(Family::ALL[family], &ModelParameters { k2, kd, k1, n, p }).unwrap()
        },
    )
}

fn any_scene() -> impl Strategy<Value = Scene> {
    let range = || (0.0..1.5, 0.0..1.5).prop_map(|(a, b): (f64, f64)| (a.min(b), a.max(b)));
    let one_incidence = prop::bool::weighted(0.2);
    let azimuth = prop_oneof![Just(Azimuth::Full), Just(Azimuth::InPlane)];
    let coordinates = prop_oneof![
        Just(Coordinates::Cosines),
        Just(Coordinates::Angles),
        Just(Coordinates::Directions)
    ];
    let tolerance = (-16.0..-2.0_f64).prop_map(f64::exp);
    (
        range(),
        range(),
        one_incidence,
        azimuth,
        coordinates,
        tolerance,
        3.0..10.0_f64,
    )
        .prop_map(
            |(incidence, view, one, azimuth, coordinates, tolerance, log_evaluations)| {
                let incidence = if one {
                    (incidence.0, incidence.0)
                } else {
                    incidence
                };
                Scene {
                    domain: Domain::new(incidence, view, azimuth).unwrap(),
                    coordinates,
                    tolerance,
                    evaluations: 10_f64.powf(log_evaluations),
                }
            },
        )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_chosen_evaluator_is_within_the_tolerance_at_a_million_other_points(
        brdf in any_brdf(), scene in any_scene(), seed in 100..10_000_u32,
    ) {
        let plan = Plan::new(&brdf, &scene).unwrap();
        let probe = Probe::new(&brdf, &scene.domain, scene.coordinates, FRESH, seed);
        let error = probe.errors(plan.evaluator.as_ref()).max;
        prop_assert!(
            error <= scene.tolerance,
            "{}: {} > {}", plan.evaluator.name(), error, scene.tolerance
        );
        let chosen = plan.chosen().unwrap();
        prop_assert_eq!(chosen.name, plan.evaluator.name());
        // All other evaluators are refused.
        let refused = plan.candidates.iter().filter(|c| c.refusal.is_some()).count();
        prop_assert_eq!(refused + 1, plan.candidates.len());
    }
}

fn paper(k2: f64, kd: f64) -> AnyBrdf {
    let at = ModelParameters {
        k2,
        kd,
        k1: 0.2,
        n: 1.5,
        p: 1.0,
    };
    AnyBrdf::new(Family::Paper, &at).unwrap()
}

#[test]
fn a_lambertian_surface_is_evaluated_as_a_constant() {
    let plan = Plan::new(&paper(0.0, 0.4), &Scene::default()).unwrap();
    assert_eq!(plan.evaluator.name(), "lambertian");
}

#[test]
fn every_refusal_has_its_reason() {
    let plan = Plan::new(&paper(0.3, 0.1), &Scene::default()).unwrap();
    let refusal = |name| {
        let candidate = plan.candidates.iter().find(|c| c.name == name).unwrap();
        candidate.refusal
    };
    assert!(matches!(refusal("lambertian"), Some(Refusal::Error { error, .. }) if error > 0.1));
    assert!(matches!(refusal("f64"), Some(Refusal::Cost { times }) if times >= 1.0));
    let at = ModelParameters {
        n: 1.0,
        ..paper(0.3, 0.1).model_parameters()
    };
    let no_polynomial = AnyBrdf::new(Family::Paper, &at).unwrap();
    let plan = Plan::new(&no_polynomial, &Scene::default()).unwrap();
    let fitted = plan
        .candidates
        .iter()
        .find(|c| c.name == "f32-fitted-fresnel");
    assert!(matches!(fitted.unwrap().refusal, Some(Refusal::Unfit(_))));
}

#[test]
fn an_unattainable_tolerance_is_an_error_with_the_best_evaluator() {
    let scene = Scene {
        tolerance: 1e-20,
        ..Scene::default()
    };
    let error = Plan::new(&paper(0.3, 0.1), &scene).unwrap_err();
    assert_eq!(error.best, "f64");
    assert!(error.reached > 1e-17 && error.reached < 1e-14);
    assert!(
        error
            .to_string()
            .contains("the most accurate, f64, has a maximum error of"),
        "{error}"
    );
}
