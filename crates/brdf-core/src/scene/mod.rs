//! The fastest evaluator of a BRDF that meets the requirements of a scene, by measurement.
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
mod requirements;

pub use cost::{TIMED, cost, cost_of_single_values};
pub use domain::{Azimuth, Domain, DomainError};
pub use plan::{Candidate, Plan, PlanError, Refusal, Survey};
pub use probe::{Errors, Probe};
pub use requirements::{Coordinates, Scene};
