//! Speed for accuracy, measured: what each way costs, how far it errs, and which are worth it.
//!
//! - [`pareto`]: which choices no other one beats;
//! - [`picture`]: cost against error.

pub mod pareto;
pub mod picture;
