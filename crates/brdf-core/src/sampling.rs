//! Importance sampling for renderers: view directions with a density that resembles f_r cos theta.
//!
//! ```
//! use brdf_core::sampling::Sampler;
//! use brdf_core::{AnyBrdf, Family, ModelParameters, Parameters};
//!
//! let parameters = Parameters::new(1.211, 0.521, 0.071)?;
//! let brdf = AnyBrdf::new(Family::Paper, &ModelParameters::three(parameters, 1.60))?;
//! let sampler = Sampler::new(&brdf);
//! let source = [0.6, 0.0, 0.8];
//! // Three random numbers in [0, 1).
//! if let Some(sample) = sampler.sample(source, [0.2, 0.7, 0.4])? {
//!     // The radiance from this direction times the weight is an unbiased estimate of the reflected
//!     // radiance.
//!     assert!(sample.weight > 0.0 && sample.pdf == sampler.pdf(source, sample.direction)?);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use crate::direction::{Direction, difference, divided, dot, length};
use crate::facet::FacetDistribution;
use crate::family::{AnyBrdf, each};
use crate::geometry::{Geometry, GeometryError};
use crate::reflectance::specular_reflectance;

/// The number of incidences at which the weight of the specular lobe is computed. It is interpolated
/// between them, since the weight affects nothing but the variance.
const INCIDENCES: usize = 17;

/// The largest incidence at which the weight is computed, in radians (89.9 deg), used for all beyond
/// it. At n = 1 the Fresnel factor is unbounded at grazing, and the reflectance integral diverges.
const LAST_INCIDENCE: f64 = 89.9 * PI / 180.0;

/// The number of view directions from each lobe from which the weight of the specular lobe is
/// computed.
const PROBES: u32 = 256;

/// The number of bisections that determine this weight.
const WEIGHT_HALVINGS: u32 = 12;

/// The least weight of each lobe, as a fraction of its share in the reflectance. It bounds
/// f_r cos theta / pdf even if the few probes miss a part of the lobe.
const WEIGHT_MARGIN: f64 = 0.01;

/// The relative tolerance of the reflectances that these weights are derived from.
const REFLECTANCE_TOLERANCE: f64 = 1e-2;

/// The surface normal.
const NORMAL: [f64; 3] = [0.0, 0.0, 1.0];

/// Draws view directions for a given source, with a density that resembles f_r cos theta.
///
/// The density is a mixture of a cosine lobe and a specular lobe, per solid angle of the view:
///
/// ```text
/// pdf = w_s p(alpha) / (4 cos gamma) + (1 - w_s) cos theta / pi          [1/sr]
/// ```
///
/// p(alpha) is the [density](FacetDistribution::sampling_density) of the facet normals that mirror
/// the source into the view, and 4 cos gamma is the ratio of the solid angle of the view to that of
/// the normal (Torrance and Sparrow 1967; Walter et al., EGSR 2007, eq. 14).
///
/// w_s minimises the variance at the incidence psi within the limits
///
/// ```text
/// q / 100 <= w_s <= 1 - (1 - q) / 100,   q = k2 rho_s(psi) / (k2 rho_s(psi) + kD)
/// ```
///
/// where rho_s is the reflectance of the [specular part](specular_reflectance) for k2 = 1. The usual
/// choice w_s = q is poor for a lobe that is about as wide as the cosine, because many of its facets
/// mirror the source below the surface. Without a specular part w_s is 0.
///
/// # The weight is bounded
///
/// Let N = 1/p(0) be the integral that normalises p(alpha). The largest gamma is (psi + pi/2)/2, so
/// that R0 <= R_max = max(1, R0((psi + pi/2)/2)). The specular part over the specular lobe is
///
/// ```text
/// (k2/pi) f/f(0) R0 G / cos psi * 4 cos gamma / p(alpha) <= B = (4/pi) k2 N R_max S
/// ```
///
/// where S bounds G cos gamma / cos psi, multiplied by 1/cos alpha if p(alpha) has the factor
/// cos alpha:
///
/// | distribution | shadowing | S |
/// |---|---|---|
/// | ellipsoid, power | V-groove | 2, since G <= 2 cos alpha cos psi / cos gamma |
/// | Beckmann | V-groove | 2, by the same bound, since cos alpha cancels |
/// | ellipsoid | Smith | s = G1(psi) / cos psi <= 2 / min(1, k1) |
/// | GGX | Smith | s min(2 / cos psi, 4 / min(1, k1)), since cos alpha = (cos psi + cos theta)/(2 cos gamma) |
///
/// The inequality (a + b)/(c + d) <= max(a/c, b/d) for the mixture, and the cosine lobe alone, give
///
/// ```text
/// f_r cos theta / pdf <= max(B / w_s, kD / (1 - w_s))    and    <= pi f_r / (1 - w_s)
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Sampler {
    brdf: AnyBrdf,
    /// w_s at cos psi = (i / (INCIDENCES - 1))^2, which is dense towards grazing, where w_s rises.
    specular_weights: [f64; INCIDENCES],
}

