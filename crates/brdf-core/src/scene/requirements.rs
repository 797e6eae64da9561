//! What a scene requires of the evaluation of a BRDF.

use serde::{Deserialize, Serialize};

use super::domain::Domain;

/// The coordinates in which a scene gives its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Coordinates {
    /// Cosines of psi, theta and phi.
    #[default]
    Cosines,
    /// psi, signed theta and phi in radians.
    Angles,
    /// Unit vectors.
    Directions,
}

/// What a scene requires of a BRDF.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// The directions that occur.
    pub domain: Domain,
    /// The coordinates that they come in.
    pub coordinates: Coordinates,
    /// The largest relative error of f_r, at the points as they come.
    pub tolerance: f64,
    /// The largest memory of a table, in bytes.
    pub memory_limit: usize,
    /// How many evaluations there will be: what a table costs to be made is divided by it.
    pub evaluations: f64,
}

/// All directions up to 85 deg, to 1e-3, 1e8 times, within 64 MiB.
impl Default for Scene {
    fn default() -> Self {
        Self {
            domain: Domain::default(),
            coordinates: Coordinates::default(),
            tolerance: 1e-3,
            memory_limit: 64 << 20,
            evaluations: 1e8,
        }
    }
}
