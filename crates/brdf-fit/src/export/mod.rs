//! A fitted BRDF in the forms that other programs take: source code, tables, scenes. One file a
//! form.

mod astm;
mod csv;
mod domain;
mod interpolated;
mod material;
mod merl;
mod mitsuba;
mod rgb;
mod source;
mod target;
mod zemax;

pub use csv::AngleGrid;
pub use material::{Fitted, Material, MaterialError};
pub use merl::LookupError;
pub use rgb::{COLOURS, PRIMARIES_UM, REACH_UM};
pub use source::{Language, NameError};
pub use target::{ExportError, ExportOptions, Target, USUAL_TOLERANCE, export, export_beside};
