//! The results of fits in the forms in which people and programs read them: tables as text and HTML,
//! a JSON document, and the parameters and curves as CSV.

mod csv;
mod details;
mod document;
mod html;
mod incidences;
mod layout;
mod models;
mod parameters;
mod run;
mod sentences;
mod stages;
mod summary;
mod table;
mod text;

pub use csv::{
    CURVE_COLUMNS, MODEL_COLUMNS, PARAMETER_COLUMNS, THEORY_COLUMNS, write_curves, write_models,
    write_parameters, write_theory,
};

#[cfg(feature = "export")]
pub(crate) use document::without_position;
pub use document::{ByFile, Document, DocumentError};
pub use html::{Picture, html};
pub use models::model_table;
pub use run::{Depth, ModelChoice, Report};
pub use summary::summary;
pub use table::{Alignment, Column, Row, Table};
pub use text::Section;
