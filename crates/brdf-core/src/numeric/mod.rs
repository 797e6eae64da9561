//! Arithmetic that the model is written in: real numbers of several kinds, ratios, trigonometric
//! functions over known ranges, and adaptive integration.
//!
//! Each term of the model is written once, over [`Real`], and serves one point in `f64` as well as
//! many points at once in `f64` and `f32`. Whoever adds a facet distribution or a shadowing
//! function needs these types; whoever only evaluates the model does not.

mod carried;
mod half_angle;
mod quadrature;
mod ratio;
mod real;
mod trigonometry;

pub use ratio::Ratio;
pub use real::{Elementary, Fused, Primitive, Real};

pub(crate) use carried::Carried;
pub(crate) use half_angle::{HalfAngle, half_of_azimuth};
pub(crate) use quadrature::{Adaptive, Quadrature, Rough, integrate};
pub(crate) use real::horner;
pub(crate) use trigonometry::{
    cos_quarter, sin_cos_quarter, sin_eighth, sin2_cos2_of_any_half, sin2_cos2_of_half,
};
