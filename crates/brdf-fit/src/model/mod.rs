//! The models that can be fitted: the paper's, smaller and larger models of its hierarchy, and the
//! reference models GGX and Beckmann.

mod fixed;
mod grid;

use std::fmt;
use std::str::FromStr;

use brdf_core::{Family, ModelParameters, N_DOMAIN, P_DOMAIN};
use serde::{Deserialize, Serialize};

use crate::format::ParseError;

pub use fixed::{FixedError, FixedParameters, ReducedModel};
pub(crate) use grid::{FAINT, FEW_READINGS, Grid, PLAIN, faint};

/// The range of k1 in a fit. The lower end is far below the resolution of any goniometer; at the
/// upper end the facet distribution has reached its limit sec alpha.
pub const K1_RANGE: (f64, f64) = (1e-6, 1e3);

/// The range of a fitted refractive index; the upper end lies above germanium and similar materials.
pub const N_RANGE: (f64, f64) = (N_DOMAIN.0, 6.0);

/// The refractive index where a fit of n starts by default: that of most binders.
pub const DEFAULT_N: f64 = 1.5;

/// A parameter of a model, in the order of [`ModelParameters`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Parameter {
    /// Specular weight.
    K2,
    /// Diffuse weight.
    Kd,
    /// Width of the facet distribution.
    K1,
    /// Refractive index.
    N,
    /// Exponent of the facet distribution.
    P,
}

impl Parameter {
    /// All parameters, in the order of [`ModelParameters`].
    pub const ALL: [Self; 5] = [Self::K2, Self::Kd, Self::K1, Self::N, Self::P];

    /// The range of the parameter in a fit: lower and upper bound.
    pub fn range(self) -> (f64, f64) {
        match self {
            Self::K2 | Self::Kd => (0.0, f64::INFINITY),
            Self::K1 => K1_RANGE,
            Self::N => N_RANGE,
            Self::P => P_DOMAIN,
        }
    }

    /// The value of this parameter in a set of parameters.
    pub fn of(self, at: &ModelParameters) -> f64 {
        match self {
            Self::K2 => at.k2,
            Self::Kd => at.kd,
            Self::K1 => at.k1,
            Self::N => at.n,
            Self::P => at.p,
        }
    }

    /// Sets the value of this parameter in a set of parameters.
    pub fn set(self, at: &mut ModelParameters, value: f64) {
        *match self {
            Self::K2 => &mut at.k2,
            Self::Kd => &mut at.kd,
            Self::K1 => &mut at.k1,
            Self::N => &mut at.n,
            Self::P => &mut at.p,
        } = value;
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::K2 => "k2",
            Self::Kd => "kD",
            Self::K1 => "k1",
            Self::N => "n",
            Self::P => "p",
        })
    }
}

/// From the name of a parameter, ignoring case.
impl FromStr for Parameter {
    type Err = ParseError;

    fn from_str(text: &str) -> Result<Self, ParseError> {
        Self::ALL
            .into_iter()
            .find(|parameter| parameter.to_string().eq_ignore_ascii_case(text))
            .ok_or_else(|| {
                let names = Self::ALL.map(|parameter| parameter.to_string()).join(", ");
                ParseError::new(format!(
                    "\"{text}\" is not a parameter: expected one of {names}"
                ))
            })
    }
}

/// A model: a family of BRDFs with its free parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// The Lambertian part only: kD.
    Lambert,
    /// The specular part only: k2 and k1.
    Specular,
    /// The paper's three parameters.
    #[default]
    Three,
    /// The paper's model with n free.
    #[serde(rename = "three+n")]
    ThreeN,
    /// The paper's facet distribution with Smith shadowing, n free.
    #[serde(rename = "smith+n")]
    SmithN,
    /// The paper's model with a free exponent p, n free.
    #[serde(rename = "power+n")]
    PowerN,
    /// GGX with Smith shadowing.
    Ggx,
    /// GGX with Smith shadowing, n free.
    #[serde(rename = "ggx+n")]
    GgxN,
    /// Beckmann with V-groove shadowing.
    Beckmann,
    /// Beckmann with V-groove shadowing, n free.
    #[serde(rename = "beckmann+n")]
    BeckmannN,
}

impl Model {
    /// The model hierarchy, from the smallest to the largest.
    pub const HIERARCHY: [Self; 6] = [
        Self::Lambert,
        Self::Specular,
        Self::Three,
        Self::ThreeN,
        Self::SmithN,
        Self::PowerN,
    ];

