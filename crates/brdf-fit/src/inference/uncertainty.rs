//! The uncertainty of a fit: an interval for each free parameter, their covariance, and the standard
//! error of the BRDF that follows from it.
//!
//! The fit minimises E whatever the errors are. Around its minimum a parameter x responds to the
//! errors of the readings by its influence a_i, a row of (sum w J J^T)^-1 w J, and
//!
//! ```text
//! var x = sum (t1 + t2 mu_i + t3 mu_i^2) a_i^2 + t4 sum_b (sum_b mu_i a_i)^2 + t5 sum_g (sum_g mu_i a_i)^2
//! ```
//!
//! with the components of `variance_components` ("sandwich" estimate: White, Econometrica 48, 817,
//! 1980, with the errors' covariance estimated as a whole). The interval at the level L is that of
//! Student's t, with the degrees of freedom by which the three sums are known (Satterthwaite,
//! Biometrics Bulletin 2, 110, 1946). It is symmetric in kD and in the logarithms of k2, k1, n - 1 and
//! p. Of the two grids of patches the wider interval counts, for each parameter.
//!
//! The intervals assume that relative errors are alike at all incidences and independent between
//! them. An error that all incidences share, as of the calibration, is never visible.

use brdf_core::{AnyBrdf, Geometry, ModelParameters};
use serde::{Deserialize, Serialize};

use super::estimate::{Estimate, Interval, Knowledge};
use super::noise::{ErrorSizes, Noise, NoiseTests};
use super::spread::{GridSpread, UPPER_95, quantile};
use super::terms::{Grid, Readings, Source};
use super::undetermined::{Undetermined, has_effect, is_on_bound};
use crate::fit::{Fit, Solution};
use crate::model::{Parameter, ReducedModel};
use crate::objective::weights::AssumedErrors;
use crate::progress::{Cancelled, Progress};
use crate::scan::Measurements;

/// The probability below the upper end of an interval of 68 %: one standard deviation.
const UPPER_68: f64 = 0.841_344_746_068_543;

/// Above this relative error of the model, in proportion to the reading, no interval is given.
const LARGEST_MISFIT: f64 = 0.5;

/// Larger scans are represented by about this number of readings.
pub(crate) const MOST_READINGS: usize = 20_000;

const NOT_DISTINGUISHED: &str = "the readings do not distinguish the parameters";

const OF_TABLES: &str = "the intervals are tested on scans, whose readings err by themselves, not on the bins of a table";

/// The uncertainty of all free parameters of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Uncertainty {
    /// The source of the errors of the readings.
    pub noise: Noise,
    /// The sizes of the errors; `None` where no covariance is known.
    #[serde(default)]
    pub errors: Option<ErrorSizes>,
    /// Whether the residuals contradict independent errors of constant size; `None` where too few
    /// readings remain for a test.
    #[serde(default)]
    pub tests: Option<NoiseTests>,
    /// Readings of non-zero weight less the covered parameters, at least 1; less all free
    /// parameters where the condition rho(psi) <= 1 is active.
    pub degrees_of_freedom: usize,
    /// One estimate for each free parameter, in their order.
    pub estimates: Vec<Estimate>,
    /// The parameters of the covariance: free, not on a bound, and with an effect on the model.
    pub covered: Vec<Parameter>,
    /// The covariance of the covered parameters, row by row; empty where the readings do not
    /// distinguish them, where the model misses the readings by more than half, and where the
    /// condition rho(psi) <= 1 is active. Its diagonal holds the squares of the standard errors.
    pub covariance: Vec<Vec<f64>>,
}

/// Whether the tests of the noise are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tests {
    Made,
    Omitted,
}

