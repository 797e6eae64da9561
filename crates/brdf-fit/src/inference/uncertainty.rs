//! The uncertainty of a fit: an estimate for each free parameter, their covariance, and the
//! standard error of the BRDF that follows from it.

use brdf_core::{AnyBrdf, Geometry, ModelParameters};
use serde::{Deserialize, Serialize};

use super::covariance::{LinearTheory, Noise};
use super::estimate::{Estimate, Knowledge};
use super::profile_likelihood::Profiler;
use crate::fit::{Fit, Solution};
use crate::model::{Parameter, ReducedModel};
use crate::objective::Objective;
use crate::progress::{Cancelled, Progress};

/// The uncertainty of all free parameters of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Uncertainty {
    /// The source of the errors of the readings.
    pub noise: Noise,
    /// Readings of non-zero weight less the covered parameters, at least 1; less all free
    /// parameters where the condition rho(psi) <= 1 is active.
    pub degrees_of_freedom: usize,
    /// One estimate for each free parameter, in their order.
    pub estimates: Vec<Estimate>,
    /// The parameters of the covariance: free, not on a bound, and with an effect on the model.
    pub covered: Vec<Parameter>,
    /// The covariance of the covered parameters, row by row; empty where the readings do not
    /// distinguish them, and where the condition rho(psi) <= 1 is active.
    ///
    /// It is that of the linear theory of least squares. With the Jacobian J of the residuals it is
    /// E/(N - K) (J^T J)^-1 for errors from the residuals, and
    /// (J^T J)^-1 J^T V J (J^T J)^-1 for stated variances V.
    pub covariance: Vec<Vec<f64>>,
}

impl Uncertainty {
    /// The uncertainty of a fit. Each parameter and each iteration of a refit is reported.
    pub(crate) fn of_fit(fitted: &Solution, progress: &Progress<'_>) -> Result<Self, Cancelled> {
        let fit = &fitted.fit;
        if fit.energy.is_some_and(|energy| energy.binding) {
            return Ok(Self::constrained_by_energy(fit));
        }
        let given_sigma = fit.options.weights.by_sigma;
        let factor = fit
            .robust
            .as_ref()
            .map_or(1.0, |robust| robust.variance_factor);
        Self::of(
            &fitted.objective,
            fit.options.reduced_model(),
            &fit.at(),
            given_sigma,
            factor,
            progress,
        )
    }

    fn constrained_by_energy(fit: &Fit) -> Self {
        let at = fit.at();
        let estimate = |&parameter: &Parameter| Estimate {
            parameter,
            value: parameter.of(&at),
            knowledge: Knowledge::ConstrainedByEnergy,
        };
        Self {
            noise: Noise::Residuals,
            degrees_of_freedom: fit.degrees_of_freedom(),
            estimates: fit.options.free().iter().map(estimate).collect(),
            covered: Vec::new(),
            covariance: Vec::new(),
        }
    }

    /// The uncertainty of the minimum `at` of a model's objective.
    ///
    /// The standard deviations of the readings are used where `given_sigma` is set and every
    /// reading has one. `variance_factor` multiplies E over the degrees of freedom; it corrects for
    /// the weights of a robust loss and is 1 without one.
    pub(crate) fn of(
        objective: &Objective,
        model: ReducedModel,
        at: &ModelParameters,
        given_sigma: bool,
        variance_factor: f64,
        progress: &Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let theory = LinearTheory::new(objective, model, at, given_sigma, variance_factor);
        let estimates = Profiler::new(objective, model, at, &theory, progress).estimates()?;
        Ok(Self {
            noise: theory.noise(),
            degrees_of_freedom: theory.degrees_of_freedom,
            estimates,
            covariance: theory.rows(),
            covered: theory.covered,
        })
    }

    /// The estimate of a parameter; `None` where it is not free.
    pub fn estimate(&self, parameter: Parameter) -> Option<&Estimate> {
        let mut all = self.estimates.iter();
        all.find(|estimate| estimate.parameter == parameter)
    }

