//! E and what the minimisers and the statistics need of it: residuals, derivatives, scalar products.

use std::ops::Range;

use brdf_core::ModelParameters;
use nalgebra::DMatrix;
use rayon::prelude::*;

use super::block::{BLOCK, column, column_factor, derivatives_for, dot, residual};
use super::rows::{IncidenceError, Objective, Segment};
use crate::model::Parameter;

/// E below which only rounding is left, as a fraction.
pub(crate) const ROUNDING: f64 = 1e-20;

/// From this number of rows on, incidences are evaluated in parallel: for the 112 readings of a
/// usual scan, starting the threads takes as long as the whole fit.
pub const PARALLEL_FROM: usize = 1 << 13;

/// E with the terms of a Gauss-Newton step: J^T r, half the gradient of E, and J^T J, half its
/// approximate Hessian. P is the number of free parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalEquations<const P: usize> {
    /// E.
    pub error: f64,
    /// J^T r, half the gradient of E.
    pub gradient: nalgebra::SVector<f64, P>,
    /// J^T J.
    pub matrix: nalgebra::SMatrix<f64, P, P>,
}

/// The scalar products of the columns u, a and y, from which k2 and kD follow exactly.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct ProfileSums {
    pub(crate) uu: f64,
    pub(crate) ua: f64,
    pub(crate) uy: f64,
    pub(crate) aa: f64,
    pub(crate) ay: f64,
}

impl Objective {
    /// E as a fraction; times 100 it is the percentage of the paper.
    pub fn error(&self, at: &ModelParameters) -> f64 {
        let mut error = 0.0;
        self.for_blocks(at, [false; 3], 0..self.len(), |_, block| {
            let r = residual(block, at);
            error += dot(&r, &r);
        });
        error
    }

    /// E of each incidence, in ascending order of the incidence angle.
    pub fn by_incidence(&self, at: &ModelParameters) -> Vec<IncidenceError> {
        self.error_and_by_incidence(at).1
    }

    /// E as a fraction, and E of each incidence. Each row is evaluated once; the incidences of large
    /// scans are evaluated in parallel.
    pub fn error_and_by_incidence(&self, at: &ModelParameters) -> (f64, Vec<IncidenceError>) {
        let squares = |segment: &Segment| self.squares_of(at, segment);
        let squares: Vec<(f64, f64)> = if self.len() < PARALLEL_FROM {
            self.segments.iter().map(squares).collect()
        } else {
            self.segments.par_iter().map(squares).collect()
        };
        let error = squares.iter().map(|(above, _)| above).sum();
        let of = |(segment, (above, below)): (&Segment, (f64, f64))| {
            IncidenceError::new(segment, (below > 0.0).then(|| 100.0 * above / below))
        };
        (error, self.segments.iter().zip(squares).map(of).collect())
    }

    /// Numerator and denominator of E, summed over one incidence.
    pub(crate) fn squares_of(&self, at: &ModelParameters, segment: &Segment) -> (f64, f64) {
        let (mut above, mut below) = (0.0, 0.0);
        self.for_blocks(at, [false; 3], segment.rows.clone(), |_, block| {
            let r = residual(block, at);
            above += dot(&r, &r);
            below += dot(&block.y, &block.y);
        });
        (above, below)
    }

    /// The residual (model - measured) and y of each row.
    pub(crate) fn residuals(&self, at: &ModelParameters) -> Vec<(f64, f64)> {
        self.residuals_of(at, 0..self.len())
    }

    /// The [`residuals`](Self::residuals) of some of the rows.
    pub(crate) fn residuals_of(&self, at: &ModelParameters, rows: Range<usize>) -> Vec<(f64, f64)> {
        let mut residuals = Vec::with_capacity(rows.len());
        self.for_blocks(at, [false; 3], rows, |rows, block| {
            let r = residual(block, at);
            residuals.extend(r.into_iter().zip(block.y).take(rows.len()));
        });
        residuals
    }

    /// E with J^T r and J^T J for the residuals r = model - measured, with respect to the free
    /// parameters.
    pub fn normal_equations<const P: usize>(
        &self,
        at: &ModelParameters,
        free: &[Parameter; P],
    ) -> NormalEquations<P> {
        let mut equations = NormalEquations {
            error: 0.0,
            gradient: nalgebra::SVector::zeros(),
            matrix: nalgebra::SMatrix::zeros(),
        };
        self.for_blocks(at, derivatives_for(free), 0..self.len(), |_, block| {
            let r = residual(block, at);
            equations.error += dot(&r, &r);
            let columns: [&[f64; BLOCK]; P] = free.map(|parameter| column(block, parameter));
            for i in 0..P {
                equations.gradient[i] += dot(columns[i], &r);
                for j in 0..=i {
                    equations.matrix[(i, j)] += dot(columns[i], columns[j]);
                }
            }
        });
        let factors = free.map(|parameter| column_factor(at, parameter));
        for i in 0..P {
            equations.gradient[i] *= factors[i];
            for j in 0..=i {
                let value = equations.matrix[(i, j)] * (factors[i] * factors[j]);
                (equations.matrix[(i, j)], equations.matrix[(j, i)]) = (value, value);
            }
        }
        equations
    }

