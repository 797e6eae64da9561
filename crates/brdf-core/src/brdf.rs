//! The three-parameter model of eq. (3) and (4), and models of the same form with other terms.

use std::f64::consts::FRAC_1_PI;

use crate::direction_pair::HalfVector;
use crate::facet::{Ellipsoid, FacetDistribution};
use crate::fresnel::Dielectric;
use crate::geometry::Geometry;
use crate::numeric::{Ratio, Real};
use crate::parameters::{ParameterError, Parameters, check_refractive_index};
use crate::shadowing::{Shadowing, VGroove};

/// The BRDF of a facet distribution, a shadowing function, the Fresnel factor and a Lambertian part:
///
/// ```text
/// f_r = (k2/pi) f(alpha)/f(0) R0(gamma) G / (cos psi cos theta) + kD/pi      [1/sr]
/// ```
///
/// f(alpha)/f(0) is the [facet distribution](crate::facet), R0 the [Fresnel
/// factor](crate::fresnel::Dielectric::relative) and G the [shadowing](crate::shadowing). The
/// function is reciprocal to the last bit.
///
/// The terms are chosen at compile time, so that the choice costs nothing in a loop;
/// [`AnyBrdf`](crate::AnyBrdf) chooses at run time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MicrofacetBrdf<F, S> {
    k2: f64,
    kd: f64,
    facet: F,
    shadowing: S,
    fresnel: Dielectric,
}

/// The BRDF of Li, Yan and Wu, eq. (4): [the ellipsoid](Ellipsoid) of facets with the [V-groove
/// shadowing](VGroove).
///
/// ```
/// use brdf_core::{Geometry, Parameters, ThreeParameterBrdf};
///
/// let brdf = ThreeParameterBrdf::new(Parameters::new(1.211, 0.521, 0.071)?, 1.60)?;
/// let mirror = Geometry::in_plane(30_f64.to_radians(), -30_f64.to_radians())?;
/// assert!((brdf.value(&mirror) - 0.6962).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type ThreeParameterBrdf = MicrofacetBrdf<Ellipsoid, VGroove>;

impl ThreeParameterBrdf {
    /// The model with the given parameters and the refractive index n in
    /// [`N_DOMAIN`](crate::N_DOMAIN), relative to air.
    ///
    /// # Errors
    ///
    /// [`ParameterError`] for a parameter outside its domain.
    pub fn new(parameters: Parameters, n: f64) -> Result<Self, ParameterError> {
        Self::from_terms(parameters, n, Ellipsoid::new, |_| VGroove)
    }
}

impl<F: FacetDistribution, S: Shadowing> MicrofacetBrdf<F, S> {
    /// The model with the given parameters and refractive index n. The terms are functions of the
    /// width k1.
    pub(crate) fn from_terms(
        parameters: Parameters,
        n: f64,
        facet: impl FnOnce(f64) -> F,
        shadowing: impl FnOnce(f64) -> S,
    ) -> Result<Self, ParameterError> {
        // The fields are public and may have been changed since they were checked.
        let Parameters { k2, kd, k1 } =
            Parameters::new(parameters.k2, parameters.kd, parameters.k1)?;
        Ok(Self {
            k2,
            kd,
            facet: facet(k1),
            shadowing: shadowing(k1),
            fresnel: Dielectric::new(check_refractive_index(n)?),
        })
    }

    /// The parameters k2, kD and k1.
    pub fn parameters(&self) -> Parameters {
        Parameters {
            k2: self.k2,
            kd: self.kd,
            k1: self.facet.k1(),
        }
    }

    /// The refractive index n.
    pub fn n(&self) -> f64 {
        self.fresnel.n()
    }

    /// f_r in 1/sr, eq. (4).
    #[inline]
    pub fn value(&self, geometry: &Geometry) -> f64 {
        let (psi, theta) = (geometry.cos_psi, geometry.cos_theta);
        let fresnel = self.fresnel.ratio_at(geometry);
        self.with_fresnel(fresnel, psi, theta, geometry.cos_gamma, &geometry.half())
    }

    /// f_r in any kind of number, with any form of the Fresnel factor, by one division.
    #[inline]
    pub(crate) fn with_fresnel<R: Real>(
        &self,
        fresnel: Ratio<R>,
        cos_psi: R,
        cos_theta: R,
        cos_gamma: R,
        half: &HalfVector<R>,
    ) -> R {
        let facet = self.facet.ratio(half);
        let shadowing = self.shadowing.ratio(cos_psi, cos_theta, cos_gamma, half);
        let specular = (facet * shadowing * fresnel).value();
        specular.mul_add(R::of(self.k2 * FRAC_1_PI), R::of(self.kd * FRAC_1_PI))
    }

