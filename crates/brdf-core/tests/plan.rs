//! The choice for a scene holds at a million fresh points.

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
                    memory_limit: 1 << 22,
                    evaluations: 10_f64.powf(log_evaluations),
                }
            },
        )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_chosen_evaluator_keeps_the_tolerance_at_a_million_fresh_points(
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
        prop_assert!(chosen.bytes <= scene.memory_limit);
        // Every other one was refused, those that would have been cheaper for their errors.
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
fn a_lambertian_surface_needs_no_more_than_a_constant() {
    let plan = Plan::new(&paper(0.0, 0.4), &Scene::default()).unwrap();
    assert_eq!(plan.evaluator.name(), "lambertian");
}

#[test]
fn every_refusal_has_its_reason() {
    let scene = Scene {
        memory_limit: 100,
        ..Scene::default()
    };
    let plan = Plan::new(&paper(0.3, 0.1), &scene).unwrap();
    let refusal = |name| {
        let candidate = plan.candidates.iter().find(|c| c.name == name).unwrap();
        candidate.refusal.clone()
    };
    assert!(matches!(refusal("lambertian"), Some(Refusal::Error { error, .. }) if error > 0.1));
    assert!(matches!(refusal("exact"), Some(Refusal::Cost { times }) if times >= 1.0));
    assert!(matches!(refusal("table-in-plane"), Some(Refusal::Unfit(_))));
    let Some(Refusal::Table(reason)) = refusal("table-isotropic") else {
        panic!("a table in 100 bytes");
    };
    assert!(reason.contains("allowed are 100"), "{reason}");
    let few = Scene {
        evaluations: 1000.0,
        ..Scene::default()
    };
    let plan = Plan::new(&paper(0.3, 0.1), &few).unwrap();
    let table = plan.candidates.iter().find(|c| c.name == "table-isotropic");
    assert_eq!(table.unwrap().refusal, Some(Refusal::Making));
}

#[test]
fn a_tolerance_that_nothing_meets_says_what_the_best_reaches() {
    let scene = Scene {
        tolerance: 1e-20,
        ..Scene::default()
    };
    let error = Plan::new(&paper(0.3, 0.1), &scene).unwrap_err();
    assert_eq!(error.best, "exact");
    assert!(error.reached > 1e-17 && error.reached < 1e-14);
    assert!(
        error.to_string().contains("the best, exact, errs by"),
        "{error}"
    );
}
