//! The settings of the lobe and of the surface, and what they show.

pub mod derived;
mod drawings;
mod subjects;
pub mod view;

pub use subjects::Beside;
pub use view::{Solid, SolidView};
