//! Exports fitted BRDFs in the formats of other programs: source code, tables and scenes.
//!
//! A [`Material`] contains the fits of one surface; [`export`] writes it as a [`Target`] with
//! [`ExportOptions`]. Each format has a file or a folder of its own, which imports the errors and
//! the options; only `target` knows all formats.

mod astm;
mod comments;
mod csv;
mod domain;
mod error;
mod grid;
mod interpolated;
mod material;
mod merl;
mod mitsuba;
mod nearest_bin;
mod options;
mod rgb;
mod source;
mod target;
#[cfg(test)]
mod test_fits;
mod zemax;

pub use error::ExportError;
pub use grid::{AngleGrid, AngleGridError};
pub use material::{Fitted, Material, MaterialError, SelectionError};
pub use nearest_bin::LookupError;
pub use options::{DEFAULT_TOLERANCE, ExportOptions};
pub use rgb::{COLOURS, MAX_DISTANCE_UM, PRIMARY_WAVELENGTHS_UM};
pub use source::{Language, NameError};
pub use target::{Target, UnknownTarget, export, export_companion};
