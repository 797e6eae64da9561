//! Compares every evaluator with the values of single points, over the whole domain.

#![expect(
    clippy::cast_possible_truncation,
    reason = "rounds to the nearest `f32`"
)]

use std::f64::consts::{PI, TAU};

use brdf_core::evaluator::{
    Double, Evaluator, FittedFresnel, Lambertian, LengthError, Points, Single, SpecularOnly,
};
use brdf_core::scene::{Coordinates, Domain, Probe};
use brdf_core::{AnyBrdf, Family, Geometry, ModelParameters};
use proptest::prelude::*;

fn brdf(family: Family, k2: f64, kd: f64, k1: f64, n: f64, p: f64) -> AnyBrdf {
    AnyBrdf::new(family, &ModelParameters { k2, kd, k1, n, p }).unwrap()
}

/// A BRDF of any family with usual weights, k1 in a range and a usual refractive index.
fn any_brdf(k1: std::ops::Range<f64>) -> impl Strategy<Value = AnyBrdf> {
    let log_k1 = k1.start.ln()..k1.end.ln();
    (0..5_usize, 0.01..3.0, 0.0..1.0, log_k1, 1.0..6.0, 0.2..4.0).prop_map(
        |(family, k2, kd, log_k1, n, p)| brdf(Family::ALL[family], k2, kd, log_k1.exp(), n, p),
    )
}

fn single_points() -> [Vec<f64>; 3] {
    let sequence = |factor: f64, scale: f64| {
        (0..100)
            .map(|i| scale * (f64::from(i) * factor).fract())
            .collect()
    };
    [
        sequence(0.618_034, 1.5),
        sequence(0.754_878, 1.5),
        sequence(0.569_841, TAU),
    ]
}

fn angles([psi, theta, phi]: &[Vec<f64>; 3], count: usize) -> Points<'_, f64> {
    Points::Angles {
        psi: &psi[..count],
        theta: &theta[..count],
        phi: &phi[..count],
    }
}

/// The largest error of an evaluator at points in all coordinates.
fn worst(brdf: &AnyBrdf, evaluator: &dyn Evaluator, domain: &Domain, seed: u32) -> f64 {
    [
        Coordinates::Cosines,
        Coordinates::Angles,
        Coordinates::Directions,
    ]
    .map(|c| {
        Probe::new(brdf, domain, c, 2000, seed)
            .errors(evaluator)
            .max
    })
    .into_iter()
    .fold(0.0, f64::max)
}

fn all_directions(largest_deg: f64) -> Domain {
    let range = (0.0, largest_deg.to_radians());
    Domain::all(range, range).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn the_batch_in_f64_is_accurate_to_a_few_roundings(
        brdf in any_brdf(1e-6..1e3), largest_deg in 1.0..89.999_f64, seed in 0..1000_u32,
    ) {
        let domain = all_directions(largest_deg);
        let error = |coordinates| {
            let probe = Probe::new(&brdf, &domain, coordinates, 2000, seed);
            probe.errors(&Double::new(brdf)).max
        };
        // The exponent p multiplies the rounding error of the logarithm, and tails of exp(-x) that of x.
        let allowed = match brdf {
            AnyBrdf::Power(_) => 1e-13,
            AnyBrdf::Beckmann(_) => 1e-12,
            // The sines of the Smith shadowing are computed from the cosines.
            AnyBrdf::Smith(_) | AnyBrdf::Ggx(_) => {
                32.0 * f64::EPSILON * brdf.parameters().k1.powi(2).max(1.0)
            }
            AnyBrdf::Paper(_) => 32.0 * f64::EPSILON,
        };
        prop_assert!(error(Coordinates::Cosines) <= allowed);
        prop_assert!(error(Coordinates::Angles) <= allowed);
        // A single point normalises its vectors, which rounds them once more. For a narrow lobe this
        // changes the point, most of all next to grazing.
        let tilt = brdf.parameters().k1.min(1.0) * largest_deg.to_radians().cos();
        let rounding = 16.0 * f64::EPSILON / tilt;
        prop_assert!(error(Coordinates::Directions) <= allowed + rounding);
    }

    #[test]
    fn the_batch_in_f32_is_within_1e_5(brdf in any_brdf(0.01..10.0), seed in 0..1000_u32) {
        let error = worst(&brdf, &Single::new(brdf), &all_directions(85.0), seed);
        prop_assert!(error <= 1e-5, "{} {:?}", error, brdf);
    }

    #[test]
    fn the_error_of_a_fitted_fresnel_factor_is_within_its_bound(
        brdf in any_brdf(0.01..10.0), largest_deg in 10.0..85.0_f64, seed in 0..1000_u32,
        log_tolerance in -12.0..-2.0_f64,
    ) {
        prop_assume!(!matches!(brdf, AnyBrdf::Beckmann(_) | AnyBrdf::Power(_)));
        let least_cos_gamma = largest_deg.to_radians().cos();
        let tolerance = log_tolerance.exp();
        let Some(fitted) = FittedFresnel::new(brdf, least_cos_gamma, tolerance) else {
            return Ok(());
        };
        let bound = fitted.fresnel_error_bound();
        prop_assert!(bound <= tolerance);
        let error = worst(&brdf, &fitted, &all_directions(largest_deg), seed);
        prop_assert!(error <= bound + 1e-5, "{} > {}", error, bound);
    }

    #[test]
    fn a_point_has_the_same_value_at_any_index(
        brdf in any_brdf(1e-3..10.0), count in 0..100_usize,
    ) {
        let arrays = single_points();
        for evaluator in [&Double::new(brdf) as &dyn Evaluator, &Single::new(brdf)] {
            let mut together = vec![0.0; count];
            evaluator.values(&angles(&arrays, count), &mut together).unwrap();
            for (i, value) in together.iter().enumerate() {
                let [psi, theta, phi] = arrays.each_ref().map(|a| a[i]);
                prop_assert_eq!(*value, evaluator.value(psi, theta, phi));
            }
        }
    }

    #[test]
    fn azimuths_beyond_a_turn_are_periodic(
        brdf in any_brdf(1e-2..10.0), psi in 0.0..1.5, theta in -1.5..1.5, turns in 1..50_i32,
    ) {
        let double = Double::new(brdf);
        let (near, far) = (2.0, 2.0 + f64::from(turns) * TAU);
        let (near, far) = (double.value(psi, theta, near), double.value(psi, theta, far));
        prop_assert!((near / far - 1.0).abs() < 1e-9);
    }
}

