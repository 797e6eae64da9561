//! The model in `f32` with a polynomial as its Fresnel factor.

use super::formula::Formula;
use super::interface::{Evaluator, Precision};
use super::points::{LengthError, Points};
use super::vector::{evaluate, native, rounded};
use crate::brdf::MicrofacetBrdf;
use crate::direction_pair::DirectionPair;
use crate::facet::FacetDistribution;
use crate::family::{AnyBrdf, each};
use crate::fresnel::{FresnelFactor, FresnelPolynomial};
use crate::numeric::Real;
use crate::shadowing::Shadowing;

/// The number of coefficients of the polynomial that is used if its error allows it.
const FEW: usize = 7;

/// The number of coefficients of the polynomial that is used otherwise.
const MANY: usize = 11;

/// The model in `f32`, with a polynomial in cos gamma in place of the root and the ratios of the
/// Fresnel factor. The error of the polynomial has a known [bound](Self::fresnel_error_bound).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedFresnel {
    brdf: AnyBrdf,
    polynomial: Polynomial,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Polynomial {
    Few(FresnelPolynomial<FEW>),
    Many(FresnelPolynomial<MANY>),
}

impl FittedFresnel {
    /// An evaluator whose Fresnel factor has a relative error of at most `tolerance` for cos gamma
    /// in [`least_cos_gamma`, 1].
    ///
    /// It is `None` if no polynomial up to the degree 10 is that accurate, which happens for n near
    /// 1, because R0 then rises too steeply towards grazing.
    pub fn new(brdf: AnyBrdf, least_cos_gamma: f64, tolerance: f64) -> Option<Self> {
        let fresnel = brdf.fresnel();
        let few = FresnelPolynomial::new(&fresnel, least_cos_gamma);
        let polynomial = if few.error_bound() <= tolerance {
            Polynomial::Few(few)
        } else {
            let many = FresnelPolynomial::new(&fresnel, least_cos_gamma);
            if many.error_bound() > tolerance {
                return None;
            }
            Polynomial::Many(many)
        };
        Some(Self { brdf, polynomial })
    }

    /// A bound of the relative error of the polynomial.
    pub fn fresnel_error_bound(&self) -> f64 {
        match &self.polynomial {
            Polynomial::Few(polynomial) => polynomial.error_bound(),
            Polynomial::Many(polynomial) => polynomial.error_bound(),
        }
    }

    fn evaluate(&self, points: &Points<f32>, out: &mut [f32]) {
        each!(self.brdf, brdf => match self.polynomial {
            Polynomial::Few(fresnel) => evaluate(WithFresnel { brdf, fresnel }, points, out),
            Polynomial::Many(fresnel) => evaluate(WithFresnel { brdf, fresnel }, points, out),
        });
    }
}

/// A BRDF with another Fresnel factor.
#[derive(Clone, Copy)]
struct WithFresnel<B, X> {
    brdf: B,
    fresnel: X,
}

impl<F: FacetDistribution, S: Shadowing, X: FresnelFactor> Formula
    for WithFresnel<MicrofacetBrdf<F, S>, X>
{
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "it is part of vector code")]
    fn at<R: Real>(&self, pair: &DirectionPair<R>) -> R {
        let half = &pair.half;
        let fresnel = self.fresnel.ratio(half.length, half.length2);
        let (psi, theta) = (pair.cos_psi, pair.cos_theta);
        let value = self
            .brdf
            .with_fresnel(fresnel, psi, theta, half.length, half);
        pair.if_above_surface(value)
    }
}

impl Evaluator for FittedFresnel {
    fn name(&self) -> &'static str {
        "f32-fitted-fresnel"
    }

    fn precision(&self) -> Precision {
        Precision::Single
    }

    fn values(&self, points: &Points<f64>, out: &mut [f64]) -> Result<(), LengthError> {
        rounded(points, out, |points, out| self.evaluate(points, out))
    }

    fn values_f32(&self, points: &Points<f32>, out: &mut [f32]) -> Result<(), LengthError> {
        native(points, out, |points, out| self.evaluate(points, out))
    }
}
