//! Python: NumPy runs it, and it has the values of the model.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use brdf_core::{AnyBrdf, Family, ModelParameters};
use brdf_fit::export::Language;
use brdf_tests::python;

use crate::materials::{brdfs, source};
use crate::points::{Errors, Found, Point, check_double, points, relative};
use crate::reference::reference;

/// Prints the results of each material at each point.
const EVALUATE: &str = "
import glob
import numpy as np

for file in sorted(glob.glob('material*.py')):
    material = __import__(file[:-3])
    points = np.loadtxt(file.replace('.py', '.txt'))
    angles, source, view, numbers = np.split(points, 4, axis=1)
    drawn, density, weight = material.brdf_sample(source, numbers)
    columns = [
        material.brdf_eval(*angles.T),
        material.brdf_eval_directions(source, view),
        material.brdf_pdf(source, view),
        *drawn.T, density, weight,
    ]
    for row in zip(*columns):
        print(*(repr(float(x)) for x in row))
";

/// Prints the values of points of parameters of their own.
const EVALUATE_ALL: &str = "
import numpy as np
import material

psi, theta, phi, k2, kd, k1, n = np.loadtxt('points.txt').T
material.brdf_K2, material.brdf_KD, material.brdf_K1, material.brdf_N_MINUS_1 = k2, kd, k1, n - 1.0
for value in material.brdf_eval(psi, theta, phi):
    print(repr(float(value)))
";

/// Evaluates numbers and arrays, also outside the domain.
const EVALUATE_NUMBERS: &str = "
import warnings
import numpy as np
import material

warnings.simplefilter('error')
one = material.brdf_eval(0.3, -0.4, 0.1)
assert one.shape == () and one > 0.0
assert material.brdf_eval([0.3, 0.2], -0.4, [[0.1], [0.2], [0.3]]).shape == (3, 2)
up, below = [0.0, 0.0, 1.0], [0.6, 0.0, -0.8]
assert material.brdf_eval_directions(up, up) > 0.0 and material.brdf_pdf(up, up) > 0.0
for source, view in [(up, below), (below, up), (below, below)]:
    assert material.brdf_eval_directions(source, view) == 0.0 and material.brdf_pdf(source, view) == 0.0
for angles in [(-0.1, 0.0, 0.0), (1.6, 0.0, 0.0), (0.0, -1.6, 0.0), (6.5, 0.0, 0.0)]:
    assert np.isnan(material.brdf_eval(*angles))
view, pdf, weight = material.brdf_sample(up, np.full((4, 5, 3), 0.5))
assert view.shape == (4, 5, 3) and pdf.shape == weight.shape == (4, 5)
";

fn run(python: &Path, folder: &Path, program: &str) -> Vec<f64> {
    let program = Command::new(python)
        .current_dir(folder)
        .args(["-c", program])
        .output();
    let output = program.expect("python starts");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8(output.stdout).expect("text");
    text.split_whitespace()
        .map(|word| word.parse().expect("a number"))
        .collect()
}

fn table(numbers: impl IntoIterator<Item = impl IntoIterator<Item = f64>>) -> String {
    let mut text = String::new();
    for row in numbers {
        for number in row {
            let _ = write!(text, "{number:?} ");
        }
        text.push('\n');
    }
    text
}

#[test]
fn the_values_of_every_family_are_those_of_the_model() {
    let Some(python) = python("numpy") else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: String, text: String| fs::write(folder.path().join(name), text);
    let all = brdfs();
    let points: Vec<_> = all
        .iter()
        .map(|brdf| points(brdf.parameters().k1, 500))
        .collect();
    for (i, (brdf, points)) in all.iter().zip(&points).enumerate() {
        write(
            format!("material{i:02}.py"),
            source(brdf, Language::Python, "brdf"),
        )
        .expect("a file");
        write(
            format!("material{i:02}.txt"),
            table(points.iter().map(Point::numbers)),
        )
        .expect("a file");
    }
    let numbers = run(&python, folder.path(), EVALUATE);
    let (rows, rest) = numbers.as_chunks();
    assert!(rest.is_empty() && rows.len() == 500 * all.len());
    for ((brdf, points), rows) in all.iter().zip(&points).zip(rows.chunks(500)) {
        let found: Vec<_> = rows.iter().map(|row| Found::from_numbers(*row)).collect();
        let errors = Errors::largest(brdf, points, &found);
        let k1 = brdf.parameters().k1;
        println!("{:?} k1 = {k1}: {errors:?}", brdf.family());
        check_double(&errors, k1);
    }
}

fn one_material(family: Family) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let at = ModelParameters {
        k2: 0.3,
        kd: 0.1,
        k1: 0.2,
        n: 1.5,
        p: 1.7,
    };
    let brdf = AnyBrdf::new(family, &at).expect("a brdf");
    let text = source(&brdf, Language::Python, "brdf");
    fs::write(folder.path().join("material.py"), text).expect("a file");
    folder
}

#[test]
fn the_reference_values_are_met() {
    let Some(python) = python("numpy") else {
        return;
    };
    let (folder, points) = (one_material(Family::Paper), reference());
    let rows = points
        .iter()
        .map(|p| p.angles.into_iter().chain(p.parameters).chain([p.n]));
    fs::write(folder.path().join("points.txt"), table(rows)).expect("a file");
    let values = run(&python, folder.path(), EVALUATE_ALL);
    assert_eq!(values.len(), points.len());
    let errors = points
        .iter()
        .zip(&values)
        .map(|(point, value)| relative(*value, point.exact));
    let worst = errors.fold(0.0, f64::max);
    println!("largest relative error {worst:.1e}");
    assert!(worst <= 1e-12);
}

#[test]
fn numbers_and_arrays_are_accepted_and_the_domain_is_checked() {
    let Some(python) = python("numpy") else {
        return;
    };
    for family in Family::ALL {
        run(&python, one_material(family).path(), EVALUATE_NUMBERS);
    }
}
