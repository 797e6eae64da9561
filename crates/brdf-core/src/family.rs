//! The model and its reference models, one of which is chosen at run time.

use std::fmt;

use crate::brdf::{MicrofacetBrdf, ThreeParameterBrdf};
use crate::facet::{Beckmann, Ellipsoid, FacetDistribution as _, Ggx, Power};
use crate::fresnel::Dielectric;
use crate::geometry::{Geometry, GeometryError};
use crate::parameters::{ModelParameters, ParameterError, Parameters, check_exponent};
use crate::shadowing::{Smith, VGroove};

/// A combination of a facet distribution and a shadowing function. The Fresnel factor and the
/// Lambertian part are the same for all families.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Family {
    /// The paper's model: the ellipsoid of eq. (2) with V-groove shadowing.
    Paper,
    /// The ellipsoid with Smith shadowing.
    Smith,
    /// The ellipsoid with a free exponent p and V-groove shadowing.
    Power,
    /// GGX with Smith shadowing.
    Ggx,
    /// Beckmann with V-groove shadowing.
    Beckmann,
}

impl Family {
    /// All families.
    pub const ALL: [Self; 5] = [
        Self::Paper,
        Self::Smith,
        Self::Power,
        Self::Ggx,
        Self::Beckmann,
    ];
}

/// The name of the family in files.
impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Paper => "paper",
            Self::Smith => "smith",
            Self::Power => "power",
            Self::Ggx => "ggx",
            Self::Beckmann => "beckmann",
        })
    }
}

/// A BRDF whose family is chosen at run time. In a file it consists of its family and its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Described", into = "Described"))]
pub enum AnyBrdf {
    /// [`Family::Paper`].
    Paper(ThreeParameterBrdf),
    /// [`Family::Smith`].
    Smith(MicrofacetBrdf<Ellipsoid, Smith>),
    /// [`Family::Power`].
    Power(MicrofacetBrdf<Power, VGroove>),
    /// [`Family::Ggx`].
    Ggx(MicrofacetBrdf<Ggx, Smith>),
    /// [`Family::Beckmann`].
    Beckmann(MicrofacetBrdf<Beckmann, VGroove>),
}

impl From<ThreeParameterBrdf> for AnyBrdf {
    fn from(brdf: ThreeParameterBrdf) -> Self {
        Self::Paper(brdf)
    }
}

/// A BRDF as a file contains it.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
struct Described {
    family: Family,
    #[serde(flatten)]
    parameters: ModelParameters,
}

