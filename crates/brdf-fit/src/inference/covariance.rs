//! The covariance of the fitted parameters by the linear theory of least squares.

use brdf_core::ModelParameters;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use crate::model::{Parameter, ReducedModel};
use crate::objective::Objective;

/// J^T J, its columns scaled to length 1, counts as singular when its smallest eigenvalue is below
/// this.
const SMALLEST_EIGENVALUE: f64 = 1e-12;

/// The source of the errors of the readings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Noise {
    /// The residuals: all terms under the sum of E have the same variance, E over the degrees of
    /// freedom.
    Residuals,
    /// The standard deviations that the scan states.
    Given {
        /// Reduced chi square: the sum of (residual / sigma)^2 over the degrees of freedom. Far
        /// above 1, the model deviates from the readings by more than their errors, and the
        /// intervals are too short.
        reduced_chi_square: f64,
    },
}

/// The linear theory around a minimum of E: the model is replaced by its tangent.
///
/// With the Jacobian J of the residuals r and N - K degrees of freedom (N readings of non-zero
/// weight, K covered parameters) the covariance is
///
/// ```text
/// C = s^2 (J^T J)^-1,  s^2 = c |r|^2 / (N - K)        errors from the residuals
/// C = (J^T J)^-1 J^T V J (J^T J)^-1                   standard deviations stated by the scan
/// ```
///
/// V is the diagonal matrix of the stated variances of the terms under the sum of E; c corrects for
/// the weights of a robust loss and is 1 without one. Both assume independent errors; the first
/// also that the terms have equal variances, and that the model is right. (Seber and Wild,
/// "Nonlinear Regression", Wiley 1989, section 2.1; the second is the "sandwich" of White,
/// Econometrica 48, 817, 1980, with known variances.)
pub(super) struct LinearTheory<'a> {
    /// The parameters of the covariance: free, not on a bound, and with an effect on the model.
    pub(super) covered: Vec<Parameter>,
    /// N - K, at least 1.
    pub(super) degrees_of_freedom: usize,
    /// E at the minimum, |r|^2.
    pub(super) error: f64,
    /// s^2, the variance of each term under the sum of E by the residuals.
    pub(super) variance: f64,
    /// The standard deviation of each term, where the scan states them and they are used.
    pub(super) given: Option<&'a [f64]>,
    /// (J^T J)^-1; `None` where J^T J is singular.
    pub(super) inverse: Option<DMatrix<f64>>,
    /// C; `None` where J^T J is singular.
    pub(super) covariance: Option<DMatrix<f64>>,
    objective: &'a Objective,
    at: ModelParameters,
}

impl<'a> LinearTheory<'a> {
    /// The linear theory around the minimum `at` of a model's objective. The standard deviations of
    /// the readings are used where `given_sigma` is set and every reading has one;
    /// `variance_factor` is c.
    pub(super) fn new(
        objective: &'a Objective,
        model: ReducedModel,
        at: &ModelParameters,
        given_sigma: bool,
        variance_factor: f64,
    ) -> Self {
        let readings = objective.count() - objective.zero_weight();
        let covered: Vec<Parameter> = model
            .free()
            .iter()
            .copied()
            .filter(|&parameter| !is_on_bound(parameter, at) && has_effect(parameter, at))
            .collect();
        let degrees_of_freedom = readings.saturating_sub(covered.len()).max(1);
        let error = objective.error(at);
        let jacobian = objective.jacobian(at, &covered);
        let inverse = inverse(&(jacobian.transpose() * &jacobian));
        let given = objective.noise().filter(|_| given_sigma);
        let variance = variance_factor * error / degrees_of_freedom as f64;
        let covariance = inverse.as_ref().map(|inverse| match given {
            Some(noise) => sandwich(&jacobian, inverse, noise),
            None => inverse * variance,
        });
        Self {
            covered,
            degrees_of_freedom,
            error,
            variance,
            given,
            inverse,
            covariance,
            objective,
            at: *at,
        }
    }

    /// The source of the errors.
    pub(super) fn noise(&self) -> Noise {
        self.given.map_or(Noise::Residuals, |noise| Noise::Given {
            reduced_chi_square: self.reduced_chi_square(noise),
        })
    }

    fn reduced_chi_square(&self, noise: &[f64]) -> f64 {
        let residuals = self.objective.residuals(&self.at);
        let squares = residuals
            .iter()
            .zip(noise)
            .filter(|(_, noise)| **noise > 0.0);
        let sum: f64 = squares.map(|((r, _), noise)| (r / noise).powi(2)).sum();
        sum / self.degrees_of_freedom as f64
    }

    /// The row of a parameter in the covariance.
    fn index(&self, parameter: Parameter) -> Option<usize> {
        self.covered.iter().position(|&p| p == parameter)
    }

    /// The standard error of a parameter, the square root of its variance in C; `None` where the
    /// covariance does not cover it.
    pub(super) fn standard_error(&self, parameter: Parameter) -> Option<f64> {
        let place = self.index(parameter).zip(self.covariance.as_ref());
        place.map(|(i, covariance)| covariance[(i, i)].sqrt())
    }

