//! The 5000 points of `tests/data/brdf_reference.csv`, computed in 80-digit arithmetic, against
//! the model in `f64`. Prints the errors of each kind of points, beside those of the textbook's
//! expressions: `cargo test -p brdf-tests --test reference -- --nocapture`.

use std::collections::BTreeMap;

use brdf_core::evaluator::{Double, Evaluator as _};
use brdf_core::{AnyBrdf, Geometry, Parameters, ThreeParameterBrdf};
use brdf_tests::{in_workspace, textbook};

/// Largest relative error of f_r in units of 2^-52.
const VALUE_LIMIT: f64 = 8.0;

/// Largest relative error of a derivative in units of 2^-52.
const DERIVATIVE_LIMIT: f64 = 12.0;

/// Largest relative error of f_r from a batch, in units of 2^-52.
const BATCH_LIMIT: f64 = 16.0;

struct Point {
    kind: String,
    angles: [f64; 3],
    parameters: Parameters,
    n: f64,
    /// f_r and its derivatives by k2 and k1.
    exact: [f64; 3],
}

fn points() -> Vec<Point> {
    let path = in_workspace("tests/data/brdf_reference.csv");
    let mut reader = csv::Reader::from_path(path).unwrap();
    let rows = reader.records().map(|record| {
        let record = record.unwrap();
        let v = |i: usize| record[i].parse::<f64>().unwrap();
        Point {
            kind: record[0].to_owned(),
            angles: [v(1), v(2), v(3)],
            parameters: Parameters::new(v(4), v(5), v(6)).unwrap(),
            n: v(7),
            exact: [v(8), v(9), v(10)],
        }
    });
    rows.collect()
}

/// Relative error in units of 2^-52; infinite for what is not a number.
fn ulps(value: f64, exact: f64) -> f64 {
    let difference = (value - exact).abs();
    let error = if difference == 0.0 {
        0.0
    } else {
        difference / exact.abs() / f64::EPSILON
    };
    if error.is_nan() { f64::INFINITY } else { error }
}

fn stable(point: &Point) -> [f64; 3] {
    let [psi, theta, phi] = point.angles;
    let brdf = ThreeParameterBrdf::new(point.parameters, point.n).unwrap();
    let geometry = Geometry::new(psi, theta, phi).unwrap();
    let [by_k2, by_kd, by_k1] = brdf.gradient(&geometry);
    assert_eq!(by_kd, std::f64::consts::FRAC_1_PI);
    [brdf.value(&geometry), by_k2, by_k1]
}

fn from_the_textbook(point: &Point) -> [f64; 3] {
    let [psi, theta, phi] = point.angles;
    textbook::brdf(psi, theta, phi, point.parameters, point.n)
}

/// For each kind of points the sorted errors of f_r, d/dk2 and d/dk1.
fn errors(points: &[Point], model: fn(&Point) -> [f64; 3]) -> BTreeMap<&str, [Vec<f64>; 3]> {
    let mut errors: BTreeMap<&str, [Vec<f64>; 3]> = BTreeMap::new();
    for point in points {
        let of_kind = errors.entry(&point.kind).or_default();
        for ((list, value), exact) in of_kind.iter_mut().zip(model(point)).zip(point.exact) {
            list.push(ulps(value, exact));
        }
    }
    errors
        .values_mut()
        .flatten()
        .for_each(|list| list.sort_by(f64::total_cmp));
    errors
}

fn print(title: &str, errors: &BTreeMap<&str, [Vec<f64>; 3]>) {
    println!("\n{title}: relative error in units of 2^-52, median and worst");
    println!("{:<20}{:>20}{:>20}{:>20}", "kind", "f_r", "d/dk2", "d/dk1");
    for (kind, lists) in errors {
        print!("{kind:<20}");
        for list in lists {
            let (median, worst) = (list[list.len() / 2], list[list.len() - 1]);
            let shown = |x: f64| {
                if x < 1e4 {
                    format!("{x:.1}")
                } else {
                    format!("{x:.0e}")
                }
            };
            print!("{:>20}", format!("{} / {}", shown(median), shown(worst)));
        }
        println!();
    }
}

#[test]
fn the_model_is_right_to_a_few_roundings_over_its_whole_domain() {
    let points = points();
    assert_eq!(points.len(), 5000);
    let stable = errors(&points, stable);
    print("stable forms", &stable);
    print("textbook", &errors(&points, from_the_textbook));
    assert_eq!(stable.len(), 5);
    for (kind, lists) in stable {
        for (list, limit) in lists
            .iter()
            .zip([VALUE_LIMIT, DERIVATIVE_LIMIT, DERIVATIVE_LIMIT])
        {
            let worst = list[list.len() - 1];
            assert!(worst <= limit, "{kind}: {worst} > {limit}");
        }
    }
}

#[test]
fn source_and_view_can_be_exchanged() {
    for point in points() {
        let [psi, theta, phi] = point.angles;
        let brdf = ThreeParameterBrdf::new(point.parameters, point.n).unwrap();
        let there = brdf.value(&Geometry::new(psi, theta, phi).unwrap());
        let back = brdf.value(&Geometry::new(theta, psi, phi).unwrap());
        assert!(ulps(there, back) <= 4.0);
    }
}

#[test]
fn a_batch_from_angles_is_right_to_a_few_roundings() {
    let mut worst: BTreeMap<String, f64> = BTreeMap::new();
    for point in points() {
        let [psi, theta, phi] = point.angles;
        let brdf = ThreeParameterBrdf::new(point.parameters, point.n).unwrap();
        let value = Double::new(AnyBrdf::Paper(brdf)).value(psi, theta, phi);
        let of_kind = worst.entry(point.kind).or_default();
        *of_kind = of_kind.max(ulps(value, point.exact[0]));
    }
    println!("batch from angles: largest relative error in units of 2^-52: {worst:.1?}");
    assert!(worst.values().all(|&error| error <= BATCH_LIMIT));
}
