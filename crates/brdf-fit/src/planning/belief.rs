//! What readings say of the parameters, with the prior: the most probable values of their logarithms and the
//! covariance about them.

use brdf_core::{AnyBrdf, Family, Geometry};
use nalgebra::Matrix4;

use super::prior::{Logs, Prior, clamped, parameters};

/// The largest number of steps from each start.
const MOST_STEPS: usize = 40;

/// The smallest value of f_r in 1/sr of which a logarithm is taken.
const SMALLEST: f64 = 1e-300;

/// ln f_r of a reading, at its geometry.
#[derive(Debug, Clone, Copy)]
pub(super) struct LogReading {
    pub(super) geometry: Geometry,
    pub(super) log: f64,
}

/// The model at some parameters.
pub(super) fn brdf(family: Family, logs: &Logs) -> AnyBrdf {
    let at = parameters(&clamped(logs));
    AnyBrdf::new(family, &at)
        .unwrap_or_else(|_| unreachable!("the ends of the search are in the domain"))
}

/// ln f_r of a model.
pub(super) fn log_value(brdf: &AnyBrdf, geometry: &Geometry) -> f64 {
    brdf.value(geometry).max(SMALLEST).ln()
}

/// The derivatives of ln f_r by ln k2, ln kD, ln k1 and ln(n - 1).
pub(super) fn log_slopes(brdf: &AnyBrdf, geometry: &Geometry) -> Logs {
    let at = brdf.model_parameters();
    let [k2, kd, k1, n, _] = brdf.gradient(geometry);
    Logs::new(at.k2 * k2, at.kd * kd, at.k1 * k1, (at.n - 1.0) * n)
        / brdf.value(geometry).max(SMALLEST)
}

/// The maximum of the posterior density and the normal distribution about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Belief {
    pub(super) mode: Logs,
    pub(super) covariance: Matrix4<f64>,
    /// The sum of squares that is minimised: of (measured less model)/`error`, and of the prior.
    misfit: f64,
}

impl Belief {
    /// Without a reading.
    pub(super) fn of_prior(prior: &Prior) -> Self {
        Self {
            mode: prior.mean,
            covariance: Matrix4::from_diagonal(&prior.deviation.map(|x| x * x)),
            misfit: 0.0,
        }
    }

    /// Minimises
    ///
    /// ```text
    /// sum_i (ln f_i - ln f_r(z))^2/error^2 + sum_k ((z_k - mean_k)/deviation_k)^2
    /// ```
    ///
    /// over the logarithms z by Levenberg-Marquardt, from `near` and from three starts of the prior.
    pub(super) fn new(
        readings: &[LogReading],
        family: Family,
        prior: &Prior,
        error: f64,
        near: &Logs,
    ) -> Self {
        let problem = Problem::new(readings, family, prior, error);
        let shifted = |shift: [f64; 4]| prior.mean + Logs::from(shift);
        let starts = [
            *near,
            prior.mean,
            shifted([1.0, -1.0, -1.0, 0.0]),
            shifted([-1.0, 1.0, 1.0, 0.0]),
        ];
        let ends = starts.map(|start| problem.descend(start));
        let best = ends
            .into_iter()
            .min_by(|a, b| a.misfit.total_cmp(&b.misfit));
        best.unwrap_or_else(|| Self::of_prior(prior))
    }

    /// [`new`](Self::new) from one start alone, for readings that are nearly those of its belief.
    pub(super) fn near(
        readings: &[LogReading],
        family: Family,
        prior: &Prior,
        error: f64,
        start: &Logs,
    ) -> Self {
        Problem::new(readings, family, prior, error).descend(*start)
    }

    /// Parameters that represent the distribution: its mode and both ends of a deviation along each axis of
    /// the covariance.
    pub(super) fn samples(&self) -> Vec<Logs> {
        let eigen = self.covariance.symmetric_eigen();
        let mut samples = vec![self.mode];
        for k in 0..4 {
            let reach = SPREAD * eigen.eigenvalues[k].max(0.0).sqrt();
            let axis = eigen.eigenvectors.column(k) * reach;
            samples.push(clamped(&(self.mode + axis)));
            samples.push(clamped(&(self.mode - axis)));
        }
        samples
    }
}

/// The samples are this many deviations from the mode.
const SPREAD: f64 = 1.0;

struct Problem<'a> {
    readings: &'a [LogReading],
    family: Family,
    prior: &'a Prior,
    precision: f64,
}

impl<'a> Problem<'a> {
    fn new(readings: &'a [LogReading], family: Family, prior: &'a Prior, error: f64) -> Self {
        Self {
            readings,
            family,
            prior,
            precision: error.powi(-2),
        }
    }

