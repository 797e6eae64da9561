//! How far fitted parameters can be trusted: covariance, profile-likelihood intervals, and the band
//! of the theory curve.

use std::fmt;

use brdf_core::{AnyBrdf, Geometry, ModelParameters};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::fit::grid_search::best_weights;
use crate::fit::{Fit, Solution};
use crate::model::{K1_RANGE, Parameter, ReducedModel};
use crate::objective::{Objective, ROUNDING};
use crate::progress::{Cancelled, Progress};
use crate::solver::{Method, minimise, unless_cancelled};

/// The end of an interval is known to this fraction of its quantile.
const END_TOLERANCE: f64 = 1e-3;

/// Refits on the way to one end of an interval, at the most.
const MOST_REFITS: u32 = 30;

/// Iterations of one refit: it starts where the linear theory expects it to end.
const REFIT_ITERATIONS: u64 = 200;

/// A weight so many times as large as the fitted one is as good as any.
const ENDLESS: f64 = 1e3;

/// The two confidence levels: 1 sigma of a normal distribution, and 95 %.
const LEVELS: [f64; 2] = [0.682_689_492, 0.95];

/// Where the size of the errors is taken from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Noise {
    /// From the residuals: each term under the sum of E has the same variance, E over the degrees
    /// of freedom.
    Residuals,
    /// From the standard deviations that the scan states.
    Given {
        /// The sum of (residual / sigma)^2 over the degrees of freedom: far above 1, the model
        /// misses the readings by more than their errors, and the intervals are too short.
        reduced_chi_square: f64,
    },
}

/// A confidence interval; an end that is `None` is beyond every value that the fit looks at.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Lower end.
    pub from: Option<f64>,
    /// Upper end.
    pub to: Option<f64>,
}

impl Interval {
    /// Whether a value lies within.
    pub fn contains(&self, value: f64) -> bool {
        self.from.is_none_or(|from| from <= value) && self.to.is_none_or(|to| value <= to)
    }
}

/// What the data say of one free parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The parameter.
    pub parameter: Parameter,
    /// Its fitted value.
    pub value: f64,
    /// How well it is known.
    #[serde(flatten)]
    pub knowledge: Knowledge,
}

/// How well a parameter is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "knowledge", rename_all = "kebab-case")]
pub enum Knowledge {
    /// The data determine it.
    Determined {
        /// Standard error by the linear theory.
        standard_error: f64,
        /// Profile-likelihood interval of 68 %.
        interval_68: Interval,
        /// Profile-likelihood interval of 95 %.
        interval_95: Interval,
    },
    /// The condition rho(psi) <= 1 holds the fit away from the minimum of E, so that its growth
    /// there says nothing of errors.
    HeldByEnergy,
    /// It stands on a bound, and is left out of the covariance.
    OnBound {
        /// Profile-likelihood interval of 95 %, one end of which is the bound.
        interval_95: Interval,
    },
    /// The data do not determine it: its value means nothing.
    NotDetermined {
        /// Why.
        reason: String,
        /// Profile-likelihood interval of 95 %.
        interval_95: Interval,
    },
}

impl Estimate {
    /// The interval of 95 %; open where there is none.
    pub fn interval_95(&self) -> Interval {
        match self.knowledge {
            Knowledge::HeldByEnergy => Interval {
                from: None,
                to: None,
            },
            Knowledge::Determined { interval_95, .. }
            | Knowledge::OnBound { interval_95 }
            | Knowledge::NotDetermined { interval_95, .. } => interval_95,
        }
    }

    /// The standard error; `None` where there is none.
    pub fn standard_error(&self) -> Option<f64> {
        match self.knowledge {
            Knowledge::Determined { standard_error, .. } => Some(standard_error),
            _ => None,
        }
    }

    /// Whether the data determine it.
    pub fn is_determined(&self) -> bool {
        !matches!(self.knowledge, Knowledge::NotDetermined { .. })
    }
}

