//! Quantities of the whole surface: the hemispherical reflectance, energy conservation, the facet
//! reflectance that k2 implies, and the laser radar cross-section.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use crate::brdf::MicrofacetBrdf;
use crate::facet::FacetDistribution;
use crate::fresnel::Dielectric;
use crate::geometry::{Geometry, GeometryError};
use crate::numeric::{Adaptive, Quadrature, Rough};
use crate::parameters::Parameters;
use crate::shadowing::Shadowing;

/// The largest incidence angle of the energy check, in radians (89 deg).
pub const ENERGY_CHECK_LIMIT: f64 = 89.0 * PI / 180.0;

/// The relative tolerance of the reflectances in the energy check. The actual errors are far smaller.
const ENERGY_CHECK_TOLERANCE: f64 = 1e-3;

/// The number of steps of the energy check up to its limit. The reflectance is a smooth function of
/// the incidence angle without narrow features, so that steps of 5.6 deg suffice.
const ENERGY_CHECK_STEPS: u32 = 16;

/// The number of angles at which the energy check computes rough reflectances first.
const ROUGH_STEPS: u32 = 5;

/// No reflectance exceeds 1 where all rough ones are below this.
const SURELY_BELOW_ONE: f64 = 0.7;

impl<F: FacetDistribution, S: Shadowing> MicrofacetBrdf<F, S> {
    /// The directional-hemispherical reflectance, dimensionless: the integral of f_r cos theta over
    /// the hemisphere of views for the incidence psi in [0, pi/2), in radians.
    ///
    /// rho(psi) = k2 [`specular_reflectance`]`(psi) + kD`, to the relative `tolerance`.
    ///
    /// # Errors
    ///
    /// [`GeometryError::Incidence`] if psi is not in [0, pi/2).
    ///
    /// # Examples
    ///
    /// ```
    /// use brdf_core::{Parameters, ThreeParameterBrdf};
    ///
    /// let brdf = ThreeParameterBrdf::new(Parameters::new(1.211, 0.521, 0.071)?, 1.60)?;
    /// let rho = brdf.hemispherical_reflectance(0.0, 1e-6)?;
    /// assert!((rho - 0.62).abs() < 0.005);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn hemispherical_reflectance(
        &self,
        psi: f64,
        tolerance: f64,
    ) -> Result<f64, GeometryError> {
        let parameters = self.parameters();
        let specular = specular_reflectance(
            self.facet(),
            self.shadowing(),
            &self.fresnel(),
            psi,
            tolerance,
        )?;
        Ok(parameters.k2 * specular + parameters.kd)
    }

    /// The smallest incidence angle psi, in radians, above which the hemispherical reflectance exceeds
    /// 1, or `None` if it does not exceed 1 up to [`ENERGY_CHECK_LIMIT`].
    ///
    /// A reflectance above 1 violates the conservation of energy.
    pub fn energy_violation_angle(&self) -> Option<f64> {
        if self.reflectance_bound() < 1.0 || self.is_surely_below_one() {
            return None;
        }
        let excess = |psi: f64| {
            self.hemispherical_reflectance(psi, ENERGY_CHECK_TOLERANCE)
                .is_ok_and(|rho| rho > 1.0)
        };
        if excess(0.0) {
            return Some(0.0);
        }
        let angle =
            |step: u32| ENERGY_CHECK_LIMIT * f64::from(step) / f64::from(ENERGY_CHECK_STEPS);
        let first = (1..=ENERGY_CHECK_STEPS).find(|&step| excess(angle(step)))?;
        let (mut below, mut above) = (angle(first - 1), angle(first));
        while above - below > 1e-4 {
            let middle = 0.5 * (below + above);
            if excess(middle) {
                above = middle;
            } else {
                below = middle;
            }
        }
        Some(above)
    }

    /// Whether rough reflectances at a few angles of the energy check are so far below 1 that no other
    /// exceeds it: the reflectance is smooth, and the rough ones are within a few percent.
    fn is_surely_below_one(&self) -> bool {
        let Parameters { k2, kd, .. } = self.parameters();
        let mut angles = (0..ROUGH_STEPS)
            .map(|step| ENERGY_CHECK_LIMIT * (1.0 - f64::from(step) / f64::from(ROUGH_STEPS - 1)));
        angles.all(|psi| {
            let (facet, shadowing) = (self.facet(), self.shadowing());
            let specular = specular_part(facet, shadowing, &self.fresnel(), psi, &Rough);
            k2 * specular + kd < SURELY_BELOW_ONE
        })
    }

    /// A bound that no hemispherical reflectance exceeds: kD + 2 R(0)/R_n(0), with the facet
    /// reflectance R(0) that k2 implies and that of the refractive index, R_n(0).
    ///
    /// In the integral over the facet normals, D G cos gamma / cos psi, the shadowing is at most
    /// 2 cos alpha cos psi / cos gamma, the projected areas D cos alpha add up to 1, and the Fresnel
    /// factor is at most 1/R_n(0).
    fn reflectance_bound(&self) -> f64 {
        let facets = self.implied_facet_reflectance() / self.fresnel().normal_reflectance();
        self.parameters().kd + 2.0 * facets
    }

    /// The facet reflectance at normal incidence that k2 = (pi/4) f(0) R(0) implies, dimensionless:
    /// R(0) = 4 k2 / (pi f(0)), with f(0) from the
    /// [normalisation](FacetDistribution::peak_density).
    ///
    /// The Fresnel equations give ((n-1)/(n+1))^2 for it.
    pub fn implied_facet_reflectance(&self) -> f64 {
        4.0 * self.parameters().k2 / (PI * self.facet().peak_density())
    }

    /// The laser radar cross-section of a unit area, sigma0 = 4 pi f_r cos psi cos theta,
    /// dimensionless (m^2 per m^2). The monostatic cross-section is that at theta = psi, phi = 0.
    pub fn unit_area_cross_section(&self, geometry: &Geometry) -> f64 {
        4.0 * PI * self.value(geometry) * (geometry.cos_psi * geometry.cos_theta)
    }
}

