//! The criterion of a plan: the mean square error of ln f_r over the scene of the fit that the readings will
//! have.
//!
//! The fit minimises sum_i w_i (ln f_i - ln f_r(z; i))^2, as `three+n` with relative weights does. With the slopes
//! j = d ln f_r/dz, the covariance K of the readings' errors (that of the misfit, K_d, included), and the prior
//! precision P, its parameters err by
//!
//! ```text
//! dz = A^-1 (sum_i w_i j_i e_i - P dz_0),     A = sum_i w_i j_i j_i^T + P,
//! ```
//!
//! and the mean over the scene of the expected square of j(x)^T dz - d(x), d being the misfit there, is
//!
//! ```text
//! Phi = tr(A^-1 M A^-1 W) - 2 tr(A^-1 H) + mean K_d(x, x)
//! M = sum_ik w_i w_k j_i K_ik j_k^T + s^2 P,   W = mean j j^T,   H = sum_i w_i j_i mean_x(K_d(i, x) j(x)^T)
//! ```
//!
//! with s^2 = K_ii, by which the prior's precision is multiplied in P.
//!//! (Box and Draper 1959: the average mean square error, bias included; the misfit as a random function as Sacks,
//! Welch, Mitchell and Wynn 1989 have it). It is averaged over parameters that the readings so far allow.

use brdf_core::Family;
use nalgebra::Matrix4;

use super::belief::{Belief, brdf, log_slopes, log_value};
use super::errors::{ErrorModel, Place};
use super::prior::{Logs, Prior};
use super::setting::Site;
use crate::objective::weights::RELATIVE_FLOOR;

/// The largest difference of ln f_r between two models that is reckoned with.
const LARGEST_DIFFERENCE: f64 = 1.0;

/// From this number of readings on, their rms is the one that the floor of the relative weights refers to.
const READINGS_FOR_FLOOR: usize = 3;

/// The families whose difference from the model is a possible misfit.
pub(super) const OTHER_FAMILIES: [Family; 3] = [Family::Smith, Family::Ggx, Family::Beckmann];

/// Everything that is the same for all plans from one state of the readings: the sites of the scene and those of
/// the readings and candidates, with their covariance.
pub(super) struct Field<'a> {
    pub(super) error: &'a ErrorModel,
    scene: Vec<Place>,
    sites: Vec<Place>,
    /// The difference of each other model, of the scene and of the sites.
    scene_differences: Vec<Vec<f64>>,
    site_differences: Vec<Vec<f64>>,
}

impl<'a> Field<'a> {
    /// The sites, with the models that the readings so far suggest: the first belief is that of the model itself.
    pub(super) fn new(
        error: &'a ErrorModel,
        scene: &[Site],
        sites: &[Site],
        belief: &Belief,
        others: &[(Family, Logs)],
    ) -> Self {
        let k1 = belief.mode[2].exp();
        let places = |sites: &[Site]| sites.iter().map(|&s| Place::new(s, k1)).collect();
        let differences = Differences::new(belief, scene);
        let of = |sites: &[Site]| -> Vec<Vec<f64>> {
            let each = others.iter();
            each.map(|(family, at)| differences.of(*family, at, scene, sites))
                .collect()
        };
        Self {
            error,
            scene: places(scene),
            sites: places(sites),
            scene_differences: of(scene),
            site_differences: of(sites),
        }
    }

    /// The covariance of the misfit between a site and a direction of the scene.
    fn to_scene(&self, site: usize, x: usize) -> f64 {
        let random = self.error.misfit(&self.sites[site], &self.scene[x]);
        random + self.shared(&self.site_differences, site, &self.scene_differences, x)
    }

    /// The covariance of the errors of the readings at two sites; of two readings where the sites are one.
    pub(super) fn covariance(&self, a: usize, b: usize) -> f64 {
        let (first, second) = (&self.sites[a], &self.sites[b]);
        let common = self.error.misfit(first, second) + self.error.common(first, second);
        common + self.shared(&self.site_differences, a, &self.site_differences, b)
    }

    /// The variance of the error of a reading at a site.
    pub(super) fn variance(&self, site: usize) -> f64 {
        self.covariance(site, site) + self.error.proportional.powi(2)
    }

    /// The part of the covariance that the differences of the models make.
    fn shared(&self, first: &[Vec<f64>], i: usize, second: &[Vec<f64>], k: usize) -> f64 {
        let each = first.iter().zip(second).map(|(a, b)| a[i] * b[k]);
        self.error.models.powi(2) * each.sum::<f64>()
    }

