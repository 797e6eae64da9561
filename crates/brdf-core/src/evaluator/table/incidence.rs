//! f_r over the view angle, for one incidence in plane.

use serde::{Deserialize, Serialize};

use super::lattice::{Lattice, Wanted};
use super::{Table, TableError, signed_tilt, tilt_at, value_in_plane, view_at};
use crate::AnyBrdf;
use crate::direction_pair::DirectionPair;
use crate::evaluator::Points;
use crate::evaluator::formula::Formula;
use crate::evaluator::vector::evaluate;
use crate::numeric::Real;
use crate::scene::Domain;

/// A table of f_r over the signed view angle in the plane of incidence, for one incidence angle: a
/// source that stands still. Its coordinate is arsinh(tan alpha / w), w the width of the lobe and
/// alpha = (psi + theta)/2 with its sign.
///
/// The incidence of the points is taken to be its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IncidenceTable {
    lattice: Lattice<1>,
    coordinate: Coordinate,
}

impl IncidenceTable {
    /// The table of a BRDF for the incidence psi, in radians, and view angles up to `largest_view`
    /// on both sides, to the relative `tolerance` and within `limit` bytes.
    ///
    /// Errors: it would need more memory.
    pub fn new(
        brdf: &AnyBrdf,
        psi: f64,
        largest_view: f64,
        tolerance: f64,
        limit: usize,
    ) -> Result<Self, TableError> {
        let width = brdf.parameters().k1.min(1.0);
        let coordinate = Coordinate {
            reciprocal_width: 1.0 / width,
        };
        let ends = [-largest_view, largest_view].map(|theta| tilt_at(psi, theta, width));
        let domain = Domain::in_plane((psi, psi), (0.0, largest_view));
        Lattice::grown(&Wanted {
            ranges: [(ends[0], ends[1])],
            function: |[tilt]: [f64; 1]| value_in_plane(brdf, psi, view_at(psi, tilt, width)),
            used: |_| true,
            offset: 0.0,
            table: |lattice| Self {
                lattice,
                coordinate,
            },
            checked: (brdf, &domain),
            tolerance,
            limit,
        })
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Coordinate {
    reciprocal_width: f64,
}

impl Formula for Coordinate {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "as all that is vector code")]
    fn at<R: Real>(&self, pair: &DirectionPair<R>) -> [R; 1] {
        [signed_tilt(pair, self.reciprocal_width)]
    }
}

impl Table for IncidenceTable {
    const NAME: &'static str = "table-incidence";

    fn bytes(&self) -> usize {
        self.lattice.bytes()
    }

    fn look_up(&self, points: &Points<f32>, out: &mut [f32]) {
        evaluate(self.coordinate, points, out);
        for value in out {
            *value = self.lattice.interpolated([*value]);
        }
    }
}