/// `0.191 (0.180 ... 0.203)`: no more digits than the standard error allows.
impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.value;
        match &self.knowledge {
            Knowledge::Determined {
                standard_error,
                interval_95,
                ..
            } => {
                let digits = |x: f64| rounded(x, *standard_error);
                let end = |x: Option<f64>| x.map_or_else(|| "?".to_owned(), digits);
                let (from, to) = (end(interval_95.from), end(interval_95.to));
                f.pad(&format!("{} ({from} ... {to})", digits(value)))
            }
            Knowledge::OnBound { interval_95 } => {
                let end = |x: f64| rounded(x, 0.3 * (x - value).abs());
                match (interval_95.from, interval_95.to) {
                    (_, Some(to)) if to > value => f.pad(&format!("{value} (< {})", end(to))),
                    (Some(from), _) if from < value => f.pad(&format!("{value} (> {})", end(from))),
                    _ => f.pad(&value.to_string()),
                }
            }
            Knowledge::HeldByEnergy => f.pad(&format!("{value:.4} (held by rho <= 1)")),
            Knowledge::NotDetermined { .. } => f.pad("not determined"),
        }
    }
}

/// A number with two digits of its error, and with 8 decimals at the most.
pub fn rounded(value: f64, error: f64) -> String {
    if !(error > 0.0 && error.is_finite() && value.is_finite()) {
        return format!("{value}");
    }
    #[expect(clippy::cast_possible_truncation, reason = "an exponent of ten")]
    let decimals = (1.0 - error.log10().floor()) as i64;
    let decimals = usize::try_from(decimals).unwrap_or(0);
    if decimals <= 8 || value.abs() >= 1e-4 {
        format!("{value:.*}", decimals.min(8))
    } else {
        format!("{value:.3e}")
    }
}

/// The uncertainty of all free parameters of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Uncertainty {
    /// Where the size of the errors is taken from.
    pub noise: Noise,
    /// Readings that have a say, less the free parameters.
    pub degrees_of_freedom: usize,
    /// Each free parameter, in their order.
    pub estimates: Vec<Estimate>,
    /// The parameters of the covariance: free, and not on a bound.
    pub covered: Vec<Parameter>,
    /// Their covariance, row by row; empty where the data cannot tell them apart.
    pub covariance: Vec<Vec<f64>>,
}

