//! Shadowing and masking of facets by adjacent facets.

mod factor;
mod smith;
#[cfg(test)]
mod tests;
mod v_groove;

pub use factor::Shadowing;
pub use smith::Smith;
pub use v_groove::VGroove;
