//! The trade-off of fitting: the time of each way to fit a scan, the excess of its E over the best,
//! and the shift of its parameters from those of the full procedure.
//!
//! ```no_run
//! use brdf_fit::tradeoff::fitting::fit_tradeoff;
//! use brdf_fit::{FitOptions, Measurements, RefractiveIndex};
//!
//! let options = FitOptions {
//!     refractive_index: Some(RefractiveIndex::Same(1.5)),
//!     ..FitOptions::default()
//! };
//! for scan in Measurements::read_csv("data/measured/z307_on_aluminium.csv")?.by_wavelength() {
//!     println!("{}", fit_tradeoff(&scan, &options)?.text());
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `trials` lists the ways, which fit all readings or those that `reduced` leaves, by the stages of a
//! fit or by `profile_alone`; `timing` measures them; `compare` sets them against the reference; `text`,
//! `csv` and `figure` present the results.

mod compare;
mod csv;
mod error;
#[cfg(feature = "plot")]
mod figure;
mod profile_alone;
mod reduced;
mod result;
mod text;
mod timing;
mod trials;

pub use compare::fit_tradeoff;
pub use csv::{FIT_TRADEOFF_COLUMNS, write_fit_tradeoffs};
pub use error::{TradeoffError, TrialError};
pub use result::{Alternative, FitTradeoff, Measured, OfParameter, Outcome, Reference};