/// A view direction that was drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The unit vector towards the viewer, above the surface.
    pub direction: [f64; 3],
    /// The density with which the direction was drawn, per solid angle, in 1/sr.
    pub pdf: f64,
    /// f_r cos theta / pdf, dimensionless. Its mean, with 0 for each `None`, is the hemispherical
    /// reflectance.
    pub weight: f64,
}

impl Sampler {
    /// The sampler of a BRDF.
    ///
    /// It computes 17 reflectances and as many small searches, which takes some milliseconds: make
    /// one for each material, not for each ray.
    pub fn new(brdf: &AnyBrdf) -> Self {
        Self {
            brdf: *brdf,
            specular_weights: std::array::from_fn(|i| {
                let root = i as f64 / (INCIDENCES - 1) as f64;
                specular_weight(brdf, (root * root).acos().min(LAST_INCIDENCE))
            }),
        }
    }

    /// The weight w_s of the specular lobe at cos psi = (i/16)^2 for i from 0 to 16. It is
    /// interpolated linearly in sqrt(cos psi).
    pub fn specular_weights(&self) -> [f64; INCIDENCES] {
        self.specular_weights
    }

    /// Draws the view direction for a source. Both are unit vectors away from the surface, with z
    /// along its normal. Of the three numbers in [0, 1), the first chooses the lobe and the others
    /// the direction; numbers outside are replaced by the nearest inside.
    ///
    /// The result is `None`, with the weight 0, if the facet that was drawn mirrors the source below
    /// the surface. Its probability is 1 less the integral of the density over the hemisphere.
    ///
    /// # Errors
    ///
    /// [`GeometryError`] for a source that is not a unit vector or not above the surface.
    pub fn sample(
        &self,
        source: impl Direction,
        u: [f64; 3],
    ) -> Result<Option<Sample>, GeometryError> {
        let source = source.components();
        let cos_psi = Geometry::from_directions(source, NORMAL)?.cos_psi();
        let [choice, u, v] = u.map(|u| u.clamp(0.0, 1.0 - 0.5 * f64::EPSILON));
        let direction = if choice < self.specular_weight(cos_psi) {
            mirrored(source, facet_normal(&self.brdf, u, v))
        } else {
            cosine_direction(u, v)
        };
        if direction[2] > 0.0 {
            let direction = divided(direction, length(direction));
            self.with_weight(source, direction).map(Some)
        } else {
            Ok(None)
        }
    }

    /// The density of the view directions that [`sample`](Self::sample) draws, per solid angle of the
    /// view, in 1/sr.
    ///
    /// # Errors
    ///
    /// [`GeometryError`] for a direction that is not a unit vector or not above the surface.
    pub fn pdf(&self, source: impl Direction, view: impl Direction) -> Result<f64, GeometryError> {
        Ok(self.density(&Geometry::from_directions(source, view)?))
    }