#[test]
fn arrays_of_different_lengths_are_an_error() {
    let double = Double::new(brdf(Family::Paper, 0.3, 0.1, 0.2, 1.5, 1.0));
    let points = Points::Cosines {
        psi: &[1.0, 1.0],
        theta: &[1.0],
        phi: &[1.0, 1.0],
    };
    let error = double.values(&points, &mut [0.0; 2]);
    assert_eq!(
        error,
        Err(LengthError {
            expected: 2,
            found: 1
        })
    );
    let arrays = single_points();
    let error = double
        .values(&angles(&arrays, 5), &mut [0.0; 4])
        .unwrap_err();
    assert!(error.to_string().contains("4 elements: expected 5"));
    assert!(double.values(&angles(&arrays, 0), &mut []).is_ok());
    assert!(
        double
            .grid(&[0.0], &[0.0, 0.1], &[0.0], &mut [0.0; 2])
            .is_err()
    );
    assert!(double.grid(&[0.0], &[0.0], &[0.0], &mut [0.0; 2]).is_err());
}

#[test]
fn values_outside_the_domain_are_nan() {
    let brdf = brdf(Family::Paper, 0.3, 0.1, 0.2, 1.5, 1.0);
    let evaluators: [&dyn Evaluator; 4] = [
        &Double::new(brdf),
        &Single::new(brdf),
        &FittedFresnel::new(brdf, 0.0, 1e-2).unwrap(),
        &Lambertian::new(0.1),
    ];
    for evaluator in evaluators {
        let name = evaluator.name();
        for (psi, theta) in [
            (-0.1, 0.0),
            (1.6, 0.0),
            (9.0, 0.0),
            (0.0, -1.6),
            (f64::NAN, 0.1),
        ] {
            assert!(
                evaluator.value(psi, theta, 0.0).is_nan(),
                "{name} {psi} {theta}"
            );
        }
        let mut out = [0.0; 3];
        let below = Points::Directions {
            source: [&[0.0, 0.0, 0.0], &[0.0, 0.0, 0.0], &[1.0, 1.0, -1.0]],
            view: [&[0.6, 1.0, 0.6], &[0.0, 0.0, 0.0], &[-0.8, 0.0, 0.8]],
        };
        evaluator.values(&below, &mut out).unwrap();
        assert!(out.iter().all(|value| value.is_nan()), "{name} {out:?}");
    }
}

#[test]
fn cosines_above_one_by_a_rounding_error_are_treated_as_one() {
    let brdf = brdf(Family::Paper, 0.3, 0.1, 0.2, 1.5, 1.0);
    let above = 1.0_f32.next_up();
    let mut out = [0.0; 2];
    let points = Points::Cosines {
        psi: &[above, 0.5],
        theta: &[above, 0.5],
        phi: &[1.0, -above],
    };
    Single::new(brdf).values_f32(&points, &mut out).unwrap();
    let normal = brdf.value(&Geometry::in_plane(0.0, 0.0).unwrap());
    let mirror = brdf.value(&Geometry::in_plane(PI / 3.0, -PI / 3.0).unwrap());
    assert!((f64::from(out[0]) / normal - 1.0).abs() < 1e-5);
    assert!((f64::from(out[1]) / mirror - 1.0).abs() < 1e-5);
}

