//! C99: gcc compiles it without a warning, and it has the values of the model in double and in single
//! precision.

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use brdf_core::{AnyBrdf, Family, Geometry, ModelParameters};
use brdf_fit::export::Language;

use crate::materials::{brdfs, source};
use crate::points::{Errors, Found, Point, SINGLE, check_double, check_single, points, relative};
use crate::reference::{Reference, reference};

const OPTIONS_DOUBLE: [&[&str]; 2] = [&["-O0", "-ffp-contract=off"], &["-O2"]];
const OPTIONS_SINGLE: [&[&str]; 2] = [
    &[
        "-O0",
        "-ffp-contract=off",
        "-DBRDF_SINGLE",
        "-Wdouble-promotion",
    ],
    &["-O2", "-DBRDF_SINGLE"],
];

/// Evaluates the points of the standard input, all for each of the materials.
const EVALUATE: &str = r#"
#include <stdio.h>

static double points[1000][12];

#define MATERIAL(NAME) \
    for (int i = 0; i < count; ++i) { \
        NAME##_real p[12], view[3], density; \
        for (int j = 0; j < 12; ++j) p[j] = (NAME##_real)points[i][j]; \
        const double weight = (double)NAME##_sample(p + 3, p + 9, view, &density); \
        printf("%.17g %.17g %.17g ", (double)NAME##_eval(p[0], p[1], p[2]), \
               (double)NAME##_eval_directions(p + 3, p + 6), (double)NAME##_pdf(p + 3, p + 6)); \
        printf("%.17g %.17g %.17g ", (double)view[0], (double)view[1], (double)view[2]); \
        printf("%.17g %.17g\n", (double)density, weight); \
    }

int main(void) {
    int count = 0;
    while (count < 12 * 1000 && scanf("%lf", &points[count / 12][count % 12]) == 1) ++count;
    count /= 12;
"#;

/// Evaluates points of parameters of their own.
const EVALUATE_ALL: &str = r#"
#include <stdio.h>

int main(void) {
    double psi, theta, phi, k2, kd, k1, n;
    while (scanf("%lf%lf%lf%lf%lf%lf%lf", &psi, &theta, &phi, &k2, &kd, &k1, &n) == 7) {
        brdf_K2 = (brdf_real)k2;
        brdf_KD = (brdf_real)kd;
        brdf_K1 = (brdf_real)k1;
        brdf_N_MINUS_1 = (brdf_real)(n - 1.0);
        printf("%.17g\n", (double)brdf_eval((brdf_real)psi, (brdf_real)theta, (brdf_real)phi));
    }
    return 0;
}
"#;

/// Whether there is a compiler. Where there is none, says so: the caller has nothing to test then.
fn gcc() -> bool {
    let found = Command::new("gcc")
        .arg("--version")
        .stdout(Stdio::null())
        .status();
    let found = found.is_ok_and(|status| status.success());
    if !found {
        println!("no gcc: skipped");
    }
    found
}

fn compiled(folder: &Path, program: &str, options: &[&str]) -> PathBuf {
    let (source, built) = (folder.join("main.c"), folder.join("main"));
    fs::write(&source, program).expect("a file");
    let strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"];
    let mut gcc = Command::new("gcc");
    gcc.args(strict)
        .args(options)
        .arg("-o")
        .args([&built, &source])
        .arg("-lm");
    let output = gcc.output().expect("gcc starts");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    built
}

/// What a program prints for the numbers of its input.
fn numbers(program: &Path, input: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut text = String::new();
    for number in input {
        let _ = writeln!(text, "{number:?}");
    }
    let mut child = Command::new(program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut stdin = child.stdin.take().expect("an input");
    let writer = std::thread::spawn(move || stdin.write_all(text.as_bytes()));
    let output = child.wait_with_output().expect("the program ends");
    writer
        .join()
        .expect("a thread")
        .expect("the input is taken");
    let text = String::from_utf8(output.stdout).expect("text");
    // Whether NaN is printed with a sign depends on the C library.
    let words = text.split_whitespace().map(|word| match word {
        "-nan" => f64::NAN,
        _ => word.parse().expect("a number"),
    });
    words.collect()
}

/// The results of the sources of several materials at points, all in one program.
fn found(brdfs: &[AnyBrdf], points: &[Point], options: &[&str]) -> Vec<Vec<Found>> {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut head, mut calls) = (String::new(), String::new());
    for (i, brdf) in brdfs.iter().enumerate() {
        let text = source(brdf, Language::C, &format!("material{i}"));
        fs::write(folder.path().join(format!("{i}.h")), text).expect("a file");
        let _ = writeln!(head, "#include \"{i}.h\"");
        let _ = writeln!(calls, "    MATERIAL(material{i})");
    }
    let program = format!("{head}{EVALUATE}{calls}    return 0;\n}}\n");
    let program = compiled(folder.path(), &program, options);
    let numbers = numbers(&program, points.iter().flat_map(Point::numbers));
    let (rows, rest) = numbers.as_chunks();
    assert!(rest.is_empty());
    let rows: Vec<_> = rows.iter().map(|row| Found::from_numbers(*row)).collect();
    rows.chunks(points.len()).map(<[_]>::to_vec).collect()
}

/// The values of the program for points of parameters of their own: its constants are made variables.
fn at_reference(points: &[Reference], options: &[&str]) -> Vec<f64> {
    let folder = tempfile::tempdir().expect("a folder");
    let at = ModelParameters {
        k2: 1.0,
        kd: 1.0,
        k1: 1.0,
        n: 1.5,
        p: 1.0,
    };
    let brdf = AnyBrdf::new(Family::Paper, &at).expect("a brdf");
    let header = source(&brdf, Language::C, "brdf");
    let variable = header.replace("static const brdf_real", "static brdf_real");
    let program = compiled(folder.path(), &(variable + EVALUATE_ALL), options);
    let input = points.iter().flat_map(|point| {
        point
            .angles
            .into_iter()
            .chain(point.parameters)
            .chain([point.n])
    });
    numbers(&program, input)
}

#[test]
fn the_values_of_every_family_are_those_of_the_model() {
    if !gcc() {
        return;
    }
    let all = brdfs();
    for (i, of_families) in all.chunks(Family::ALL.len()).enumerate() {
        let k1 = of_families[0].parameters().k1;
        let points = points(k1, 400);
        for options in OPTIONS_DOUBLE {
            for (brdf, found) in of_families.iter().zip(found(of_families, &points, options)) {
                let errors = Errors::largest(brdf, &points, &found);
                println!("{i} {:?} k1 = {k1} {options:?}: {errors:?}", brdf.family());
                check_double(&errors, k1);
            }
        }
        let points: Vec<_> = points.into_iter().map(Point::single).collect();
        for options in OPTIONS_SINGLE {
            for (brdf, found) in of_families.iter().zip(found(of_families, &points, options)) {
                let errors = Errors::largest(brdf, &points, &found);
                println!("{i} {:?} k1 = {k1} {options:?}: {errors:?}", brdf.family());
                check_single(&errors, SINGLE);
            }
        }
    }
}

#[test]
fn the_reference_values_are_met_in_double_precision() {
    if !gcc() {
        return;
    }
    let points = reference();
    for options in OPTIONS_DOUBLE {
        let values = at_reference(&points, options);
        let errors = points
            .iter()
            .zip(&values)
            .map(|(point, value)| relative(*value, point.exact));
        let worst = errors.fold(0.0, f64::max);
        println!("{options:?}: largest relative error {worst:.1e}");
        assert!(worst <= 1e-12);
    }
}

/// The points within the domain of single precision: up to 85 deg, k1 in [0.01, 10], n up to 6. The
/// others, most of those made for extremes, are beyond it.
#[test]
fn the_reference_points_of_its_domain_are_met_in_single_precision() {
    if !gcc() {
        return;
    }
    let largest = 85_f64.to_radians();
    let points = reference().into_iter().filter(|point| {
        let angles = point.angles[..2].iter().all(|angle| *angle <= largest);
        angles && (0.01..=10.0).contains(&point.parameters[2]) && point.n <= 6.0
    });
    let points: Vec<_> = points.collect();
    for options in OPTIONS_SINGLE {
        let values = at_reference(&points, options);
        let errors = points
            .iter()
            .zip(&values)
            .map(|(point, value)| relative(*value, at_single_angles(point)));
        let worst = errors.fold(0.0, f64::max);
        println!(
            "{options:?}: {} points, largest relative error {worst:.1e}",
            points.len()
        );
        assert!(points.len() > 1000 && worst <= SINGLE);
    }
}

/// The model at the angles that `f32` has: next to the mirror direction their rounding is a change.
fn at_single_angles(point: &Reference) -> f64 {
    let [k2, kd, k1] = point.parameters;
    let at = ModelParameters {
        k2,
        kd,
        k1,
        n: point.n,
        p: 1.0,
    };
    let brdf = AnyBrdf::new(Family::Paper, &at).expect("a brdf");
    let [psi, theta, phi] = crate::points::narrow(point.angles).map(f64::from);
    brdf.value(&Geometry::new(psi, theta, phi).expect("angles"))
}

#[test]
fn f_r_is_0_below_the_surface_and_nan_outside_the_domain() {
    if !gcc() {
        return;
    }
    let angles = [
        [-0.1, 0.0, 0.0],
        [1.6, 0.0, 0.0],
        [0.0, -1.6, 0.0],
        [6.5, 0.0, 0.0],
        [f64::NAN; 3],
    ];
    let (up, below) = ([0.0, 0.0, 1.0], [0.6, 0.0, -0.8]);
    let directions = [
        [up, below],
        [below, up],
        [below, below],
        [below, up],
        [below, up],
    ];
    let points = angles
        .into_iter()
        .zip(directions)
        .map(|(angles, [source, view])| Point {
            angles,
            source,
            view,
            numbers: [0.3; 3],
        });
    let points: Vec<_> = points.collect();
    let all = brdfs();
    for options in [OPTIONS_DOUBLE[1], OPTIONS_SINGLE[1]] {
        for found in found(&all[..Family::ALL.len()], &points, options).concat() {
            assert!(found.of_angles.is_nan(), "{found:?}");
            assert_eq!((found.of_directions, found.pdf), (0.0, 0.0));
        }
    }
}
