//! The directions that occur in a scene.

use std::f64::consts::FRAC_PI_2;

/// Whether directions leave the plane of incidence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Azimuth {
    /// All views are in the plane of incidence: phi is 0 or pi.
    InPlane,
    /// phi is arbitrary.
    Full,
}

/// The ranges of the incidence angle and of the magnitude of the view angle, in radians, and of the
/// azimuth.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "RawDomain"))]
pub struct Domain {
    pub(crate) incidence: (f64, f64),
    pub(crate) view: (f64, f64),
    pub(crate) azimuth: Azimuth,
}

/// A range of angles that is not a range within [0, pi/2).
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{angle} from {from} to {to} rad: expected a range within [0, pi/2)")]
pub struct DomainError {
    angle: &'static str,
    from: f64,
    to: f64,
}

/// A domain as a file contains it, before it is checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct RawDomain {
    incidence: (f64, f64),
    view: (f64, f64),
    azimuth: Azimuth,
}

#[cfg(feature = "serde")]
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
    /// The domain of two ranges in radians, each from its smaller to its larger end and within
    /// [0, pi/2), with the given azimuths.
    ///
    /// # Errors
    ///
    /// [`DomainError`] for a range that is not within [0, pi/2) or whose ends are not ascending.
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

    /// The domain of two ranges in radians with all azimuths.
    ///
    /// # Errors
    ///
    /// [`DomainError`] as for [`new`](Self::new).
    pub fn all(incidence: (f64, f64), view: (f64, f64)) -> Result<Self, DomainError> {
        Self::new(incidence, view, Azimuth::Full)
    }

    /// The range of the incidence angle psi, in radians.
    pub fn incidence(&self) -> (f64, f64) {
        self.incidence
    }

    /// The range of the magnitude of the view angle theta, in radians.
    pub fn view(&self) -> (f64, f64) {
        self.view
    }

    /// Whether directions leave the plane of incidence.
    pub fn azimuth(&self) -> Azimuth {
        self.azimuth
    }

    /// A bound of the facet's tilt alpha and of the incidence gamma on it, in radians: half of the
    /// largest angle between the source and the view or its mirror image.
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
