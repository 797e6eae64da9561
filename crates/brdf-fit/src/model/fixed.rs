//! Parameters that are fixed at a value instead of being fitted.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use brdf_core::{Family, ModelParameters};
use serde::{Deserialize, Serialize};

use super::{Model, Parameter};
use crate::format::{ParseError, shortest};

/// The parameters that are fixed, with their values. In JSON a map: `{"k1": 0.2}`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(into = "BTreeMap<Parameter, f64>", from = "BTreeMap<Parameter, f64>")]
pub struct FixedParameters {
    /// In the order of [`Parameter::ALL`].
    values: [Option<f64>; Parameter::ALL.len()],
}

/// Why a parameter cannot be fixed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FixedError {
    /// The model does not fit the parameter.
    #[error(
        "{parameter} cannot be fixed: model {model} fits {}",
        .model.free().iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
    )]
    NotFree {
        /// The parameter.
        parameter: Parameter,
        /// The model.
        model: Model,
    },
    /// The value is outside the range of the parameter.
    #[error("{parameter} = {value} cannot be fixed: expected {}", in_range(*.parameter))]
    OutOfRange {
        /// The parameter.
        parameter: Parameter,
        /// The value.
        value: f64,
    },
}

/// The range of a parameter in words.
fn in_range(parameter: Parameter) -> String {
    match parameter.range() {
        (lowest, f64::INFINITY) => format!("a number of at least {lowest}"),
        (lowest, highest) => format!(
            "a number from {} to {}",
            shortest(lowest),
            shortest(highest)
        ),
    }
}

impl FixedParameters {
    /// No parameter is fixed.
    pub fn none() -> Self {
        Self::default()
    }

    /// The same with one parameter fixed at a value.
    #[must_use]
    pub fn with(mut self, parameter: Parameter, value: f64) -> Self {
        self.values[parameter as usize] = Some(value);
        self
    }

    /// The value at which a parameter is fixed, if it is.
    pub fn get(&self, parameter: Parameter) -> Option<f64> {
        self.values[parameter as usize]
    }

    /// Whether no parameter is fixed.
    pub fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }

    /// The fixed parameters with their values, in the order of [`Parameter::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (Parameter, f64)> {
        let values = Parameter::ALL.into_iter().zip(self.values);
        values.filter_map(|(parameter, value)| Some((parameter, value?)))
    }

    /// The fixed parameters that the model would otherwise fit.
    #[must_use]
    pub fn within(&self, model: Model) -> Self {
        self.iter()
            .filter(|(parameter, _)| model.frees(*parameter))
            .collect()
    }

    /// Checks that the model fits each of these parameters, and that each value is in its range.
    pub(crate) fn check(&self, model: Model) -> Result<(), FixedError> {
        for (parameter, value) in self.iter() {
            if !model.frees(parameter) {
                return Err(FixedError::NotFree { parameter, model });
            }
            let (lowest, highest) = parameter.range();
            if !(value.is_finite() && (lowest..=highest).contains(&value)) {
                return Err(FixedError::OutOfRange { parameter, value });
            }
        }
        Ok(())
    }
}

impl FromIterator<(Parameter, f64)> for FixedParameters {
    fn from_iter<I: IntoIterator<Item = (Parameter, f64)>>(values: I) -> Self {
        let add = |fixed: Self, (parameter, value)| fixed.with(parameter, value);
        values.into_iter().fold(Self::none(), add)
    }
}

impl From<BTreeMap<Parameter, f64>> for FixedParameters {
    fn from(values: BTreeMap<Parameter, f64>) -> Self {
        values.into_iter().collect()
    }
}

impl From<FixedParameters> for BTreeMap<Parameter, f64> {
    fn from(fixed: FixedParameters) -> Self {
        fixed.iter().collect()
    }
}

/// `k1 = 0.2, kD = 0.05`; empty if no parameter is fixed.
impl fmt::Display for FixedParameters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = self
            .iter()
            .map(|(parameter, value)| format!("{parameter} = {value}"));
        f.pad(&words.collect::<Vec<_>>().join(", "))
    }
}

/// From `k1=0.2,kD=0.05`; the case of the names is ignored.
impl FromStr for FixedParameters {
    type Err = ParseError;

    fn from_str(text: &str) -> Result<Self, ParseError> {
        let mut fixed = Self::none();
        for entry in text.split(',') {
            let (name, value) = entry.split_once('=').unwrap_or((entry, ""));
            let parameter = name.trim().parse()?;
            let value = value.trim().parse().map_err(|_| {
                ParseError::new(format!(
                    "\"{entry}\": expected NAME=VALUE with a number, such as k1=0.2"
                ))
            })?;
            if fixed.get(parameter).is_some() {
                return Err(ParseError::new(format!(
                    "\"{text}\": {parameter} is given twice"
                )));
            }
            fixed = fixed.with(parameter, value);
        }
        Ok(fixed)
    }
}

/// A model with some of its parameters fixed: the model that is fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReducedModel {
    model: Model,
    fixed: FixedParameters,
    /// The free parameters come first; the entries behind `count` are not used.
    parameters: [Parameter; Parameter::ALL.len()],
    /// The number of free parameters.
    count: usize,
}

impl ReducedModel {
    /// The values of k2 and kD that are not fitted.
    pub(crate) fn fixed_weights(self) -> [Option<f64>; 2] {
        [Parameter::K2, Parameter::Kd].map(|weight| self.fixed(weight))
    }

    /// The model with these parameters fixed. Parameters that the model does not fit are ignored.
    pub fn new(model: Model, fixed: FixedParameters) -> Self {
        let mut parameters = Parameter::ALL;
        let mut count = 0;
        let fitted = model.free().iter().filter(|&&p| fixed.get(p).is_none());
        for &parameter in fitted {
            parameters[count] = parameter;
            count += 1;
        }
        Self {
            model,
            fixed: fixed.within(model),
            parameters,
            count,
        }
    }

    /// The model.
    pub fn model(self) -> Model {
        self.model
    }

    /// The family of the model.
    pub fn family(self) -> Family {
        self.model.family()
    }

    /// The free parameters, in the order of [`Parameter::ALL`].
    pub fn free(&self) -> &[Parameter] {
        &self.parameters[..self.count]
    }

    /// Whether a parameter is free.
    pub fn frees(&self, parameter: Parameter) -> bool {
        self.free().contains(&parameter)
    }

    /// The value of a parameter that is not free: the fixed one, or the neutral one if the model lacks
    /// the parameter. `None` if the parameter is free, and for a refractive index that is stated
    /// elsewhere.
    pub fn fixed(&self, parameter: Parameter) -> Option<f64> {
        self.fixed
            .get(parameter)
            .or_else(|| self.model.neutral(parameter))
    }

    /// A start for this model: fixed parameters take their values, free ones are clamped to their
    /// ranges.
    pub fn start(&self, mut at: ModelParameters) -> ModelParameters {
        for parameter in Parameter::ALL {
            let fixed = self.fixed(parameter);
            if fixed.is_none() && !self.frees(parameter) {
                continue;
            }
            let (lowest, highest) = parameter.range();
            let value = parameter.of(&at).clamp(lowest, highest);
            parameter.set(&mut at, fixed.unwrap_or(value));
        }
        at
    }
}

impl From<Model> for ReducedModel {
    fn from(model: Model) -> Self {
        Self::new(model, FixedParameters::none())
    }
}
