//! The directions that occur in a scene.

use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

/// Whether directions leave the plane of incidence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Azimuth {
    /// phi is 0 or pi.
    InPlane,
    /// Any phi.
    Full,
}

/// Ranges of the incidence angle and of the view angle's magnitude, in radians, and the azimuths.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RawDomain")]
pub struct Domain {
    pub(crate) incidence: (f64, f64),
    pub(crate) view: (f64, f64),
    pub(crate) azimuth: Azimuth,
}

/// Why there is no such domain.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{angle} from {from} to {to} rad: expected a range within [0, pi/2)")]
pub struct DomainError {
    angle: &'static str,
    from: f64,
    to: f64,
}

/// A domain as it stands in a file.
#[derive(Deserialize)]
struct RawDomain {
    incidence: (f64, f64),
    view: (f64, f64),
    azimuth: Azimuth,
}

impl TryFrom<RawDomain> for Domain {
    type Error = DomainError;

    fn try_from(raw: RawDomain) -> Result<Self, DomainError> {
        Self::new(raw.incidence, raw.view, raw.azimuth)
    }
}

/// All directions up to 85 deg.
impl Default for Domain {
    fn default() -> Self {
        let range = (0.0, 85_f64.to_radians());
        Self {
            incidence: range,
            view: range,
            azimuth: Azimuth::Full,
        }
    }
}

impl Domain {
    /// The domain of ranges, each from its smaller to its larger end, within [0, pi/2).
    pub fn new(
        incidence: (f64, f64),
        view: (f64, f64),
        azimuth: Azimuth,
    ) -> Result<Self, DomainError> {
        for (angle, (from, to)) in [("incidence psi", incidence), ("view theta", view)] {
            if !(0.0 <= from && from <= to && to < FRAC_PI_2) {
                return Err(DomainError { angle, from, to });
            }
        }
        Ok(Self {
            incidence,
            view,
            azimuth,
        })
    }

    /// The domain with all azimuths.
    pub fn all(incidence: (f64, f64), view: (f64, f64)) -> Result<Self, DomainError> {
        Self::new(incidence, view, Azimuth::Full)
    }

    /// The domain in plane, of ranges that are known to be right.
    pub(crate) fn in_plane(incidence: (f64, f64), view: (f64, f64)) -> Self {
        Self {
            incidence,
            view,
            azimuth: Azimuth::InPlane,
        }
    }

    /// The range of the incidence angle psi, in radians.
    pub fn incidence(&self) -> (f64, f64) {
        self.incidence
    }

    /// The range of the view angle's magnitude, in radians.
    pub fn view(&self) -> (f64, f64) {
        self.view
    }

    /// Whether directions leave the plane of incidence.
    pub fn azimuth(&self) -> Azimuth {
        self.azimuth
    }

    /// A bound of the facet's tilt alpha, and of the incidence gamma on it: half of the largest
    /// angle between the source and the view, or its mirror image.
    pub(crate) fn largest_facet_angle(&self) -> f64 {
        0.5 * (self.incidence.1 + self.view.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_outside_are_named() {
        let error = Domain::all((0.0, 1.6), (0.0, 1.0)).unwrap_err();
        assert!(error.to_string().starts_with("incidence psi from 0 to 1.6"));
        let error = Domain::all((0.0, 1.0), (0.5, 0.4)).unwrap_err();
        assert!(error.to_string().starts_with("view theta from 0.5 to 0.4"));
        assert!(Domain::all((f64::NAN, 1.0), (0.0, 1.0)).is_err());
    }
}
