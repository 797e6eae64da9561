//! The models that can be fitted: the paper's, its simpler and its richer relatives, and the
//! neighbours that a user would otherwise take.

mod held;

use std::fmt;
use std::str::FromStr;

use brdf_core::{Family, ModelParameters, N_DOMAIN, P_DOMAIN};
use serde::{Deserialize, Serialize};

pub use held::{Held, HeldModel};

/// The range of k1 in a fit. Far below the resolution of any goniometer at one end; at the other
/// the facet distribution no longer changes (its limit is sec alpha).
pub const K1_RANGE: (f64, f64) = (1e-6, 1e3);

/// The range of a fitted refractive index: up to that of germanium and the like.
pub const N_RANGE: (f64, f64) = (N_DOMAIN.0, 6.0);

/// The refractive index where a fit of n starts when nobody says another: that of most binders.
pub const USUAL_N: f64 = 1.5;

/// One number of a model, in the order of [`ModelParameters`].
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

    /// The bounds of the parameter in a fit.
    pub fn range(self) -> (f64, f64) {
        match self {
            Self::K2 | Self::Kd => (0.0, f64::INFINITY),
            Self::K1 => K1_RANGE,
            Self::N => N_RANGE,
            Self::P => P_DOMAIN,
        }
    }

    /// Its value among all parameters.
    pub fn of(self, at: &ModelParameters) -> f64 {
        match self {
            Self::K2 => at.k2,
            Self::Kd => at.kd,
            Self::K1 => at.k1,
            Self::N => at.n,
            Self::P => at.p,
        }
    }

    /// Sets its value among all parameters.
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

/// Its name, in capitals or not.
impl FromStr for Parameter {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|parameter| parameter.to_string().eq_ignore_ascii_case(text))
            .ok_or_else(|| {
                let names = Self::ALL.map(|parameter| parameter.to_string()).join(", ");
                format!("\"{text}\" is no parameter: expected one of {names}")
            })
    }
}

/// A model: a family and which of its parameters are free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// Lambertian only: kD.
    Lambert,
    /// Specular only: k2 and k1.
    Specular,
    /// The paper's three parameters.
    #[default]
    Three,
    /// The paper's, and n free.
    #[serde(rename = "three+n")]
    ThreeN,
    /// The paper's with Smith's shadowing, and n free.
    #[serde(rename = "smith+n")]
    SmithN,
    /// The paper's with a free exponent, and n free.
    #[serde(rename = "power+n")]
    PowerN,
    /// GGX with Smith's shadowing.
    Ggx,
    /// GGX with Smith's shadowing, and n free.
    #[serde(rename = "ggx+n")]
    GgxN,
    /// Beckmann with V-groove shadowing.
    Beckmann,
    /// Beckmann with V-groove shadowing, and n free.
    #[serde(rename = "beckmann+n")]
    BeckmannN,
}

impl Model {
    /// The ladder, from the smallest to the largest.
    pub const LADDER: [Self; 6] = [
        Self::Lambert,
        Self::Specular,
        Self::Three,
        Self::ThreeN,
        Self::SmithN,
        Self::PowerN,
    ];

    /// What is compared: the ladder from the paper's model on, and the neighbours.
    pub const COMPARED: [Self; 8] = [
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

    /// The family.
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

    /// The value of a parameter that the model does not have, as if it had it: `None` where it is
    /// free, and for the index, which others state.
    pub fn neutral(self, parameter: Parameter) -> Option<f64> {
        match parameter {
            _ if self.frees(parameter) => None,
            Parameter::K2 | Parameter::Kd => Some(0.0),
            Parameter::K1 | Parameter::P => Some(1.0),
            Parameter::N => None,
        }
    }

    /// A start of this model: the parameters that it does not have take their neutral values.
    pub fn start(self, at: ModelParameters) -> ModelParameters {
        HeldModel::from(self).start(at)
    }

    /// Its name on the command line and in files.
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

    /// What it is, in a few words.
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
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|model| model.name() == text)
            .ok_or_else(|| {
                let names = Self::ALL.map(Self::name).join(", ");
                format!("\"{text}\": expected one of {names}")
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