    /// By how much E, minimised over the other parameters, grows in the linear theory when a
    /// parameter moves by one standard error: `C_ii` / ((J^T J)^-1)_ii, which is s^2 for errors from
    /// the residuals. `None` where the covariance does not cover the parameter.
    pub(super) fn growth(&self, parameter: Parameter) -> Option<f64> {
        let i = self.index(parameter)?;
        let (covariance, inverse) = (self.covariance.as_ref()?, self.inverse.as_ref()?);
        Some(covariance[(i, i)] / inverse[(i, i)])
    }

    /// [`growth`](Self::growth) of a parameter on its bound, as if the covariance covered it.
    pub(super) fn growth_on_bound(&self, parameter: Parameter) -> f64 {
        let Some(noise) = self.given else {
            return self.variance;
        };
        let with: Vec<Parameter> = std::iter::once(parameter)
            .chain(self.covered.iter().copied())
            .collect();
        let jacobian = self.objective.jacobian(&self.at, &with);
        let Some(inverse) = inverse(&(jacobian.transpose() * &jacobian)) else {
            return self.variance;
        };
        sandwich(&jacobian, &inverse, noise)[(0, 0)] / inverse[(0, 0)]
    }

    /// Shifts of the covered parameters that minimise E in the linear theory when one of them moves
    /// by `step`: the column of (J^T J)^-1 over its diagonal element, times the step. Empty where
    /// the covariance does not cover the parameter.
    pub(super) fn shifts(&self, parameter: Parameter, step: f64) -> Vec<(Parameter, f64)> {
        let (Some(i), Some(inverse)) = (self.index(parameter), self.inverse.as_ref()) else {
            return Vec::new();
        };
        let shifts: DVector<f64> = inverse.column(i) * (step / inverse[(i, i)]);
        let covered = self.covered.iter().copied();
        covered.zip(shifts.iter().copied()).collect()
    }

    /// C row by row; empty where J^T J is singular.
    pub(super) fn rows(&self) -> Vec<Vec<f64>> {
        let Some(matrix) = &self.covariance else {
            return Vec::new();
        };
        let row = |i: usize| matrix.row(i).iter().copied().collect();
        (0..matrix.nrows()).map(row).collect()
    }
}

/// Whether a parameter is on a bound of its range.
pub(super) fn is_on_bound(parameter: Parameter, at: &ModelParameters) -> bool {
    let (lowest, highest) = parameter.range();
    let value = parameter.of(at);
    value <= lowest || value >= highest
}

/// Whether the model depends on a parameter: without a specular lobe neither width nor index nor
/// exponent has an effect.
pub(super) fn has_effect(parameter: Parameter, at: &ModelParameters) -> bool {
    at.k2 > 0.0 || matches!(parameter, Parameter::K2 | Parameter::Kd)
}

/// The inverse of J^T J; `None` where it is singular.
///
/// The columns of J are scaled to length 1 first, so that the units of the parameters do not affect
/// the condition of the matrix.
fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let scale: Vec<f64> = matrix.diagonal().iter().map(|d| d.sqrt()).collect();
    // Without any parameter there is no covariance.
    if scale.is_empty() || scale.iter().any(|s| !(*s > 0.0 && s.is_finite())) {
        return None;
    }
    let scaled = |m: &DMatrix<f64>| {
        DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| {
            m[(i, j)] / (scale[i] * scale[j])
        })
    };
    let correlation = scaled(matrix);
    if correlation.symmetric_eigenvalues().min() < SMALLEST_EIGENVALUE {
        return None;
    }
    Some(scaled(&correlation.cholesky()?.inverse()))
}

/// (J^T J)^-1 J^T V J (J^T J)^-1, the square roots of the diagonal of V given as `noise`.
fn sandwich(jacobian: &DMatrix<f64>, inverse: &DMatrix<f64>, noise: &[f64]) -> DMatrix<f64> {
    let noisy = DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |i, j| {
        jacobian[(i, j)] * noise[i]
    });
    inverse * (noisy.transpose() * &noisy) * inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_of_a_badly_scaled_matrix_is_exact_and_of_a_singular_one_is_none() {
        let matrix = DMatrix::from_row_slice(2, 2, &[4e12, 1e6, 1e6, 1.0]);
        let product = inverse(&matrix).unwrap() * &matrix;
        assert!((product - DMatrix::identity(2, 2)).norm() < 1e-8);
        let singular = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 4.0]);
        assert_eq!(inverse(&singular), None);
        assert_eq!(inverse(&DMatrix::zeros(0, 0)), None);
    }

    /// With equal standard deviations of 1 the sandwich is (J^T J)^-1.
    #[test]
    fn the_sandwich_of_equal_variances_is_the_inverse() {
        let jacobian = DMatrix::from_row_slice(3, 2, &[1.0, 0.5, -1.0, 2.0, 0.3, 1.0]);
        let inverse = inverse(&(jacobian.transpose() * &jacobian)).unwrap();
        let difference = sandwich(&jacobian, &inverse, &[1.0; 3]) - &inverse;
        assert!(difference.norm() < 1e-14);
    }
}