#[test]
fn a_grid_has_the_values_of_its_points() {
    let psi: Vec<f64> = (0..40).map(|i| f64::from(i) * 0.039).collect();
    let theta: Vec<f64> = (0..901).map(|i| f64::from(i) * 0.003_4 - 1.53).collect();
    let phi: Vec<f64> = (0..901).map(|i| f64::from(i) * 0.01).collect();
    for family in Family::ALL {
        let brdf = brdf(family, 0.3, 0.1, 0.2, 1.5, 1.3);
        let mut grid = vec![0.0; psi.len() * theta.len()];
        Double::new(brdf)
            .grid(&psi, &theta, &phi, &mut grid)
            .unwrap();
        let narrow = |a: &[f64]| a.iter().map(|&x| x as f32).collect::<Vec<_>>();
        let mut single = vec![0.0; grid.len()];
        let [psi32, theta32, phi32] = [&psi, &theta, &phi].map(|a| narrow(a));
        Single::new(brdf)
            .grid(&psi32, &theta32, &phi32, &mut single)
            .unwrap();
        for (i, &psi) in psi.iter().enumerate() {
            for (j, (&theta, &phi)) in theta.iter().zip(&phi).enumerate() {
                let exact = brdf.value(&Geometry::new(psi, theta, phi).unwrap());
                let at = i * phi32.len() + j;
                assert!(
                    (grid[at] / exact - 1.0).abs() < 1e-12,
                    "{family:?} {psi} {theta}"
                );
                assert!((f64::from(single[at]) / exact - 1.0).abs() < 1e-3);
            }
        }
    }
}

#[test]
fn many_points_have_the_values_of_few() {
    let brdf = brdf(Family::Ggx, 0.3, 0.1, 0.2, 1.5, 1.0);
    let count = 100_000;
    let probe = Probe::new(&brdf, &all_directions(85.0), Coordinates::Cosines, count, 3);
    let Points::Cosines { psi, theta, phi } = probe.points() else {
        unreachable!("the probe has the requested coordinates")
    };
    let mut many = vec![0.0; count];
    Double::new(brdf)
        .values(&probe.points(), &mut many)
        .unwrap();
    for from in (0..count).step_by(1000) {
        let range = from..from + 1000;
        let mut few = vec![0.0; 1000];
        let part = Points::Cosines {
            psi: &psi[range.clone()],
            theta: &theta[range.clone()],
            phi: &phi[range.clone()],
        };
        Double::new(brdf).values(&part, &mut few).unwrap();
        assert_eq!(few, many[range]);
    }
}

#[test]
fn specular_and_lambertian_parts_add_up_to_the_whole() {
    let brdf = brdf(Family::Paper, 0.3, 0.1, 0.2, 1.5, 1.0);
    let whole = Single::new(brdf).value(0.3, -0.3, 0.0);
    let specular = SpecularOnly::new(&brdf).value(0.3, -0.3, 0.0);
    let diffuse = Lambertian::new(0.1).value(0.3, -0.3, 0.0);
    assert!((specular + diffuse - whole).abs() < 1e-6 * whole);
    assert!((diffuse - 0.1 / PI).abs() < 1e-8);
}

/// Prints the errors in `f32` that the documentation of the evaluators states:
/// `cargo test -p brdf-core --release --test evaluators -- --nocapture errors_in_f32`.
#[test]
fn errors_in_f32_are_as_documented() {
    println!("largest and rms relative error in f32, k2 = 0.3, kD = 0.1, n = 1.5, p = 1.7");
    for largest_deg in [60.0, 85.0, 89.9] {
        for k1 in [1e-3, 0.01, 0.1, 1.0] {
            let errors = Family::ALL.map(|family| {
                let brdf = brdf(family, 0.3, 0.1, k1, 1.5, 1.7);
                let domain = all_directions(largest_deg);
                let probe = |c| Probe::new(&brdf, &domain, c, 100_000, 5);
                [
                    Coordinates::Cosines,
                    Coordinates::Angles,
                    Coordinates::Directions,
                ]
                .map(|c| probe(c).errors(&Single::new(brdf)).max)
            });
            let words = errors.map(|e| format!("{:7.1e} {:7.1e} {:7.1e}", e[0], e[1], e[2]));
            println!("{largest_deg:5} deg, k1 = {k1:5}: {}", words.join(" | "));
            if largest_deg <= 85.0 && k1 >= 0.01 {
                assert!(errors.iter().flatten().all(|&error| error <= 1e-5));
            }
        }
    }
}