/// The hemispherical reflectance of the specular part for k2 = 1 at the incidence psi in [0, pi/2), in
/// radians, to the relative `tolerance`. Dimensionless.
///
/// The integral is over the facet normals (tilt alpha, azimuth beta), in which the peak does not
/// depend on psi: d omega of the view is 4 cos gamma times that of the facet normal. With
/// t = tan^2 alpha, sin alpha d alpha is 1/2 cos^3 alpha dt, and the substitution
/// tan alpha = w sinh u with w = min(k1, 1) makes the distribution smooth for any k1.
///
/// The integrand ends at the horizon and has kinks where the V-groove shadowing changes its branch.
/// For a given alpha each of these is at a known cos gamma, hence at a known beta, and enters or
/// leaves the range of beta at a known alpha. The panels of the integration end there.
///
/// # Errors
///
/// [`GeometryError::Incidence`] if psi is not in [0, pi/2).
pub fn specular_reflectance<F: FacetDistribution, S: Shadowing>(
    facet: F,
    shadowing: S,
    fresnel: &Dielectric,
    psi: f64,
    tolerance: f64,
) -> Result<f64, GeometryError> {
    if !(0.0..=FRAC_PI_2).contains(&psi) {
        return Err(GeometryError::Incidence(psi));
    }
    Ok(specular_part(
        facet,
        shadowing,
        fresnel,
        psi,
        &Adaptive(tolerance),
    ))
}

/// [`specular_reflectance`] for psi in [0, pi/2).
fn specular_part(
    facet: impl FacetDistribution,
    shadowing: impl Shadowing,
    fresnel: &Dielectric,
    psi: f64,
    quadrature: &impl Quadrature,
) -> f64 {
    let width = facet.k1().min(1.0);
    let ring = |u: f64| {
        let (sinh, cosh) = (u.sinh(), u.cosh());
        let t = (width * sinh).powi(2);
        let sec_alpha = (1.0 + t).sqrt();
        // Half of dt cos^3 alpha.
        let area = width * width * sinh * cosh / (sec_alpha * (1.0 + t));
        facet.relative(t, sec_alpha)
            * area
            * facet_ring(shadowing, fresnel, psi, t, &quadrature.of_values())
    };
    let mut breaks = [
        0.0,
        (FRAC_PI_2 - psi) / 3.0,
        FRAC_PI_4 - 0.5 * psi,
        FRAC_PI_2 - psi,
        psi,
        (FRAC_PI_2 + psi) / 3.0,
        FRAC_PI_4 + 0.5 * psi,
    ]
    // Steeper facets reflect no light above the horizon.
    .map(|alpha: f64| alpha.min(FRAC_PI_4 + 0.5 * psi))
    .map(|alpha| (alpha.tan() / width).asinh());
    breaks.sort_by(f64::total_cmp);
    8.0 / PI * quadrature.integrate(&ring, breaks)
}

