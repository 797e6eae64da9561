//! Where a lobe is looked at from.

use std::f64::consts::{FRAC_PI_2, TAU};

use serde::{Deserialize, Serialize};

use super::vector::Vector;

/// The lowest height above the horizon, in radians: the surface is never seen from below.
const LOWEST: f64 = 0.03;

/// The smallest and the largest magnification.
const ZOOM: [f64; 2] = [0.3, 20.0];

/// The direction and the magnification of a view from far away.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// The angle around the normal in radians; 0 is at right angles to the plane of incidence, with the
    /// source to the right.
    pub yaw: f64,
    /// The height above the horizon in radians, up to pi/2.
    pub pitch: f64,
    /// The magnification.
    pub zoom: f64,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            yaw: 0.5,
            pitch: 0.45,
            zoom: 1.0,
        }
    }
}

impl Camera {
    /// The camera turned by angles in radians: around the normal, and upwards as far as it can.
    pub fn turned(self, yaw: f64, pitch: f64) -> Self {
        Self {
            yaw: (self.yaw + yaw).rem_euclid(TAU),
            pitch: (self.pitch + pitch).clamp(LOWEST, FRAC_PI_2),
            ..self
        }
    }

    /// The camera with a magnification larger by a factor, within its limits.
    pub fn zoomed(self, factor: f64) -> Self {
        Self {
            zoom: (self.zoom * factor).clamp(ZOOM[0], ZOOM[1]),
            ..self
        }
    }

    /// Whether all numbers are within their limits.
    pub fn is_valid(&self) -> bool {
        self.yaw.is_finite()
            && (LOWEST..=FRAC_PI_2).contains(&self.pitch)
            && (ZOOM[0]..=ZOOM[1]).contains(&self.zoom)
    }

    /// Unit vectors to the right and upwards in the picture, and towards the camera.
    pub(super) fn axes(&self) -> [Vector; 3] {
        let ((sin_yaw, cos_yaw), (sin_pitch, cos_pitch)) =
            (self.yaw.sin_cos(), self.pitch.sin_cos());
        [
            [cos_yaw, sin_yaw, 0.0],
            [-sin_yaw * sin_pitch, cos_yaw * sin_pitch, cos_pitch],
            [sin_yaw * cos_pitch, -cos_yaw * cos_pitch, sin_pitch],
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::super::vector::{cross, difference, dot};
    use super::*;

    #[test]
    fn the_axes_are_at_right_angles_and_the_surface_is_seen_from_above() {
        let mut camera = Camera::default();
        for _ in 0..40 {
            camera = camera.turned(0.37, 0.11).zoomed(1.3);
            let [right, up, towards] = camera.axes();
            let off = difference(cross(right, up), towards);
            assert!(dot(off, off) < 1e-24);
            assert!(towards[2] > 0.0 && camera.is_valid());
        }
        assert_eq!(camera.pitch, FRAC_PI_2);
        assert_eq!(camera.zoom, ZOOM[1]);
        assert_eq!(camera.turned(0.0, -9.0).pitch, LOWEST);
    }
}