    /// The Jacobian of the residuals: one row for each row of the objective, one column for each free
    /// parameter.
    pub(crate) fn jacobian(&self, at: &ModelParameters, free: &[Parameter]) -> DMatrix<f64> {
        let mut jacobian = DMatrix::zeros(self.len(), free.len());
        self.for_blocks(at, derivatives_for(free), 0..self.len(), |rows, block| {
            for (j, &parameter) in free.iter().enumerate() {
                let factor = column_factor(at, parameter);
                for (i, value) in rows.clone().zip(column(block, parameter)) {
                    jacobian[(i, j)] = value * factor;
                }
            }
        });
        jacobian
    }

    /// The scalar products of the columns for the given k1, n and p.
    pub(crate) fn profile_sums(&self, at: &ModelParameters) -> ProfileSums {
        let mut sums = ProfileSums {
            aa: self.diffuse_squared,
            ay: self.diffuse_measured,
            ..ProfileSums::default()
        };
        self.for_blocks(at, [false; 3], 0..self.len(), |_, block| {
            sums.uu += dot(&block.u, &block.u);
            sums.ua += dot(&block.u, &block.a);
            sums.uy += dot(&block.u, &block.y);
        });
        sums
    }

    /// kD of the best Lambertian model, which negative readings can make negative.
    pub(crate) fn lambertian_weight(&self) -> f64 {
        self.diffuse_measured / self.diffuse_squared
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::{AnyBrdf, Family, Parameters, ThreeParameterBrdf};
    use proptest::prelude::*;

    use super::*;
    use crate::objective::ObjectiveError;
    use crate::objective::weights::{AssumedErrors, Weights};
    use crate::scan::Measurement;
    use crate::scan::Measurements;
    use crate::scan::synthetic::scan;

    const N: f64 = 1.5;

    /// A scan whose readings are not those of the model.
    fn distorted_scan() -> Vec<Measurement> {
        let truth = Parameters::new(0.3, 0.1, 0.2).unwrap();
        let mut readings = scan(truth, N).readings().to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= 1.0 + 0.3 * (i as f64).sin();
            reading.sigma = Some(0.1 + 0.01 * (i % 7) as f64);
        }
        readings
    }

    fn of(readings: Vec<Measurement>, weights: &Weights) -> Result<Objective, ObjectiveError> {
        let scan = Measurements::new("test", readings).unwrap();
        Objective::new(&scan, Family::Paper, N, weights)
    }

    fn objective(weights: &Weights) -> Objective {
        of(distorted_scan(), weights).unwrap()
    }

    fn three(parameters: Parameters) -> ModelParameters {
        ModelParameters::three(parameters, N)
    }