impl Uncertainty {
    /// The uncertainty of a fit of these measurements.
    pub(crate) fn of_fit(
        measurements: &Measurements,
        fitted: &Solution,
        tests: Tests,
        progress: &Progress<'_>,
    ) -> Result<Self, Cancelled> {
        progress.advance()?;
        let fit = &fitted.fit;
        if fit.energy.is_some_and(|energy| energy.binding) {
            return Ok(Self::without_covariance(fit, |_| {
                Knowledge::ConstrainedByEnergy
            }));
        }
        let fitted_readings = fit.options.fitted_readings(measurements);
        let share = Share::of(&fitted_readings, fitted);
        // The rows of the objective of a fit name readings of the whole scan.
        let (scan, solution, part) = match &share {
            None => (measurements, fitted, 1.0),
            Some(share) => {
                let count = share.scan.readings().len() as f64;
                let part = count / fitted_readings.readings().len() as f64;
                (&share.scan, &share.solution, part)
            }
        };
        let inference = Inference {
            scan,
            fitted: solution,
            share: part,
            undetermined: Undetermined::new(fitted, progress)?,
            tests,
        };
        let uncertainty = inference.uncertainty();
        Ok(if measurements.is_table() {
            uncertainty.without_intervals(OF_TABLES)
        } else {
            uncertainty
        })
    }

    /// The same without intervals and covariance.
    fn without_intervals(mut self, reason: &str) -> Self {
        for estimate in &mut self.estimates {
            if let Knowledge::Determined { .. } = estimate.knowledge {
                estimate.knowledge = Knowledge::NoInterval {
                    reason: reason.to_owned(),
                };
            }
        }
        self.covariance = Vec::new();
        self
    }

    fn without_covariance(fit: &Fit, knowledge: impl Fn(Parameter) -> Knowledge) -> Self {
        let at = fit.at();
        let estimate = |&parameter: &Parameter| Estimate {
            parameter,
            value: parameter.of(&at),
            knowledge: knowledge(parameter),
        };
        Self {
            noise: Noise::Residuals,
            errors: None,
            tests: None,
            degrees_of_freedom: fit.degrees_of_freedom(),
            estimates: fit.options.free().iter().map(estimate).collect(),
            covered: Vec::new(),
            covariance: Vec::new(),
        }
    }

    /// The estimate of a parameter; `None` where it is not free.
    pub fn estimate(&self, parameter: Parameter) -> Option<&Estimate> {
        let mut all = self.estimates.iter();
        all.find(|estimate| estimate.parameter == parameter)
    }

    /// Correlation coefficients of the covered parameters, row by row: `C_ij / sqrt(C_ii C_jj)`.
    pub fn correlations(&self) -> Vec<Vec<f64>> {
        let c = &self.covariance;
        let one = |i: usize, j: usize| c[i][j] / c[i][i].sqrt() / c[j][j].sqrt();
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

/// Readings that represent a scan too large for the estimate, or one whose objective is condensed.
struct Share {
    scan: Measurements,
    solution: Solution,
}

impl Share {
    /// `None` where the objective has one row for each reading of a scan of moderate size, and where a
    /// robust loss has a weight for each reading.
    fn of(measurements: &Measurements, fitted: &Solution) -> Option<Self> {
        let condensed = fitted.objective.readings().is_empty();
        let large = measurements.readings().len() > MOST_READINGS && fitted.robust().is_none();
        if !condensed && !large {
            return None;
        }
        let scan = measurements.thinned(MOST_READINGS);
        let solution = fitted.over(&scan).ok()?;
        Some(Self { scan, solution })
    }
}

/// A fit and the readings that its uncertainty is inferred from.
struct Inference<'a> {
    scan: &'a Measurements,
    fitted: &'a Solution,
    /// The share of the readings of the fit that are used.
    share: f64,
    undetermined: Undetermined,
    tests: Tests,
}

/// Calls a function with an array of the parameters as an array of known length.
macro_rules! with_array {
    ($parameters:expr, $array:ident => $body:expr) => {
        match *$parameters {
            [a] => {
                let $array = [a];
                $body
            }
            [a, b] => {
                let $array = [a, b];
                $body
            }
            [a, b, c] => {
                let $array = [a, b, c];
                $body
            }
            [a, b, c, d] => {
                let $array = [a, b, c, d];
                $body
            }
            [a, b, c, d, e] => {
                let $array = [a, b, c, d, e];
                $body
            }
            _ => None,
        }
    };
}

impl Inference<'_> {
    fn model(&self) -> ReducedModel {
        self.fitted.fit.options.reduced_model()
    }