    /// The derivatives of f_r with respect to (k2, kD, k1), in 1/sr.
    #[inline]
    pub fn gradient(&self, geometry: &Geometry) -> [f64; 3] {
        let (t, sec) = (geometry.tan2_alpha, geometry.sec_alpha);
        let fresnel = self.fresnel.ratio_at(geometry).value() * FRAC_1_PI;
        let shadowing = self.shadowing.over_cosines_at(geometry);
        let facet = self.facet.relative(t, sec);
        let mut by_k1 = self.facet.derivative_k1(t, sec) * (shadowing * fresnel);
        if S::DEPENDS_ON_WIDTH {
            let (psi, theta) = (geometry.cos_psi, geometry.cos_theta);
            by_k1 += facet * fresnel * self.shadowing.over_cosines_derivative_k1(psi, theta, t);
        }
        [facet * (shadowing * fresnel), FRAC_1_PI, self.k2 * by_k1]
    }

    /// The derivative of f_r with respect to the refractive index n, in 1/sr.
    #[inline]
    pub fn derivative_n(&self, geometry: &Geometry) -> f64 {
        let fresnel_slope = self
            .fresnel
            .relative_derivative_n(geometry.cos_gamma, geometry.sin2_gamma);
        FRAC_1_PI
            * self.k2
            * self.facet.relative(geometry.tan2_alpha, geometry.sec_alpha)
            * fresnel_slope
            * self.shadowing.over_cosines_at(geometry)
    }

    /// The derivative of f_r with respect to the exponent p, in 1/sr; 0 for a distribution without
    /// one.
    #[inline]
    pub fn derivative_p(&self, geometry: &Geometry) -> f64 {
        FRAC_1_PI
            * self.k2
            * self
                .facet
                .derivative_p(geometry.tan2_alpha, geometry.sec_alpha)
            * self.fresnel.ratio_at(geometry).value()
            * self.shadowing.over_cosines_at(geometry)
    }

    /// The scattered radiant intensity for unit flux, K = f_r cos theta in 1/sr, eq. (3).
    #[inline]
    pub fn radiant_intensity(&self, geometry: &Geometry) -> f64 {
        self.value(geometry) * geometry.cos_theta
    }

    pub(crate) fn facet(&self) -> F {
        self.facet
    }

    pub(crate) fn shadowing(&self) -> S {
        self.shadowing
    }

    pub(crate) fn set_kd(&mut self, kd: f64) {
        self.kd = kd;
    }

    pub(crate) fn fresnel(&self) -> Dielectric {
        self.fresnel
    }
}

