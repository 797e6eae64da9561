//! Speed for accuracy, measured: what each way costs, how far it errs, and which are worth it.
//!
//! - [`fitting`]: the ways to fit a scan, time against E;
//! - [`pareto`]: which choices no other one beats;
//! - [`picture`]: cost against error.

pub mod fitting;
pub mod pareto;
pub mod picture;
