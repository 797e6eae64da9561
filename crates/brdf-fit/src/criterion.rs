//! The error criterion E of eq. (5), with its derivatives by the parameters.

use std::ops::RangeInclusive;

use brdf_core::brdf::mirror_factor;
use brdf_core::fresnel::Dielectric;
use brdf_core::{GeometryError, Parameters};
use nalgebra::{Matrix3, Vector3};

use crate::measurement::Measurement;
use crate::weights::Weights;

/// Sizes of the largest weighted reading for which all squares and their products stay well within
/// the range of numbers; far beyond any BRDF.
const SIZES: RangeInclusive<f64> = 1e-30..=1e30;

/// E as a function of the parameters, for one set of readings:
///
/// ```text
/// E = sum g (f_meas - f_model)^2 cos^2 theta / sum g (f_meas cos theta)^2
///   = sum (y - kD a - k2 s k1^2/(t + k1^2))^2
/// ```
///
/// What does not depend on the parameters is computed once for each reading: with
/// w = sqrt(g) cos theta / sqrt(sum g (f_meas cos theta)^2), y = w `f_meas`, a = w/pi,
/// s = a sec alpha R0(gamma) G/(cos psi cos theta) and t = tan^2 alpha. Vectors and matrices are
/// in the order (k2, kD, k1). (Eq. 5 of Li, Yan and Wu 2002.)
#[derive(Debug, Clone)]
pub struct Criterion {
    measured: Vec<f64>,
    diffuse: Vec<f64>,
    specular: Vec<f64>,
    tan2_alpha: Vec<f64>,
    /// The sums that do not depend on k1.
    diffuse_squared: f64,
    diffuse_measured: f64,
}

/// E and what a step of Gauss and Newton needs: half the gradient of E, J^T r, and half its
/// approximate Hessian, J^T J.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalEquations<const P: usize> {
    /// E.
    pub error: f64,
    /// J^T r, half the gradient of E.
    pub gradient: nalgebra::SVector<f64, P>,
    /// J^T J.
    pub matrix: nalgebra::SMatrix<f64, P, P>,
}

/// The scalar products that the exact solution for k2 and kD needs at one k1, with
/// u = s k1^2/(t + k1^2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ProfileSums {
    pub(crate) uu: f64,
    pub(crate) ua: f64,
    pub(crate) uy: f64,
    pub(crate) aa: f64,
    pub(crate) ay: f64,
}

/// Why E is not defined for a set of readings.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum CriterionError {
    /// Weights by sigma, and a reading without one.
    #[error(
        "weights by 1/sigma^2 need the standard deviation of every reading (column sigma_per_sr)"
    )]
    NoSigma,
    /// Angles outside the model's domain, which no [validated](Measurement::validated) reading has.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The squares of the readings, or of what they are divided by, leave the range of numbers.
    #[error("the largest weighted reading is {0:e} 1/sr: expected one between 1e-30 and 1e30 1/sr")]
    Size(f64),
    /// The denominator of E is zero.
    #[error("all readings are zero, or weigh nothing: E of eq. (5) is not defined")]
    AllZero,
}

impl Criterion {
    /// The criterion over the readings at the refractive index n.
    ///
    /// n is in the model's domain. Errors: a weight that cannot be had, readings whose E is not
    /// defined, and angles outside the domain.
    pub fn new(
        readings: &[Measurement],
        n: f64,
        weights: &Weights,
    ) -> Result<Self, CriterionError> {
        let fresnel = Dielectric::new(n);
        let mut criterion = Self::with_capacity(readings.len());
        for reading in readings {
            let weight = weights.of(reading).ok_or(CriterionError::NoSigma)?;
            let geometry = reading.geometry()?;
            let w = weight.sqrt() * geometry.cos_theta();
            let a = w / std::f64::consts::PI;
            criterion.measured.push(w * reading.brdf);
            criterion.diffuse.push(a);
            criterion
                .specular
                .push(a * geometry.sec_alpha() * mirror_factor(&fresnel, &geometry));
            criterion.tan2_alpha.push(geometry.tan2_alpha());
        }
        criterion.normalised()
    }

    /// The criterion over some of the readings: those whose index `keep` accepts.
    pub fn subset(&self, keep: impl Fn(usize) -> bool) -> Result<Self, CriterionError> {
        let mut criterion = Self::with_capacity(self.len());
        for i in (0..self.len()).filter(|&i| keep(i)) {
            criterion.measured.push(self.measured[i]);
            criterion.diffuse.push(self.diffuse[i]);
            criterion.specular.push(self.specular[i]);
            criterion.tan2_alpha.push(self.tan2_alpha[i]);
        }
        criterion.normalised()
    }

    /// How many readings have a weight of zero.
    pub fn weightless(&self) -> usize {
        self.diffuse.iter().filter(|&&a| a == 0.0).count()
    }

    /// How many readings there are.
    pub fn len(&self) -> usize {
        self.measured.len()
    }

