//! Scans computed from Table 1 of the paper: the fit gives back what went in, exactly without
//! noise, and as the linear theory of errors says with noise.

use brdf_core::published::PUBLISHED;
use brdf_core::{Parameters, ThreeParameterBrdf};
use brdf_fit::synthetic::scan;
use brdf_fit::{FitOptions, Measurement, Measurements, RefractiveIndex, fit};
use brdf_tests::{generator, normal};
use nalgebra::{Matrix3, Vector3};

const NOISE: f64 = 0.05;
const SEEDS: u64 = 200;

fn options(n: f64) -> FitOptions {
    FitOptions {
        refractive_index: Some(RefractiveIndex::Same(n)),
        ..FitOptions::default()
    }
}

fn vector(parameters: Parameters) -> Vector3<f64> {
    Vector3::new(parameters.k2, parameters.kd, parameters.k1)
}

#[test]
fn noise_free_scans_give_back_the_published_parameters() {
    for row in PUBLISHED {
        let fit = fit(&scan(row.parameters, row.n), &options(row.n)).unwrap();
        for (found, truth) in vector(fit.parameters).iter().zip(&vector(row.parameters)) {
            if *truth == 0.0 {
                assert_eq!(*found, 0.0, "{} {}", row.sample, row.wavelength_um);
            } else {
                let error = (found / truth - 1.0).abs();
                assert!(
                    error < 1e-8,
                    "{} {}: {error:e}",
                    row.sample,
                    row.wavelength_um
                );
            }
        }
    }
}

/// The linear theory: the step from the truth that minimises the linearised E, kD >= 0 included.
struct LinearTheory {
    truth: Vector3<f64>,
    /// Rows of the Jacobian of cos theta f_r.
    rows: Vec<Vector3<f64>>,
    matrix: Matrix3<f64>,
}

impl LinearTheory {
    fn new(scan: &Measurements, parameters: Parameters, n: f64) -> Self {
        let brdf = ThreeParameterBrdf::new(parameters, n).unwrap();
        let row = |reading: &Measurement| {
            Vector3::from(brdf.gradient(&reading.geometry().unwrap())) * reading.theta.cos()
        };
        let rows: Vec<_> = scan.readings().iter().map(row).collect();
        let matrix = rows.iter().map(|row| row * row.transpose()).sum();
        Self {
            truth: vector(parameters),
            rows,
            matrix,
        }
    }

    /// The parameters that it predicts for given errors of cos theta f_r.
    fn predict(&self, errors: &[f64]) -> Vector3<f64> {
        let right: Vector3<f64> = self.rows.iter().zip(errors).map(|(row, e)| row * *e).sum();
        let free = self.truth + self.matrix.try_inverse().unwrap() * right;
        if free[1] >= 0.0 {
            return free;
        }
        // kD on its bound: the others answer to the step that it may make.
        let step = -self.truth[1];
        let (k2, k1) = (0, 2);
        let m = &self.matrix;
        let b = [right[k2] - m[(k2, 1)] * step, right[k1] - m[(k1, 1)] * step];
        let determinant = m[(k2, k2)] * m[(k1, k1)] - m[(k2, k1)] * m[(k2, k1)];
        self.truth
            + Vector3::new(
                (b[0] * m[(k1, k1)] - b[1] * m[(k2, k1)]) / determinant,
                step,
                (b[1] * m[(k2, k2)] - b[0] * m[(k2, k1)]) / determinant,
            )
    }
}

/// Mean and standard deviation of each parameter.
fn moments(all: &[Vector3<f64>]) -> (Vector3<f64>, Vector3<f64>) {
    let count = all.len() as f64;
    let mean: Vector3<f64> = all.iter().sum::<Vector3<f64>>() / count;
    let square = |p: &Vector3<f64>| (p - mean).component_mul(&(p - mean));
    let variance: Vector3<f64> = all.iter().map(square).sum::<Vector3<f64>>() / (count - 1.0);
    (mean, variance.map(f64::sqrt))
}

#[test]
fn noise_moves_the_parameters_as_the_linear_theory_says() {
    for row in PUBLISHED {
        let exact = scan(row.parameters, row.n);
        let theory = LinearTheory::new(&exact, row.parameters, row.n);
        let (mut found, mut predicted) = (Vec::new(), Vec::new());
        for seed in 0..SEEDS {
            let mut generator = generator(seed);
            let mut readings = exact.readings().to_vec();
            let mut errors = Vec::new();
            for reading in &mut readings {
                let error = NOISE * reading.brdf * normal(&mut generator);
                errors.push(error * reading.theta.cos());
                reading.brdf += error;
            }
            let noisy = Measurements::new("noisy", readings).unwrap();
            found.push(vector(fit(&noisy, &options(row.n)).unwrap().parameters));
            predicted.push(theory.predict(&errors));
        }
        let ((mean, spread), (mean_theory, spread_theory)) = (moments(&found), moments(&predicted));
        for i in 0..3 {
            let name = ["k2", "kD", "k1"][i];
            let spread_ratio = spread[i] / spread_theory[i];
            let bias = (mean[i] - mean_theory[i]) / spread_theory[i];
            println!(
                "{} {} um {name}: spread {:.2e} ({spread_ratio:.3} of the theory), bias {bias:+.3} spreads",
                row.sample, row.wavelength_um, spread[i]
            );
            assert!(
                (spread_ratio - 1.0).abs() < 0.2,
                "{} {name}: {spread_ratio}",
                row.sample
            );
            assert!(bias.abs() < 0.2, "{} {name}: {bias}", row.sample);
        }
    }
}
