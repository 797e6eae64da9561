//! What is drawn of a lobe: the lobe, a second one to compare it with, and readings.

use brdf_core::AnyBrdf;
use brdf_fit::plot::{Quantity, Scale};

use super::lobe::Lobe;
use super::vector::Vector;
use crate::plot::radius::Radius;

/// A logarithmic radius begins at most this factor below the largest value.
const LARGEST_RANGE: f64 = 1e6;

/// A reading of the incidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// The unit vector towards the viewer.
    pub direction: Vector,
    /// The value of the quantity in 1/sr.
    pub value: f64,
    /// Whether the reading is left out of the fit.
    pub left_out: bool,
}

/// A lobe with all that is drawn of it.
#[derive(Debug, Clone, PartialEq)]
pub struct LobeScene {
    /// The lobe.
    pub lobe: Lobe,
    /// A second lobe at the same incidence.
    pub ghost: Option<Lobe>,
    /// Readings at that incidence, or at the nearest one that was measured.
    pub readings: Vec<Spot>,
    /// How values are distances from the surface.
    pub radius: Radius,
}

impl LobeScene {
    /// The lobe of a BRDF, and of a second one, at an incidence angle psi in radians with readings.
    pub fn new(
        (brdf, ghost): (&AnyBrdf, Option<&AnyBrdf>),
        psi: f64,
        (quantity, scale): (Quantity, Scale),
        readings: Vec<Spot>,
    ) -> Self {
        let lobe = Lobe::new(brdf, psi, quantity);
        let ghost = ghost.map(|ghost| Lobe::new(ghost, psi, quantity));
        let lobes = || std::iter::once(&lobe).chain(&ghost);
        let of_lobes = lobes().map(Lobe::largest);
        let of_readings = readings.iter().map(|spot| spot.value);
        let most = of_lobes.chain(of_readings).fold(0.0, f64::max);
        let most = if most > 0.0 { most } else { 1.0 };
        let least = lobes().filter_map(Lobe::least).fold(most, f64::min);
        Self {
            radius: Radius::new((least.max(most / LARGEST_RANGE), most), scale),
            lobe,
            ghost,
            readings,
        }
    }

    /// The number of readings that have no radius.
    pub fn not_shown(&self) -> usize {
        let values = self.readings.iter().map(|spot| spot.value);
        values
            .filter(|value| self.radius.fraction(*value).is_none())
            .count()
    }
}