    /// The mean square of the misfit over the scene, before any reading.
    fn misfit(&self) -> f64 {
        let each = (0..self.scene.len()).map(|x| {
            self.error.misfit_variance()
                + self.shared(&self.scene_differences, x, &self.scene_differences, x)
        });
        each.sum::<f64>() / self.scene.len() as f64
    }
}

/// Differences of other models from the model, less what its parameters can take up over the scene.
struct Differences {
    mode: Logs,
    /// (mean j j^T)^-1 over the scene.
    inverse: Matrix4<f64>,
}

impl Differences {
    fn new(belief: &Belief, scene: &[Site]) -> Self {
        let mode = belief.mode;
        let paper = brdf(Family::Paper, &mode);
        let mut gram = Matrix4::zeros();
        for site in scene {
            let slopes = log_slopes(&paper, &site.geometry);
            gram += slopes * slopes.transpose();
        }
        // A parameter without influence takes up nothing.
        let ridge = 1e-9 * gram.trace();
        let inverse = (gram + Matrix4::identity() * ridge).try_inverse();
        Self {
            mode,
            inverse: inverse.unwrap_or_else(Matrix4::zeros),
        }
    }

    fn of(&self, family: Family, at: &Logs, scene: &[Site], sites: &[Site]) -> Vec<f64> {
        let (paper, other) = (brdf(Family::Paper, &self.mode), brdf(family, at));
        let difference =
            |site: &Site| log_value(&other, &site.geometry) - log_value(&paper, &site.geometry);
        let mut projected = Logs::zeros();
        for site in scene {
            projected += difference(site) * log_slopes(&paper, &site.geometry);
        }
        let taken_up = self.inverse * projected;
        let rest = |site: &Site| {
            let own = difference(site) - taken_up.dot(&log_slopes(&paper, &site.geometry));
            own.clamp(-LARGEST_DIFFERENCE, LARGEST_DIFFERENCE)
        };
        sites.iter().map(rest).collect()
    }
}

/// The mean square error that chosen sites will leave, and that each further one would.
#[derive(Clone)]
pub(super) struct Criterion<'a> {
    field: &'a Field<'a>,
    particles: Vec<Particle>,
    misfit: f64,
}

/// The sums of the criterion at one set of parameters.
#[derive(Clone)]
struct Particle {
    slopes: Vec<Logs>,
    weights: Vec<f64>,
    /// The mean over the scene of K_d(site, x) j(x).
    cross: Vec<Logs>,
    gram: Matrix4<f64>,
    a: Matrix4<f64>,
    m: Matrix4<f64>,
    h: Matrix4<f64>,
    /// sum_s w_s j_s K(s, site) over the chosen sites s.
    pull: Vec<Logs>,
}

impl<'a> Criterion<'a> {
    /// Without a chosen site. `read` are the sites with readings, for the floor of the weights.
    pub(super) fn new(field: &'a Field<'a>, prior: &Prior, samples: &[Logs], read: usize) -> Self {
        let precision = prior.deviation.map(|x| field.error.variance() / (x * x));
        let precision = Matrix4::from_diagonal(&precision);
        let covariances = field.scene_covariances();
        let particles = samples
            .iter()
            .map(|at| Particle::new(field, at, &precision, &covariances, read))
            .collect();
        Self {
            field,
            particles,
            misfit: field.misfit(),
        }
    }

    /// The number of sites.
    pub(super) fn count(&self) -> usize {
        self.field.sites.len()
    }

    /// The root mean square error of ln f_r over the scene.
    pub(super) fn error(&self) -> f64 {
        let each = self.particles.iter().map(|particle| particle.error(None));
        self.root(each.sum::<f64>())
    }

    /// The same with one more site.
    pub(super) fn error_with(&self, site: usize) -> f64 {
        let own = self.field.variance(site);
        let each = self.particles.iter();
        self.root(each.map(|particle| particle.error(Some((site, own)))).sum())
    }

    fn root(&self, sum: f64) -> f64 {
        (sum / self.particles.len() as f64 + self.misfit)
            .max(0.0)
            .sqrt()
    }