impl Uncertainty {
    /// The uncertainty of a fit; each iteration of a refit is told.
    pub(crate) fn of_fit(fitted: &Solution, progress: &Progress<'_>) -> Result<Self, Cancelled> {
        let fit = &fitted.fit;
        if fit.energy.is_some_and(|energy| energy.binding) {
            return Ok(Self::held_by_energy(fit));
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

    fn held_by_energy(fit: &Fit) -> Self {
        let at = fit.at();
        let estimate = |&parameter: &Parameter| Estimate {
            parameter,
            value: parameter.of(&at),
            knowledge: Knowledge::HeldByEnergy,
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
    /// The covariance is that of the linear theory. With `given_sigma` and a standard deviation of
    /// every reading it is (J^T J)^-1 J^T V J (J^T J)^-1, V being the variances of the terms under
    /// the sum of E as the scan states them; else V is E over the degrees of freedom for each. The
    /// intervals are those of the profile of E: all other parameters are fitted anew for each value
    /// of one, and its interval ends where E has grown by the square of the quantile times the
    /// growth that the linear theory has for one standard error. (Quantiles of Student's t, or of
    /// the normal distribution for given standard deviations.)
    /// `variance_factor` corrects E over the degrees of freedom for the weights of a robust loss; it
    /// is 1 without one.
    pub(crate) fn of(
        objective: &Objective,
        model: ReducedModel,
        at: &ModelParameters,
        given_sigma: bool,
        variance_factor: f64,
        progress: &Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let readings = objective.count() - objective.zero_weight();
        let on_bound = |parameter: &Parameter| is_on_bound(*parameter, at);
        let covered: Vec<Parameter> = model
            .free()
            .iter()
            .copied()
            .filter(|parameter| !on_bound(parameter) && has_effect(*parameter, at))
            .collect();
        let degrees_of_freedom = readings.saturating_sub(covered.len()).max(1);
        let error = objective.error(at);
        let jacobian = objective.jacobian(at, &covered);
        let inverse = inverse(&(jacobian.transpose() * &jacobian));
        let given = objective.noise().filter(|_| given_sigma);
        let variance = variance_factor * error / degrees_of_freedom as f64;
        let noise = given.map_or(Noise::Residuals, |noise| Noise::Given {
            reduced_chi_square: reduced_chi_square(objective, at, noise, degrees_of_freedom),
        });
        let covariance = inverse.as_ref().map(|inverse| match given {
            Some(noise) => sandwich(&jacobian, inverse, noise),
            None => inverse * variance,
        });
        let quantiles = quantiles(given.is_none().then_some(degrees_of_freedom));
        let profiler = Profiler {
            objective,
            model,
            at,
            error,
            covered: &covered,
            covariance: covariance.as_ref(),
            inverse: inverse.as_ref(),
            variance,
            given,
            quantiles,
            progress,
        };
        let estimates = model.free().iter().map(|&p| profiler.estimate(p));
        let mut estimates = estimates.collect::<Result<Vec<Estimate>, _>>()?;
        profiler.open_with_the_width(&mut estimates);
        Ok(Self {
            noise,
            degrees_of_freedom,
            estimates,
            covered,
            covariance: covariance.map_or_else(Vec::new, |covariance| rows(&covariance)),
        })
    }

    /// The estimate of a parameter, where it is free.
    pub fn estimate(&self, parameter: Parameter) -> Option<&Estimate> {
        let mut all = self.estimates.iter();
        all.find(|estimate| estimate.parameter == parameter)
    }

    /// Correlation coefficients of the covered parameters, row by row.
    pub fn correlations(&self) -> Vec<Vec<f64>> {
        let c = &self.covariance;
        let one = |i: usize, j: usize| c[i][j] / (c[i][i] * c[j][j]).sqrt();
        (0..c.len())
            .map(|i| (0..c.len()).map(|j| one(i, j)).collect())
            .collect()
    }

    /// The standard error of f_r at a geometry, in 1/sr: the half width of the 1-sigma band.
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

fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let row = |i: usize| matrix.row(i).iter().copied().collect();
    (0..matrix.nrows()).map(row).collect()
}

fn is_on_bound(parameter: Parameter, at: &ModelParameters) -> bool {
    let (lowest, highest) = parameter.range();
    let value = parameter.of(at);
    value <= lowest || value >= highest
}

/// Whether nature ends a parameter where its range begins, and not the search alone.
fn has_natural_bound(parameter: Parameter) -> bool {
    matches!(parameter, Parameter::K2 | Parameter::Kd | Parameter::N)
}

/// An absent lobe has neither width nor index nor exponent.
fn has_effect(parameter: Parameter, at: &ModelParameters) -> bool {
    at.k2 > 0.0 || matches!(parameter, Parameter::K2 | Parameter::Kd)
}

/// The inverse of J^T J, its columns scaled to one first; `None` where the parameters cannot be
/// told apart.
fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let scale: Vec<f64> = matrix.diagonal().iter().map(|d| d.sqrt()).collect();
    // No parameter at all has no covariance either.
    if scale.is_empty() || scale.iter().any(|s| !(*s > 0.0 && s.is_finite())) {
        return None;
    }
    let scaled = |m: &DMatrix<f64>| {
        DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| {
            m[(i, j)] / (scale[i] * scale[j])
        })
    };
    let correlation = scaled(matrix);
    let condition = correlation.symmetric_eigenvalues().min();
    if condition < 1e-12 {
        return None;
    }
    Some(scaled(&correlation.cholesky()?.inverse()))
}

/// (J^T J)^-1 J^T V J (J^T J)^-1 for variances V, given as standard deviations.
fn sandwich(jacobian: &DMatrix<f64>, inverse: &DMatrix<f64>, noise: &[f64]) -> DMatrix<f64> {
    let noisy = DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |i, j| {
        jacobian[(i, j)] * noise[i]
    });
    inverse * (noisy.transpose() * &noisy) * inverse
}

fn reduced_chi_square(
    objective: &Objective,
    at: &ModelParameters,
    noise: &[f64],
    degrees_of_freedom: usize,
) -> f64 {
    let residuals = objective.residuals(at);
    let squares = residuals
        .iter()
        .zip(noise)
        .filter(|(_, noise)| **noise > 0.0);
    let sum: f64 = squares.map(|((r, _), noise)| (r / noise).powi(2)).sum();
    sum / degrees_of_freedom as f64
}

/// Two-sided quantiles of the [`LEVELS`]: of Student's t, or of the normal distribution.
fn quantiles(degrees_of_freedom: Option<usize>) -> [f64; 2] {
    LEVELS.map(|level| {
        let tail = 0.5 * (1.0 + level);
        degrees_of_freedom
            .and_then(|degrees| StudentsT::new(0.0, 1.0, degrees as f64).ok())
            .map_or_else(
                || Normal::standard().inverse_cdf(tail),
                |t| t.inverse_cdf(tail),
            )
    })
}

/// Follows the profile of E along one parameter.
struct Profiler<'a> {
    objective: &'a Objective,
    model: ReducedModel,
    at: &'a ModelParameters,
    error: f64,
    covered: &'a [Parameter],
    covariance: Option<&'a DMatrix<f64>>,
    inverse: Option<&'a DMatrix<f64>>,
    /// Variance of each term under the sum of E.
    variance: f64,
    /// Its standard deviation for each, where the scan states them.
    given: Option<&'a [f64]>,
    quantiles: [f64; 2],
    progress: &'a Progress<'a>,
}

