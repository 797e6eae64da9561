//! Fits of many scans that share their angles.
//!
//! An imaging goniometer takes a scan for each pixel, a spectral one a scan for each wavelength, and all
//! of them have the same angles. The columns of the model then depend on k1, n and p alone: they are
//! computed once, in a [`BatchPlan`], and each scan costs a few scalar products.
//!
//! For given k1, n and p the model is linear in k2 and kD. With y the weighted readings, a the diffuse
//! column and u the lobe's, the exact minimum of E over k2 >= 0 and kD >= 0 is yy - F, where F follows
//! from a'y and v'y, the scalar products with a' = a/|a| and with v, the unit column orthogonal to a' in the
//! plane of a and u. Both are linear in y, and the columns v of all widths lie within rounding in a space of
//! some 25 dimensions:
//!
//! 1. `basis`: the scan is projected once. `table`: the columns of the grid in that basis.
//! 2. `search`: F at all points of the grid; `cell`: its maxima between the widths, by Newton's method on
//!    polynomials of ln k1.
//! 3. `exact`: the weights, E and standard errors at the result, with the columns of the model itself.
//!
//! Where n or p are free, the basis is coarse and gives the starts of descents with exact columns
//! (`solver::descent`). Scans with gaps or with weights of their own have their own scalar products (`own`)
//! and are followed with exact columns between two widths of the grid (`along`).
//!
//! The optimum is that of [`fit`](crate::fit::fit()): E of the two differed by less than 1e-9 of its value, or
//! 1e-13 of the readings' squares, on all scans of `tests/batch.rs`, 100,000 of each of nine models in five
//! geometries. Neither search proves its optimum.

mod along;
mod basis;
mod cell;
mod exact;
mod own;
mod plan;
mod result;
mod run;
mod scans;
mod search;
mod table;

pub use plan::{BatchError, BatchOptions, BatchPlan};
pub use result::{BatchFit, StandardErrors, Status};
pub use run::{BatchObserver, BatchRun};
pub use scans::Scans;
