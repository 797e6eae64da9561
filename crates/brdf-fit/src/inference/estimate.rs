//! The estimate of a single parameter: its value, and how well the data determine it.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::format::{exact, fixed, rounded};
use crate::model::Parameter;

/// A confidence interval. An end is `None` where the interval is unbounded within the range that is
/// searched.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Lower end.
    pub from: Option<f64>,
    /// Upper end.
    pub to: Option<f64>,
}

impl Interval {
    /// The interval without ends.
    pub const UNBOUNDED: Self = Self {
        from: None,
        to: None,
    };

    /// Whether the interval contains a value; its ends belong to it.
    pub fn contains(&self, value: f64) -> bool {
        self.from.is_none_or(|from| from <= value) && self.to.is_none_or(|to| value <= to)
    }
}

/// The estimate of one free parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The parameter.
    pub parameter: Parameter,
    /// Its fitted value.
    pub value: f64,
    /// How well the data determine it.
    #[serde(flatten)]
    pub knowledge: Knowledge,
}

/// How well the data determine a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "knowledge", rename_all = "kebab-case")]
pub enum Knowledge {
    /// The data determine the parameter.
    Determined {
        /// Standard error: the square root of the parameter's variance in
        /// [`Uncertainty::covariance`](super::Uncertainty::covariance).
        standard_error: f64,
        /// The degrees of freedom of the standard error.
        #[serde(default)]
        degrees_of_freedom: Option<f64>,
        /// Interval at a confidence level of 68 %.
        interval_68: Interval,
        /// Interval at a confidence level of 95 %.
        interval_95: Interval,
        /// The interval of 95 % if the errors were independent and of constant size in f_r cos theta.
        /// With other errors it is far too short.
        #[serde(default)]
        interval_constant_noise: Option<Interval>,
    },
    /// The parameter has no interval that could be trusted.
    NoInterval {
        /// Why, as a clause.
        reason: String,
    },
    /// The condition rho(psi) <= 1 is active: the fit is not at the minimum of E, so that the
    /// growth of E around it is no measure of the uncertainty.
    #[serde(rename = "held-by-energy")]
    ConstrainedByEnergy,
    /// The parameter is on a bound of its range and is not part of the covariance.
    OnBound {
        /// Interval at a confidence level of 95 %, for a weight at zero; unbounded for others.
        interval_95: Interval,
    },
    /// The data do not determine the parameter: its value is arbitrary within the interval.
    NotDetermined {
        /// Why, as a clause.
        reason: String,
        /// The range of the parameter that the data leave; unbounded where it is not known.
        interval_95: Interval,
    },
}

impl Knowledge {
    /// That the data do not determine a parameter.
    pub(super) fn not_determined(reason: &str) -> Self {
        Self::NotDetermined {
            reason: reason.to_owned(),
            interval_95: Interval::UNBOUNDED,
        }
    }
}

impl Estimate {
    /// The interval at a confidence level of 95 %, unbounded where none is known.
    pub fn interval_95(&self) -> Interval {
        match self.knowledge {
            Knowledge::ConstrainedByEnergy | Knowledge::NoInterval { .. } => Interval::UNBOUNDED,
            Knowledge::Determined { interval_95, .. }
            | Knowledge::OnBound { interval_95 }
            | Knowledge::NotDetermined { interval_95, .. } => interval_95,
        }
    }

    /// The standard error of a determined parameter.
    pub fn standard_error(&self) -> Option<f64> {
        match self.knowledge {
            Knowledge::Determined { standard_error, .. } => Some(standard_error),
            _ => None,
        }
    }

    /// Whether the data determine the parameter, be it on a bound or under the condition
    /// rho(psi) <= 1.
    pub fn is_determined(&self) -> bool {
        !matches!(self.knowledge, Knowledge::NotDetermined { .. })
    }
}

/// `0.191 (0.180 ... 0.203)`: value and 95 % interval, with two digits of the standard error.
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
                    (_, Some(to)) if to > value => {
                        f.pad(&format!("{} (< {})", exact(value), end(to)))
                    }
                    (Some(from), _) if from < value => {
                        f.pad(&format!("{} (> {})", exact(value), end(from)))
                    }
                    _ => f.pad(&exact(value)),
                }
            }
            Knowledge::ConstrainedByEnergy => {
                f.pad(&format!("{} (constrained by rho <= 1)", fixed(value, 4)))
            }
            Knowledge::NoInterval { .. } => f.pad(&format!("{} (no interval)", fixed(value, 4))),
            Knowledge::NotDetermined { .. } => f.pad("not determined"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(value: f64, knowledge: Knowledge) -> Estimate {
        Estimate {
            parameter: Parameter::K1,
            value,
            knowledge,
        }
    }

    #[test]
    fn an_estimate_has_the_digits_of_its_standard_error() {
        let interval = |from, to| Interval {
            from: Some(from),
            to,
        };
        let determined = Knowledge::Determined {
            standard_error: 0.0123,
            degrees_of_freedom: Some(10.0),
            interval_68: interval(0.18, Some(0.2)),
            interval_95: interval(0.1652, None),
            interval_constant_noise: None,
        };
        assert_eq!(
            estimate(0.19076, determined).to_string(),
            "0.191 (0.165 ... ?)"
        );
        let on_bound = Knowledge::OnBound {
            interval_95: interval(0.0, Some(0.0456)),
        };
        assert_eq!(estimate(0.0, on_bound).to_string(), "0 (< 0.046)");
    }

    #[test]
    fn the_serialised_names_are_those_of_the_file_format() {
        let constrained = estimate(0.5, Knowledge::ConstrainedByEnergy);
        let json = serde_json::to_value(&constrained).unwrap();
        assert_eq!(json["knowledge"], "held-by-energy");
        assert_eq!(
            serde_json::from_value::<Estimate>(json).unwrap(),
            constrained
        );
    }
}
