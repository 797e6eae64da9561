//! The model in `f64` against itself in double-double arithmetic, at random points.
//!
//! Next to n = 1 the Fresnel factor falls as 1/cos^4 gamma, which multiplies rounding errors, so that
//! n - 1 is drawn from each decade. The largest errors are printed by
//! `cargo test -p brdf-core --test accuracy -- --nocapture`, with PROPTEST_CASES points of each decade.

mod double_double;
mod model;

use std::cell::Cell;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use brdf_core::evaluator::{Double, Evaluator as _};
use brdf_core::{Geometry, Parameters, ThreeParameterBrdf};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

use model::Point;

/// The largest relative error of f_r in units of 2^-52.
const LIMIT: f64 = 8.0;

/// The largest relative error of f_r from a batch, in units of 2^-52.
const BATCH_LIMIT: f64 = 20.0;

/// The points of each decade, unless PROPTEST_CASES is set.
const CASES: u32 = 500;

fn brdf(point: &Point) -> ThreeParameterBrdf {
    ThreeParameterBrdf::new(point.parameters, point.n).unwrap()
}

fn value(point: &Point) -> f64 {
    let geometry = Geometry::new(point.psi, point.theta, point.phi).unwrap();
    brdf(point).value(&geometry)
}

fn from_a_batch(point: &Point) -> f64 {
    Double::new(brdf(point).into()).value(point.psi, point.theta, point.phi)
}

/// The relative error in units of 2^-52.
fn error(value: f64, point: &Point) -> f64 {
    let exact = model::brdf(point);
    ((exact - value.into()) / exact).nearest().abs() / f64::EPSILON
}

/// A number whose logarithm is uniform between two powers of ten.
fn magnitude(exponents: std::ops::Range<f64>) -> impl Strategy<Value = f64> + Clone {
    exponents.prop_map(|exponent| 10_f64.powf(exponent))
}

/// Zenith angles: anywhere, next to grazing and next to the normal.
fn zenith() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![
        2 => 0.0..=FRAC_PI_2,
        1 => magnitude(-16.0..0.0).prop_map(|distance| FRAC_PI_2 - distance),
        1 => magnitude(-8.0..0.0),
    ]
}

/// Azimuths: anywhere, next to the plane of incidence and beyond a turn.
fn azimuth() -> impl Strategy<Value = f64> {
    prop_oneof![
        2 => -TAU..TAU,
        1 => magnitude(-16.0..0.0).prop_map(|distance| PI - distance),
        1 => -100.0..100.0,
    ]
}

/// Pairs of psi and the signed theta, some of them next to the same or the opposite angle.
fn zeniths() -> impl Strategy<Value = (f64, f64)> {
    let near = (zenith(), magnitude(-12.0..0.0)).prop_map(|(psi, part)| (psi, psi * (1.0 - part)));
    let pair = prop_oneof![3 => (zenith(), zenith()), 1 => near];
    (pair, prop::bool::weighted(0.25))
        .prop_map(|((psi, theta), negative)| (psi, if negative { -theta } else { theta }))
}

fn points(n: impl Strategy<Value = f64>) -> impl Strategy<Value = Point> {
    let k1 = prop_oneof![2 => magnitude(-1.5..1.5), 1 => magnitude(-8.0..8.0)];
    let kd = prop_oneof![3 => Just(0.0), 1 => 0.0..1.0];
    let parameters = (0.01..10.0, kd, k1)
        .prop_map(|(k2, kd, k1)| Parameters::new(k2, kd, k1).expect("in the domain"));
    (zeniths(), azimuth(), parameters, n).prop_map(|((psi, theta), phi, parameters, n)| Point {
        psi,
        theta,
        phi,
        parameters,
        n,
    })
}

/// The largest errors of the value and of a batch over random points, after a check of each.
fn largest_errors(n: impl Strategy<Value = f64>) -> [f64; 2] {
    let cases = std::env::var("PROPTEST_CASES").map_or(CASES, |text| text.parse().unwrap());
    let largest = [Cell::new(0.0_f64), Cell::new(0.0)];
    let config = ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(cases)
    };
    TestRunner::new(config)
        .run(&points(n), |point| {
            let errors = [value(&point), from_a_batch(&point)].map(|value| error(value, &point));
            for (largest, error) in largest.iter().zip(errors) {
                largest.set(largest.get().max(error));
            }
            prop_assert!(errors[0] <= LIMIT, "{}", errors[0]);
            prop_assert!(errors[1] <= BATCH_LIMIT, "batch: {}", errors[1]);
            Ok(())
        })
        .unwrap_or_else(|failure| panic!("{failure}"));
    largest.map(Cell::into_inner)
}

#[test]
fn f_r_is_right_to_a_few_roundings_in_each_decade_of_n() {
    println!("largest relative error in units of 2^-52");
    println!("{:<18}{:>8}{:>8}", "n - 1", "value", "batch");
    let print =
        |name: &str, [value, batch]: [f64; 2]| println!("{name:<18}{value:>8.1}{batch:>8.1}");
    print("0", largest_errors(Just(1.0)));
    for exponent in -16..5_i32 {
        let exponents = f64::from(exponent)..f64::from(exponent + 1);
        let n = magnitude(exponents).prop_map(|above| (1.0 + above).min(1e5));
        print(
            &format!("1e{exponent} to 1e{}", exponent + 1),
            largest_errors(n),
        );
    }
}

/// At this point f_r had an error of 10.4 units.
#[test]
fn a_point_next_to_n_of_one_is_right() {
    let point = Point {
        psi: 1.481_621_193_342_705_3,
        theta: 1.204_109_318_867_845_1,
        phi: 2.065_221_633_844_411_4,
        parameters: Parameters::new(1.205_590_899_436_300_7, 0.0, 2.618_234_956_537_062).unwrap(),
        n: 1.000_000_014_249_737,
    };
    // From a computation in 80-digit arithmetic: 15.375165742808262082.
    assert_eq!(model::brdf(&point).nearest(), 15.375_165_742_808_262);
    let error = error(value(&point), &point);
    assert!(error <= LIMIT, "{error}");
}

/// The double-double arithmetic against 80 digits, of which the file states 25.
#[test]
fn the_reference_agrees_with_eighty_digits() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/data/brdf_reference.csv"
    );
    let Ok(text) = std::fs::read_to_string(path) else {
        println!("skipped: no {path}");
        return;
    };
    let rows = text.lines().skip(1);
    for row in rows {
        let fields: Vec<&str> = row.split(',').collect();
        let number = |i: usize| fields[i].parse::<f64>().unwrap();
        let point = Point {
            psi: number(1),
            theta: number(2),
            phi: number(3),
            parameters: Parameters::new(number(4), number(5), number(6)).unwrap(),
            n: number(7),
        };
        let exact = model::brdf(&point).nearest();
        let error = (exact - number(8)).abs() / (number(8) * f64::EPSILON);
        assert!(error <= 1e-3, "{row}: {error}");
    }
}
