//! fit
pub mod criterion;
pub mod measurement;
pub mod profile;
pub mod read;
pub mod refractive_index;
pub mod solver;
pub mod weights;
