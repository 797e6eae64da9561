//! Confidence intervals from the profile of E along one parameter.
//!
//! The profile likelihood of a parameter x is the minimum of E over all other free parameters,
//! E(x). With the growth g of E for one standard error in the linear theory, its signed root
//!
//! ```text
//! tau(x) = sign(x - x_fit) sqrt((E(x) - E_fit) / g)
//! ```
//!
//! is linear in x where the model is linear, and the interval at the confidence level L consists of
//! the values with |tau| <= q. The quantile q at (1 + L)/2 is that of Student's t with N - K degrees
//! of freedom for errors from the residuals (g = s^2), and that of the normal distribution for
//! stated standard deviations. Unlike the standard error, the interval follows the curvature of the
//! model; it assumes independent, normal errors. (Bates and Watts, "Nonlinear Regression Analysis
//! and Its Applications", Wiley 1988, section 6.1.2; Venzon and Moolgavkar, Applied Statistics 37,
//! 87, 1988.)

use brdf_core::ModelParameters;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use super::covariance::{LinearTheory, has_effect, is_on_bound};
use super::estimate::{Estimate, Interval, Knowledge};
use crate::fit::grid_search::best_weights;
use crate::model::{K1_RANGE, Parameter, ReducedModel};
use crate::objective::{Objective, ROUNDING};
use crate::progress::{Cancelled, Progress};
use crate::solver::{Method, minimise, unless_cancelled};

/// Tolerance of |tau| at the end of an interval, as a fraction of its quantile.
const END_TOLERANCE: f64 = 1e-3;

/// Largest number of refits for one end of an interval.
const MOST_REFITS: u32 = 30;

/// Largest number of iterations of one refit, which starts at the minimum of the linear theory.
const REFIT_ITERATIONS: u64 = 200;

/// A weight this many times as large as the fitted one counts as infinite.
const INFINITE_FACTOR: f64 = 1e3;

/// The two confidence levels: that of one standard deviation of a normal distribution, and 95 %.
const LEVELS: [f64; 2] = [0.682_689_492, 0.95];

/// Two-sided quantiles of the [`LEVELS`]: of Student's t with the given degrees of freedom, or of
/// the normal distribution without them.
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

/// Follows the profile of E along each parameter of a model.
pub(super) struct Profiler<'a> {
    objective: &'a Objective,
    model: ReducedModel,
    /// The minimum of E.
    at: &'a ModelParameters,
    theory: &'a LinearTheory<'a>,
    quantiles: [f64; 2],
    progress: &'a Progress<'a>,
}

impl<'a> Profiler<'a> {
    /// A profiler around the minimum `at`, with the linear theory there. Each parameter and each
    /// iteration of a refit is reported.
    pub(super) fn new(
        objective: &'a Objective,
        model: ReducedModel,
        at: &'a ModelParameters,
        theory: &'a LinearTheory<'a>,
        progress: &'a Progress<'a>,
    ) -> Self {
        let degrees_of_freedom = theory.given.is_none().then_some(theory.degrees_of_freedom);
        Self {
            objective,
            model,
            at,
            theory,
            quantiles: quantiles(degrees_of_freedom),
            progress,
        }
    }

    /// The estimates of all free parameters, in their order.
    pub(super) fn estimates(&self) -> Result<Vec<Estimate>, Cancelled> {
        let estimates = self.model.free().iter().map(|&p| self.estimate(p));
        let mut estimates = estimates.collect::<Result<Vec<Estimate>, _>>()?;
        self.release_k2_with_k1(&mut estimates);
        Ok(estimates)
    }

    fn estimate(&self, parameter: Parameter) -> Result<Estimate, Cancelled> {
        Ok(Estimate {
            parameter,
            value: parameter.of(self.at),
            knowledge: self.knowledge(parameter)?,
        })
    }

    fn knowledge(&self, parameter: Parameter) -> Result<Knowledge, Cancelled> {
        self.progress.advance()?;
        if !has_effect(parameter, self.at) {
            return Ok(Knowledge::NotDetermined {
                reason: "k2 is 0, and without a specular lobe it has no effect".to_owned(),
                interval_95: Interval::UNBOUNDED,
            });
        }
        if is_on_bound(parameter, self.at) {
            self.knowledge_on_bound(parameter)
        } else {
            self.knowledge_between_bounds(parameter)
        }
    }

