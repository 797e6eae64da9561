//! fit
pub mod criterion;
pub mod initial;
pub mod measurement;
pub mod output;
pub mod profile;
pub mod read;
pub mod refractive_index;
pub mod report;
pub mod solver;
pub mod stages;
pub mod synthetic;
pub mod warning;
pub mod weights;
mod words;

pub use measurement::{Measurement, Measurements};
pub use refractive_index::RefractiveIndex;
pub use solver::Method;
pub use stages::{Fit, FitError, FitOptions, fit};
