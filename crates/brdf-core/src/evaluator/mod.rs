//! The evaluation of many points at once, by evaluators that differ in speed and accuracy and share one
//! interface, [`Evaluator`].
//!
//! | evaluator | arithmetic | use |
//! |---|---|---|
//! | [`Double`] | `f64` | any |
//! | [`Single`] | `f32` | rendering |
//! | [`FittedFresnel`] | `f32`, with a polynomial of known error as the Fresnel factor | rendering, slightly faster |
//! | [`Lambertian`] | constant | surfaces, or ranges of angles, with a negligible specular part |
//! | [`SpecularOnly`] | `f32`, without the Lambertian part | surfaces with a negligible Lambertian part |
//!
//! ```
//! use brdf_core::evaluator::{Double, Evaluator as _, Points};
//! use brdf_core::{Parameters, ThreeParameterBrdf};
//!
//! let brdf = ThreeParameterBrdf::new(Parameters::new(1.211, 0.521, 0.071)?, 1.60)?;
//! let points = Points::Angles {
//!     psi: &[0.3, 0.3],
//!     theta: &[-0.3, -0.4],
//!     phi: &[0.0, 0.0],
//! };
//! let mut f_r = [0.0; 2];
//! Double::new(brdf.into()).values(&points, &mut f_r)?;
//! # assert!(f_r[0] > f_r[1]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Their time and their errors for a scene are measured by [`Plan`](crate::scene::Plan). The values of
//! [`Double`] differ from single values by a few roundings. The largest relative errors of [`Single`],
//! from cosines, for k2 = 0.3, kD = 0.1, n = 1.5 and p = 1.7, among 100,000 points half of which are
//! next to the mirror direction or at the ends of the ranges, are
//!
//! | angles up to | k1 | paper | Smith | power | GGX | Beckmann |
//! |---|---|---|---|---|---|---|
//! | 85 deg | 0.001 | 5.0e-7 | 5.2e-7 | 8.1e-7 | 6.2e-7 | 1.0e-6 |
//! | 85 deg | 0.01 | 4.7e-7 | 4.8e-7 | 8.6e-7 | 6.9e-7 | 1.0e-6 |
//! | 85 deg | 0.1 | 4.9e-7 | 5.1e-7 | 8.5e-7 | 6.5e-7 | 1.2e-6 |
//! | 85 deg | 1 | 5.9e-7 | 5.7e-7 | 5.9e-7 | 6.6e-7 | 1.3e-6 |
//! | 89.9 deg | 0.01 | 5.0e-7 | 5.6e-7 | 1.0e-6 | 6.3e-7 | 1.2e-6 |
//!
//! (`cargo test -p brdf-core --release --test evaluators -- --nocapture errors_in_f32` prints more of
//! them.) These are the errors of the evaluation at the points as they are given. They do not include
//! the effect of rounding a coordinate to `f32` beforehand, which no evaluator can undo: the cosine of
//! an azimuth next to pi in `f32` determines it to 3e-4 rad, so that directions or angles are better
//! for narrow lobes.

mod double;
mod fitted_fresnel;
mod formula;
mod interface;
mod lambertian;
mod points;
mod processor;
mod single;
mod vector;

pub use double::Double;
pub use fitted_fresnel::FittedFresnel;
pub use interface::{Evaluator, Precision};
pub use lambertian::Lambertian;
pub use points::{LengthError, Points};
pub use processor::vector_unit;
pub use single::{Single, SpecularOnly};
pub use vector::PARALLEL_FROM;
