//! A fitted BRDF in the forms that other programs take: source code, tables, scenes. One file a
//! form.

mod astm;
mod coating;
mod csv;
mod domain;
mod merl;
mod mitsuba;
mod rgb;
mod source;
mod table;
mod target;
mod zemax;

pub use coating::{Coating, CoatingError, Fitted};
pub use csv::AngleGrid;
pub use merl::LookupError;
pub use rgb::{COLOURS, PRIMARIES_UM, REACH_UM};
pub use source::{Language, NameError};
pub use target::{ExportError, ExportOptions, Target, USUAL_TOLERANCE, export, export_beside};