    #[test]
    fn equals_eq_5_written_out() {
        let parameters = Parameters::new(0.2, 0.15, 0.3).unwrap();
        let brdf = ThreeParameterBrdf::new(parameters, N).unwrap();
        let weights = Weights {
            g1: "0=1,60=1,70=0.5".parse().unwrap(),
            errors: AssumedErrors::Stated,
            ..Weights::default()
        };
        let (mut above, mut below) = (0.0, 0.0);
        for reading in distorted_scan() {
            let g = if reading.psi.to_degrees() > 65.0 {
                0.5
            } else {
                1.0
            } / reading.sigma.unwrap().powi(2);
            let difference = reading.brdf - brdf.value(&reading.geometry().unwrap());
            above += g * (difference * reading.theta.cos()).powi(2);
            below += g * (reading.brdf * reading.theta.cos()).powi(2);
        }
        let error = objective(&weights).error(&three(parameters));
        assert!((error / (above / below) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn residuals_and_subsets_add_up() {
        let at = three(Parameters::new(0.2, 0.15, 0.3).unwrap());
        let objective = objective(&Weights::default());
        let residuals = objective.residuals(&at);
        let sum: f64 = residuals.iter().map(|(r, _)| r * r).sum();
        assert!((sum / objective.error(&at) - 1.0).abs() < 1e-12);
        let some = objective.subset(|i| i % 3 == 0).unwrap();
        let (mut above, mut below) = (0.0, 0.0);
        for segment in objective.segments().iter().step_by(3) {
            for (r, y) in &residuals[segment.rows.clone()] {
                above += r * r;
                below += y * y;
            }
        }
        assert!((some.error(&at) / (above / below) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_incidences_add_up_to_e() {
        let at = three(Parameters::new(0.2, 0.15, 0.3).unwrap());
        let objective = objective(&Weights::default());
        let incidences = objective.by_incidence(&at);
        assert_eq!(incidences.len(), objective.segments().len());
        assert!(incidences.is_sorted_by(|a, b| a.psi_deg < b.psi_deg));
        let mut error = 0.0;
        for (incidence, segment) in incidences.iter().zip(objective.segments()) {
            let (_, readings) = objective.squares_of(&at, segment);
            error += 0.01 * incidence.e_percent.unwrap() * readings;
        }
        assert!((error / objective.error(&at) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_factor_on_a_weight_is_like_repeated_readings() {
        let at = three(Parameters::new(0.2, 0.15, 0.3).unwrap());
        let once = objective(&Weights::default());
        let twice = once.reweighted(|i| if i < 20 { 2.0 } else { 1.0 }).unwrap();
        let mut readings = distorted_scan();
        let repeated: Vec<Measurement> =
            once.readings()[..20].iter().map(|&i| readings[i]).collect();
        readings.extend(repeated);
        let expected = of(readings, &Weights::default()).unwrap().error(&at);
        assert!((twice.error(&at) / expected - 1.0).abs() < 1e-12);
    }

    #[test]
    fn every_family_has_the_residuals_of_its_brdf() {
        let at = ModelParameters {
            k2: 0.2,
            kd: 0.15,
            k1: 0.3,
            n: 1.8,
            p: 1.4,
        };
        let scan = Measurements::new("test", distorted_scan()).unwrap();
        for family in Family::ALL {
            // Neither with the index of the objective nor with another one.
            for n in [1.8, 1.5] {
                let objective = Objective::new(&scan, family, n, &Weights::default()).unwrap();
                let brdf = AnyBrdf::new(family, &at).unwrap();
                let rows = objective.residuals(&at);
                for (&i, (r, y)) in objective.readings().iter().zip(rows) {
                    let reading = &scan.readings()[i];
                    let ratio = brdf.value(&reading.geometry().unwrap()) / reading.brdf;
                    assert!(((r + y) / y - ratio).abs() < 1e-12 * ratio.abs());
                }
            }
        }
    }

    #[test]
    fn readings_without_any_weight_are_an_error() {
        let mut readings = distorted_scan();
        let g1 = "0=0".parse().unwrap();
        let zero_weight = of(
            readings.clone(),
            &Weights {
                g1,
                ..Weights::default()
            },
        );
        assert_eq!(zero_weight.unwrap_err(), ObjectiveError::AllZero);
        readings[3].sigma = None;
        let by_sigma = Weights {
            errors: AssumedErrors::Stated,
            ..Weights::default()
        };
        assert_eq!(
            of(readings, &by_sigma).unwrap_err(),
            ObjectiveError::NoSigma
        );
    }

    #[test]
    fn readings_beyond_any_brdf_are_an_error() {
        for size in [1e-200, 1e-40, 1e40, 1e200] {
            let mut readings = distorted_scan();
            for reading in &mut readings {
                reading.brdf *= size;
            }
            let error = of(readings, &Weights::default()).unwrap_err();
            assert!(
                error.to_string().contains("expected one between"),
                "{error}"
            );
        }
    }

    proptest! {
        #[test]
        fn derivatives_agree_with_finite_differences(
            k2 in 0.01..2.0, kd in 0.01..1.0, log_k1 in -4.0..1.5_f64, n in 1.1..5.0, p in 0.3..5.0,
        ) {
            let scan = Measurements::new("test", distorted_scan()).unwrap();
            let at = [k2, kd, log_k1.exp(), n, p];
            let parameters = |x: [f64; 5]| ModelParameters { k2: x[0], kd: x[1], k1: x[2], n: x[3], p: x[4] };
            for family in Family::ALL {
                let objective = Objective::new(&scan, family, N, &Weights::default()).unwrap();
                let equations = objective.normal_equations(&parameters(at), &Parameter::ALL);
                prop_assert!((equations.error / objective.error(&parameters(at)) - 1.0).abs() < 1e-12);

                // Columns of the Jacobian by differences, and with them J^T r and J^T J.
                let residuals = |at| objective.residuals(&parameters(at)).iter().map(|(r, _)| *r).collect::<Vec<_>>();
                let columns: Vec<Vec<f64>> = (0..5).map(|j| {
                    let step = 1e-5 * at[j];
                    let moved = |sign: f64| { let mut moved = at; moved[j] += sign * step; residuals(moved) };
                    moved(1.0).iter().zip(moved(-1.0)).map(|(up, down)| (up - down) / (2.0 * step)).collect()
                }).collect();
                let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                let size = columns.iter().map(|c| dot(c, c)).fold(0.0, f64::max).sqrt();
                let r = residuals(at);
                for i in 0..5 {
                    let gradient = dot(&columns[i], &r);
                    let scale = size * dot(&r, &r).sqrt();
                    prop_assert!((equations.gradient[i] - gradient).abs() < 1e-6 * scale, "{family:?}");
                    for j in 0..5 {
                        let product = dot(&columns[i], &columns[j]);
                        let error = (equations.matrix[(i, j)] - product).abs();
                        prop_assert!(error < 1e-6 * size * size, "{family:?}");
                    }
                }
                let jacobian = objective.jacobian(&parameters(at), &Parameter::ALL);
                let difference = jacobian.transpose() * &jacobian - equations.matrix;
                prop_assert!(difference.norm() < 1e-12 * equations.matrix.norm());
            }
        }
    }
}