/// The factor R0(gamma) G / (cos psi cos theta) of the paper's specular part, dimensionless.
///
/// It depends on n and the geometry alone, and is the whole specular part for k2 = pi at alpha = 0.
#[inline]
pub fn mirror_factor(fresnel: &Dielectric, geometry: &Geometry) -> f64 {
    fresnel.ratio_at(geometry).value() * VGroove.over_cosines_at(geometry)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use proptest::prelude::*;

    use super::*;

    fn brdf(k2: f64, kd: f64, k1: f64, n: f64) -> ThreeParameterBrdf {
        ThreeParameterBrdf::new(Parameters::new(k2, kd, k1).unwrap(), n).unwrap()
    }

    /// Models over the whole domain of k1 and n with usual weights.
    fn any_brdf() -> impl Strategy<Value = ThreeParameterBrdf> {
        (1e-4..10.0, 0.0..1.0, -18.4..18.4_f64, -16.0..11.5_f64)
            .prop_map(|(k2, kd, log_k1, log_n)| brdf(k2, kd, log_k1.exp(), 1.0 + log_n.exp()))
    }

    #[test]
    fn normal_incidence_and_view_give_the_sum_of_the_weights() {
        let normal = Geometry::in_plane(0.0, 0.0).unwrap();
        let value = brdf(0.3, 0.2, 0.15, 1.5).value(&normal);
        assert!((value - 0.5 / PI).abs() < 1e-16);
    }

    #[test]
    fn without_a_specular_weight_the_surface_is_lambertian() {
        let geometry = Geometry::new(0.4, 1.2, 2.0).unwrap();
        assert_eq!(brdf(0.0, 0.25, 0.15, 1.5).value(&geometry), 0.25 / PI);
    }

    #[test]
    fn the_radiant_intensity_contains_the_view_cosine() {
        let brdf = brdf(0.3, 0.2, 0.15, 1.5);
        let geometry = Geometry::in_plane(0.3, 0.5).unwrap();
        let expected = brdf.value(&geometry) * 0.5_f64.cos();
        assert_eq!(brdf.radiant_intensity(&geometry), expected);
    }

    #[test]
    fn parameters_outside_the_domain_are_named() {
        let message = |k2, kd, k1| Parameters::new(k2, kd, k1).unwrap_err().to_string();
        assert!(message(-1.0, 0.0, 1.0).contains("k2 = -1"));
        assert!(message(0.0, f64::NAN, 1.0).contains("kD = NaN"));
        assert!(message(0.0, 0.0, 0.0).contains("k1 = 0"));
        assert!(message(0.0, 0.0, f64::INFINITY).contains("k1 = inf"));
        let parameters = Parameters::new(1.0, 0.0, 1.0).unwrap();
        let error = ThreeParameterBrdf::new(parameters, 0.9).unwrap_err();
        assert!(error.to_string().contains("n = 0.9"));
        let changed = Parameters {
            k1: -1.0,
            ..parameters
        };
        assert_eq!(
            ThreeParameterBrdf::new(changed, 1.5),
            Err(ParameterError::K1(-1.0))
        );
    }

    proptest! {
        #[test]
        fn is_reciprocal(
            brdf in any_brdf(), psi in 0.0..FRAC_PI_2, theta in 0.0..FRAC_PI_2, phi in -7.0..7.0_f64,
        ) {
            let there = Geometry::new(psi, theta, phi).unwrap();
            let back = Geometry::new(theta, psi, phi).unwrap();
            prop_assert_eq!(brdf.value(&there), brdf.value(&back));
        }

        #[test]
        fn is_positive_and_finite(
            brdf in any_brdf(), psi in 0.0..=FRAC_PI_2, theta in 0.0..=FRAC_PI_2, phi in -7.0..7.0_f64,
        ) {
            let geometry = Geometry::new(psi, theta, phi).unwrap();
            prop_assert!(brdf.value(&geometry) >= 0.0 && brdf.value(&geometry).is_finite());
            prop_assert!(brdf.gradient(&geometry).iter().all(|d| d.is_finite() && *d >= 0.0));
            prop_assert!(brdf.derivative_n(&geometry).is_finite());
        }

        #[test]
        fn grows_with_each_weight(
            psi in 0.0..1.57, theta in 0.0..1.57, phi in 0.0..6.3_f64, more in 1e-3..1.0,
        ) {
            let geometry = Geometry::new(psi, theta, phi).unwrap();
            let value = brdf(0.3, 0.2, 0.2, 1.5).value(&geometry);
            prop_assert!(brdf(0.3 + more, 0.2, 0.2, 1.5).value(&geometry) > value);
            prop_assert!(brdf(0.3, 0.2 + more, 0.2, 1.5).value(&geometry) > value);
        }

        #[test]
        fn the_gradient_is_the_derivative_of_the_value(
            k2 in 0.01..3.0, kd in 0.01..1.0, log_k1 in -4.0..2.0_f64, n in 1.1..4.0,
            psi in 0.0..1.5, theta in -1.5..1.5,
        ) {
            let k1 = log_k1.exp();
            let geometry = Geometry::in_plane(psi, theta).unwrap();
            let at = |k2, kd, k1, n| brdf(k2, kd, k1, n).value(&geometry);
            let central = |up: f64, down: f64, step: f64| (up - down) / (2.0 * step);
            let h = 1e-6;
            let [dk2, dkd, dk1] = brdf(k2, kd, k1, n).gradient(&geometry);
            let dn = brdf(k2, kd, k1, n).derivative_n(&geometry);
            let by_k2 = central(at(k2 + h * k2, kd, k1, n), at(k2 - h * k2, kd, k1, n), h * k2);
            let by_kd = central(at(k2, kd + h * kd, k1, n), at(k2, kd - h * kd, k1, n), h * kd);
            let by_k1 = central(at(k2, kd, k1 + h * k1, n), at(k2, kd, k1 - h * k1, n), h * k1);
            let by_n = central(at(k2, kd, k1, n + h), at(k2, kd, k1, n - h), h);
            let tolerance = 1e-8 * at(k2, kd, k1, n);
            prop_assert!((dk2 - by_k2).abs() < tolerance / k2.min(1.0));
            prop_assert!((dkd - by_kd).abs() < tolerance / kd.min(1.0));
            prop_assert!((dk1 - by_k1).abs() < tolerance / k1.min(1.0));
            prop_assert!((dn - by_n).abs() < tolerance * 10.0);
        }
    }
}
