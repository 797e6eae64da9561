//! Distributions of facet normals: the paper's, eq. (2), and those of its reference models.
//!
//! Each is evaluated relative to its peak, f(alpha)/f(0), as in the model. The width k1 has the same
//! meaning in all of them: far from the peak of a narrow distribution, f(alpha) depends on
//! tan alpha / k1 alone.

mod beckmann;
mod distribution;
mod ellipsoid;
mod ggx;
mod power;
#[cfg(test)]
mod tests;

pub use beckmann::Beckmann;
pub use distribution::FacetDistribution;
pub use ellipsoid::Ellipsoid;
pub use ggx::Ggx;
pub use power::Power;
