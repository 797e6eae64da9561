//! Directions drawn for renderers, with a density that follows f_r cos theta.
//!
//! ```
//! use brdf_core::sampling::Sampler;
//! use brdf_core::{AnyBrdf, Family, ModelParameters, Parameters};
//! use nalgebra::Vector3;
//!
//! let parameters = Parameters::new(1.211, 0.521, 0.071)?;
//! let brdf = AnyBrdf::new(Family::Paper, &ModelParameters::three(parameters, 1.60))?;
//! let sampler = Sampler::new(&brdf);
//! let source = Vector3::new(0.6, 0.0, 0.8);
//! // Three random numbers of [0, 1).
//! if let Some(sample) = sampler.sample(&source, [0.2, 0.7, 0.4])? {
//!     // The light from there, times the weight, is an unbiased estimate of what is reflected.
//!     assert!(sample.weight > 0.0 && sample.pdf == sampler.pdf(&source, &sample.direction)?);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use nalgebra::Vector3;

use crate::facet::FacetDistribution;
use crate::family::{AnyBrdf, each};
use crate::geometry::{Geometry, GeometryError};
use crate::reflectance::specular_reflectance;

/// Incidences at which the weight of the specular lobe is computed. Between them it is interpolated:
/// what it is changes the variance and nothing else.
const INCIDENCES: usize = 17;

/// The incidence, in radians (89.9 deg), that stands for all beyond it: at n = 1 the Fresnel factor
/// has no bound at grazing, and the reflectance there is no number to integrate.
const LAST_INCIDENCE: f64 = 89.9 * PI / 180.0;

/// View directions from each lobe that the weight of the specular one is computed from.
const PROBES: u32 = 256;

/// Halvings in which it is found.
const WEIGHT_HALVINGS: u32 = 12;

/// Neither lobe gets less than this part of the weight that its reflectance would give it. That
/// keeps f_r cos theta / pdf bounded, and the probes, which are few, need not see everything.
const WEIGHT_MARGIN: f64 = 0.01;

/// Relative tolerance of the reflectances behind these weights.
const REFLECTANCE_TOLERANCE: f64 = 1e-2;

/// Draws view directions for a given source, with a density that resembles f_r cos theta.
///
/// The density is a mixture of a cosine lobe and a specular one, per solid angle of the view:
///
/// ```text
/// pdf = w_s p(alpha) / (4 cos gamma) + (1 - w_s) cos theta / pi          [1/sr]
/// ```
///
/// p(alpha) is the [density](FacetDistribution::sampling_density) of facet normals, on one of which
/// the source is mirrored; 4 cos gamma the solid angle of the view over that of the normal (Torrance
/// and Sparrow 1967; Walter et al., EGSR 2007, eq. 14).
///
/// w_s is the weight of least variance for the incidence, within
///
/// ```text
/// q / 100 <= w_s <= 1 - (1 - q) / 100,   q = k2 rho_s(psi) / (k2 rho_s(psi) + kD)
/// ```
///
/// rho_s being the reflectance of the [specular part](specular_reflectance) for k2 = 1. q itself
/// would be the usual choice, and is a poor one for a lobe about as wide as the cosine: many of its
/// facets mirror the source below the surface. Without a specular part w_s is 0.
///
/// # The weight is bounded
///
/// With N the integral that normalises p(alpha), N = 1/p(0), and the largest gamma being
/// (psi + pi/2)/2, so that R0 <= R_max = max(1, R0(that gamma)), the specular part over the
/// specular lobe is
///
/// ```text
/// (k2/pi) f/f(0) R0 G / cos psi * 4 cos gamma / p(alpha) <= B = (4/pi) k2 N R_max S
/// ```
///
/// where S bounds G cos gamma / cos psi, times 1/cos alpha if p(alpha) has the factor cos alpha:
///
/// | distribution | shadowing | S |
/// |---|---|---|
/// | ellipsoid, power | V-groove | 2, since G <= 2 cos alpha cos psi / cos gamma |
/// | Beckmann | V-groove | 2, by the same: cos alpha cancels |
/// | ellipsoid | Smith | s = G1(psi) / cos psi <= 2 / min(1, k1) |
/// | GGX | Smith | s min(2 / cos psi, 4 / min(1, k1)), cos alpha being (cos psi + cos theta)/(2 cos gamma) |
///
/// and for the mixture (a + b)/(c + d) <= max(a/c, b/d), and the cosine lobe alone, give
///
/// ```text
/// f_r cos theta / pdf <= max(B / w_s, kD / (1 - w_s))    and    <= pi f_r / (1 - w_s)
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Sampler {
    brdf: AnyBrdf,
    /// w_s at cos psi = (i / (INCIDENCES - 1))^2, close together towards grazing, where it rises.
    specular_weights: [f64; INCIDENCES],
}

