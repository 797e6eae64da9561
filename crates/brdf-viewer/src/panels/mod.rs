//! The panels of the window, one per file. They draw the state and answer with intents.

pub mod dialog;
pub mod drop;
pub mod fit;
mod incidences;
pub mod menu;
pub mod messages;
pub mod parameters;
pub mod result;
pub mod results;
pub mod samples;
pub mod status;
mod wavelengths;
