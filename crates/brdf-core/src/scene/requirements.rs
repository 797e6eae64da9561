//! The requirements of a scene.

use super::domain::Domain;

/// The coordinates in which the points of a scene are given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Coordinates {
    /// Cosines of psi, theta and phi.
    #[default]
    Cosines,
    /// psi, signed theta and phi in radians.
    Angles,
    /// Unit vectors towards the source and towards the viewer.
    Directions,
}

/// The requirements of a scene on the evaluation of a BRDF.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Scene {
    /// The directions that occur.
    pub domain: Domain,
    /// The coordinates in which they are given.
    pub coordinates: Coordinates,
    /// The largest relative error of f_r at the points as they are given, without the rounding of
    /// their coordinates.
    pub tolerance: f64,
    /// The number of evaluations, over which the time of making an evaluator is distributed.
    pub evaluations: f64,
}

/// 1e8 evaluations in all directions up to 85 deg, to the relative tolerance 1e-3.
impl Default for Scene {
    fn default() -> Self {
        Self {
            domain: Domain::default(),
            coordinates: Coordinates::default(),
            tolerance: 1e-3,
            evaluations: 1e8,
        }
    }
}