    /// Adds a site to those that are chosen.
    pub(super) fn choose(&mut self, site: usize) {
        let (field, count) = (self.field, self.field.sites.len());
        let covariances: Vec<f64> = (0..count).map(|k| field.covariance(site, k)).collect();
        let own = field.variance(site);
        for particle in &mut self.particles {
            particle.choose(site, own, &covariances);
        }
    }

    /// The standard deviations of ln k2, ln kD, ln k1 and ln(n - 1), at the most probable parameters.
    pub(super) fn deviations(&self) -> Logs {
        let particle = &self.particles[0];
        let inverse = inverse(&particle.a);
        let covariance = inverse * particle.m * inverse;
        covariance.diagonal().map(|x| x.max(0.0).sqrt())
    }
}

impl Field<'_> {
    /// K_d between each site and each direction of the scene.
    fn scene_covariances(&self) -> Vec<Vec<f64>> {
        let row = |site| {
            (0..self.scene.len())
                .map(|x| self.to_scene(site, x))
                .collect()
        };
        (0..self.sites.len()).map(row).collect()
    }
}

impl Particle {
    fn new(
        field: &Field<'_>,
        at: &Logs,
        precision: &Matrix4<f64>,
        covariances: &[Vec<f64>],
        read: usize,
    ) -> Self {
        let brdf = brdf(Family::Paper, at);
        let slopes = |places: &[Place]| -> Vec<Logs> {
            let each = places.iter();
            each.map(|p| log_slopes(&brdf, &p.site.geometry)).collect()
        };
        let (own, of_scene) = (slopes(&field.sites), slopes(&field.scene));
        let count = of_scene.len() as f64;
        let mut gram = Matrix4::zeros();
        for j in &of_scene {
            gram += j * j.transpose() / count;
        }
        let cross = covariances.iter().map(|row| {
            let each = row.iter().zip(&of_scene).map(|(k, j)| j * *k);
            each.sum::<Logs>() / count
        });
        Self {
            weights: weights(&brdf, field, read),
            cross: cross.collect(),
            gram,
            a: *precision,
            m: *precision * field.error.variance(),
            h: Matrix4::zeros(),
            pull: vec![Logs::zeros(); own.len()],
            slopes: own,
        }
    }

    /// The mean square error less that of the misfit, with one more site of that variance.
    fn error(&self, more: Option<(usize, f64)>) -> f64 {
        let (mut a, mut m, mut h) = (self.a, self.m, self.h);
        if let Some((site, own)) = more {
            self.add(site, own, &mut a, &mut m, &mut h);
        }
        let inverse = inverse(&a);
        (inverse * m * inverse * self.gram).trace() - 2.0 * (inverse * h).trace()
    }

    fn add(
        &self,
        site: usize,
        own: f64,
        a: &mut Matrix4<f64>,
        m: &mut Matrix4<f64>,
        h: &mut Matrix4<f64>,
    ) {
        let (j, w) = (self.slopes[site], self.weights[site]);
        let pulled = j * self.pull[site].transpose() * w;
        *a += j * j.transpose() * w;
        *m += j * j.transpose() * (w * w * own) + pulled + pulled.transpose();
        *h += j * self.cross[site].transpose() * w;
    }

    fn choose(&mut self, site: usize, own: f64, covariances: &[f64]) {
        let (mut a, mut m, mut h) = (self.a, self.m, self.h);
        self.add(site, own, &mut a, &mut m, &mut h);
        (self.a, self.m, self.h) = (a, m, h);
        let pull = self.slopes[site] * self.weights[site];
        for (sum, covariance) in self.pull.iter_mut().zip(covariances) {
            *sum += pull * *covariance;
        }
    }
}

fn inverse(a: &Matrix4<f64>) -> Matrix4<f64> {
    a.try_inverse().unwrap_or_else(Matrix4::zeros)
}

