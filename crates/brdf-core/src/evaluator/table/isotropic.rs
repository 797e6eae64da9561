//! The specular part over its two coordinates, for any pair of directions.

use std::f64::consts::FRAC_1_PI;

use serde::{Deserialize, Serialize};

use super::lattice::{Lattice, Wanted};
use super::{Table, TableError};
use crate::AnyBrdf;
use crate::brdf::MicrofacetBrdf;
use crate::direction_pair::DirectionPair;
use crate::evaluator::Points;
use crate::evaluator::formula::Formula;
use crate::evaluator::points::BLOCK;
use crate::evaluator::vector::evaluate_all;
use crate::facet::FacetDistribution;
use crate::family::each;
use crate::numeric::Real;
use crate::scene::Domain;
use crate::shadowing::Shadowing;

/// A table for all pairs of directions.
///
/// The three coordinates of an isotropic BRDF are here the tilt alpha of the facet that mirrors
/// source into view, the incidence gamma on it, and the azimuth of their difference. Divided by the
/// shadowing, the specular part depends on the first two alone:
///
/// ```text
/// f_r = S(alpha, gamma) G/(cos psi cos theta) + kD/pi,   S = (k2/pi) f(alpha)/f(0) R0(gamma)
/// ```
///
/// so that a table of two dimensions holds all three, and G, whose kinks no table follows, stays
/// exact. Its coordinates are ln(1 + tan^2 alpha / w^2), w the width of the lobe, and cos gamma.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IsotropicTable {
    lattice: Lattice<2>,
    brdf: AnyBrdf,
}

impl IsotropicTable {
    /// The table of a BRDF for the directions of a domain, to the relative `tolerance` and within
    /// `limit` bytes.
    ///
    /// Errors: it would need more memory.
    pub fn new(
        brdf: AnyBrdf,
        domain: &Domain,
        tolerance: f64,
        limit: usize,
    ) -> Result<Self, TableError> {
        let width = brdf.parameters().k1.min(1.0);
        let at_tilt = |tan2_alpha: f64| (tan2_alpha / (width * width)).ln_1p();
        let largest_angle = domain.largest_facet_angle();
        let largest_tilt = largest_angle.tan().powi(2);
        let least_cosine = largest_angle.cos();
        Lattice::grown(&Wanted {
            ranges: [(0.0, at_tilt(largest_tilt)), (least_cosine, 1.0)],
            function: |[tilt, cos_gamma]: [f64; 2]| {
                let tan2_alpha = width * width * tilt.exp_m1();
                each!(&brdf, brdf => brdf.unshadowed(tan2_alpha, cos_gamma))
            },
            used: |_| true,
            offset: brdf.parameters().kd * FRAC_1_PI,
            table: |lattice| Self { lattice, brdf },
            checked: (&brdf, domain),
            tolerance,
            limit,
        })
    }
}

/// The two coordinates, and the shadowing.
#[derive(Clone, Copy)]
struct Coordinates<S> {
    reciprocal_width2: f64,
    shadowing: S,
}

impl<S: Shadowing> Coordinates<S> {
    fn of<F: FacetDistribution>(brdf: MicrofacetBrdf<F, S>) -> Self {
        Self {
            reciprocal_width2: brdf.parameters().k1.min(1.0).powi(-2),
            shadowing: brdf.shadowing(),
        }
    }
}

impl<S: Shadowing> Formula<3> for Coordinates<S> {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "as all that is vector code")]
    fn at<R: Real>(&self, pair: &DirectionPair<R>) -> [R; 3] {
        let half = &pair.half;
        let excess = half.tan2_alpha() * R::of(self.reciprocal_width2);
        let tilt = (R::of(1.0) + excess).ln();
        let shadowing = self.shadowing.ratio(pair.cos_psi, pair.cos_theta, half);
        [tilt, half.length, pair.if_above_surface(shadowing.value())]
    }
}

impl Table for IsotropicTable {
    const NAME: &'static str = "table-isotropic";

    fn bytes(&self) -> usize {
        self.lattice.bytes()
    }

    fn look_up(&self, points: &Points<f32>, out: &mut [f32]) {
        let mut buffers = [[0.0; BLOCK]; 2];
        let [tilts, cosines] = buffers.each_mut().map(|buffer| &mut buffer[..out.len()]);
        let arrays = [&mut *tilts, &mut *cosines, &mut *out];
        each!(self.brdf, brdf => evaluate_all(Coordinates::of(brdf), points, arrays));
        #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
        let diffuse = (self.brdf.parameters().kd * FRAC_1_PI) as f32;
        for ((value, tilt), cosine) in out.iter_mut().zip(tilts).zip(cosines) {
            *value = self.lattice.interpolated([*tilt, *cosine]) * *value + diffuse;
        }
    }
}