    fn misfit(&self, at: &Logs) -> f64 {
        let brdf = brdf(self.family, at);
        let of_reading =
            |reading: &LogReading| (reading.log - log_value(&brdf, &reading.geometry)).powi(2);
        let of_readings: f64 = self.readings.iter().map(of_reading).sum();
        let from_prior = (at - self.prior.mean).component_div(&self.prior.deviation);
        self.precision * of_readings + from_prior.norm_squared()
    }

    /// Half of the second derivatives (Gauss-Newton), and half of the descent direction.
    fn normal_equations(&self, at: &Logs) -> (Matrix4<f64>, Logs) {
        let brdf = brdf(self.family, at);
        let weights = self.prior.deviation.map(|x| x.powi(-2));
        let mut matrix = Matrix4::from_diagonal(&weights);
        let mut slope = weights.component_mul(&(self.prior.mean - at));
        for reading in self.readings {
            let slopes = log_slopes(&brdf, &reading.geometry);
            let residual = reading.log - log_value(&brdf, &reading.geometry);
            matrix += self.precision * slopes * slopes.transpose();
            slope += self.precision * residual * slopes;
        }
        (matrix, slope)
    }

    fn descend(&self, start: Logs) -> Belief {
        let mut at = clamped(&start);
        let mut misfit = self.misfit(&at);
        let mut damping = 1e-2;
        for _ in 0..MOST_STEPS {
            let (matrix, slope) = self.normal_equations(&at);
            let Some((next, below)) = self.step(&at, misfit, &matrix, &slope, &mut damping) else {
                break;
            };
            let gain = misfit - below;
            (at, misfit) = (next, below);
            if gain < 1e-7 * misfit {
                break;
            }
        }
        let (matrix, _) = self.normal_equations(&at);
        Belief {
            mode: at,
            covariance: matrix.try_inverse().unwrap_or_else(Matrix4::zeros),
            misfit,
        }
    }

    /// A step that lowers the misfit, with the misfit there.
    fn step(
        &self,
        at: &Logs,
        misfit: f64,
        matrix: &Matrix4<f64>,
        slope: &Logs,
        damping: &mut f64,
    ) -> Option<(Logs, f64)> {
        for _ in 0..8 {
            let mut damped = *matrix;
            for k in 0..4 {
                damped[(k, k)] *= 1.0 + *damping;
            }
            let next = clamped(&(at + damped.lu().solve(slope)?));
            let below = self.misfit(&next);
            if below < misfit {
                *damping *= 0.2;
                return Some((next, below));
            }
            *damping *= 5.0;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planning::prior::MaterialClass;

    fn readings(truth: &Logs) -> Vec<LogReading> {
        let brdf = brdf(Family::Paper, truth);
        let mut readings = Vec::new();
        for psi in [10.0, 40.0, 70.0_f64] {
            for theta in [-80.0, -60.0, -40.0, -20.0, 0.0, 30.0, 60.0_f64] {
                let geometry = Geometry::in_plane(psi.to_radians(), theta.to_radians()).unwrap();
                let log = log_value(&brdf, &geometry);
                readings.push(LogReading { geometry, log });
            }
        }
        readings
    }

    #[test]
    fn many_exact_readings_outweigh_the_prior() {
        let prior = Prior::of(MaterialClass::Unknown);
        let truth = Logs::new(0.3_f64.ln(), 0.02_f64.ln(), 0.12_f64.ln(), 0.8_f64.ln());
        let belief = Belief::new(&readings(&truth), Family::Paper, &prior, 1e-3, &prior.mean);
        assert!((belief.mode - truth).norm() < 1e-3, "{}", belief.mode);
        let deviations = belief.covariance.diagonal().map(f64::sqrt);
        assert!(deviations.iter().all(|d| *d < 0.02), "{deviations}");
    }

    #[test]
    fn without_readings_the_belief_is_the_prior() {
        let prior = Prior::of(MaterialClass::Paint);
        let far = prior.mean + Logs::new(1.0, -1.0, 0.5, 0.2);
        let belief = Belief::new(&[], Family::Paper, &prior, 0.1, &far);
        assert!((belief.mode - prior.mean).norm() < 1e-6);
        let expected = Belief::of_prior(&prior);
        assert!((belief.covariance - expected.covariance).norm() < 1e-9);
    }

    #[test]
    fn the_slopes_are_those_of_the_logarithm() {
        let at = Logs::new(0.3_f64.ln(), 0.02_f64.ln(), 0.12_f64.ln(), 0.8_f64.ln());
        let geometry = Geometry::new(0.7, 0.5, 2.0).unwrap();
        let slopes = log_slopes(&brdf(Family::Smith, &at), &geometry);
        for k in 0..4 {
            let mut step = Logs::zeros();
            step[k] = 1e-5;
            let value = |at: Logs| log_value(&brdf(Family::Smith, &at), &geometry);
            let difference = (value(at + step) - value(at - step)) / 2e-5;
            assert!((slopes[k] - difference).abs() < 1e-7, "{k}");
        }
    }
}
