//! What is known of a surface before anything is measured: the parameters of `three+n` that coatings of its
//! class have.

use std::fmt;
use std::str::FromStr;

use brdf_core::ModelParameters;
use nalgebra::Vector4;
use serde::{Deserialize, Serialize};

use crate::format::ParseError;

/// The parameters in which everything of this layer is linear: ln k2, ln kD, ln k1, ln(n - 1).
pub(super) type Logs = Vector4<f64>;

/// The ends of the search, in k2, kD, k1 and n - 1.
const LOWEST: [f64; 4] = [1e-6, 1e-7, 1e-3, 0.05];
const HIGHEST: [f64; 4] = [100.0, 2.0, 10.0, 4.9];

/// A kind of surface, with the parameters that are likely for it.
///
/// The likely values are near the geometric means of the fits of `three+n` to the measured scans of the class that were at
/// hand, 10 of paints, 6 of anodised surfaces and 2 of bare metals, with wide distributions. `Unknown` covers all of
/// them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MaterialClass {
    /// Paints and lacquers.
    Paint,
    /// Anodised metals.
    Anodise,
    /// Bare metals, rough or polished.
    Metal,
    /// Any surface.
    #[default]
    Unknown,
}

/// The likely values of k2, kD, k1 and n - 1, and the standard deviations of their logarithms.
struct Likely {
    median: [f64; 4],
    deviation: [f64; 4],
}

impl MaterialClass {
    /// All classes, with their names in options and files.
    pub const NAMED: [(Self, &str); 4] = [
        (Self::Paint, "paint"),
        (Self::Anodise, "anodise"),
        (Self::Metal, "metal"),
        (Self::Unknown, "unknown"),
    ];

    fn likely(self) -> Likely {
        let (median, deviation) = match self {
            Self::Paint => ([0.02, 0.02, 0.3, 0.2], [1.8, 1.2, 0.7, 0.7]),
            Self::Anodise => ([0.3, 0.025, 0.18, 1.0], [1.6, 0.8, 0.7, 0.6]),
            Self::Metal => ([2.0, 0.3, 0.1, 2.0], [2.0, 1.5, 0.9, 0.7]),
            Self::Unknown => ([0.1, 0.05, 0.2, 0.5], [1.5, 1.5, 0.8, 0.5]),
        };
        Likely { median, deviation }
    }

    /// The likely parameters: the medians of the class.
    pub fn likely_parameters(self) -> ModelParameters {
        parameters(&Prior::of(self).mean)
    }
}

impl fmt::Display for MaterialClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = Self::NAMED.iter().find(|(class, _)| class == self);
        f.write_str(named.map_or("", |(_, name)| name))
    }
}

impl FromStr for MaterialClass {
    type Err = ParseError;

    fn from_str(text: &str) -> Result<Self, ParseError> {
        let found = Self::NAMED.iter().find(|(_, name)| *name == text);
        found.map(|(class, _)| *class).ok_or_else(|| {
            let names = Self::NAMED.map(|(_, name)| name).join(", ");
            ParseError::new(format!("\"{text}\": expected one of {names}"))
        })
    }
}

/// A normal distribution of the logarithms of the parameters, independent of each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Prior {
    pub(super) mean: Logs,
    pub(super) deviation: Logs,
}

impl Prior {
    pub(super) fn of(class: MaterialClass) -> Self {
        let Likely { median, deviation } = class.likely();
        Self {
            mean: Logs::from(median.map(f64::ln)),
            deviation: Logs::from(deviation),
        }
    }
}

/// The logarithms within the ends of the search.
pub(super) fn clamped(logs: &Logs) -> Logs {
    Logs::from_fn(|k, _| logs[k].clamp(LOWEST[k].ln(), HIGHEST[k].ln()))
}

/// The parameters of the model, with p = 1.
pub(super) fn parameters(logs: &Logs) -> ModelParameters {
    let [k2, kd, k1, beyond_one] = logs.map(f64::exp).into();
    ModelParameters {
        k2,
        kd,
        k1,
        n: 1.0 + beyond_one,
        p: 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_class_has_a_name_that_is_read_again_and_likely_parameters_within_the_search() {
        for (class, name) in MaterialClass::NAMED {
            assert_eq!(name.parse(), Ok(class));
            assert_eq!(class.to_string(), name);
            let mean = Prior::of(class).mean;
            assert_eq!(clamped(&mean), mean);
        }
        let error = "plastic".parse::<MaterialClass>().unwrap_err();
        assert!(error.to_string().contains("expected one of paint, anodise"));
    }
}
