//! The light of a uniform sky that a surface reflects.

use brdf_core::AnyBrdf;

/// The number of entries, by the zenith angle in equal steps.
const ENTRIES: usize = 1024;

/// The number of zenith angles at which the reflectance is integrated.
const NODES: usize = 16;

/// The largest of them in radians (89 deg): nearer to the horizon the reflectance stays the same, since a
/// pixel there is a part of the limb.
const LAST: f64 = 89.0 * std::f64::consts::PI / 180.0;

/// The relative tolerance of the integrals.
const TOLERANCE: f64 = 1e-3;

/// The radiance towards a zenith angle under a uniform sky, in units of that of the sky. By reciprocity
/// it is the hemispherical reflectance for light from there.
#[derive(Debug, Clone, PartialEq)]
pub struct Sky {
    table: Vec<f32>,
}

impl Sky {
    /// The sky on a BRDF. Between the angles that are integrated, which crowd towards the horizon, the
    /// reflectance is interpolated by cubics.
    pub fn new(brdf: &AnyBrdf) -> Self {
        let angle = |i: usize| {
            let part = i as f64 / (NODES - 1) as f64;
            LAST * (1.0 - (1.0 - part).powi(2))
        };
        let node = |i: usize| {
            let rho = brdf.hemispherical_reflectance(angle(i), TOLERANCE);
            (angle(i), rho.unwrap_or(0.0))
        };
        let nodes: Vec<(f64, f64)> = (0..NODES).map(node).collect();
        let mut before = 0;
        let entry = |i: usize| {
            let theta = (i as f64 / (ENTRIES - 1) as f64 * std::f64::consts::FRAC_PI_2).min(LAST);
            while before + 2 < NODES && nodes[before + 1].0 < theta {
                before += 1;
            }
            interpolated(&nodes, before, theta) as f32
        };
        Self {
            table: (0..ENTRIES).map(entry).collect(),
        }
    }

    /// The reflectance at an index.
    pub(super) fn at(&self, index: u16) -> f32 {
        self.table[usize::from(index)]
    }

    /// The reflectance towards a zenith angle in radians.
    pub fn reflectance(&self, theta: f64) -> f32 {
        self.at(Self::index(theta.cos() as f32))
    }

    /// The index of the entry for the cosine of a zenith angle.
    pub(super) fn index(cos_theta: f32) -> u16 {
        let part = cos_theta.clamp(0.0, 1.0).acos() / std::f32::consts::FRAC_PI_2;
        (part * (ENTRIES - 1) as f32).round() as u16
    }
}

/// The cubic between node `i` and the next one, with the slopes of parabolas through three nodes.
fn interpolated(nodes: &[(f64, f64)], i: usize, x: f64) -> f64 {
    let [(from, low), (to, high)] = [nodes[i], nodes[i + 1]];
    let (width, rise) = (to - from, high - low);
    let u = ((x - from) / width).clamp(0.0, 1.0);
    let [start, end] = [slope(nodes, i), slope(nodes, i + 1)].map(|slope| slope * width);
    let (square, cube) = (u * u, u * u * u);
    low + rise * (3.0 * square - 2.0 * cube)
        + start * (u - 2.0 * square + cube)
        + end * (cube - square)
}

/// The slope at a node. At the normal, around which the reflectance is even, it is 0.
fn slope(nodes: &[(f64, f64)], i: usize) -> f64 {
    let chord = |i: usize| (nodes[i + 1].1 - nodes[i].1) / (nodes[i + 1].0 - nodes[i].0);
    if i == 0 {
        return 0.0;
    }
    if i + 1 == nodes.len() {
        return chord(i - 1);
    }
    let [before, after] = [nodes[i].0 - nodes[i - 1].0, nodes[i + 1].0 - nodes[i].0];
    (chord(i - 1) * after + chord(i) * before) / (before + after)
}

#[cfg(test)]
mod tests {
    use brdf_core::{Family, ModelParameters};

    use super::*;

    #[test]
    fn the_table_is_the_reflectance() {
        for family in Family::ALL {
            for k1 in [0.02, 0.3] {
                let at = ModelParameters {
                    k2: 0.4,
                    kd: 0.05,
                    k1,
                    n: 1.5,
                    p: 1.4,
                };
                let brdf = AnyBrdf::new(family, &at).unwrap();
                let sky = Sky::new(&brdf);
                for deg in 0..88 {
                    let theta = f64::from(deg).to_radians();
                    let expected = brdf.hemispherical_reflectance(theta, 1e-6).unwrap();
                    let off = f64::from(sky.reflectance(theta)) / expected - 1.0;
                    assert!(off.abs() < 0.015, "{family:?} {k1} {deg}: {off}");
                }
            }
        }
    }
}