    fn uncertainty(&self) -> Uncertainty {
        let fit = &self.fitted.fit;
        let at = fit.at();
        let covered: Vec<Parameter> = self
            .model()
            .free()
            .iter()
            .copied()
            .filter(|&parameter| !is_on_bound(parameter, &at) && has_effect(parameter, &at))
            .collect();
        let spread = with_array!(covered.as_slice(), array => self.spread(&at, array));
        let mut uncertainty = Uncertainty::without_covariance(fit, |parameter| {
            self.knowledge(parameter, &at, &covered, spread.as_ref())
        });
        self.undetermined.release(&mut uncertainty.estimates);
        let readings = fit.readings - fit.zero_weight;
        uncertainty.degrees_of_freedom = readings.saturating_sub(covered.len()).max(1);
        if let Some(spread) = spread {
            uncertainty.noise = spread.noise;
            uncertainty.errors = Some(spread.errors);
            uncertainty.tests = spread.tests;
            if !spread.misses() {
                uncertainty.covariance = spread.covariance;
            }
        }
        uncertainty.covered = covered;
        uncertainty
    }

    fn knowledge(
        &self,
        parameter: Parameter,
        at: &ModelParameters,
        covered: &[Parameter],
        spread: Option<&Spread>,
    ) -> Knowledge {
        let value = parameter.of(at);
        if !has_effect(parameter, at) {
            return Knowledge::not_determined(
                "k2 is 0, and without a specular lobe it has no effect",
            );
        }
        if parameter == Parameter::K1 && is_on_bound(parameter, at) {
            return Knowledge::not_determined(Undetermined::width_at_limit(value));
        }
        let misses = spread.is_some_and(Spread::misses);
        if is_on_bound(parameter, at) {
            let upper =
                (parameter == Parameter::Kd && !misses).then(|| self.upper_limit(at, covered));
            return Knowledge::OnBound {
                interval_95: Interval {
                    from: upper.map(|_| 0.0),
                    to: upper.flatten().filter(|to| to.is_finite()),
                },
            };
        }
        let own = spread.zip(covered.iter().position(|&p| p == parameter));
        let Some((spread, i)) = own else {
            return Knowledge::not_determined(NOT_DISTINGUISHED);
        };
        if misses {
            return Knowledge::NoInterval {
                reason: "the model misses the readings by more than half: no interval is honest"
                    .to_owned(),
            };
        }
        let width = spread.widths[i];
        self.undetermined
            .reason(parameter, value, &width)
            .map_or_else(
                || width.around(parameter, value, &self.undetermined),
                Knowledge::not_determined,
            )
    }

    /// The upper limit of kD where the fit has it on its bound: the distance that an interval reaches
    /// above where one Gauss-Newton step would lead, and above zero at least.
    fn upper_limit(&self, at: &ModelParameters, covered: &[Parameter]) -> Option<f64> {
        let with: Vec<Parameter> = std::iter::once(Parameter::Kd)
            .chain(covered.iter().copied())
            .collect();
        let spread = with_array!(with.as_slice(), array => self.spread(at, array))?;
        Some(spread.first_step.max(0.0) + spread.widths[0].half_95)
    }

    /// The spread of parameters by the errors of the readings; `None` where the readings do not
    /// distinguish them.
    fn spread<const P: usize>(
        &self,
        at: &ModelParameters,
        parameters: [Parameter; P],
    ) -> Option<Spread> {
        let fit = &self.fitted.fit;
        let source = if fit.options.weights.errors == AssumedErrors::Stated {
            Source::Stated
        } else {
            Source::Residuals
        };
        let readings = Readings::new(self.scan, self.fitted, at, parameters, source)?;
        let by_grid = Grid::BOTH.map(|grid| GridSpread::new(&readings, grid, source, self.share));
        let widths: Vec<Width> = (0..P)
            .map(|i| {
                let [a, b] = &by_grid;
                let wider = if b.half_95[i] > a.half_95[i] { b } else { a };
                let bread = readings.bread[i][i];
                Width::new(wider, i, bread, self.constant_noise(bread, P))
            })
            .collect();
        // The covariance has the correlations of the grid that makes the intervals wider on the whole.
        let log_width =
            |spread: &GridSpread<P>| -> f64 { spread.half_95.iter().map(|half| half.ln()).sum() };
        let ruling = &by_grid[usize::from(log_width(&by_grid[1]) > log_width(&by_grid[0]))];
        let covariance = (0..P)
            .map(|i| {
                let entry = |j: usize| {
                    let own = ruling.covariance[i][j]
                        / (ruling.covariance[i][i] * ruling.covariance[j][j]).sqrt();
                    widths[i].standard_error
                        * widths[j].standard_error
                        * if i == j {
                            1.0
                        } else if own.is_finite() {
                            own
                        } else {
                            0.0
                        }
                };
                (0..P).map(entry).collect()
            })
            .collect();
        let errors = ErrorSizes::new(&ruling.components, source, readings.full_incidences);
        Some(Spread {
            noise: self.noise(source, at, P),
            errors,
            tests: (source == Source::Residuals && self.tests == Tests::Made)
                .then(|| NoiseTests::of(&readings))
                .flatten(),
            first_step: (0..P)
                .map(|j| readings.bread[0][j] * readings.score[j])
                .sum::<f64>(),
            widths,
            covariance,
        })
    }