/// A view direction that was drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Unit vector towards the viewer, above the surface.
    pub direction: Vector3<f64>,
    /// The density it was drawn with, per solid angle, in 1/sr.
    pub pdf: f64,
    /// f_r cos theta / pdf, dimensionless: its mean, 0 for `None`, is the hemispherical reflectance.
    pub weight: f64,
}

impl Sampler {
    /// The sampler of a BRDF.
    ///
    /// It costs 17 reflectances and as many small searches, some milliseconds: make one for a
    /// material, not for a ray.
    pub fn new(brdf: &AnyBrdf) -> Self {
        Self {
            brdf: *brdf,
            specular_weights: std::array::from_fn(|i| {
                let root = i as f64 / (INCIDENCES - 1) as f64;
                specular_weight(brdf, (root * root).acos().min(LAST_INCIDENCE))
            }),
        }
    }

    /// The weight w_s of the specular lobe at cos psi = (i/16)^2, i from 0 to 16. Between them it is
    /// interpolated linearly in sqrt(cos psi).
    pub fn specular_weights(&self) -> [f64; INCIDENCES] {
        self.specular_weights
    }

    /// Draws the view direction for a source, both unit vectors away from the surface with z its
    /// normal, from three numbers of [0, 1): the first chooses the lobe, the others the direction.
    ///
    /// `None`, with a weight of 0, where the facet that was drawn mirrors the source below the
    /// surface. That has a probability: the integral of the density over the hemisphere is what is
    /// left of 1. Numbers outside [0, 1) are taken as the nearest inside.
    ///
    /// Errors: a source that is no unit vector, or not above the surface.
    pub fn sample(
        &self,
        source: &Vector3<f64>,
        u: [f64; 3],
    ) -> Result<Option<Sample>, GeometryError> {
        let cos_psi = Geometry::from_directions(source, &Vector3::z())?.cos_psi();
        let [choice, u, v] = u.map(|u| u.clamp(0.0, 1.0 - 0.5 * f64::EPSILON));
        let direction = if choice < self.specular_weight(cos_psi) {
            mirrored(source, &facet_normal(&self.brdf, u, v))
        } else {
            cosine_direction(u, v)
        };
        if direction.z > 0.0 {
            self.with_weight(source, direction.normalize()).map(Some)
        } else {
            Ok(None)
        }
    }

    /// The density of the view directions that [`sample`](Self::sample) draws, per solid angle of the
    /// view, in 1/sr.
    ///
    /// Errors: a direction that is no unit vector, or not above the surface.
    pub fn pdf(&self, source: &Vector3<f64>, view: &Vector3<f64>) -> Result<f64, GeometryError> {
        Ok(self.density(&Geometry::from_directions(source, view)?))
    }

    fn with_weight(
        &self,
        source: &Vector3<f64>,
        direction: Vector3<f64>,
    ) -> Result<Sample, GeometryError> {
        let geometry = Geometry::from_directions(source, &direction)?;
        let pdf = self.density(&geometry);
        let intensity = self.brdf.value(&geometry) * geometry.cos_theta();
        Ok(Sample {
            direction,
            pdf,
            weight: intensity / pdf,
        })
    }

    fn density(&self, geometry: &Geometry) -> f64 {
        let weight = self.specular_weight(geometry.cos_psi());
        mixed(weight, lobe_densities(&self.brdf, geometry))
    }

