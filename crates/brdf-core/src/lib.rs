//! The three-parameter model of the bidirectional reflectance distribution function (BRDF) of
//! coated surfaces, by Li Tie, Yan Wei and Wu Zhensen, "A Parametric Model of Bidirectional
//! Reflectance Distribution Function", Acta Optica Sinica 22(7), 769-773 (2002).
//!
//! Angles are in radians, the BRDF in 1/sr.
pub mod brdf;
pub mod facet;
pub mod fresnel;
pub mod geometry;
pub mod published;
mod quadrature;
pub mod reflectance;
pub mod shadowing;
mod trigonometry;

pub use brdf::{ParameterError, Parameters, ThreeParameterBrdf};
pub use geometry::{Geometry, GeometryError};
