//! The Fresnel factor of a dielectric facet.

mod dielectric;
mod factor;
mod polynomial;

pub use dielectric::Dielectric;
pub use factor::FresnelFactor;
pub use polynomial::FresnelPolynomial;