    /// w_s at an incidence, the same number for the choice of the lobe and for the density.
    fn specular_weight(&self, cos_psi: f64) -> f64 {
        let position = cos_psi.sqrt() * (INCIDENCES - 1) as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "it is between 0 and INCIDENCES - 1"
        )]
        let below = (position as usize).min(INCIDENCES - 2);
        let [left, right] = [below, below + 1].map(|i| self.specular_weights[i]);
        left + (position - below as f64) * (right - left)
    }
}

/// The density of the view in the specular lobe and in the cosine lobe, in 1/sr.
fn lobe_densities(brdf: &AnyBrdf, geometry: &Geometry) -> [f64; 2] {
    let (tan2_alpha, sec_alpha) = (geometry.tan2_alpha(), geometry.sec_alpha());
    let normal = each!(brdf, brdf => brdf.facet().sampling_density(tan2_alpha, sec_alpha));
    [
        normal / (4.0 * geometry.cos_gamma()),
        FRAC_1_PI * geometry.cos_theta(),
    ]
}

/// The density of the mixture.
fn mixed(specular_weight: f64, [specular, cosine]: [f64; 2]) -> f64 {
    specular_weight * specular + (1.0 - specular_weight) * cosine
}

/// A facet normal from two numbers of [0, 1).
fn facet_normal(brdf: &AnyBrdf, u: f64, v: f64) -> Vector3<f64> {
    let tan2_alpha = each!(brdf, brdf => brdf.facet().sample_tan2_alpha(u));
    let cos_alpha = 1.0 / (1.0 + tan2_alpha).sqrt();
    let sin_alpha = tan2_alpha.sqrt() * cos_alpha;
    let (sin, cos) = (TAU * v).sin_cos();
    Vector3::new(sin_alpha * cos, sin_alpha * sin, cos_alpha)
}

/// The weight w_s of the specular lobe at the incidence psi in [0, pi/2), in radians.
fn specular_weight(brdf: &AnyBrdf, psi: f64) -> f64 {
    let fraction = specular_fraction(brdf, psi);
    if fraction == 0.0 {
        return 0.0;
    }
    let range = [
        WEIGHT_MARGIN * fraction,
        1.0 - WEIGHT_MARGIN * (1.0 - fraction),
    ];
    least_variance(&probes(brdf, psi), range)
}

/// The specular part of the reflectance at psi, k2 rho_s / (k2 rho_s + kD).
fn specular_fraction(brdf: &AnyBrdf, psi: f64) -> f64 {
    let reflectance = each!(brdf, brdf => specular_reflectance(
        brdf.facet(),
        brdf.shadowing(),
        &brdf.fresnel(),
        psi,
        REFLECTANCE_TOLERANCE,
    ));
    // psi is within the domain. Where it were not, any fraction would do.
    let specular = brdf.parameters().k2 * reflectance.unwrap_or(1.0);
    if specular > 0.0 {
        // The sum may be beyond the numbers where the quotient is not.
        1.0 / (1.0 + brdf.parameters().kd / specular)
    } else {
        0.0
    }
}

/// A view direction that stands for a part of the hemisphere.
struct Probe {
    /// (f_r cos theta)^2 over the density of the probes.
    square: f64,
    /// The densities of the lobes.
    lobes: [f64; 2],
}

/// Probes from both lobes in equal parts, by the points of Hammersley.
fn probes(brdf: &AnyBrdf, psi: f64) -> Vec<Probe> {
    let source = Vector3::new(psi.sin(), 0.0, psi.cos());
    let views = (0..PROBES).flat_map(|i| {
        let u = (f64::from(i) + 0.5) / f64::from(PROBES);
        let v = (f64::from(i.reverse_bits()) + 0.5) / (f64::from(u32::MAX) + 1.0);
        let mirrored = mirrored(&source, &facet_normal(brdf, u, v));
        [mirrored, cosine_direction(u, v)]
    });
    views
        // A direction below the surface is refused.
        .filter_map(|view| Geometry::from_directions(&source, &view).ok())
        .map(|geometry| {
            let lobes = lobe_densities(brdf, &geometry);
            let intensity = brdf.value(&geometry) * geometry.cos_theta();
            Probe {
                square: intensity * intensity / mixed(0.5, lobes),
                lobes,
            }
        })
        .collect()
}

