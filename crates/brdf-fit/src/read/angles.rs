//! Pairs of directions that a file gives by zenith angles and azimuths.

use std::f64::consts::PI;

/// The unit of the angles of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AngleUnit {
    Degrees,
    Radians,
}

impl AngleUnit {
    /// The angle of 180 deg in this unit.
    pub(super) fn half_turn(self) -> f64 {
        match self {
            Self::Degrees => 180.0,
            Self::Radians => PI,
        }
    }

    fn radians(self, angle: f64) -> f64 {
        match self {
            Self::Degrees => angle.to_radians(),
            Self::Radians => angle,
        }
    }
}

/// The directions of source (i) and view (s) of a reading, in the file's unit: zenith angles theta
/// from the normal, and azimuths phi about it. A negative zenith angle is a positive one at the opposite
/// azimuth, phi + 180 deg. Equal azimuths are the same side of the normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TwoDirections {
    pub(super) theta_i: f64,
    pub(super) phi_i: f64,
    pub(super) theta_s: f64,
    pub(super) phi_s: f64,
}

impl TwoDirections {
    /// psi, theta and phi in the model's convention, in radians:
    ///
    /// ```text
    /// psi = |theta_i|,  theta = theta_s,  phi = phi_s - phi_i (+ 180 deg where theta_i < 0)
    /// ```
    ///
    /// `None` where a direction is at or beyond 90 deg from the normal.
    pub(super) fn in_model(self, unit: AngleUnit) -> Option<(f64, f64, f64)> {
        let quarter = unit.half_turn() / 2.0;
        let inside = |angle: f64| angle.abs() < quarter;
        if !inside(self.theta_i) || !inside(self.theta_s) {
            return None;
        }
        let opposite = if self.theta_i < 0.0 {
            unit.half_turn()
        } else {
            0.0
        };
        let phi = self.phi_s - self.phi_i + opposite;
        let (psi, theta) = (self.theta_i.abs(), self.theta_s);
        let inside = |angle: f64| angle.abs() < PI / 2.0;
        let (psi, theta) = (unit.radians(psi), unit.radians(theta));
        (inside(psi) && inside(theta)).then_some((psi, theta, unit.radians(phi)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(theta_i: f64, phi_i: f64, theta_s: f64, phi_s: f64) -> Option<(f64, f64, f64)> {
        let directions = TwoDirections {
            theta_i,
            phi_i,
            theta_s,
            phi_s,
        };
        directions.in_model(AngleUnit::Degrees)
    }

    #[test]
    fn the_azimuth_is_counted_from_the_source() {
        let rad = f64::to_radians;
        let expected = Some((rad(30.0), rad(40.0), rad(180.0)));
        assert_eq!(model(30.0, 0.0, 40.0, 180.0), expected);
        assert_eq!(model(30.0, 90.0, 40.0, 270.0), expected);
        assert_eq!(model(-30.0, 0.0, 40.0, 0.0), expected);
        let in_plane = model(30.0, 180.0, -40.0, 180.0);
        assert_eq!(in_plane, Some((rad(30.0), rad(-40.0), 0.0)));
    }

    #[test]
    fn directions_at_or_beyond_the_horizon_are_none() {
        assert_eq!(model(90.0, 0.0, 0.0, 0.0), None);
        assert_eq!(model(0.0, 0.0, -90.0, 0.0), None);
        assert_eq!(model(0.0, 0.0, 120.0, 0.0), None);
        let directions = TwoDirections {
            theta_i: 0.0,
            phi_i: 0.0,
            theta_s: 1.6,
            phi_s: 0.0,
        };
        assert_eq!(directions.in_model(AngleUnit::Radians), None);
    }
}
