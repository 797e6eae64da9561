//! The directions at which a lobe is evaluated: a grid that is crowded about the mirror direction, which
//! is one of its points, so that a narrow lobe has its height and its width.

use std::f64::consts::PI;

use brdf_core::{AnyBrdf, Geometry};

/// The number of zenith angles.
pub(super) const ROWS: usize = 65;

/// The number of azimuths. The first and the last are the same direction.
pub(super) const COLUMNS: usize = 129;

/// The largest zenith angle in radians: next to 90 deg, which is not in the domain of the model.
const END: f64 = 89.9 * PI / 180.0;

/// The least number of rows on each side of the mirror direction.
const LEAST_ROWS: usize = 12;

/// The number of steps next to the mirror direction within half the width of the lobe.
const STEPS_IN_LOBE: f64 = 4.0;

/// The zenith angles and the azimuths of a grid of directions, in radians.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Directions {
    pub(super) theta: Vec<f64>,
    pub(super) phi: Vec<f64>,
}

impl Directions {
    /// The directions for a BRDF at an incidence angle psi in radians.
    pub(super) fn new(brdf: &AnyBrdf, psi: f64) -> Self {
        let width = half_width(brdf, psi);
        Self {
            theta: zenith_angles(psi.min(END), width),
            phi: azimuths(width / psi.sin().max(1e-9)),
        }
    }
}

/// The angle in radians from the mirror direction, along theta, at which half the specular part is
/// left; at most 1.
fn half_width(brdf: &AnyBrdf, psi: f64) -> f64 {
    let diffuse = brdf.parameters().kd / PI;
    let specular = |theta: f64| {
        let geometry = Geometry::in_plane(psi, -theta);
        geometry.map_or(0.0, |geometry| brdf.value(&geometry) - diffuse)
    };
    let half = 0.5 * specular(psi);
    let inwards = if psi > 0.0 { -1.0 } else { 1.0 };
    let mut width = 1e-4;
    while width < 1.0 && specular(psi + inwards * width) > half {
        width *= 1.2;
    }
    width.min(1.0)
}

fn zenith_angles(psi: f64, width: f64) -> Vec<f64> {
    let last = ROWS - 1;
    let mirror = if psi > 0.0 {
        let share = (psi / END * last as f64).round() as usize;
        share.clamp(LEAST_ROWS, last - LEAST_ROWS)
    } else {
        0
    };
    let below = crowded(psi, mirror, width);
    let above = crowded(END - psi, last - mirror, width);
    let below = below[1..].iter().rev().map(|distance| psi - distance);
    let mut theta: Vec<f64> = below
        .chain(above.iter().map(|distance| psi + distance))
        .collect();
    // The sums may differ from the ends by a rounding.
    theta[0] = 0.0;
    theta[mirror] = psi;
    theta[last] = END;
    theta
}

fn azimuths(width: f64) -> Vec<f64> {
    let distances = crowded(PI, COLUMNS / 2, width);
    let before = distances[1..].iter().rev().map(|distance| PI - distance);
    before
        .chain(distances.iter().map(|distance| PI + distance))
        .collect()
}

/// `steps` + 1 distances from 0 to `length`, the first step about a part of `width`: a sinh(a u), with the
/// `a` that makes it so, or evenly spaced where that is fine enough.
fn crowded(length: f64, steps: usize, width: f64) -> Vec<f64> {
    let even = length / steps.max(1) as f64;
    let wanted = (width / STEPS_IN_LOBE / even).max(1e-4);
    let (mut low, mut high) = (0.0_f64, 20.0_f64);
    for _ in 0..50 {
        let a = 0.5 * (low + high);
        if a / a.sinh() > wanted {
            low = a;
        } else {
            high = a;
        }
    }
    let a = low;
    let distance = |i: usize| {
        let u = i as f64 / steps as f64;
        match a {
            a if a < 1e-3 => length * u,
            a => length * (a * u).sinh() / a.sinh(),
        }
    };
    (0..=steps)
        .map(|i| if i == 0 { 0.0 } else { distance(i) })
        .collect()
}

#[cfg(test)]
mod tests {
    use brdf_core::{Family, ModelParameters};

    use super::*;

    fn brdf(k1: f64) -> AnyBrdf {
        let at = ModelParameters {
            k2: 0.3,
            kd: 0.1,
            k1,
            n: 1.5,
            p: 1.0,
        };
        AnyBrdf::new(Family::Paper, &at).unwrap()
    }

    #[test]
    fn the_mirror_direction_is_one_of_them_and_they_ascend() {
        for k1 in [0.002, 0.05, 0.4, 2.0] {
            for psi_deg in [0.0_f64, 0.3, 15.0, 60.0, 89.0, 89.8] {
                let psi = psi_deg.to_radians();
                let Directions { theta, phi } = Directions::new(&brdf(k1), psi);
                assert_eq!((theta.len(), phi.len()), (ROWS, COLUMNS));
                assert!(theta.contains(&psi) && phi.contains(&PI), "{k1} {psi_deg}");
                for ascending in [&theta, &phi] {
                    let mut steps = ascending.windows(2);
                    assert!(steps.all(|w| w[0] < w[1]), "{k1} {psi_deg}");
                }
                assert_eq!((theta[0], phi[0]), (0.0, 0.0));
                assert!((phi[COLUMNS - 1] - 2.0 * PI).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn the_steps_follow_the_width_of_the_lobe() {
        let step = |k1: f64| {
            let Directions { theta, .. } = Directions::new(&brdf(k1), 0.8);
            let mirror = theta.iter().position(|theta| *theta == 0.8).unwrap();
            theta[mirror + 1] - theta[mirror]
        };
        assert!(step(0.01) < 0.005, "{}", step(0.01));
        assert!(step(0.01) < 0.3 * step(0.1), "{}", step(0.1));
    }
}