/// The weights of relative errors, with the floor of the fit: m^2/(m^2 + floor^2), m = f_r cos(theta).
fn weights(brdf: &brdf_core::AnyBrdf, field: &Field<'_>, read: usize) -> Vec<f64> {
    let intensity = |place: &Place| {
        let geometry = &place.site.geometry;
        brdf.value(geometry) * geometry.cos_theta()
    };
    let values: Vec<f64> = field.sites.iter().map(intensity).collect();
    let squares =
        |values: &[f64]| values.iter().map(|m| m * m).sum::<f64>() / values.len().max(1) as f64;
    let mean = if read < READINGS_FOR_FLOOR {
        squares(&values)
    } else {
        squares(&values[..read])
    };
    let floor = RELATIVE_FLOOR.powi(2) * mean;
    values.iter().map(|m| m * m / (m * m + floor)).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::planning::prior::MaterialClass;
    use crate::planning::scene_points::directions;
    use crate::planning::setting::Setting;

    fn sites() -> Vec<Site> {
        let mut sites = Vec::new();
        for psi in [10.0, 45.0, 70.0_f64] {
            for theta in [-75.0, -45.0, -10.0, 30.0_f64] {
                let [psi, theta] = [psi, theta].map(f64::to_radians);
                let setting = Setting {
                    psi,
                    theta,
                    phi: 0.3,
                };
                sites.push(Site::new(setting).unwrap());
            }
        }
        sites
    }

    fn with_field(check: impl FnOnce(&Field<'_>, &Prior, &Belief)) {
        let (error, prior) = (ErrorModel::default(), Prior::of(MaterialClass::Paint));
        let belief = Belief::of_prior(&prior);
        let others = [(Family::Ggx, prior.mean)];
        let scene = directions(&brdf_core::scene::Domain::default());
        check(
            &Field::new(&error, &scene, &sites(), &belief, &others),
            &prior,
            &belief,
        );
    }

    /// The mean square error by matrices of all readings, as its definition has it.
    #[test]
    fn the_sums_are_those_of_the_definition() {
        with_field(|field, prior, belief| {
            let chosen = [1, 4, 6, 9, 11];
            let mut criterion = Criterion::new(field, prior, &[belief.mode], 0);
            for site in chosen {
                criterion.choose(site);
            }
            let brdf = brdf(Family::Paper, &belief.mode);
            let weights = weights(&brdf, field, 0);
            let slopes = |place: &Place| log_slopes(&brdf, &place.site.geometry);
            let (count, directions) = (chosen.len(), field.scene.len());
            let j = DMatrix::from_fn(count, 4, |i, k| slopes(&field.sites[chosen[i]])[k]);
            let w = DMatrix::from_fn(
                count,
                count,
                |i, k| {
                    if i == k { weights[chosen[i]] } else { 0.0 }
                },
            );
            let covariance = DMatrix::from_fn(count, count, |i, k| {
                if i == k {
                    field.variance(chosen[i])
                } else {
                    field.covariance(chosen[i], chosen[k])
                }
            });
            let of_error = field.error.variance();
            let p = DMatrix::from_fn(4, 4, |i, k| {
                if i == k {
                    of_error / prior.deviation[i].powi(2)
                } else {
                    0.0
                }
            });
            let a = (j.transpose() * &w * &j + &p).try_inverse().unwrap();
            let influence = &a * j.transpose() * &w;
            let spread = &influence * &covariance * influence.transpose() + &a * &p * &a * of_error;
            let mut expected = field.misfit();
            for x in 0..directions {
                let own = slopes(&field.scene[x]);
                let own = DMatrix::from_fn(4, 1, |k, _| own[k]);
                let shared = DMatrix::from_fn(count, 1, |i, _| field.to_scene(chosen[i], x));
                let square = own.transpose() * &spread * &own;
                let cross = own.transpose() * &influence * shared;
                expected += (square[0] - 2.0 * cross[0]) / directions as f64;
            }
            let found = criterion.error().powi(2);
            assert!(
                (found - expected).abs() < 1e-9 * expected,
                "{found} {expected}"
            );
        });
    }

    #[test]
    fn the_error_with_a_site_is_that_after_choosing_it() {
        with_field(|field, prior, belief| {
            let mut criterion = Criterion::new(field, prior, &belief.samples(), 0);
            criterion.choose(2);
            let expected = criterion.error_with(7);
            criterion.choose(7);
            assert!((criterion.error() / expected - 1.0).abs() < 1e-9);
        });
    }

    /// A second reading at one place brings less than one elsewhere: the misfit there is the same.
    #[test]
    fn a_repetition_brings_less_than_another_place() {
        with_field(|field, prior, belief| {
            let mut criterion = Criterion::new(field, prior, &belief.samples(), 0);
            for site in [0, 3, 5, 8, 10] {
                criterion.choose(site);
            }
            let repeated = criterion.error_with(10);
            let best = (0..field.sites.len()).map(|site| criterion.error_with(site));
            assert!(best.fold(f64::INFINITY, f64::min) < repeated);
        });
    }
}