impl Profiler<'_> {
    fn estimate(&self, parameter: Parameter) -> Result<Estimate, Cancelled> {
        Ok(Estimate {
            parameter,
            value: parameter.of(self.at),
            knowledge: self.knowledge(parameter)?,
        })
    }

    fn knowledge(&self, parameter: Parameter) -> Result<Knowledge, Cancelled> {
        self.progress.advance()?;
        let open = Interval {
            from: None,
            to: None,
        };
        let not_determined = |reason: &str, interval_95| Knowledge::NotDetermined {
            reason: reason.to_owned(),
            interval_95,
        };
        if !has_effect(parameter, self.at) {
            let reason = "k2 is 0, and an absent lobe has no such property";
            return Ok(not_determined(reason, open));
        }
        let value = parameter.of(self.at);
        if is_on_bound(parameter, self.at) {
            let growth = self.growth_on_bound(parameter);
            let end = |sign: f64| self.end(parameter, sign, growth, self.quantiles[1]);
            let (from, to) = if value > parameter.range().0 {
                (end(-1.0)?, None)
            } else if has_natural_bound(parameter) {
                (Some(value), end(1.0)?)
            } else {
                (None, end(1.0)?)
            };
            let interval_95 = Interval { from, to };
            return Ok(match self.open_end(parameter, interval_95) {
                Some(reason) => not_determined(reason, interval_95),
                None => Knowledge::OnBound { interval_95 },
            });
        }
        let place = self.covered.iter().position(|&p| p == parameter);
        let (Some(i), Some(covariance), Some(inverse)) = (place, self.covariance, self.inverse)
        else {
            let reason = "the readings do not tell the parameters apart";
            return Ok(not_determined(reason, open));
        };
        let standard_error = covariance[(i, i)].sqrt();
        // The growth of E for one standard error, also where the variances are given.
        let growth = covariance[(i, i)] / inverse[(i, i)];
        let [narrow, wide] = self.quantiles;
        let interval_68 = self.interval(parameter, standard_error, growth, narrow)?;
        let interval_95 = self.interval(parameter, standard_error, growth, wide)?;
        Ok(match self.open_end(parameter, interval_95) {
            Some(reason) => not_determined(reason, interval_95),
            None => Knowledge::Determined {
                standard_error,
                interval_68,
                interval_95,
            },
        })
    }

    /// The growth of E for one standard error of a parameter on its bound, as if it were covered.
    fn growth_on_bound(&self, parameter: Parameter) -> f64 {
        let Some(noise) = self.given else {
            return self.variance;
        };
        let with: Vec<Parameter> = std::iter::once(parameter)
            .chain(self.covered.iter().copied())
            .collect();
        let jacobian = self.objective.jacobian(self.at, &with);
        let Some(inverse) = inverse(&(jacobian.transpose() * &jacobian)) else {
            return self.variance;
        };
        sandwich(&jacobian, &inverse, noise)[(0, 0)] / inverse[(0, 0)]
    }

    fn interval(
        &self,
        parameter: Parameter,
        standard_error: f64,
        growth: f64,
        quantile: f64,
    ) -> Result<Interval, Cancelled> {
        if self.error < ROUNDING {
            let value = parameter.of(self.at);
            let reach = quantile * standard_error;
            return Ok(Interval {
                from: Some(value - reach),
                to: Some(value + reach),
            });
        }
        Ok(Interval {
            from: self.end(parameter, -1.0, growth, quantile)?,
            to: self.end(parameter, 1.0, growth, quantile)?,
        })
    }

    /// The end of the interval on one side, by the secant method on the square root of the growth
    /// of E, which is nearly linear. `None` where E never grows so much; a weight or an index ends
    /// at its lower bound.
    fn end(
        &self,
        parameter: Parameter,
        sign: f64,
        growth: f64,
        quantile: f64,
    ) -> Result<Option<f64>, Cancelled> {
        let value = parameter.of(self.at);
        let (lowest, highest) = self.limits(parameter);
        let limit = if sign < 0.0 { lowest } else { highest };
        let scale = Scale::of(parameter);
        let (start, stop) = (scale.coordinate(value), scale.coordinate(limit));
        let linear = self.linear_step(parameter, &scale, value, quantile);
        let distance = |x: f64| -> Result<f64, Cancelled> {
            Ok(self.deviations(parameter, scale.value(x), growth)? - quantile)
        };
        let (mut inside, mut below) = (start, -quantile);
        let mut outside: Option<(f64, f64)> = None;
        let mut trial = start + sign * linear;
        for _ in 0..MOST_REFITS {
            trial = if sign < 0.0 {
                trial.max(stop)
            } else {
                trial.min(stop)
            };
            let found = distance(trial)?;
            if found.abs() <= END_TOLERANCE * quantile {
                return Ok(Some(scale.value(trial)));
            }
            if found < 0.0 {
                if trial == stop {
                    return Ok((sign < 0.0 && has_natural_bound(parameter)).then_some(limit));
                }
                (inside, below) = (trial, found);
            } else {
                outside = Some((trial, found));
            }
            trial = if let Some((x, above)) = outside {
                let secant = inside + (x - inside) * (-below / (above - below));
                // Not next to an end of the bracket, where the secant method creeps.
                let (near, far) = (inside + 0.1 * (x - inside), x - 0.1 * (x - inside));
                secant.clamp(near.min(far), near.max(far))
            } else {
                let reach = (inside - start).abs();
                let factor = (1.1 * quantile / (quantile + below).max(1e-9)).clamp(1.5, 4.0);
                start + sign * reach * factor
            };
        }
        let middle = outside.map_or(inside, |(x, _)| 0.5 * (inside + x));
        Ok(Some(scale.value(middle)))
    }

    /// The range that is looked at: the bounds of a fit; for a weight, what is as good as infinite.
    fn limits(&self, parameter: Parameter) -> (f64, f64) {
        let (lowest, highest) = parameter.range();
        if highest.is_finite() {
            return (lowest, highest);
        }
        let level = self.objective.lambertian_weight().abs();
        (
            lowest,
            ENDLESS * parameter.of(self.at).max(level).max(f64::MIN_POSITIVE),
        )
    }

    /// The first trial: as far as the linear theory puts the end.
    fn linear_step(&self, parameter: Parameter, scale: &Scale, value: f64, quantile: f64) -> f64 {
        let place = self.covered.iter().position(|&p| p == parameter);
        let standard_error = place
            .zip(self.covariance)
            .map(|(i, covariance)| covariance[(i, i)].sqrt())
            .filter(|error| error.is_finite() && *error > 0.0)
            .unwrap_or_else(|| {
                0.05 * value
                    .max(self.objective.lambertian_weight().abs())
                    .max(1e-3)
            });
        match scale {
            Scale::Linear => quantile * standard_error,
            Scale::Logarithmic => (quantile * standard_error / value).min(2.0),
        }
    }

    /// How many standard errors a value is away by the growth of E, the other parameters fitted
    /// anew: sqrt((E - E at the minimum) / growth for one standard error).
    fn deviations(&self, parameter: Parameter, value: f64, growth: f64) -> Result<f64, Cancelled> {
        let others: Vec<Parameter> = self
            .model
            .free()
            .iter()
            .copied()
            .filter(|&p| p != parameter)
            .collect();
        let mut start = self.expected(parameter, value);
        parameter.set(&mut start, value);
        let method = Method::LevenbergMarquardt;
        let (objective, progress) = (self.objective, self.progress);
        let refit = minimise(
            objective,
            method,
            start,
            &others,
            REFIT_ITERATIONS,
            progress,
        );
        let error = unless_cancelled(refit)?.map_or(f64::INFINITY, |minimum| minimum.error);
        Ok(((error - self.error).max(0.0) / growth).sqrt())
    }

    /// Where the linear theory expects the other parameters when one has the given value.
    fn expected(&self, parameter: Parameter, value: f64) -> ModelParameters {
        let mut expected = *self.at;
        let place = self.covered.iter().position(|&p| p == parameter);
        let (Some(i), Some(inverse)) = (place, self.inverse) else {
            return expected;
        };
        let step = value - parameter.of(self.at);
        let shifts: DVector<f64> = inverse.column(i) * (step / inverse[(i, i)]);
        for (&other, shift) in self.covered.iter().zip(shifts.iter()) {
            let (lowest, highest) = other.range();
            let moved = other.of(self.at) + shift;
            // A width or an exponent that the linear theory makes negative stays as it is.
            let lowest = match Scale::of(other) {
                Scale::Linear => lowest,
                Scale::Logarithmic => 0.3 * other.of(self.at),
            };
            other.set(&mut expected, moved.clamp(lowest, highest));
        }
        expected
    }

    /// Where the width is open, so is the specular weight that goes with it: on the flank of a
    /// narrow peak only k2 k1^2 is known.
    fn open_with_the_width(&self, estimates: &mut [Estimate]) {
        let width = estimates.iter().find(|e| e.parameter == Parameter::K1);
        let Some(open) = width
            .filter(|e| !e.is_determined())
            .map(Estimate::interval_95)
        else {
            return;
        };
        let Some(k1) = open.from.or(open.to) else {
            return;
        };
        let there = best_weights(
            self.objective,
            self.model,
            ModelParameters { k1, ..*self.at },
        );
        let ratio = there.parameters.k2 / self.at.k2;
        let weight = estimates.iter_mut().find(|e| e.parameter == Parameter::K2);
        if let Some(weight) = weight.filter(|_| !(0.5..=2.0).contains(&ratio)) {
            let limit = Some(there.parameters.k2);
            let (from, to) = if ratio < 1.0 {
                (limit, None)
            } else {
                (None, limit)
            };
            weight.knowledge = Knowledge::NotDetermined {
                reason: "it goes with k1, which is open".to_owned(),
                interval_95: Interval { from, to },
            };
        }
    }

    /// Why an interval leaves its parameter open.
    fn open_end(&self, parameter: Parameter, interval: Interval) -> Option<&'static str> {
        let k1 = self.at.k1;
        match (parameter, interval.from, interval.to) {
            (_, Some(_), Some(_)) if parameter != Parameter::K2 => None,
            (Parameter::K1, None, None) => Some("any width fits as well"),
            (Parameter::K1, None, _) => {
                Some("any narrower peak fits as well: it is narrower than the scan resolves")
            }
            (Parameter::K1, _, None) if k1 <= K1_RANGE.0 => {
                Some("any narrower peak fits as well: it is narrower than the scan resolves")
            }
            (Parameter::K1, _, None) => {
                Some("any wider distribution fits as well: there is no peak")
            }
            (Parameter::K2, Some(from), Some(_)) => {
                (from <= 0.0 && self.at.k2 > 0.0).then_some("no specular part at all fits as well")
            }
            (Parameter::K2 | Parameter::Kd, _, None) => {
                Some("any larger weight fits as well: the readings do not tell it from the others")
            }
            (Parameter::N, _, _) => Some("any larger index fits as well"),
            (Parameter::P, None, None) => Some("any exponent fits as well"),
            (Parameter::P, None, _) => Some("any smaller exponent fits as well"),
            (Parameter::P, _, None) => Some("any larger exponent fits as well"),
            _ => None,
        }
    }
}

