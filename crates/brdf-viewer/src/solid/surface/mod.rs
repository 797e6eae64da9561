//! A surface under light: a ball, and a plate at grazing light, shaded by a BRDF on the processor.
//!
//! The light is a lamp far away and a uniform sky all around. The picture shows the reflected radiance in
//! units of that of a perfect diffuser, f_r = 1/pi, which faces a lamp that gives all the light: the lamp
//! contributes pi f_r cos psi, the sky its hemispherical reflectance towards the viewer, each times its
//! share of the light. There are neither shadows nor a second reflection.
//!
//! [`Pixels`] holds what does not depend on the BRDF, so that it is kept while a parameter changes.

mod colours;
mod composed;
mod develop;
mod pixels;
mod shading;
mod sky;

pub use colours::{Channels, channels};
pub use composed::Composition;
pub use develop::{MOST_STOPS, automatic_stops, develop, stops_for_highlights};
pub use pixels::{Pixels, lamp_direction};
pub use shading::{Light, Radiance, shade};
pub use sky::Sky;