    fn with_weight(&self, source: [f64; 3], direction: [f64; 3]) -> Result<Sample, GeometryError> {
        let geometry = Geometry::from_directions(source, direction)?;
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

    /// w_s at an incidence, both for the choice of the lobe and for the density.
    fn specular_weight(&self, cos_psi: f64) -> f64 {
        let position = cos_psi.sqrt() * (INCIDENCES - 1) as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the position is between 0 and INCIDENCES - 1"
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

/// A facet normal drawn from two numbers in [0, 1).
fn facet_normal(brdf: &AnyBrdf, u: f64, v: f64) -> [f64; 3] {
    let tan2_alpha = each!(brdf, brdf => brdf.facet().sample_tan2_alpha(u));
    let cos_alpha = 1.0 / (1.0 + tan2_alpha).sqrt();
    let sin_alpha = tan2_alpha.sqrt() * cos_alpha;
    let (sin, cos) = (TAU * v).sin_cos();
    [sin_alpha * cos, sin_alpha * sin, cos_alpha]
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

/// The share of the specular part in the reflectance at psi, k2 rho_s / (k2 rho_s + kD).
fn specular_fraction(brdf: &AnyBrdf, psi: f64) -> f64 {
    let reflectance = each!(brdf, brdf => specular_reflectance(
        brdf.facet(),
        brdf.shadowing(),
        &brdf.fresnel(),
        psi,
        REFLECTANCE_TOLERANCE,
    ));
    // psi is within the domain, so that there is no error.
    let specular = brdf.parameters().k2 * reflectance.unwrap_or(1.0);
    if specular > 0.0 {
        // The sum may overflow if the ratio does not.
        1.0 / (1.0 + brdf.parameters().kd / specular)
    } else {
        0.0
    }
}

/// A view direction that represents a part of the hemisphere.
struct Probe {
    /// (f_r cos theta)^2 over the density of the probes.
    square: f64,
    /// The densities of the lobes.
    lobes: [f64; 2],
}

/// Probes from both lobes in equal parts, at the points of Hammersley.
fn probes(brdf: &AnyBrdf, psi: f64) -> Vec<Probe> {
    let source = [psi.sin(), 0.0, psi.cos()];
    let views = (0..PROBES).flat_map(|i| {
        let u = (f64::from(i) + 0.5) / f64::from(PROBES);
        let v = (f64::from(i.reverse_bits()) + 0.5) / (f64::from(u32::MAX) + 1.0);
        let mirrored = mirrored(source, facet_normal(brdf, u, v));
        [mirrored, cosine_direction(u, v)]
    });
    views
        // Directions below the surface are dropped.
        .filter_map(|view| Geometry::from_directions(source, view).ok())
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

/// The weight of the specular lobe, within a range, that minimises the variance. The mean square of
/// f_r cos theta / pdf is convex in it, and the root of its derivative is found by bisection.
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
fn mirrored(source: [f64; 3], normal: [f64; 3]) -> [f64; 3] {
    let twice = 2.0 * dot(source, normal);
    difference(normal.map(|component| twice * component), source)
}

/// A direction of the density cos theta / pi.
fn cosine_direction(u: f64, v: f64) -> [f64; 3] {
    let sin_theta = u.sqrt();
    let (sin, cos) = (TAU * v).sin_cos();
    [sin_theta * cos, sin_theta * sin, (1.0 - u).sqrt()]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{Family, ModelParameters};

    fn direction(zenith: f64, azimuth: f64) -> [f64; 3] {
        let (sin, cos) = azimuth.sin_cos();
        [zenith.sin() * cos, zenith.sin() * sin, zenith.cos()]
    }

    fn brdf(family: Family, [k2, kd, k1, n, p]: [f64; 5]) -> AnyBrdf {
        AnyBrdf::new(family, &ModelParameters { k2, kd, k1, n, p }).unwrap()
    }

    fn any_family() -> impl Strategy<Value = Family> {
        prop::sample::select(Family::ALL.to_vec())
    }

    /// The bound of the specular part over the specular lobe as documented.
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
            sampler.sample(source, u).unwrap().unwrap()
        };
        let mirror = at(1.0, 0.2, [0.0, 0.0, 0.2]);
        let expected = direction(0.5, 1.0 + PI);
        assert!(length(difference(mirror.direction, expected)) < 1e-15);
        let normal = at(1.0, 0.2, [1.0, 0.0, 0.2]);
        assert!(length(difference(normal.direction, NORMAL)) < 1e-15);
    }

    #[test]
    fn a_lambertian_surface_is_sampled_by_the_cosine() {
        for kd in [0.3, 0.0] {
            let sampler = Sampler::new(&brdf(Family::Paper, [0.0, kd, 0.1, 1.5, 1.0]));
            let drawn = sampler.sample(direction(0.5, 1.0), [0.0, 0.4, 0.2]);
            let sample = drawn.unwrap().unwrap();
            assert!((sample.pdf - sample.direction[2] / PI).abs() < 1e-15);
            assert!((sample.weight - kd).abs() < 1e-15);
        }
    }

    #[test]
    fn directions_outside_the_domain_are_refused() {
        let sampler = Sampler::new(&brdf(Family::Ggx, [1.0, 0.1, 0.1, 1.5, 1.0]));
        let below = direction(2.0, 0.0);
        assert!(sampler.sample(below, [0.5; 3]).is_err());
        assert!(sampler.sample([0.0, 0.0, 2.0], [0.5; 3]).is_err());
        assert!(sampler.pdf(NORMAL, below).is_err());
        assert!(sampler.pdf(below, NORMAL).is_err());
    }

    #[test]
    fn numbers_outside_the_unit_interval_give_finite_samples() {
        for family in Family::ALL {
            let sampler = Sampler::new(&brdf(family, [1.0, 0.1, 0.1, 1.5, 1.0]));
            for bad in [-1.0, 1.0, 7.0, f64::INFINITY, f64::NAN] {
                for u in [[bad, 0.5, 0.5], [0.0, bad, 0.5], [0.0, 0.5, bad], [bad; 3]] {
                    let sample = sampler.sample(direction(0.5, 1.0), u).unwrap();
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
            let bound = weight_bound(&sampler, source[2]);
            for u in numbers {
                let Some(sample) = sampler.sample(source, u).unwrap() else { continue };
                prop_assert!(sample.pdf > 0.0 && sample.pdf.is_finite());
                prop_assert!(sample.weight >= 0.0 && sample.weight <= bound * (1.0 + 1e-6),
                    "{family:?}: {} {bound}", sample.weight);
                prop_assert_eq!(sample.pdf, sampler.pdf(source, sample.direction).unwrap());
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
            let source = [(1.0 - cos_psi * cos_psi).sqrt(), 0.0, cos_psi];
            for u in numbers {
                if let Some(sample) = sampler.sample(source, u).unwrap() {
                    prop_assert!(sample.pdf > 0.0 && sample.pdf.is_finite());
                    prop_assert!(sample.weight >= 0.0 && sample.weight.is_finite());
                }
            }
        }
    }
}
