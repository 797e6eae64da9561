//! Tabulated forms, in coordinates that follow the specular peak.
//!
//! A table grows until it is within its tolerance at fresh points of the domain, or is refused where
//! that would take more memory than allowed.

mod in_plane;
mod incidence;
mod isotropic;
mod lattice;

pub use in_plane::InPlaneTable;
pub use incidence::IncidenceTable;
pub use isotropic::IsotropicTable;

use std::f64::consts::FRAC_PI_2;
use std::fmt::Debug;

use super::points::in_blocks;
use super::vector::{native, rounded};
use super::{Evaluator, LengthError, Points, Precision};
use crate::direction_pair::DirectionPair;
use crate::numeric::Real;
use crate::{AnyBrdf, Geometry};

/// Why a table cannot be made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TableError {
    /// It would need more memory than allowed.
    #[error("would need {needed} bytes: allowed are {limit}{}", reached_words(*.reached))]
    Memory {
        /// Bytes of the table that would be tried next.
        needed: usize,
        /// Bytes that are allowed.
        limit: usize,
        /// The relative error of the last table that was checked; infinite where none was.
        reached: f64,
    },
}

fn reached_words(reached: f64) -> String {
    if reached.is_finite() {
        format!(" (the largest one within them errs by {reached:.1e})")
    } else {
        String::new()
    }
}

/// What the tables have in common.
trait Table {
    /// What it is called.
    const NAME: &'static str;

    /// The memory of its values, in bytes.
    fn bytes(&self) -> usize;

    /// f_r at a [block](super::points::BLOCK) of points, or fewer.
    fn look_up(&self, points: &Points<f32>, out: &mut [f32]);
}

impl<T: Table + Debug + Send + Sync> Evaluator for T {
    fn name(&self) -> &'static str {
        T::NAME
    }

    fn precision(&self) -> Precision {
        Precision::Single
    }

    fn bytes(&self) -> usize {
        Table::bytes(self)
    }

    fn values(&self, points: &Points<f64>, out: &mut [f64]) -> Result<(), LengthError> {
        rounded(points, out, |points, out| self.look_up(points, out))
    }

    fn values_f32(&self, points: &Points<f32>, out: &mut [f32]) -> Result<(), LengthError> {
        native(points, out, |points, out| {
            in_blocks(points, out, |points, out| self.look_up(points, out));
        })
    }
}

/// arsinh(tan alpha / w), with the sign of the side on which the view lies, as seen in the plane of
/// incidence: positive towards the source. Linear next to the mirror direction, logarithmic far from
/// it.
#[inline(always)]
#[expect(clippy::inline_always, reason = "as all that is vector code")]
fn signed_tilt<R: Real>(pair: &DirectionPair<R>, reciprocal_width: f64) -> R {
    let half = &pair.half;
    let t = half.across2.sqrt() / half.along * R::of(reciprocal_width);
    let tilt = (t + t.mul_add(t, R::of(1.0)).sqrt()).ln();
    // On the forward side gamma is larger than alpha: cos^2 gamma < cos gamma cos alpha.
    let forward = half.length2 < half.along;
    let beyond = forward && (pair.cos_theta < pair.cos_psi);
    pair.if_above_surface(R::select(beyond, -tilt, tilt))
}

/// The signed view angle theta at a signed tilt coordinate for the incidence psi: the facet that is
/// tilted by alpha mirrors psi into 2 alpha - psi.
fn view_at(psi: f64, tilt: f64, width: f64) -> f64 {
    let alpha = (width * tilt.sinh()).atan();
    (2.0 * alpha - psi).clamp(-LARGEST_VIEW, LARGEST_VIEW)
}

/// The signed tilt coordinate at a signed view angle.
fn tilt_at(psi: f64, theta: f64, width: f64) -> f64 {
    ((0.5 * (psi + theta)).tan() / width).asinh()
}

/// f_r in plane; NaN outside the domain.
fn value_in_plane(brdf: &AnyBrdf, psi: f64, theta: f64) -> f64 {
    Geometry::in_plane(psi, theta).map_or(f64::NAN, |geometry| brdf.value(&geometry))
}

/// The largest view angle of a table, next to 90 deg: the nodes beyond the ends of its domain.
const LARGEST_VIEW: f64 = 0.999_94 * FRAC_PI_2;