/// The weight of the specular lobe, within a range, that gives the least variance: the mean square
/// of f_r cos theta / pdf is convex in it, and its derivative is halved down.
fn least_variance(probes: &[Probe], [mut from, mut to]: [f64; 2]) -> f64 {
    let falls = |weight: f64| {
        let slopes = probes.iter().map(|Probe { square, lobes }| {
            let density = mixed(weight, *lobes);
            square * ((lobes[1] - lobes[0]) / density) / density
        });
        slopes.sum::<f64>() < 0.0
    };
    for _ in 0..WEIGHT_HALVINGS {
        let middle = 0.5 * (from + to);
        if falls(middle) {
            from = middle;
        } else {
            to = middle;
        }
    }
    0.5 * (from + to)
}

/// The source mirrored about a facet normal.
fn mirrored(source: &Vector3<f64>, normal: &Vector3<f64>) -> Vector3<f64> {
    2.0 * source.dot(normal) * normal - source
}

/// A direction of the density cos theta / pi.
fn cosine_direction(u: f64, v: f64) -> Vector3<f64> {
    let sin_theta = u.sqrt();
    let (sin, cos) = (TAU * v).sin_cos();
    Vector3::new(sin_theta * cos, sin_theta * sin, (1.0 - u).sqrt())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{Family, ModelParameters};

    fn direction(zenith: f64, azimuth: f64) -> Vector3<f64> {
        let (sin, cos) = azimuth.sin_cos();
        Vector3::new(zenith.sin() * cos, zenith.sin() * sin, zenith.cos())
    }

    fn brdf(family: Family, [k2, kd, k1, n, p]: [f64; 5]) -> AnyBrdf {
        AnyBrdf::new(family, &ModelParameters { k2, kd, k1, n, p }).unwrap()
    }

    fn any_family() -> impl Strategy<Value = Family> {
        prop::sample::select(Family::ALL.to_vec())
    }

    /// The bound of the specular part over the specular lobe, as the documentation has it.
    fn specular_bound(brdf: &AnyBrdf, cos_psi: f64) -> f64 {
        let total = each!(brdf, brdf => 1.0 / brdf.facet().sampling_density(0.0, 1.0));
        let k1 = brdf.parameters().k1;
        let smith = 2.0 / (cos_psi + cos_psi.hypot(k1 * (1.0 - cos_psi * cos_psi).sqrt()));
        let shadowing = match brdf {
            AnyBrdf::Paper(_) | AnyBrdf::Power(_) | AnyBrdf::Beckmann(_) => 2.0,
            AnyBrdf::Smith(_) => smith,
            AnyBrdf::Ggx(_) => smith * (2.0 / cos_psi).min(4.0 / k1.min(1.0)),
        };
        let largest_gamma = 0.5 * (cos_psi.acos() + 0.5 * PI);
        let fresnel = brdf.fresnel().relative(largest_gamma.cos()).max(1.0);
        4.0 * FRAC_1_PI * brdf.parameters().k2 * total * fresnel * shadowing
    }

    fn weight_bound(sampler: &Sampler, cos_psi: f64) -> f64 {
        let specular_weight = sampler.specular_weight(cos_psi);
        let over = |part: f64, weight: f64| if part > 0.0 { part / weight } else { 0.0 };
        let specular = over(specular_bound(&sampler.brdf, cos_psi), specular_weight);
        specular.max(over(sampler.brdf.parameters().kd, 1.0 - specular_weight))
    }

    #[test]
    fn the_first_number_chooses_the_lobe() {
        let source = direction(0.5, 1.0);
        let at = |k2, kd, u| {
            let sampler = Sampler::new(&brdf(Family::Paper, [k2, kd, 0.1, 1.5, 1.0]));
            sampler.sample(&source, u).unwrap().unwrap()
        };
        let mirror = at(1.0, 0.2, [0.0, 0.0, 0.2]);
        assert!((mirror.direction - direction(0.5, 1.0 + PI)).norm() < 1e-15);
        let normal = at(1.0, 0.2, [1.0, 0.0, 0.2]);
        assert!((normal.direction - Vector3::z()).norm() < 1e-15);
    }

    #[test]
    fn a_lambertian_surface_is_sampled_by_the_cosine() {
        for kd in [0.3, 0.0] {
            let sampler = Sampler::new(&brdf(Family::Paper, [0.0, kd, 0.1, 1.5, 1.0]));
            let drawn = sampler.sample(&direction(0.5, 1.0), [0.0, 0.4, 0.2]);
            let sample = drawn.unwrap().unwrap();
            assert!((sample.pdf - sample.direction.z / PI).abs() < 1e-15);
            assert!((sample.weight - kd).abs() < 1e-15);
        }
    }

    #[test]
    fn directions_outside_the_domain_are_refused() {
        let sampler = Sampler::new(&brdf(Family::Ggx, [1.0, 0.1, 0.1, 1.5, 1.0]));
        let (up, below) = (Vector3::z(), direction(2.0, 0.0));
        assert!(sampler.sample(&below, [0.5; 3]).is_err());
        assert!(sampler.sample(&(2.0 * up), [0.5; 3]).is_err());
        assert!(sampler.pdf(&up, &below).is_err());
        assert!(sampler.pdf(&below, &up).is_err());
    }

    #[test]
    fn numbers_outside_the_unit_interval_do_no_harm() {
        for family in Family::ALL {
            let sampler = Sampler::new(&brdf(family, [1.0, 0.1, 0.1, 1.5, 1.0]));
            for bad in [-1.0, 1.0, 7.0, f64::INFINITY, f64::NAN] {
                for u in [[bad, 0.5, 0.5], [0.0, bad, 0.5], [0.0, 0.5, bad], [bad; 3]] {
                    let sample = sampler.sample(&direction(0.5, 1.0), u).unwrap();
                    assert!(sample.is_none_or(|sample| sample.weight.is_finite()));
                }
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        #[test]
        fn the_weight_is_below_its_bound(
            family in any_family(),
            k2 in 0.01..3.0, kd in prop_oneof![Just(0.0), 1e-3..1.0], log_k1 in -9.2..3.0_f64,
            n in 1.0..4.0, p in 0.1..16.0,
            psi_deg in prop_oneof![0.0..89.9_f64, 85.0..89.9_f64], azimuth in -4.0..4.0_f64,
            numbers in prop::collection::vec(prop::array::uniform3(0.0..1.0_f64), 64),
        ) {
            let sampler = Sampler::new(&brdf(family, [k2, kd, log_k1.exp(), n, p]));
            let source = direction(psi_deg.to_radians(), azimuth);
            let bound = weight_bound(&sampler, source.z);
            for u in numbers {
                let Some(sample) = sampler.sample(&source, u).unwrap() else { continue };
                prop_assert!(sample.pdf > 0.0 && sample.pdf.is_finite());
                prop_assert!(sample.weight >= 0.0 && sample.weight <= bound * (1.0 + 1e-6),
                    "{family:?}: {} {bound}", sample.weight);
                prop_assert_eq!(sample.pdf, sampler.pdf(&source, &sample.direction).unwrap());
            }
        }

        #[test]
        fn extreme_parameters_give_finite_samples(
            family in any_family(),
            log_k1 in -18.4..18.4_f64, log_n in -36.0..11.5_f64, p in 0.1..16.0,
            log_cos_psi in -30.0..0.0_f64,
            numbers in prop::collection::vec(prop::array::uniform3(0.0..1.0_f64), 16),
        ) {
            let brdf = brdf(family, [0.5, 0.2, log_k1.exp(), 1.0 + log_n.exp(), p]);
            let sampler = Sampler::new(&brdf);
            prop_assert!(sampler.specular_weights.iter().all(|w| (0.0..=1.0).contains(w)));
            let cos_psi = log_cos_psi.exp();
            let source = Vector3::new((1.0 - cos_psi * cos_psi).sqrt(), 0.0, cos_psi);
            for u in numbers {
                if let Some(sample) = sampler.sample(&source, u).unwrap() {
                    prop_assert!(sample.pdf > 0.0 && sample.pdf.is_finite());
                    prop_assert!(sample.weight >= 0.0 && sample.weight.is_finite());
                }
            }
        }
    }
}