    fn knowledge_on_bound(&self, parameter: Parameter) -> Result<Knowledge, Cancelled> {
        let value = parameter.of(self.at);
        let growth = self.theory.growth_on_bound(parameter);
        let end = |sign: f64| self.end(parameter, sign, growth, self.quantiles[1]);
        let (from, to) = if value > parameter.range().0 {
            (end(-1.0)?, None)
        } else if has_physical_lower_bound(parameter) {
            (Some(value), end(1.0)?)
        } else {
            (None, end(1.0)?)
        };
        let interval_95 = Interval { from, to };
        Ok(self
            .not_determined(parameter, interval_95)
            .unwrap_or(Knowledge::OnBound { interval_95 }))
    }

    fn knowledge_between_bounds(&self, parameter: Parameter) -> Result<Knowledge, Cancelled> {
        let theory = self.theory;
        let (Some(standard_error), Some(growth)) =
            (theory.standard_error(parameter), theory.growth(parameter))
        else {
            return Ok(Knowledge::NotDetermined {
                reason: "the readings do not distinguish the parameters".to_owned(),
                interval_95: Interval::UNBOUNDED,
            });
        };
        let [narrow, wide] = self.quantiles;
        let interval_68 = self.interval(parameter, standard_error, growth, narrow)?;
        let interval_95 = self.interval(parameter, standard_error, growth, wide)?;
        let not_determined = self.not_determined(parameter, interval_95);
        Ok(not_determined.unwrap_or(Knowledge::Determined {
            standard_error,
            interval_68,
            interval_95,
        }))
    }

    fn not_determined(&self, parameter: Parameter, interval_95: Interval) -> Option<Knowledge> {
        let reason = self.reason_undetermined(parameter, interval_95)?.to_owned();
        Some(Knowledge::NotDetermined {
            reason,
            interval_95,
        })
    }

    fn interval(
        &self,
        parameter: Parameter,
        standard_error: f64,
        growth: f64,
        quantile: f64,
    ) -> Result<Interval, Cancelled> {
        // E of rounding alone has no profile.
        if self.theory.error < ROUNDING {
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

    /// The end of an interval below (`sign` -1) or above (`sign` 1) the fitted value. `None` where
    /// |tau| stays below the quantile over the whole range, unless the parameter has a physical
    /// lower bound, which then is the end.
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
        let linear = self.linear_step(parameter, &scale, value, quantile);
        let (start, stop) = (scale.coordinate(value), scale.coordinate(limit));
        let mut bracket = Bracket::new(start, stop, sign, quantile);
        let mut trial = start + sign * linear;
        for _ in 0..MOST_REFITS {
            trial = bracket.within_range(trial);
            let excess = self.deviations(parameter, scale.value(trial), growth)? - quantile;
            if excess.abs() <= END_TOLERANCE * quantile {
                return Ok(Some(scale.value(trial)));
            }
            if excess < 0.0 && trial == stop {
                let ends_there = sign < 0.0 && has_physical_lower_bound(parameter);
                return Ok(ends_there.then_some(limit));
            }
            bracket.add(trial, excess);
            trial = bracket.next_trial();
        }
        Ok(Some(scale.value(bracket.middle())))
    }

    /// The range that is searched: that of a fit, or up to a value that counts as infinite.
    fn limits(&self, parameter: Parameter) -> (f64, f64) {
        let (lowest, highest) = parameter.range();
        if highest.is_finite() {
            return (lowest, highest);
        }
        let level = self.objective.lambertian_weight().abs();
        (
            lowest,
            INFINITE_FACTOR * parameter.of(self.at).max(level).max(f64::MIN_POSITIVE),
        )
    }

    /// The distance of the first trial, in the coordinate of the scale: where the linear theory has
    /// the end.
    fn linear_step(&self, parameter: Parameter, scale: &Scale, value: f64, quantile: f64) -> f64 {
        let standard_error = self
            .theory
            .standard_error(parameter)
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

    /// |tau| at a value of a parameter, the other free parameters being fitted again.
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
        let refit = minimise(
            self.objective,
            Method::LevenbergMarquardt,
            start,
            &others,
            REFIT_ITERATIONS,
            self.progress,
        );
        let error = unless_cancelled(refit)?.map_or(f64::INFINITY, |minimum| minimum.error);
        Ok(((error - self.theory.error).max(0.0) / growth).sqrt())
    }

    /// The parameters that the linear theory expects when one of them has the given value.
    fn expected(&self, parameter: Parameter, value: f64) -> ModelParameters {
        let mut expected = *self.at;
        let step = value - parameter.of(self.at);
        for (other, shift) in self.theory.shifts(parameter, step) {
            let (lowest, highest) = other.range();
            let moved = other.of(self.at) + shift;
            // The linear theory may make a width or an exponent negative.
            let lowest = match Scale::of(other) {
                Scale::Linear => lowest,
                Scale::Logarithmic => 0.3 * other.of(self.at),
            };
            other.set(&mut expected, moved.clamp(lowest, highest));
        }
        expected
    }

    /// Marks k2 as not determined where k1 is not and k2 depends on it: on the flank of a narrow
    /// peak the readings determine only k2 k1^2.
    fn release_k2_with_k1(&self, estimates: &mut [Estimate]) {
        let width = estimates.iter().find(|e| e.parameter == Parameter::K1);
        let Some(undetermined) = width
            .filter(|e| !e.is_determined())
            .map(Estimate::interval_95)
        else {
            return;
        };
        let Some(k1) = undetermined.from.or(undetermined.to) else {
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
                reason: "it depends on k1, which is not determined".to_owned(),
                interval_95: Interval { from, to },
            };
        }
    }

