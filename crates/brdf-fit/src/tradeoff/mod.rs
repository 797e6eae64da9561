//! Speed for accuracy, measured: what each way costs, how far it errs, and which are worth it.
//!
//! - [`evaluators`]: the ways to evaluate a BRDF, time against error, over the directions of a scene;
//! - [`fitting`]: the ways to fit a scan, time against E;
//! - [`pareto`]: which choices no other one beats;
//! - [`picture`]: cost against error.

pub mod evaluators;
pub mod fitting;
pub mod pareto;
pub mod picture;
