//! A direction pair that a goniometer can be set to.

use brdf_core::Geometry;

use crate::scan::Measurement;

/// A direction pair in the convention of the model: the incidence angle psi, the signed view angle theta and
/// the view azimuth phi, in radians. Positive theta at phi = 0 is on the side of the source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Incidence angle in [0, pi/2).
    pub psi: f64,
    /// View angle in (-pi/2, pi/2).
    pub theta: f64,
    /// View azimuth from that of the source.
    pub phi: f64,
}

impl Setting {
    /// The angle between the source and the detector, in radians.
    pub fn from_source(&self) -> f64 {
        let cosine =
            self.psi.cos() * self.theta.cos() + self.psi.sin() * self.theta.sin() * self.phi.cos();
        cosine.clamp(-1.0, 1.0).acos()
    }

    /// The angle between the detector and the mirror direction, in radians.
    pub fn from_mirror(&self) -> f64 {
        let mirrored = Self {
            theta: -self.theta,
            ..*self
        };
        mirrored.from_source()
    }

    /// The view angle without a sign, and the azimuth that belongs to it, in [0, 2 pi): 0 is the side of the
    /// source, pi the forward side.
    pub fn zenith_and_azimuth(&self) -> (f64, f64) {
        let half_turn = if self.theta < 0.0 {
            std::f64::consts::PI
        } else {
            0.0
        };
        let azimuth = (self.phi + half_turn).rem_euclid(std::f64::consts::TAU);
        (self.theta.abs(), azimuth)
    }
}

impl From<&Measurement> for Setting {
    fn from(reading: &Measurement) -> Self {
        Self {
            psi: reading.psi,
            theta: reading.theta,
            phi: reading.phi,
        }
    }
}

/// A setting with what the criterion needs of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Site {
    pub(super) setting: Setting,
    pub(super) geometry: Geometry,
    /// The place of the view in the plane of angles (zenith angle as radius) from the mirror direction: along
    /// the plane of incidence, and across it without a sign, in radians.
    pub(super) along: f64,
    pub(super) across: f64,
    /// The incidence angle on the facet, in radians.
    pub(super) gamma: f64,
}

impl Site {
    /// `None` where the setting is outside the domain of the model.
    pub(super) fn new(setting: Setting) -> Option<Self> {
        let Setting { psi, theta, phi } = setting;
        let geometry = Geometry::new(psi, theta, phi).ok()?;
        let is_above = geometry.cos_psi() > 1e-9 && geometry.cos_theta() > 1e-9;
        is_above.then(|| Self {
            setting,
            geometry,
            along: theta * phi.cos() + psi,
            across: (theta * phi.sin()).abs(),
            gamma: geometry.cos_gamma().clamp(0.0, 1.0).acos(),
        })
    }

    /// The tilt of the facet in widths of the lobe: asinh(tan(alpha)/k1), which grows like the tilt within the
    /// lobe and like its logarithm beyond.
    pub(super) fn tilt(&self, k1: f64) -> f64 {
        (self.geometry.tan2_alpha().sqrt() / k1).asinh()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn degrees(psi: f64, theta: f64, phi: f64) -> Setting {
        let [psi, theta, phi] = [psi, theta, phi].map(f64::to_radians);
        Setting { psi, theta, phi }
    }

    #[test]
    fn the_source_is_at_its_own_angle_and_the_mirror_direction_opposite() {
        assert!(degrees(30.0, 30.0, 0.0).from_source() < 1e-7);
        assert!(degrees(30.0, -30.0, 0.0).from_mirror() < 1e-7);
        assert!((degrees(30.0, -30.0, 0.0).from_source().to_degrees() - 60.0).abs() < 1e-9);
        let (zenith, azimuth) = degrees(30.0, -40.0, 10.0).zenith_and_azimuth();
        assert!((zenith.to_degrees() - 40.0).abs() < 1e-9);
        assert!((azimuth.to_degrees() - 190.0).abs() < 1e-9);
    }

    #[test]
    fn the_mirror_direction_is_the_origin_of_the_views() {
        let site = Site::new(degrees(50.0, -50.0, 0.0)).unwrap();
        assert!(site.along.abs() < 1e-12 && site.across < 1e-12);
        assert!(site.tilt(0.2) < 1e-7);
        assert!(Site::new(degrees(91.0, 0.0, 0.0)).is_none());
    }
}
