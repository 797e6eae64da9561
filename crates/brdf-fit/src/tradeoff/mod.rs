//! Measured trade-offs between speed and accuracy: the cost of each alternative, its error, and the
//! alternatives that no other one beats in both.
//!
//! - [`evaluators`]: the ways to evaluate a BRDF over the directions of a scene, time against error;
//! - [`fitting`]: the ways to fit a scan, time against E;
//! - [`pareto`]: the Pareto front.

pub mod evaluators;
pub mod fitting;
pub mod pareto;