    /// Why an interval leaves its parameter undetermined; `None` where it does not.
    fn reason_undetermined(
        &self,
        parameter: Parameter,
        interval: Interval,
    ) -> Option<&'static str> {
        const NARROWER: &str =
            "any narrower peak fits equally well: the scan does not resolve its width";
        let k1 = self.at.k1;
        match (parameter, interval.from, interval.to) {
            (_, Some(_), Some(_)) if parameter != Parameter::K2 => None,
            (Parameter::K1, None, None) => Some("any width fits equally well"),
            (Parameter::K1, None, _) => Some(NARROWER),
            (Parameter::K1, _, None) if k1 <= K1_RANGE.0 => Some(NARROWER),
            (Parameter::K1, _, None) => {
                Some("any wider distribution fits equally well: the readings have no peak")
            }
            (Parameter::K2, Some(from), Some(_)) => (from <= 0.0 && self.at.k2 > 0.0)
                .then_some("the model without a specular part fits equally well"),
            (Parameter::K2 | Parameter::Kd, _, None) => Some(
                "any larger weight fits equally well: the readings do not separate it from the \
                 other parameters",
            ),
            (Parameter::N, _, _) => Some("any larger index fits equally well"),
            (Parameter::P, None, None) => Some("any exponent fits equally well"),
            (Parameter::P, None, _) => Some("any smaller exponent fits equally well"),
            (Parameter::P, _, None) => Some("any larger exponent fits equally well"),
            _ => None,
        }
    }
}

/// Whether the lower bound of a parameter is one of physics, and not one of the search alone.
fn has_physical_lower_bound(parameter: Parameter) -> bool {
    matches!(parameter, Parameter::K2 | Parameter::Kd | Parameter::N)
}

/// The search for |tau| = quantile on one side of the fitted value, by the secant method on |tau|,
/// which is nearly linear.
struct Bracket {
    /// The coordinate of the fitted value.
    start: f64,
    /// The coordinate of the end of the range.
    stop: f64,
    /// The direction from start to stop: -1 or 1.
    sign: f64,
    quantile: f64,
    /// The outermost trial with |tau| below the quantile, and |tau| - quantile there.
    inside: (f64, f64),
    /// The last trial with |tau| above the quantile, and |tau| - quantile there.
    outside: Option<(f64, f64)>,
}

impl Bracket {
    fn new(start: f64, stop: f64, sign: f64, quantile: f64) -> Self {
        Self {
            start,
            stop,
            sign,
            quantile,
            inside: (start, -quantile),
            outside: None,
        }
    }

    fn within_range(&self, trial: f64) -> f64 {
        if self.sign < 0.0 {
            trial.max(self.stop)
        } else {
            trial.min(self.stop)
        }
    }