    /// Whether there are no readings.
    pub fn is_empty(&self) -> bool {
        self.measured.is_empty()
    }

    /// E, as a fraction (times 100: the paper's percent).
    pub fn error(&self, parameters: &Parameters) -> f64 {
        let [k2, kd, k1] = [parameters.k2, parameters.kd, parameters.k1];
        let k1_squared = k1 * k1;
        self.sum::<4, 1>(|y, a, s, t| {
            let residual = y - kd * a - k2 * s * (k1_squared / (t + k1_squared));
            [residual * residual]
        })[0]
    }

    /// The terms under the sum of E before they are squared: model - measured and measured, for
    /// each reading.
    pub fn residuals(&self, parameters: &Parameters) -> impl Iterator<Item = (f64, f64)> {
        let [k2, kd, k1] = [parameters.k2, parameters.kd, parameters.k1];
        let k1_squared = k1 * k1;
        (0..self.len()).map(move |i| {
            let (y, a) = (self.measured[i], self.diffuse[i]);
            let u = self.specular[i] * (k1_squared / (self.tan2_alpha[i] + k1_squared));
            (k2 * u + kd * a - y, y)
        })
    }

    /// E with J^T r and J^T J for the residuals r = model - measured.
    pub fn normal_equations(&self, parameters: &Parameters) -> NormalEquations<3> {
        let [k2, kd, k1] = [parameters.k2, parameters.kd, parameters.k1];
        let k1_squared = k1 * k1;
        let [rr, ur, ar, vr, uu, ua, uv, av, vv] = self.sum::<2, 9>(|y, a, s, t| {
            let reciprocal = 1.0 / (t + k1_squared);
            let u = s * (k1_squared * reciprocal);
            // d(u)/d(k1) = 2 u t / (k1 (t + k1^2)); the factor 2 k2/k1 is put on afterwards.
            let v = u * (t * reciprocal);
            let r = k2 * u + kd * a - y;
            [
                r * r,
                u * r,
                a * r,
                v * r,
                u * u,
                u * a,
                u * v,
                a * v,
                v * v,
            ]
        });
        let f = 2.0 * k2 / k1;
        NormalEquations {
            error: rr,
            gradient: Vector3::new(ur, ar, f * vr),
            matrix: Matrix3::new(
                uu,
                ua,
                f * uv,
                ua,
                self.diffuse_squared,
                f * av,
                f * uv,
                f * av,
                f * f * vv,
            ),
        }
    }

    pub(crate) fn profile_sums(&self, k1: f64) -> ProfileSums {
        let k1_squared = k1 * k1;
        let [uu, ua, uy] = self.sum::<4, 3>(|y, a, s, t| {
            let u = s * (k1_squared / (t + k1_squared));
            [u * u, u * a, u * y]
        });
        ProfileSums {
            uu,
            ua,
            uy,
            aa: self.diffuse_squared,
            ay: self.diffuse_measured,
        }
    }

    /// kD of the best Lambertian description, negative readings included.
    pub(crate) fn lambertian_weight(&self) -> f64 {
        self.diffuse_measured / self.diffuse_squared
    }

    /// Sums over all readings of what `term(y, a, s, t)` gives for each.
    ///
    /// Several running sums side by side, so that they do not wait for each other; they come out
    /// the same on every processor. `LANES` times `N` numbers should fit into the registers.
    fn sum<const LANES: usize, const N: usize>(
        &self,
        term: impl Fn(f64, f64, f64, f64) -> [f64; N],
    ) -> [f64; N] {
        let mut sums = [[0.0; LANES]; N];
        let columns = [
            &self.measured,
            &self.diffuse,
            &self.specular,
            &self.tan2_alpha,
        ];
        let [y, a, s, t] = columns.map(|column| column.as_chunks::<LANES>());
        for (((y, a), s), t) in y.0.iter().zip(a.0).zip(s.0).zip(t.0) {
            let terms: [_; LANES] =
                std::array::from_fn(|lane| term(y[lane], a[lane], s[lane], t[lane]));
            for (i, sum) in sums.iter_mut().enumerate() {
                for (sum, terms) in sum.iter_mut().zip(&terms) {
                    *sum += terms[i];
                }
            }
        }
        for (lane, (((y, a), s), t)) in y.1.iter().zip(a.1).zip(s.1).zip(t.1).enumerate() {
            for (sum, term) in sums.iter_mut().zip(term(*y, *a, *s, *t)) {
                sum[lane] += term;
            }
        }
        sums.map(|lanes| lanes.iter().sum())
    }

    fn with_capacity(readings: usize) -> Self {
        let column = || Vec::with_capacity(readings);
        Self {
            measured: column(),
            diffuse: column(),
            specular: column(),
            tan2_alpha: column(),
            diffuse_squared: 0.0,
            diffuse_measured: 0.0,
        }
    }

