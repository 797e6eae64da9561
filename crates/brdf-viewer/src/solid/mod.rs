//! The theory in three dimensions: the lobe of an incidence, and a surface under light.
//!
//! Everything here is a pure function of its arguments and draws by triangles and pixels of its own, so
//! that a picture is the same in a window, in a file and in a test. `directions` chooses where a lobe is
//! evaluated, [`Lobe`] evaluates it, [`LobeScene`] adds the readings and a second lobe, and [`project`]
//! turns it all into [`Piece`]s of a picture, the farthest first. `painting` hands these to egui, `figure`
//! to the figures of `brdf_fit`, and `obj` writes the lobe for other programs. [`surface`] shades pixels.

mod camera;
mod depth;
mod directions;
mod figure;
mod lobe;
mod obj;
mod painting;
mod projection;
mod scene;
pub mod surface;
mod surroundings;
mod vector;

pub use camera::Camera;
pub use figure::lobe_figure;
pub use lobe::Lobe;
pub use obj::write_obj;
pub use painting::{mesh, texts};
pub use projection::{Inks, Piece, Projection, project};
pub use scene::{LobeScene, Spot};
pub use vector::{Vector, direction};
