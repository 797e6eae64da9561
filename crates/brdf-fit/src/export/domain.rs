//! The angles over which the tables of f_r are interpolated.

use std::f64::consts::FRAC_PI_2;

use brdf_core::{AnyBrdf, Geometry};

/// The largest incidence and view zenith angle at which the error of a table is bounded, in
/// degrees.
pub(super) const MAX_ZENITH_DEG: f64 = 85.0;

/// f_r in 1/sr by psi, theta and phi in radians; `None` outside the domain of the model.
pub(super) fn value(brdf: &AnyBrdf, [psi, theta, phi]: [f64; 3]) -> Option<f64> {
    let geometry = Geometry::new(psi, theta, phi).ok()?;
    Some(brdf.value(&geometry))
}

/// The geometry of psi, theta and phi in radians. Below the horizon it is that at the horizon, so that
/// the cells of a table that extend below it can be interpolated.
pub(super) fn continued_geometry([psi, theta, phi]: [f64; 3]) -> Option<Geometry> {
    Geometry::new(psi, theta.min(FRAC_PI_2.next_down()), phi).ok()
}

/// f_r in 1/sr at a [`continued_geometry`]; 0 outside the domain of the model.
pub(super) fn continued_value(brdf: &AnyBrdf, geometry: Option<&Geometry>) -> f64 {
    geometry.map_or(0.0, |geometry| brdf.value(geometry))
}

/// Angles at equal distances, both ends included; `count` is at least 2.
pub(super) fn evenly_spaced(from: f64, to: f64, count: u32) -> Vec<f64> {
    let step = (to - from) / f64::from(count - 1);
    (0..count).map(|i| from + f64::from(i) * step).collect()
}

/// 0, and angles from `to` downwards in geometric progression: dense near 0, where the specular
/// lobe may be narrow.
pub(super) fn dense_near_zero(to: f64) -> Vec<f64> {
    let ratio = 1.5_f64;
    let mut angles = vec![0.0];
    let mut angle = to;
    while angle > to * 1e-4 {
        angles.push(angle);
        angle /= ratio;
    }
    angles
}