    /// The source of the errors, with the reduced chi square of stated standard deviations.
    fn noise(&self, source: Source, at: &ModelParameters, parameters: usize) -> Noise {
        let objective = self.fitted.without_loss();
        let stated = objective.noise().filter(|_| source == Source::Stated);
        let Some(noise) = stated else {
            return Noise::Residuals;
        };
        let (mut sum, mut count) = (0.0, 0_usize);
        for ((r, _), noise) in objective.residuals(at).iter().zip(noise) {
            if *noise > 0.0 {
                sum += (r / noise).powi(2);
                count += 1;
            }
        }
        let free = count.saturating_sub(parameters).max(1);
        Noise::Given {
            reduced_chi_square: sum / free as f64,
        }
    }

    /// The half width of the interval of 95 % for independent errors of constant size under the sum of
    /// E.
    fn constant_noise(&self, bread: f64, parameters: usize) -> f64 {
        let fit = &self.fitted.fit;
        let free = (fit.readings - fit.zero_weight)
            .saturating_sub(parameters)
            .max(1) as f64;
        let factor = fit
            .robust
            .as_ref()
            .map_or(1.0, |robust| robust.variance_factor);
        let error = self.fitted.objective.error(&fit.at());
        let full = bread * self.fitted.robust().map_or(1.0, |robust| robust.mean_slope);
        quantile(UPPER_95, free) * (full * factor * error / free).sqrt()
    }
}

/// The spread of some parameters.
struct Spread {
    noise: Noise,
    errors: ErrorSizes,
    tests: Option<NoiseTests>,
    /// The step of the first parameter to the minimum of the linear theory.
    first_step: f64,
    widths: Vec<Width>,
    covariance: Vec<Vec<f64>>,
}

impl Spread {
    /// Whether the model misses the readings by more than half.
    fn misses(&self) -> bool {
        self.errors.relative() > LARGEST_MISFIT
    }
}

/// The spread of a parameter, in its own unit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Width {
    pub(super) standard_error: f64,
    degrees_of_freedom: f64,
    half_68: f64,
    pub(super) half_95: f64,
    half_constant_noise: f64,
    /// The square of `half_95`, as a growth of E in the linear theory.
    pub(super) growth_95: f64,
}

impl Width {
    fn new<const P: usize>(
        spread: &GridSpread<P>,
        i: usize,
        bread: f64,
        half_constant_noise: f64,
    ) -> Self {
        let (standard_error, half_95) = (spread.standard_error(i), spread.half_95[i]);
        Self {
            standard_error,
            degrees_of_freedom: spread.degrees[i],
            half_68: quantile(UPPER_68, spread.degrees[i]) * standard_error,
            half_95,
            half_constant_noise,
            growth_95: half_95 * half_95 / bread,
        }
    }

    fn around(&self, parameter: Parameter, value: f64, profile: &Undetermined) -> Knowledge {
        let interval_95 = interval(parameter, value, self.half_95);
        Knowledge::Determined {
            standard_error: self.standard_error,
            degrees_of_freedom: Some(self.degrees_of_freedom),
            interval_68: interval(parameter, value, self.half_68),
            interval_95: profile.widened(parameter, interval_95, self),
            interval_constant_noise: Some(interval(parameter, value, self.half_constant_noise)),
        }
    }
}