/// In which scale a parameter is followed.
enum Scale {
    Linear,
    Logarithmic,
}

impl Scale {
    fn of(parameter: Parameter) -> Self {
        match parameter {
            Parameter::K1 | Parameter::P => Self::Logarithmic,
            Parameter::K2 | Parameter::Kd | Parameter::N => Self::Linear,
        }
    }

    fn coordinate(&self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic => value.ln(),
        }
    }

    fn value(&self, coordinate: f64) -> f64 {
        match self {
            Self::Linear => coordinate,
            Self::Logarithmic => coordinate.exp(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::report::{Depth, Report};
    use crate::scan::synthetic::scan;
    use crate::{FitOptions, Measurements, RefractiveIndex};
    use brdf_core::Parameters;

    fn uncertainty(k2: f64, kd: f64, k1: f64, model: Model) -> (Uncertainty, Measurements) {
        let truth = Parameters::new(k2, kd, k1).unwrap();
        let mut readings = scan(truth, 1.5).readings().to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= 1.0 + 0.03 * (2.4 * i as f64).sin();
        }
        let scan = Measurements::new("test", readings).unwrap();
        let (report, _) = Report::new(&scan, &options(model), Depth::Fit);
        (report.uncertainty.unwrap(), scan)
    }

    fn options(model: Model) -> FitOptions {
        FitOptions {
            model,
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            ..FitOptions::default()
        }
    }

    #[test]
    fn numbers_have_two_digits_of_their_error() {
        assert_eq!(rounded(0.022_859_766, 0.000_5), "0.02286");
        assert_eq!(rounded(1870.3, 20.0), "1870");
        assert_eq!(rounded(0.156, 1e-17), "0.15600000");
        assert_eq!(rounded(1.5e-9, 1e-11), "1.500e-9");
    }

    /// The interval of k1 by its definition: E of the exact weights along a dense line of widths.
    #[test]
    fn the_interval_of_the_width_is_where_the_profile_has_risen() {
        let (uncertainty, scan) = uncertainty(0.3, 0.1, 0.2, Model::Three);
        let objective = Objective::new(
            &scan,
            Model::Three.family(),
            1.5,
            &crate::objective::weights::Weights::default(),
        )
        .unwrap();
        let estimate = uncertainty.estimate(Parameter::K1).unwrap();
        let at = |k1: f64| ModelParameters {
            k2: 0.0,
            kd: 0.0,
            k1,
            n: 1.5,
            p: 1.0,
        };
        let error = |k1: f64| best_weights(&objective, Model::Three.into(), at(k1)).error;
        let lowest = error(estimate.value);
        let t = quantiles(Some(uncertainty.degrees_of_freedom))[1];
        let limit = lowest * (1.0 + t * t / uncertainty.degrees_of_freedom as f64);
        let Interval { from, to } = estimate.interval_95();
        for end in [from.unwrap(), to.unwrap()] {
            assert!(
                (error(end) / limit - 1.0).abs() < 1e-3,
                "{}",
                error(end) / limit
            );
        }
    }

    #[test]
    fn every_interval_of_every_model_holds_its_value_and_grows_with_the_level() {
        for model in Model::ALL {
            let (uncertainty, _) = uncertainty(0.3, 0.1, 0.2, model);
            for estimate in &uncertainty.estimates {
                if let Knowledge::Determined {
                    interval_68,
                    interval_95,
                    ..
                } = estimate.knowledge
                {
                    assert!(interval_68.contains(estimate.value), "{model} {estimate:?}");
                    let inner = [interval_68.from, interval_68.to].into_iter().flatten();
                    for end in inner {
                        assert!(interval_95.contains(end), "{model} {estimate:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_weight_on_its_bound_has_an_upper_end_and_no_covariance() {
        let (uncertainty, _) = uncertainty(0.3, 0.0, 0.2, Model::Three);
        let estimate = uncertainty.estimate(Parameter::Kd).unwrap();
        if let Knowledge::OnBound { interval_95 } = estimate.knowledge {
            assert_eq!(interval_95.from, Some(0.0));
            assert!(interval_95.to.unwrap() > 0.0);
            assert!(!uncertainty.covered.contains(&Parameter::Kd));
        } else {
            // The ripple may leave a little of kD: then zero is within its interval.
            assert!(estimate.interval_95().contains(0.0), "{estimate:?}");
        }
    }

    #[test]
    fn the_correlation_of_a_parameter_with_itself_is_one() {
        let (uncertainty, _) = uncertainty(0.3, 0.1, 0.2, Model::PowerN);
        let correlations = uncertainty.correlations();
        for (i, row) in correlations.iter().enumerate() {
            assert!((row[i] - 1.0).abs() < 1e-12);
            assert!(row.iter().all(|c| c.abs() <= 1.0 + 1e-9));
        }
    }
}