    /// The hierarchy from the paper's model on, and the reference models.
    pub const WITH_REFERENCES: [Self; 8] = [
        Self::Three,
        Self::ThreeN,
        Self::SmithN,
        Self::PowerN,
        Self::Ggx,
        Self::GgxN,
        Self::Beckmann,
        Self::BeckmannN,
    ];

    /// All models.
    pub const ALL: [Self; 10] = [
        Self::Lambert,
        Self::Specular,
        Self::Three,
        Self::ThreeN,
        Self::SmithN,
        Self::PowerN,
        Self::Ggx,
        Self::GgxN,
        Self::Beckmann,
        Self::BeckmannN,
    ];

    /// The family of BRDFs.
    pub fn family(self) -> Family {
        match self {
            Self::Lambert | Self::Specular | Self::Three | Self::ThreeN => Family::Paper,
            Self::SmithN => Family::Smith,
            Self::PowerN => Family::Power,
            Self::Ggx | Self::GgxN => Family::Ggx,
            Self::Beckmann | Self::BeckmannN => Family::Beckmann,
        }
    }

    /// The free parameters, in their order.
    pub fn free(self) -> &'static [Parameter] {
        use Parameter::{K1, K2, Kd, N, P};
        match self {
            Self::Lambert => &[Kd],
            Self::Specular => &[K2, K1],
            Self::Three | Self::Ggx | Self::Beckmann => &[K2, Kd, K1],
            Self::ThreeN | Self::SmithN | Self::GgxN | Self::BeckmannN => &[K2, Kd, K1, N],
            Self::PowerN => &[K2, Kd, K1, N, P],
        }
    }

    /// Whether a parameter is free.
    pub fn frees(self, parameter: Parameter) -> bool {
        self.free().contains(&parameter)
    }

    /// The value at which a parameter that the model lacks has no effect. `None` if the parameter is
    /// free, and for the refractive index, which is stated elsewhere.
    pub fn neutral(self, parameter: Parameter) -> Option<f64> {
        match parameter {
            _ if self.frees(parameter) => None,
            Parameter::K2 | Parameter::Kd => Some(0.0),
            Parameter::K1 | Parameter::P => Some(1.0),
            Parameter::N => None,
        }
    }

    /// A start of this model: parameters that it lacks take their neutral values.
    pub fn start(self, at: ModelParameters) -> ModelParameters {
        ReducedModel::from(self).start(at)
    }

    /// The name in options and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lambert => "lambert",
            Self::Specular => "specular",
            Self::Three => "three",
            Self::ThreeN => "three+n",
            Self::SmithN => "smith+n",
            Self::PowerN => "power+n",
            Self::Ggx => "ggx",
            Self::GgxN => "ggx+n",
            Self::Beckmann => "beckmann",
            Self::BeckmannN => "beckmann+n",
        }
    }

    /// A short description.
    pub fn description(self) -> &'static str {
        match self {
            Self::Lambert => "Lambertian only",
            Self::Specular => "specular part only",
            Self::Three => "the paper's three parameters",
            Self::ThreeN => "the paper's with n free",
            Self::SmithN => "the paper's facets with Smith shadowing, n free",
            Self::PowerN => "the paper's with a free exponent, n free",
            Self::Ggx => "GGX with Smith shadowing",
            Self::GgxN => "GGX with Smith shadowing, n free",
            Self::Beckmann => "Beckmann with V-groove shadowing",
            Self::BeckmannN => "Beckmann with V-groove shadowing, n free",
        }
    }
}

impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Model {
    type Err = ParseError;

    fn from_str(text: &str) -> Result<Self, ParseError> {
        Self::ALL
            .into_iter()
            .find(|model| model.name() == text)
            .ok_or_else(|| {
                let names = Self::ALL.map(Self::name).join(", ");
                ParseError::new(format!("\"{text}\": expected one of {names}"))
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_go_there_and_back_also_in_json() {
        for model in Model::ALL {
            assert_eq!(model.name().parse(), Ok(model));
            let json = serde_json::to_string(&model).unwrap();
            assert_eq!(json, format!("\"{model}\""));
        }
    }

    #[test]
    fn a_start_has_only_what_its_model_has() {
        let at = ModelParameters {
            k2: 0.3,
            kd: 0.1,
            k1: 0.2,
            n: 9.0,
            p: 2.0,
        };
        assert_eq!(Model::Lambert.start(at).k2, 0.0);
        assert_eq!(Model::Specular.start(at).kd, 0.0);
        assert_eq!(Model::Three.start(at).n, 9.0);
        assert_eq!(Model::ThreeN.start(at).n, N_RANGE.1);
        assert_eq!(Model::PowerN.start(at).p, 2.0);
    }
}