    /// Correlation coefficients of the covered parameters, row by row: `C_ij / sqrt(C_ii C_jj)`.
    pub fn correlations(&self) -> Vec<Vec<f64>> {
        let c = &self.covariance;
        let one = |i: usize, j: usize| c[i][j] / (c[i][i] * c[j][j]).sqrt();
        (0..c.len())
            .map(|i| (0..c.len()).map(|j| one(i, j)).collect())
            .collect()
    }

    /// The standard error of f_r at a geometry, in 1/sr: the half width of the one-sigma band of a
    /// theory curve.
    ///
    /// It is sqrt(g^T C g), g being the gradient of f_r by the covered parameters and C their
    /// covariance (propagation of errors to first order).
    pub fn band(&self, brdf: &AnyBrdf, geometry: &Geometry) -> f64 {
        let gradient = brdf.gradient(geometry);
        let slopes: Vec<f64> = self.covered.iter().map(|&p| gradient[p as usize]).collect();
        let mut variance = 0.0;
        for (row, by) in self.covariance.iter().zip(&slopes) {
            variance += by * row.iter().zip(&slopes).map(|(c, s)| c * s).sum::<f64>();
        }
        variance.max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::FitOptions;
    use crate::fit::fit_scan;
    use crate::inference::Interval;
    use crate::inference::test_scans::{options, rippled};
    use crate::model::Model;
    use crate::progress::{NoObserver, Phase};

    /// The uncertainty of a model over a scan with 3 % of ripple.
    fn uncertainty(k2: f64, kd: f64, k1: f64, options: &FitOptions) -> Uncertainty {
        let scan = rippled([k2, kd, k1], 1.5, 0.03);
        let fitted = fit_scan(&scan, options, &NoObserver).unwrap();
        let progress = Progress::new(&NoObserver, Phase::Uncertainty);
        Uncertainty::of_fit(&fitted, &progress).unwrap()
    }

    #[test]
    fn a_weight_on_its_bound_has_an_upper_end_and_no_covariance() {
        let uncertainty = uncertainty(0.3, 0.0, 0.2, &options());
        let estimate = uncertainty.estimate(Parameter::Kd).unwrap();
        if let Knowledge::OnBound { interval_95 } = estimate.knowledge {
            assert_eq!(interval_95.from, Some(0.0));
            assert!(interval_95.to.unwrap() > 0.0);
            assert!(!uncertainty.covered.contains(&Parameter::Kd));
        } else {
            // The ripple may leave a small kD: then zero is within its interval.
            assert!(estimate.interval_95().contains(0.0), "{estimate:?}");
        }
    }

    #[test]
    fn the_correlation_of_a_parameter_with_itself_is_one() {
        let options = FitOptions {
            model: Model::PowerN,
            ..options()
        };
        let correlations = uncertainty(0.3, 0.1, 0.2, &options).correlations();
        for (i, row) in correlations.iter().enumerate() {
            assert!((row[i] - 1.0).abs() < 1e-12);
            assert!(row.iter().all(|c| c.abs() <= 1.0 + 1e-9));
        }
    }

    /// Sample 002 at 1.04 um of the paper's Table 1 reflects more than it receives.
    #[test]
    fn under_an_active_energy_condition_no_parameter_has_an_interval() {
        let options = FitOptions {
            energy_limit: Some(80_f64.to_radians()),
            ..options()
        };
        let uncertainty = uncertainty(0.156, 0.584, 1.338, &options);
        assert_eq!(uncertainty.estimates.len(), 3);
        for estimate in &uncertainty.estimates {
            assert_eq!(estimate.knowledge, Knowledge::ConstrainedByEnergy);
            assert_eq!(estimate.interval_95(), Interval::UNBOUNDED);
            assert!(estimate.to_string().ends_with("(constrained by rho <= 1)"));
        }
        assert!(uncertainty.covariance.is_empty());
    }
}
