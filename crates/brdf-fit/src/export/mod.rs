//! A fitted BRDF in the forms that other programs take: source code, tables, scenes. One file a
//! form.

mod coating;
mod mitsuba;
mod rgb;
mod source;
mod target;

pub use coating::{Coating, CoatingError, Fitted};
pub use rgb::{COLOURS, PRIMARIES_UM, REACH_UM};
pub use source::{Language, NameError};
pub use target::{ExportError, ExportOptions, Target, export, export_beside};
