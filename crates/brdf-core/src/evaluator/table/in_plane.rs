//! f_r over incidence and view, in plane.

use serde::{Deserialize, Serialize};

use super::lattice::{Lattice, Wanted};
use super::{Table, TableError, signed_tilt, tilt_at, value_in_plane, view_at};
use crate::AnyBrdf;
use crate::direction_pair::DirectionPair;
use crate::evaluator::Points;
use crate::evaluator::formula::Formula;
use crate::evaluator::points::BLOCK;
use crate::evaluator::vector::evaluate_all;
use crate::numeric::Real;
use crate::scene::Domain;

/// A table of f_r over incidence and view in the plane of incidence. Its coordinates are
/// tan(psi/2), and arsinh(tan alpha / w) as for one incidence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InPlaneTable {
    lattice: Lattice<2>,
    coordinates: Coordinates,
}

impl InPlaneTable {
    /// The table of a BRDF for incidence angles in a range, in radians, and view angles up to
    /// `largest_view` on both sides, to the relative `tolerance` and within `limit` bytes.
    ///
    /// Errors: it would need more memory.
    pub fn new(
        brdf: &AnyBrdf,
        incidence: (f64, f64),
        largest_view: f64,
        tolerance: f64,
        limit: usize,
    ) -> Result<Self, TableError> {
        let width = brdf.parameters().k1.min(1.0);
        let coordinates = Coordinates {
            reciprocal_width: 1.0 / width,
        };
        let (least, largest) = incidence;
        let ends = (
            tilt_at(least, -largest_view, width),
            tilt_at(largest, largest_view, width),
        );
        let domain = Domain::in_plane(incidence, (0.0, largest_view));
        let view = |[half, tilt]: [f64; 2]| {
            let psi = 2.0 * half.atan();
            (psi, view_at(psi, tilt, width))
        };
        Lattice::grown(&Wanted {
            ranges: [((0.5 * least).tan(), (0.5 * largest).tan()), ends],
            function: |at| {
                let (psi, theta) = view(at);
                value_in_plane(brdf, psi, theta)
            },
            used: |at| view(at).1.abs() <= largest_view,
            offset: 0.0,
            table: |lattice| Self {
                lattice,
                coordinates,
            },
            checked: (brdf, &domain),
            tolerance,
            limit,
        })
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Coordinates {
    reciprocal_width: f64,
}

impl Formula<2> for Coordinates {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "as all that is vector code")]
    fn at<R: Real>(&self, pair: &DirectionPair<R>) -> [R; 2] {
        let (one, cosine) = (R::of(1.0), pair.cos_psi);
        // tan^2(psi/2) = (1 - cos psi)/(1 + cos psi).
        let tan_half = ((one - cosine).abs() / (one + cosine)).sqrt();
        [tan_half, signed_tilt(pair, self.reciprocal_width)]
    }
}

impl Table for InPlaneTable {
    const NAME: &'static str = "table-in-plane";

    fn bytes(&self) -> usize {
        self.lattice.bytes()
    }

    fn look_up(&self, points: &Points<f32>, out: &mut [f32]) {
        let mut halves = [0.0; BLOCK];
        let halves = &mut halves[..out.len()];
        evaluate_all(self.coordinates, points, [&mut *halves, &mut *out]);
        for (value, half) in out.iter_mut().zip(halves) {
            *value = self.lattice.interpolated([*half, *value]);
        }
    }
}
