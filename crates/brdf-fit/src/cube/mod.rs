//! Fits of the scans of an array of NumPy, piece by piece.
//!
//! An imaging goniometer gives a scan for each pixel, with the same angles for all. The array has any number of
//! dimensions, one of which runs over the readings; it is read in pieces of some megabytes, so that it need
//! not fit into memory, and the fits are written as they come:
//!
//! - `array`: the array and its pieces.
//! - `fit`: the fits of all pieces with one [`BatchPlan`](crate::batch::BatchPlan).
//! - `columns`: what is written of each fit; `npy` and `parquet`: the files.

mod array;
mod columns;
mod error;
mod fit;
mod npy;
#[cfg(feature = "parquet")]
mod parquet;

pub use array::{Cube, Element};
pub use error::CubeError;
pub use fit::{CubeFit, CubeOptions, OutputFormat};