/// The interval of a parameter with a half width in its own unit: in the logarithm of k2, k1, n - 1
/// and p, and from zero on in kD.
fn interval(parameter: Parameter, value: f64, half: f64) -> Interval {
    let (from, to) = match parameter {
        Parameter::Kd => ((value - half).max(0.0), value + half),
        Parameter::N => {
            let factor = (half / (value - 1.0)).exp();
            (1.0 + (value - 1.0) / factor, 1.0 + (value - 1.0) * factor)
        }
        Parameter::K2 | Parameter::K1 | Parameter::P => {
            let factor = (half / value).exp();
            (value / factor, value * factor)
        }
    };
    Interval {
        from: Some(from),
        to: Some(to).filter(|to| to.is_finite()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::FitOptions;
    use crate::fit::fit_scan;
    use crate::inference::test_scans::{options, rippled};
    use crate::model::Model;
    use crate::progress::{NoObserver, Phase};

    /// The uncertainty of a model over a scan with 3 % of ripple.
    fn uncertainty(k2: f64, kd: f64, k1: f64, options: &FitOptions) -> Uncertainty {
        let scan = rippled([k2, kd, k1], 1.5, 0.03);
        let fitted = fit_scan(&scan, options, &NoObserver).unwrap();
        let progress = Progress::new(&NoObserver, Phase::Uncertainty);
        Uncertainty::of_fit(&scan, &fitted, Tests::Made, &progress).unwrap()
    }

    #[test]
    fn a_diffuse_weight_on_its_bound_has_an_upper_end_and_no_covariance() {
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
    fn the_covariance_has_the_squares_of_the_standard_errors() {
        let options = FitOptions {
            model: Model::PowerN,
            ..options()
        };
        let uncertainty = uncertainty(0.3, 0.1, 0.2, &options);
        let correlations = uncertainty.correlations();
        for (i, row) in correlations.iter().enumerate() {
            assert!((row[i] - 1.0).abs() < 1e-12);
            assert!(row.iter().all(|c| c.abs() <= 1.0 + 1e-9));
            let estimate = uncertainty.estimate(uncertainty.covered[i]).unwrap();
            if let Some(error) = estimate.standard_error() {
                let variance = uncertainty.covariance[i][i];
                assert!((variance.sqrt() / error - 1.0).abs() < 1e-12);
            }
        }
    }

    /// The incidences of a file come in any order, and a fit of some of them has their intervals.
    #[test]
    fn the_intervals_of_stage_1_alone_are_those_of_its_readings() {
        let scan = rippled([0.3, 0.1, 0.2], 1.5, 0.03);
        let mut readings = scan.readings().to_vec();
        readings.reverse();
        let scan = Measurements::new("test", readings).unwrap();
        let alone = FitOptions {
            stage2: None,
            ..options()
        };
        let intervals = |scan: &Measurements, options: &FitOptions| {
            let fitted = fit_scan(scan, options, &NoObserver).unwrap();
            let progress = Progress::new(&NoObserver, Phase::Uncertainty);
            let found = Uncertainty::of_fit(scan, &fitted, Tests::Omitted, &progress).unwrap();
            let ends = found.estimates.iter().map(|e| e.interval_95().to.unwrap());
            ends.collect::<Vec<f64>>()
        };
        let some = scan.up_to(alone.stage1_limit);
        assert!(some.readings().len() < scan.readings().len());
        let found = intervals(&scan, &alone);
        for (found, expected) in found.iter().zip(intervals(&some, &options())) {
            assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        }
    }

    #[test]
    fn intervals_on_a_logarithmic_scale_have_no_negative_end() {
        let wide = interval(Parameter::K1, 0.2, 0.3);
        assert!(wide.from.unwrap() > 0.0 && wide.to.unwrap() > 0.5);
        assert_eq!(interval(Parameter::Kd, 0.2, 0.3).from, Some(0.0));
        assert!(interval(Parameter::N, 1.2, 0.3).from.unwrap() > 1.0);
        let product = wide.from.unwrap() * wide.to.unwrap();
        assert!((product - 0.04).abs() < 1e-12);
    }

    #[test]
    fn quantiles_of_t_are_those_of_the_tables() {
        for (degrees, expected) in [(1.0, 12.706_205), (10.0, 2.228_139), (1e9, 1.959_964)] {
            let found = quantile(UPPER_95, degrees);
            assert!((found / expected - 1.0).abs() < 2e-5, "{degrees}: {found}");
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
