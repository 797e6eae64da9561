//! What a whole surface does with the light: hemispherical reflectance, whether it stays below 1,
//! the facet reflectance that k2 implies, and the laser radar cross-section.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use crate::brdf::MicrofacetBrdf;
use crate::facet::FacetDistribution;
use crate::fresnel::Dielectric;
use crate::geometry::{Geometry, GeometryError};
use crate::numeric::integrate;
use crate::shadowing::Shadowing;

/// Up to this incidence angle the energy check looks for a reflectance above 1, in radians
/// (89 deg).
pub const ENERGY_CHECK_LIMIT: f64 = 89.0 * PI / 180.0;

/// Tolerance of the reflectances in the energy check: the estimates are far better than that.
const ENERGY_CHECK_TOLERANCE: f64 = 1e-3;

/// Steps in which the energy check goes up to its limit, 5.6 deg each: the reflectance is a smooth
/// function of the incidence angle without any narrow feature.
const ENERGY_CHECK_STEPS: u32 = 16;

impl<F: FacetDistribution, S: Shadowing> MicrofacetBrdf<F, S> {
    /// Directional-hemispherical reflectance: the integral of f_r cos theta over the hemisphere of
    /// views, for incidence psi in [0, pi/2), in radians. Dimensionless.
    ///
    /// rho(psi) = k2 [`specular_reflectance`]`(psi) + kD`, to the relative `tolerance`.
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

    /// The smallest incidence angle psi, in radians, from which the hemispherical reflectance is
    /// above 1, looked for up to [`ENERGY_CHECK_LIMIT`]; `None` where there is no such angle.
    ///
    /// More than 1 is not possible for a real surface.
    pub fn energy_violation_angle(&self) -> Option<f64> {
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

    /// The facet reflectance at normal incidence that k2 = (pi/4) f(0) R(0) implies,
    /// R(0) = 4 k2 / (pi f(0)), with f(0) from the
    /// [normalisation](FacetDistribution::peak_density).
    ///
    /// To be compared with Fresnel's ((n-1)/(n+1))^2; dimensionless.
    pub fn implied_facet_reflectance(&self) -> f64 {
        4.0 * self.parameters().k2 / (PI * self.facet().peak_density())
    }

    /// Laser radar cross-section of a unit area, sigma0 = 4 pi f_r cos psi cos theta
    /// (dimensionless: m^2 per m^2). The monostatic one is that at theta = psi, phi = 0.
    pub fn unit_area_cross_section(&self, geometry: &Geometry) -> f64 {
        4.0 * PI * self.value(geometry) * (geometry.cos_psi * geometry.cos_theta)
    }
}

/// Hemispherical reflectance of the specular part for k2 = 1 at incidence psi in [0, pi/2), in
/// radians, to the relative `tolerance`. Dimensionless.
///
/// The integral is taken over the facet normals (tilt alpha, azimuth beta), where the peak stands
/// still: d omega of the view is 4 cos gamma times that of the facet normal. With t = tan^2 alpha,
/// sin alpha d alpha is 1/2 cos^3 alpha dt, and tan alpha = w sinh u, w = min(k1, 1), makes the
/// distribution smooth for any k1. The integrand ends at the horizon and has kinks where the
/// V-groove shadowing changes its branch; for a given alpha each lies at a known cos gamma, hence
/// at a known beta, and enters or leaves the range of beta at a known alpha: the panels end there.
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
    let width = facet.k1().min(1.0);
    let ring = |u: f64| {
        let (sinh, cosh) = (u.sinh(), u.cosh());
        let t = (width * sinh).powi(2);
        let sec_alpha = (1.0 + t).sqrt();
        // Half of dt cos^3 alpha.
        let area = width * width * sinh * cosh / (sec_alpha * (1.0 + t));
        facet.relative(t, sec_alpha)
            * area
            * facet_ring(shadowing, fresnel, psi, t, 0.1 * tolerance)
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
    // Beyond the last, no facet sends light above the horizon.
    .map(|alpha: f64| alpha.min(FRAC_PI_4 + 0.5 * psi))
    .map(|alpha| (alpha.tan() / width).asinh());
    breaks.sort_by(f64::total_cmp);
    Ok(8.0 / PI * integrate(&ring, breaks, tolerance))
}

/// The integral over beta in [0, pi] of cos gamma R0(gamma) G / cos psi, for the facets of one
/// tilt with t = tan^2 alpha.
fn facet_ring(
    shadowing: impl Shadowing,
    fresnel: &Dielectric,
    psi: f64,
    t: f64,
    tolerance: f64,
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
    integrate(&facet, breaks, tolerance)
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

    /// The defining integral over view directions by the midpoint rule: slow, and for broad lobes
    /// only, but nothing in common with the integral over facets.
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
    fn published_samples_reflect_what_is_known() {
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
    fn the_neighbours_agree_with_the_integral_over_views() {
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
    fn a_lambertian_surface_reflects_its_weight() {
        let brdf = ThreeParameterBrdf::new(Parameters::new(0.0, 0.3, 1.0).unwrap(), 1.5).unwrap();
        assert_eq!(reflectance(&brdf, 40.0), 0.3);
        assert_eq!(brdf.energy_violation_angle(), None);
    }

    #[test]
    fn sample_002_breaks_energy_conservation_between_50_and_60_degrees() {
        let brdf = published("002", 1.04);
        let angle = brdf.energy_violation_angle().unwrap();
        assert!((50.0..60.0).contains(&angle.to_degrees()));
        let at = |psi| brdf.hemispherical_reflectance(psi, 1e-8).unwrap();
        assert!((at(angle) - 1.0).abs() < 1e-4);
        assert!(at(angle - 0.01) < 1.0);
    }

    #[test]
    fn the_implied_facet_reflectance_is_the_known_one() {
        let at = |sample, wavelength| published(sample, wavelength).implied_facet_reflectance();
        assert!((at("001", 0.91) - 0.1151).abs() < 5e-5);
        assert!((at("003", 1.04) - 0.0653).abs() < 5e-5);
    }

    #[test]
    fn the_cross_section_carries_both_cosines() {
        let brdf = published("001", 0.91);
        let retro = Geometry::in_plane(0.5, 0.5).unwrap();
        let sigma0 = 4.0 * PI * brdf.value(&retro) * 0.5_f64.cos().powi(2);
        assert!((brdf.unit_area_cross_section(&retro) / sigma0 - 1.0).abs() < 1e-15);
    }

    #[test]
    fn an_integral_without_an_end_does_not_take_for_ever() {
        // At n = 1 the Fresnel factor has no bound at grazing.
        let brdf = ThreeParameterBrdf::new(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.0).unwrap();
        assert!(brdf.hemispherical_reflectance(FRAC_PI_2, 1e-3).unwrap() > 1e6);
    }

    #[test]
    fn an_incidence_outside_the_domain_is_refused() {
        let brdf = published("001", 0.91);
        assert_eq!(
            brdf.hemispherical_reflectance(1.6, 1e-6),
            Err(GeometryError::Incidence(1.6))
        );
    }
}
