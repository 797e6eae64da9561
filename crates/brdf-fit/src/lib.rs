//! From a goniometer scan to the parameters of [`brdf_core`]'s model, in the two stages of Li, Yan
//! and Wu (2002) and with a check of the global optimum.
//!
//! ```no_run
//! use brdf_fit::{FitOptions, Measurements, RefractiveIndex, fit};
//!
//! let options = FitOptions {
//!     refractive_index: Some(RefractiveIndex::Same(1.5)),
//!     ..FitOptions::default()
//! };
//! for scan in Measurements::read_csv("data/measured/z307_on_aluminium.csv")?.by_wavelength() {
//!     let fit = fit(&scan, &options)?;
//!     println!("{:?}: E = {} %", fit.parameters, fit.e_percent);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The data flow one way:
//!
//! ```text
//! file -> read -> Measurements -> initial -> stages -> Fit -> uncertainty, assessment -> report, plot
//!                                     |         |               |
//!                                 criterion, profile, solver    prediction, ladder of models
//! ```
//!
//! Every step on the way can be watched, and ended: see [`watch`].
//!
//! Angles are in radians, wavelengths in micrometres, the BRDF in 1/sr; degrees stand in files and
//! on screens only, with `_deg` in the name.

pub mod assessment;
pub mod criterion;
pub mod energy;
pub mod export;
pub mod initial;
pub mod measurement;
pub mod model;
pub mod output;
pub mod plot;
pub mod prediction;
pub mod profile;
pub mod read;
pub mod refractive_index;
pub mod report;
pub mod robust;
pub mod solver;
pub mod stages;
mod stratified;
pub mod synthetic;
pub mod trade;
pub mod uncertainty;
pub mod warning;
pub mod watch;
pub mod weights;
pub mod words;

pub use measurement::{Measurement, Measurements};
pub use refractive_index::RefractiveIndex;
pub use solver::Method;
pub use stages::{Fit, FitError, FitOptions, fit};
