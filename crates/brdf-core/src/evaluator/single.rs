//! The model in `f32`, with or without its Lambertian part.

use super::interface::{Evaluator, Precision};
use super::points::{LengthError, Points, check_grid};
use super::vector::{evaluate, grid, native, rounded};
use crate::family::{AnyBrdf, each};

/// The model in `f32` at many points, by the same formula, which is accurate in `f32` because no term
/// of it cancels.
///
/// Domain: k1 in [1e-4, 1e4], n up to 1e3 and cosines of the zenith angles from 1e-3 (89.94 deg);
/// outside, products exceed the range of `f32`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Single {
    brdf: AnyBrdf,
}

impl Single {
    /// An evaluator of the BRDF.
    pub fn new(brdf: AnyBrdf) -> Self {
        Self { brdf }
    }

    /// [`Double::grid`](super::Double::grid) in `f32`.
    ///
    /// # Errors
    ///
    /// [`LengthError`] if theta and phi, or `out` and the grid, have different lengths.
    pub fn grid(
        &self,
        psi: &[f32],
        theta: &[f32],
        phi: &[f32],
        out: &mut [f32],
    ) -> Result<(), LengthError> {
        check_grid(psi.len(), theta.len(), phi.len(), out.len())?;
        each!(&self.brdf, brdf => grid(*brdf, psi, theta, phi, out));
        Ok(())
    }
}

impl Evaluator for Single {
    fn name(&self) -> &'static str {
        "f32"
    }

    fn precision(&self) -> Precision {
        Precision::Single
    }

    fn values(&self, points: &Points<f64>, out: &mut [f64]) -> Result<(), LengthError> {
        each!(&self.brdf, brdf => {
            rounded(points, out, |points: &Points<f32>, out| evaluate(*brdf, points, out))
        })
    }

    fn values_f32(&self, points: &Points<f32>, out: &mut [f32]) -> Result<(), LengthError> {
        each!(&self.brdf, brdf => native(points, out, |points, out| evaluate(*brdf, points, out)))
    }
}

/// The specular part alone in `f32`, for surfaces without a Lambertian part and for scenes in which it
/// is negligible beside the specular part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpecularOnly {
    specular: Single,
}

impl SpecularOnly {
    /// An evaluator of the specular part of the BRDF.
    pub fn new(brdf: &AnyBrdf) -> Self {
        Self {
            specular: Single::new(brdf.with_kd(0.0)),
        }
    }
}

impl Evaluator for SpecularOnly {
    fn name(&self) -> &'static str {
        "specular-only"
    }

    fn precision(&self) -> Precision {
        Precision::Single
    }

    fn values(&self, points: &Points<f64>, out: &mut [f64]) -> Result<(), LengthError> {
        self.specular.values(points, out)
    }

    fn values_f32(&self, points: &Points<f32>, out: &mut [f32]) -> Result<(), LengthError> {
        self.specular.values_f32(points, out)
    }
}
