//! The three-parameter model of the bidirectional reflectance distribution function (BRDF) of
//! coated surfaces by Li Tie, Yan Wei and Wu Zhensen, "A Parametric Model of Bidirectional Reflectance
//! Distribution Function", Acta Optica Sinica 22(7), 769-773 (2002).
//!
//! ```
//! use brdf_core::{Geometry, Parameters, ThreeParameterBrdf};
//!
//! // Sample 001 of the paper's Table 1 at 0.91 um: k2, kD, k1, and the refractive index n.
//! let brdf = ThreeParameterBrdf::new(Parameters::new(1.211, 0.521, 0.071)?, 1.60)?;
//!
//! // Light is incident at 30 deg and observed 10 deg from the mirror direction.
//! let geometry = Geometry::in_plane(30_f64.to_radians(), -40_f64.to_radians())?;
//! let f_r = brdf.value(&geometry); // 1/sr
//! let [by_k2, by_kd, by_k1] = brdf.gradient(&geometry);
//! # assert!(f_r > 0.0 && by_k2 > 0.0 && by_kd > 0.0 && by_k1 > 0.0);
//!
//! let rho = brdf.hemispherical_reflectance(30_f64.to_radians(), 1e-6)?;
//! # assert!(rho < 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`AnyBrdf`] chooses between this model and its reference models at run time, [`evaluator`]
//! evaluates many points at once, [`scene`] finds the fastest evaluator within a tolerance, and
//! [`sampling`] draws directions for renderers.
//!
//! Angles are in radians, directions are unit vectors with the surface normal along z, and the BRDF
//! is in 1/sr. The incidence zenith angle psi is not negative. The view angle theta may be signed: in
//! the plane of incidence, theta = -psi is the specular direction and theta = psi is the direction
//! back into the source. The azimuth phi is relative to the source, and pi is forward.
//!
//! # Features
//!
//! All features are enabled by default. Without them the crate depends on `libm` and `thiserror` only.
//! No feature changes single values.
//!
//! | feature | effect |
//! |---|---|
//! | `parallel` | many points are evaluated on all threads of the current rayon pool |
//! | `simd` | many points are evaluated in the widest vectors of the processor, found at run time |
//! | `serde` | parameters, models, domains and scenes can be serialised |
//! | `nalgebra` | a [`Direction`] may be a `nalgebra::Vector3<f64>` beside a `[f64; 3]` |
//!
//! # Domain and accuracy
//!
//! For psi and |theta| in [0, 90 deg), any phi, k1 from 1e-8 to 1e8 and n from 1 (included) to 1e5,
//! all results are finite and accurate to a few roundings. On 5000 points in 80-digit arithmetic the
//! relative errors in units of 2^-52 are (median / maximum):
//!
//! | points | f_r | df_r/dk2 | df_r/dk1 |
//! |---|---|---|---|
//! | ordinary | 0.6 / 4.0 | 0.8 / 4.3 | 0.9 / 4.4 |
//! | extreme angles | 0.6 / 4.3 | 0.8 / 3.4 | 0.9 / 4.1 |
//! | extreme parameters | 0.7 / 3.4 | 0.8 / 3.9 | 0.9 / 4.6 |
//! | near the specular direction | 0.7 / 3.2 | 0.8 / 3.5 | 0.8 / 4.8 |
//! | both angles at grazing | 0.7 / 3.9 | 0.8 / 4.1 | 0.9 / 4.2 |
//!
//! The expressions of a textbook, evaluated as printed, have on the same points:
//!
//! | points | f_r | df_r/dk2 | df_r/dk1 |
//! |---|---|---|---|
//! | ordinary | 0.9 / 670 | 1.7 / 671 | 2.4 / 9e3 |
//! | extreme angles | 1.1 / 7e35 | 1.9 / 7e35 | 2.7 / not a number |
//! | extreme parameters | 2.4 / 3e13 | 12 / 3e13 | 6e5 / 3e18 |
//! | near the specular direction | 3e4 / 1e13 | 7e4 / 1e13 | 2e9 / 2e22 |
//! | both angles at grazing | 1.7 / 8e15 | 2.7 / 8e15 | 2.8 / 4e31 |
//!
//! Both tables are printed by `cargo test -p brdf-tests --test reference -- --nocapture`. The forms
//! without cancellation that make the difference are documented with [`Geometry`] for the half vector,
//! [`facet::Ellipsoid`] for the distribution, [`fresnel::Dielectric`] for the Fresnel factor and
//! [`shadowing`] for G over the cosines. f_r and its derivatives consist of operations whose rounding
//! is defined, so that they have the same digits on every machine.

#![warn(clippy::missing_errors_doc)]

mod brdf;
mod direction;
mod direction_pair;
pub mod evaluator;
pub mod facet;
mod family;
pub mod fresnel;
mod geometry;
pub mod numeric;
mod parallel;
mod parameters;
pub mod published;
mod reflectance;
pub mod sampling;
pub mod scene;
pub mod shadowing;

pub use brdf::{MicrofacetBrdf, ThreeParameterBrdf, mirror_factor};
pub use direction::Direction;
pub use direction_pair::HalfVector;
pub use family::{AnyBrdf, Family};
pub use geometry::{Geometry, GeometryError};
pub use parameters::{
    K1_DOMAIN, ModelParameters, N_DOMAIN, P_DOMAIN, ParameterError, Parameters,
    check_refractive_index,
};
pub use reflectance::{ENERGY_CHECK_LIMIT, specular_reflectance};
pub use sampling::{Sample, Sampler};

/// The examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
