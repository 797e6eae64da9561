//! Many points at once: ways to evaluate a BRDF that differ in speed, accuracy and memory, behind
//! one interface.
//!
//! | evaluator | arithmetic | memory | for |
//! |---|---|---|---|
//! | [`Double`] | `f64` | none | all, and the measure of the others |
//! | [`Single`] | `f32` | none | what a renderer wants |
//! | [`FittedFresnel`] | `f32`, the Fresnel factor a polynomial in cos gamma with a known error | none | the same, a little faster |
//! | [`Lambertian`] | a constant | none | a surface, or a range of angles, without a specular part to speak of |
//! | [`SpecularOnly`] | `f32` without the Lambertian part | none | where that is not to be seen |
//! | [`IsotropicTable`] | `f32`, a table over alpha and gamma | some KiB | processors whose divisions and roots are slow |
//! | [`IncidenceTable`] | `f32`, a table over signed theta | some KiB | one incidence, in plane |
//! | [`InPlaneTable`] | `f32`, a table over psi and signed theta | MiB | in plane |
//!
//! What they cost, and how they err for a scene, is measured by [`Plan`](crate::scene::Plan), and by
//! the command `trade`. [`Double`] differs from single values by a few roundings. The largest relative
//! errors of [`Single`], from cosines, for k2 = 0.3, kD = 0.1, n = 1.5 and p = 1.7, among 100,000
//! points half of which lie next to the mirror direction or at the ends of the ranges
//! (`cargo test -p brdf-core --test evaluators -- --nocapture errors_in_f32` prints more of them):
//!
//! | angles up to | k1 | paper | Smith | power | GGX | Beckmann |
//! |---|---|---|---|---|---|---|
//! | 85 deg | 0.001 | 5.0e-7 | 5.2e-7 | 8.1e-7 | 6.2e-7 | 1.0e-6 |
//! | 85 deg | 0.01 | 4.7e-7 | 4.8e-7 | 8.6e-7 | 6.9e-7 | 1.0e-6 |
//! | 85 deg | 0.1 | 4.9e-7 | 5.1e-7 | 8.5e-7 | 6.5e-7 | 1.2e-6 |
//! | 85 deg | 1 | 5.9e-7 | 5.7e-7 | 5.9e-7 | 6.6e-7 | 1.3e-6 |
//! | 89.9 deg | 0.01 | 5.0e-7 | 5.6e-7 | 1.0e-6 | 6.3e-7 | 1.2e-6 |
//!
//! They are those of the evaluation, at the points as they are given: that a coordinate was rounded
//! to `f32` before is not in them, and no evaluator can mend it. (The cosine of an azimuth next to
//! pi, in `f32`, is good to 3e-4 rad: for narrow lobes, directions or angles are better.)

mod double;
mod fitted_fresnel;
mod formula;
mod interface;
mod lambertian;
mod points;
mod single;
mod table;
mod vector;

pub use double::Double;
pub use fitted_fresnel::FittedFresnel;
pub use interface::{Evaluator, Precision};
pub use lambertian::Lambertian;
pub use points::{LengthError, Points};
pub use single::{Single, SpecularOnly};
pub use table::{InPlaneTable, IncidenceTable, IsotropicTable, TableError};
pub use vector::{PARALLEL_FROM, vector_unit};