#[cfg(feature = "serde")]
impl From<AnyBrdf> for Described {
    fn from(brdf: AnyBrdf) -> Self {
        Self {
            family: brdf.family(),
            parameters: brdf.model_parameters(),
        }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<Described> for AnyBrdf {
    type Error = ParameterError;

    fn try_from(described: Described) -> Result<Self, ParameterError> {
        Self::new(described.family, &described.parameters)
    }
}

/// Evaluates the same expression for the BRDF of any family.
macro_rules! each {
    ($any:expr, $brdf:ident => $value:expr) => {
        match $any {
            AnyBrdf::Paper($brdf) => $value,
            AnyBrdf::Smith($brdf) => $value,
            AnyBrdf::Power($brdf) => $value,
            AnyBrdf::Ggx($brdf) => $value,
            AnyBrdf::Beckmann($brdf) => $value,
        }
    };
}

pub(crate) use each;

impl AnyBrdf {
    /// The BRDF of a family with the given parameters. Only [`Family::Power`] uses the exponent p.
    ///
    /// # Errors
    ///
    /// [`ParameterError`] for a parameter outside its domain.
    ///
    /// # Examples
    ///
    /// ```
    /// use brdf_core::{AnyBrdf, Family, Geometry, ModelParameters};
    ///
    /// let parameters = ModelParameters { k2: 0.3, kd: 0.1, k1: 0.2, n: 1.5, p: 1.0 };
    /// let brdf = AnyBrdf::new(Family::Ggx, &parameters)?;
    /// let f_r = brdf.value(&Geometry::in_plane(0.5, -0.4)?);
    /// # assert!(f_r > 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(family: Family, at: &ModelParameters) -> Result<Self, ParameterError> {
        let (three, n, p) = (at.parameters(), at.n, at.p);
        Ok(match family {
            Family::Paper => Self::Paper(ThreeParameterBrdf::new(three, n)?),
            Family::Smith => Self::Smith(MicrofacetBrdf::from_terms(
                three,
                n,
                Ellipsoid::new,
                Smith::new,
            )?),
            Family::Power => {
                let p = check_exponent(p)?;
                let facet = |k1| Power::new(k1, p);
                Self::Power(MicrofacetBrdf::from_terms(three, n, facet, |_| VGroove)?)
            }
            Family::Ggx => Self::Ggx(MicrofacetBrdf::from_terms(three, n, Ggx::new, Smith::new)?),
            Family::Beckmann => {
                Self::Beckmann(MicrofacetBrdf::from_terms(three, n, Beckmann::new, |_| {
                    VGroove
                })?)
            }
        })
    }

    /// The parameters k2, kD and k1.
    pub fn parameters(&self) -> Parameters {
        each!(self, brdf => brdf.parameters())
    }

    /// All parameters of the model.
    pub fn model_parameters(&self) -> ModelParameters {
        let p = each!(self, brdf => brdf.facet().p());
        ModelParameters {
            p,
            ..ModelParameters::three(self.parameters(), self.fresnel().n())
        }
    }

    /// The family.
    pub fn family(&self) -> Family {
        match self {
            Self::Paper(_) => Family::Paper,
            Self::Smith(_) => Family::Smith,
            Self::Power(_) => Family::Power,
            Self::Ggx(_) => Family::Ggx,
            Self::Beckmann(_) => Family::Beckmann,
        }
    }

    /// The Fresnel factor.
    pub fn fresnel(&self) -> Dielectric {
        each!(self, brdf => brdf.fresnel())
    }

    /// The same BRDF with another diffuse weight kD >= 0.
    pub(crate) fn with_kd(mut self, kd: f64) -> Self {
        each!(&mut self, brdf => brdf.set_kd(kd));
        self
    }

    /// f_r in 1/sr.
    #[inline]
    pub fn value(&self, geometry: &Geometry) -> f64 {
        each!(self, brdf => brdf.value(geometry))
    }

    /// The derivatives of f_r with respect to (k2, kD, k1, n, p), in 1/sr.
    #[inline]
    pub fn gradient(&self, geometry: &Geometry) -> [f64; 5] {
        each!(self, brdf => {
            let [k2, kd, k1] = brdf.gradient(geometry);
            [k2, kd, k1, brdf.derivative_n(geometry), brdf.derivative_p(geometry)]
        })
    }

    /// [`MicrofacetBrdf::hemispherical_reflectance`] of the chosen family.
    ///
    /// # Errors
    ///
    /// [`GeometryError::Incidence`] if psi is not in [0, pi/2).
    pub fn hemispherical_reflectance(
        &self,
        psi: f64,
        tolerance: f64,
    ) -> Result<f64, GeometryError> {
        each!(self, brdf => brdf.hemispherical_reflectance(psi, tolerance))
    }

    /// [`MicrofacetBrdf::energy_violation_angle`] of the chosen family.
    pub fn energy_violation_angle(&self) -> Option<f64> {
        each!(self, brdf => brdf.energy_violation_angle())
    }

    /// [`MicrofacetBrdf::implied_facet_reflectance`] of the chosen family.
    pub fn implied_facet_reflectance(&self) -> f64 {
        each!(self, brdf => brdf.implied_facet_reflectance())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn at(k2: f64, kd: f64, k1: f64, n: f64, p: f64) -> ModelParameters {
        ModelParameters { k2, kd, k1, n, p }
    }

    #[test]
    fn an_exponent_outside_the_domain_is_named() {
        let error = AnyBrdf::new(Family::Power, &at(0.1, 0.1, 0.1, 1.5, 0.0)).unwrap_err();
        assert!(error.to_string().contains("p = 0"));
    }

    proptest! {
        #[test]
        fn every_family_is_reciprocal_and_positive(
            log_k1 in -14.0..7.0_f64, n in 1.0..6.0, p in 0.1..16.0,
            psi in 0.0..1.56, theta in 0.0..1.56, phi in -7.0..7.0_f64,
        ) {
            let there = Geometry::new(psi, theta, phi).unwrap();
            let back = Geometry::new(theta, psi, phi).unwrap();
            for family in Family::ALL {
                let brdf = AnyBrdf::new(family, &at(0.3, 0.1, log_k1.exp(), n, p)).unwrap();
                let value = brdf.value(&there);
                prop_assert_eq!(value, brdf.value(&back));
                prop_assert!(value > 0.0 && value.is_finite());
            }
        }

        #[test]
        fn gradients_are_those_of_the_values(
            k2 in 0.01..3.0, kd in 0.01..1.0, log_k1 in -3.0..1.0_f64, n in 1.1..5.0, p in 0.3..5.0,
            psi in 0.0..1.5, theta in -1.5..1.5,
        ) {
            let geometry = Geometry::in_plane(psi, theta).unwrap();
            let here = [k2, kd, log_k1.exp(), n, p];
            for family in Family::ALL {
                let brdf = |x: [f64; 5]| {
                    AnyBrdf::new(family, &at(x[0], x[1], x[2], x[3], x[4])).unwrap()
                };
                let value = brdf(here).value(&geometry);
                let gradient = brdf(here).gradient(&geometry);
                for j in 0..5 {
                    let step = 1e-5 * here[j];
                    let moved = |sign: f64| {
                        let mut moved = here;
                        moved[j] += sign * step;
                        brdf(moved).value(&geometry)
                    };
                    let difference = (moved(1.0) - moved(-1.0)) / (2.0 * step);
                    let tolerance = 1e-6 * (value / here[j]).max(gradient[j].abs());
                    prop_assert!((gradient[j] - difference).abs() < tolerance, "{:?} {}", family, j);
                }
            }
        }
    }
}
