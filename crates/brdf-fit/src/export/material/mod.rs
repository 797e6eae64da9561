//! What is exported: the fits of one surface as BRDFs.

mod error;
mod file;
mod fitted;

pub use error::{MaterialError, SelectionError};
pub use fitted::{Fitted, Material};