    /// Divides by the denominator of E, and sums what does not depend on the parameters.
    fn normalised(mut self) -> Result<Self, CriterionError> {
        let largest = self
            .measured
            .iter()
            .fold(0.0_f64, |max, y| max.max(y.abs()));
        let weighed = [&self.measured, &self.diffuse, &self.specular];
        let finite = weighed.into_iter().flatten().all(|value| value.is_finite());
        if finite && largest == 0.0 {
            return Err(CriterionError::AllZero);
        }
        if !finite || !SIZES.contains(&largest) {
            return Err(CriterionError::Size(largest));
        }
        let norm = largest * self.sum::<4, 1>(|y, _, _, _| [(y / largest).powi(2)])[0].sqrt();
        for column in [&mut self.measured, &mut self.diffuse, &mut self.specular] {
            for value in column {
                *value /= norm;
            }
        }
        [self.diffuse_squared, self.diffuse_measured] =
            self.sum::<4, 2>(|y, a, _, _| [a * a, a * y]);
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::ThreeParameterBrdf;
    use proptest::prelude::*;

    use super::*;
    use crate::synthetic::scan;

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

    fn criterion(weights: &Weights) -> Criterion {
        Criterion::new(&distorted_scan(), N, weights).unwrap()
    }

    #[test]
    fn equals_eq_5_written_out() {
        let parameters = Parameters::new(0.2, 0.15, 0.3).unwrap();
        let brdf = ThreeParameterBrdf::new(parameters, N).unwrap();
        let weights = Weights {
            g1: "0=1,60=1,70=0.5".parse().unwrap(),
            by_sigma: true,
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
        let error = criterion(&weights).error(&parameters);
        assert!((error / (above / below) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn residuals_and_subsets_add_up() {
        let parameters = Parameters::new(0.2, 0.15, 0.3).unwrap();
        let criterion = criterion(&Weights::default());
        let sum: f64 = criterion.residuals(&parameters).map(|(r, _)| r * r).sum();
        assert!((sum / criterion.error(&parameters) - 1.0).abs() < 1e-12);
        let some = criterion.subset(|i| i % 3 == 0).unwrap();
        let (mut above, mut below) = (0.0, 0.0);
        for (r, y) in criterion.residuals(&parameters).step_by(3) {
            above += r * r;
            below += y * y;
        }
        assert!((some.error(&parameters) / (above / below) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn readings_without_any_weight_are_an_error() {
        let mut readings = distorted_scan();
        let g1 = "0=0".parse().unwrap();
        let weightless = Criterion::new(
            &readings,
            N,
            &Weights {
                g1,
                ..Weights::default()
            },
        );
        assert_eq!(weightless.unwrap_err(), CriterionError::AllZero);
        readings[3].sigma = None;
        let by_sigma = Weights {
            by_sigma: true,
            ..Weights::default()
        };
        assert_eq!(
            Criterion::new(&readings, N, &by_sigma).unwrap_err(),
            CriterionError::NoSigma
        );
    }

    #[test]
    fn readings_beyond_any_brdf_are_an_error() {
        for size in [1e-200, 1e-40, 1e40, 1e200] {
            let mut readings = distorted_scan();
            for reading in &mut readings {
                reading.brdf *= size;
            }
            let error = Criterion::new(&readings, N, &Weights::default()).unwrap_err();
            assert!(
                error.to_string().contains("expected one between"),
                "{error}"
            );
        }
    }

    proptest! {
        #[test]
        fn derivatives_agree_with_finite_differences(
            k2 in 0.01..2.0, kd in 0.01..1.0, log_k1 in -4.0..1.5_f64,
        ) {
            let criterion = criterion(&Weights::default());
            let at = [k2, kd, log_k1.exp()];
            let parameters = |[k2, kd, k1]: [f64; 3]| Parameters { k2, kd, k1 };
            let equations = criterion.normal_equations(&parameters(at));
            prop_assert!((equations.error / criterion.error(&parameters(at)) - 1.0).abs() < 1e-12);

            // Columns of the Jacobian by differences, and with them J^T r and J^T J.
            let residuals = |at| criterion.residuals(&parameters(at)).map(|(r, _)| r).collect::<Vec<_>>();
            let columns: Vec<Vec<f64>> = (0..3).map(|j| {
                let step = 1e-6 * at[j];
                let moved = |sign: f64| { let mut moved = at; moved[j] += sign * step; residuals(moved) };
                moved(1.0).iter().zip(moved(-1.0)).map(|(up, down)| (up - down) / (2.0 * step)).collect()
            }).collect();
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let length = |j: usize| dot(&columns[j], &columns[j]).sqrt();
            let r = residuals(at);
            for i in 0..3 {
                let gradient = dot(&columns[i], &r);
                let scale = length(i) * dot(&r, &r).sqrt();
                prop_assert!((equations.gradient[i] - gradient).abs() < 1e-7 * scale);
                for j in 0..3 {
                    let product = dot(&columns[i], &columns[j]);
                    let error = (equations.matrix[(i, j)] - product).abs();
                    prop_assert!(error < 1e-7 * length(i) * length(j));
                }
            }
        }
    }
}
