//! Readers of files with measured BRDFs, one module for each [`Format`](crate::scan::Format).
//!
//! Each reader converts once to the model's convention: f_r in 1/sr, angles in radians, wavelengths
//! in micrometres, theta positive and phi = 0 on the source's side. It reports what it converted and
//! what it left out in [`Measurements::conversions`](crate::Measurements::conversions).

mod angles;
pub mod astm;
pub mod black_lab;
mod comments;
mod conversion;
pub mod csv;
mod detect;
mod error;
mod fields;
mod file;
mod foreign;
pub mod fred;
pub mod goniometer;
pub mod klems;
mod lazy_scan;
pub mod lighttools;
pub mod merl;
mod names;
mod number;
pub mod open_material;
mod options;
mod reader;
pub mod rgl;
pub mod rt300s;
pub mod speos;
pub mod ssdd;
mod text;
pub mod tracepro;
pub mod workbook;
pub mod zemax;

pub use error::{ReadError, Remedy};
pub use lazy_scan::LazyScan;
pub use options::{DECLARED_KEYS, ReadOptions};
