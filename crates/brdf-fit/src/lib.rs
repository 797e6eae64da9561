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
//!                                 objective, profile, solver    prediction, ladder of models
//! ```
//!
//! Every step on the way can be watched, and ended: see [`watch`].
//!
//! Angles are in radians, wavelengths in micrometres, the BRDF in 1/sr; degrees stand in files and
//! on screens only, with `_deg` in the name.

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "export")]
pub mod export;
pub mod fit;
pub mod format;
pub mod inference;
pub mod model;
pub mod objective;
pub mod output;
#[cfg(feature = "plot")]
pub mod plot;
pub mod progress;
pub mod read;
pub mod report;
pub mod scan;
pub mod solver;
#[cfg(feature = "tradeoff")]
pub mod tradeoff;

pub use fit::{Fit, FitError, FitOptions, fit};
pub use scan::{Measurement, Measurements, RefractiveIndex};
pub use solver::Method;
