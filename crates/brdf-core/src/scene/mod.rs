//! What a scene requires, and the cheapest evaluator that gives it.
//!
//! ```
//! use brdf_core::evaluator::{Evaluator as _, Points};
//! use brdf_core::scene::{Domain, Plan, Scene};
//! use brdf_core::{AnyBrdf, Parameters, ThreeParameterBrdf};
//!
//! let brdf = ThreeParameterBrdf::new(Parameters::new(1.211, 0.521, 0.071)?, 1.60)?;
//! let scene = Scene {
//!     domain: Domain::all((0.0, 1.2), (0.0, 1.4))?,
//!     tolerance: 1e-3,
//!     ..Scene::default()
//! };
//! let plan = Plan::new(&AnyBrdf::Paper(brdf), &scene)?;
//! let mut f_r = [0.0; 2];
//! let points = Points::Angles {
//!     psi: &[0.3, 0.3],
//!     theta: &[-0.3, -0.4],
//!     phi: &[0.0, 0.0],
//! };
//! plan.evaluator.values_f32(&points, &mut f_r)?;
//! # assert!(f_r[0] > f_r[1]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cost;
mod domain;
mod plan;
mod probe;

use serde::{Deserialize, Serialize};

pub use cost::{TIMED, cost, cost_of_single_values};
pub use domain::{Azimuth, Domain, DomainError};
pub use plan::{Candidate, Plan, PlanError, Refusal, Survey};
pub(crate) use probe::worst_error;
pub use probe::{Errors, Probe};

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