/// The integral over beta in [0, pi] of cos gamma R0(gamma) G / cos psi, for the facets of one
/// tilt with t = tan^2 alpha.
fn facet_ring(
    shadowing: impl Shadowing,
    fresnel: &Dielectric,
    psi: f64,
    t: f64,
    quadrature: &impl Quadrature,
) -> f64 {
    let cos_alpha = 1.0 / (1.0 + t).sqrt();
    let sin_alpha = t.sqrt() * cos_alpha;
    let (sin_psi, cos_psi) = psi.sin_cos();
    let (offset, amplitude) = (cos_psi * cos_alpha, sin_psi * sin_alpha);
    let facet = |beta: f64| {
        let cos_gamma = offset + amplitude * beta.cos();
        let cos_theta = 2.0 * cos_gamma * cos_alpha - cos_psi;
        if cos_gamma <= 0.0 || cos_theta <= 0.0 {
            return 0.0;
        }
        let seen = shadowing.over_cosines(cos_psi, cos_theta, t) * cos_theta;
        fresnel.relative(cos_gamma) * cos_gamma * seen
    };
    let beta_at = |cos_gamma: f64| {
        let cosine = (cos_gamma - offset) / amplitude;
        if cosine.is_nan() {
            PI
        } else {
            cosine.clamp(-1.0, 1.0).acos()
        }
    };
    let horizon = beta_at(cos_psi / (2.0 * cos_alpha));
    let source_side = beta_at(2.0 * cos_alpha * cos_psi);
    let view_side = beta_at(2.0 * cos_alpha * cos_psi / (4.0 * cos_alpha * cos_alpha - 1.0));
    let equal_angles = beta_at(cos_psi / cos_alpha);
    let mut breaks =
        [0.0, source_side, view_side, equal_angles, horizon].map(|beta: f64| beta.min(horizon));
    breaks.sort_by(f64::total_cmp);
    quadrature.integrate(&facet, breaks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::published::PUBLISHED;
    use crate::{AnyBrdf, Family, ModelParameters, Parameters, ThreeParameterBrdf};

    fn published(sample: &str, wavelength_um: f64) -> ThreeParameterBrdf {
        let row = PUBLISHED
            .iter()
            .find(|row| row.sample == sample && row.wavelength_um == wavelength_um)
            .unwrap();
        ThreeParameterBrdf::new(row.parameters, row.n).unwrap()
    }

    fn reflectance(brdf: &ThreeParameterBrdf, psi_deg: f64) -> f64 {
        brdf.hemispherical_reflectance(psi_deg.to_radians(), 1e-6)
            .unwrap()
    }

    /// The defining integral over view directions by the midpoint rule. It is slow and for broad lobes
    /// only, but independent of the integral over facets.
    fn by_views(value: impl Fn(&Geometry) -> f64, psi: f64, steps: u32) -> f64 {
        let count = f64::from(steps);
        let mut sum = 0.0;
        for i in 0..steps {
            let theta = FRAC_PI_2 * (f64::from(i) + 0.5) / count;
            for j in 0..steps {
                let phi = PI * (f64::from(j) + 0.5) / count;
                let geometry = Geometry::new(psi, theta, phi).unwrap();
                sum += value(&geometry) * theta.cos() * theta.sin();
            }
        }
        2.0 * sum * (FRAC_PI_2 / count) * (PI / count)
    }

    #[test]
    fn published_samples_have_the_known_reflectances() {
        let known = [
            (
                "002",
                1.04,
                [(0.0, 0.82), (60.0, 1.11), (70.0, 1.34), (80.0, 1.87)],
            ),
            (
                "002",
                0.62,
                [(0.0, 0.54), (60.0, 0.84), (70.0, 1.07), (80.0, 1.60)],
            ),
            (
                "001",
                0.91,
                [(0.0, 0.62), (60.0, 0.71), (70.0, 0.81), (80.0, 1.03)],
            ),
        ];
        for (sample, wavelength, angles) in known {
            for (psi_deg, expected) in angles {
                let rho = reflectance(&published(sample, wavelength), psi_deg);
                assert!((rho - expected).abs() <= 0.005, "{sample} {psi_deg}: {rho}");
            }
        }
    }

    #[test]
    fn agrees_with_the_integral_over_views() {
        for (k1, n) in [
            (0.3, 1.5),
            (0.9, 1.62),
            (1.338, 1.56),
            (40.0, 1.5),
            (0.5, 1.0),
        ] {
            let brdf = ThreeParameterBrdf::new(Parameters::new(0.5, 0.1, k1).unwrap(), n).unwrap();
            for psi_deg in [0.0_f64, 20.0, 55.0, 75.0] {
                let psi = psi_deg.to_radians();
                let ratio = reflectance(&brdf, psi_deg) / by_views(|g| brdf.value(g), psi, 1000);
                assert!((ratio - 1.0).abs() < 2e-5, "{k1} {n} {psi_deg}: {ratio}");
            }
        }
    }

    #[test]
    fn all_families_agree_with_the_integral_over_views() {
        for family in Family::ALL {
            let at = ModelParameters {
                k2: 0.5,
                kd: 0.1,
                k1: 0.4,
                n: 1.5,
                p: 1.7,
            };
            let brdf = AnyBrdf::new(family, &at).unwrap();
            for psi_deg in [0.0_f64, 20.0, 55.0, 75.0] {
                let psi = psi_deg.to_radians();
                let rho = brdf.hemispherical_reflectance(psi, 1e-6).unwrap();
                let ratio = rho / by_views(|g| brdf.value(g), psi, 1000);
                assert!((ratio - 1.0).abs() < 2e-5, "{family:?} {psi_deg}: {ratio}");
            }
        }
    }

    #[test]
    fn the_tolerance_is_kept() {
        for k1 in [1e-8, 1e-3, 0.1, 1.0, 30.0, 1e8] {
            let brdf =
                ThreeParameterBrdf::new(Parameters::new(1.0, 0.0, k1).unwrap(), 1.5).unwrap();
            for psi_deg in [0.0_f64, 10.0, 60.0, 85.0, 89.9] {
                let at = |tolerance| {
                    brdf.hemispherical_reflectance(psi_deg.to_radians(), tolerance)
                        .unwrap()
                };
                let (rough, fine) = (at(1e-5), at(1e-10));
                assert!(
                    (rough / fine - 1.0).abs() < 1e-5,
                    "{k1} {psi_deg}: {rough} {fine}"
                );
            }
        }
    }

    #[test]
    fn rough_reflectances_decide_as_the_search_does() {
        for family in Family::ALL {
            for k1 in [1e-6, 1e-3, 0.03, 0.1, 0.3, 0.7, 1.0, 3.0, 30.0, 1e3] {
                for n in [1.0, 1.01, 1.5, 2.5, 6.0, 1e3] {
                    let at = ModelParameters {
                        k2: 1.0,
                        kd: 0.0,
                        k1,
                        n,
                        p: 1.3,
                    };
                    assert_rough_check_is_safe(&AnyBrdf::new(family, &at).unwrap(), &at);
                }
            }
        }
    }

    /// Scales a lobe so that its largest rough reflectance is the threshold: no other is above 1.
    fn assert_rough_check_is_safe(brdf: &AnyBrdf, at: &ModelParameters) {
        let rho = |psi: f64| brdf.hemispherical_reflectance(psi, 1e-2).unwrap();
        let rough = (0..ROUGH_STEPS)
            .map(|step| rho(ENERGY_CHECK_LIMIT * f64::from(step) / f64::from(ROUGH_STEPS - 1)));
        let rough = rough.fold(0.0, f64::max);
        let fine = (0..30).map(|step| rho(ENERGY_CHECK_LIMIT * f64::from(step) / 29.0));
        let fine = fine.fold(0.0, f64::max);
        assert!(
            fine / rough * SURELY_BELOW_ONE < 0.95,
            "{at:?}: {rough} {fine}"
        );
    }

    #[test]
    fn rough_reflectances_are_near_the_others() {
        for k1 in [1e-6, 1e-3, 0.1, 1.0, 30.0, 1e6] {
            for n in [1.0, 1.5, 4.0] {
                let brdf =
                    ThreeParameterBrdf::new(Parameters::new(1.0, 0.0, k1).unwrap(), n).unwrap();
                for psi_deg in [0.0_f64, 22.25, 44.5, 66.75, 89.0] {
                    let psi = psi_deg.to_radians();
                    let (facet, shadowing) = (brdf.facet(), brdf.shadowing());
                    let rough = specular_part(facet, shadowing, &brdf.fresnel(), psi, &Rough);
                    let ratio = rough / reflectance(&brdf, psi_deg);
                    assert!((ratio - 1.0).abs() < 0.05, "{k1} {n} {psi_deg}: {ratio}");
                }
            }
        }
    }

    #[test]
    fn a_lambertian_surface_reflects_its_weight() {
        let brdf = ThreeParameterBrdf::new(Parameters::new(0.0, 0.3, 1.0).unwrap(), 1.5).unwrap();
        assert_eq!(reflectance(&brdf, 40.0), 0.3);
        assert_eq!(brdf.energy_violation_angle(), None);
    }

    #[test]
    fn sample_002_violates_energy_conservation_from_between_50_and_60_degrees() {
        let brdf = published("002", 1.04);
        let angle = brdf.energy_violation_angle().unwrap();
        assert!((50.0..60.0).contains(&angle.to_degrees()));
        let at = |psi| brdf.hemispherical_reflectance(psi, 1e-8).unwrap();
        assert!((at(angle) - 1.0).abs() < 1e-4);
        assert!(at(angle - 0.01) < 1.0);
    }

    #[test]
    fn the_implied_facet_reflectance_is_the_known_value() {
        let at = |sample, wavelength| published(sample, wavelength).implied_facet_reflectance();
        assert!((at("001", 0.91) - 0.1151).abs() < 5e-5);
        assert!((at("003", 1.04) - 0.0653).abs() < 5e-5);
    }

    #[test]
    fn the_cross_section_contains_both_cosines() {
        let brdf = published("001", 0.91);
        let retro = Geometry::in_plane(0.5, 0.5).unwrap();
        let sigma0 = 4.0 * PI * brdf.value(&retro) * 0.5_f64.cos().powi(2);
        assert!((brdf.unit_area_cross_section(&retro) / sigma0 - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_divergent_integral_terminates() {
        // At n = 1 the Fresnel factor is unbounded at grazing.
        let brdf = ThreeParameterBrdf::new(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.0).unwrap();
        assert!(brdf.hemispherical_reflectance(FRAC_PI_2, 1e-3).unwrap() > 1e6);
    }

    #[test]
    fn an_incidence_outside_the_domain_is_an_error() {
        let brdf = published("001", 0.91);
        assert_eq!(
            brdf.hemispherical_reflectance(1.6, 1e-6),
            Err(GeometryError::Incidence(1.6))
        );
    }

    #[test]
    fn no_reflectance_exceeds_its_bound() {
        for family in Family::ALL {
            for k1 in [0.01, 0.2, 1.0, 3.0] {
                for n in [1.05, 1.5, 3.0] {
                    let at = ModelParameters {
                        k2: 0.1,
                        kd: 0.1,
                        k1,
                        n,
                        p: 1.3,
                    };
                    let brdf = AnyBrdf::new(family, &at).unwrap();
                    let bound = 0.1
                        + 2.0 * brdf.implied_facet_reflectance()
                            / Dielectric::new(n).normal_reflectance();
                    for psi_deg in [0.0_f64, 40.0, 70.0, 85.0, 89.0] {
                        let rho = brdf.hemispherical_reflectance(psi_deg.to_radians(), 1e-3);
                        let rho = rho.unwrap();
                        assert!(rho <= bound, "{family:?} {k1} {n} {psi_deg}: {rho} {bound}");
                    }
                }
            }
        }
    }
}
