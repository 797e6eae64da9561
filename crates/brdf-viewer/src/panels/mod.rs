//! The parts of the window, a file each: they draw the state and answer with intents.

pub mod dialog;
pub mod drop;
pub mod fit;
pub mod menu;
pub mod messages;
pub mod parameters;
pub mod results;
pub mod samples;
pub mod status;