    /// Takes a trial with its |tau| - quantile.
    fn add(&mut self, trial: f64, excess: f64) {
        if excess < 0.0 {
            self.inside = (trial, excess);
        } else {
            self.outside = Some((trial, excess));
        }
    }

    fn next_trial(&self) -> f64 {
        let (inside, below) = self.inside;
        if let Some((x, above)) = self.outside {
            let secant = inside + (x - inside) * (-below / (above - below));
            // Near an end of the bracket the secant method converges slowly.
            let (near, far) = (inside + 0.1 * (x - inside), x - 0.1 * (x - inside));
            secant.clamp(near.min(far), near.max(far))
        } else {
            let reach = (inside - self.start).abs();
            let tau = self.quantile + below;
            let factor = (1.1 * self.quantile / tau.max(1e-9)).clamp(1.5, 4.0);
            self.start + self.sign * reach * factor
        }
    }

    /// The best value where the number of refits does not suffice.
    fn middle(&self) -> f64 {
        let inside = self.inside.0;
        self.outside.map_or(inside, |(x, _)| 0.5 * (inside + x))
    }
}

/// The scale in which the profile along a parameter is followed.
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
    use crate::fit::FitOptions;
    use crate::fit::fit_scan;
    use crate::inference::test_scans::{options, rippled};
    use crate::model::Model;
    use crate::objective::weights::Weights;
    use crate::progress::{NoObserver, Phase};

    /// The estimates of a model over a scan with 3 % of ripple, and the degrees of freedom.
    fn estimates(k2: f64, kd: f64, k1: f64, model: Model) -> (Vec<Estimate>, usize) {
        let scan = rippled([k2, kd, k1], 1.5, 0.03);
        let options = FitOptions { model, ..options() };
        let fitted = fit_scan(&scan, &options, &NoObserver).unwrap();
        let (objective, model, at) = (&fitted.objective, options.reduced_model(), fitted.fit.at());
        let theory = LinearTheory::new(objective, model, &at, false, 1.0);
        let progress = Progress::new(&NoObserver, Phase::Uncertainty);
        let profiler = Profiler::new(objective, model, &at, &theory, &progress);
        (profiler.estimates().unwrap(), theory.degrees_of_freedom)
    }

    fn estimate_of(estimates: &[Estimate], parameter: Parameter) -> &Estimate {
        let mut all = estimates.iter();
        all.find(|estimate| estimate.parameter == parameter)
            .unwrap()
    }

    /// The interval of k1 by its definition: E of the exact weights along a dense line of widths.
    #[test]
    fn the_interval_of_the_width_ends_where_the_profile_has_risen() {
        let (estimates, degrees_of_freedom) = estimates(0.3, 0.1, 0.2, Model::Three);
        let scan = rippled([0.3, 0.1, 0.2], 1.5, 0.03);
        let family = Model::Three.family();
        let objective = Objective::new(&scan, family, 1.5, &Weights::default()).unwrap();
        let estimate = estimate_of(&estimates, Parameter::K1);
        let at = |k1: f64| ModelParameters {
            k2: 0.0,
            kd: 0.0,
            k1,
            n: 1.5,
            p: 1.0,
        };
        let error = |k1: f64| best_weights(&objective, Model::Three.into(), at(k1)).error;
        let lowest = error(estimate.value);
        let t = quantiles(Some(degrees_of_freedom))[1];
        let limit = lowest * (1.0 + t * t / degrees_of_freedom as f64);
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
    fn every_interval_of_every_model_contains_its_value_and_grows_with_the_level() {
        for model in Model::ALL {
            let (estimates, _) = estimates(0.3, 0.1, 0.2, model);
            for estimate in &estimates {
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
    fn quantiles_are_those_of_published_tables() {
        let [narrow, wide] = quantiles(None);
        assert!((narrow - 1.0).abs() < 1e-8 && (wide - 1.959_964).abs() < 1e-6);
        for (degrees_of_freedom, wide) in [(10, 2.228_139), (100, 1.983_972), (1000, 1.962_339)] {
            let found = quantiles(Some(degrees_of_freedom))[1];
            assert!((found - wide).abs() < 1e-5, "{degrees_of_freedom}: {found}");
        }
    }
}
