//! The ways of a descent to minima that its start does not lead to: other valleys, the wide end of a plain, a
//! faint lobe.

use brdf_core::ModelParameters;

use super::descent::{Descent, Local, Rows};
use crate::model::{PLAIN, Parameter};
use crate::objective::demand_for_lobe;

/// A descent begins in another valley as well where E exceeds that of the minimum by less than this fraction ...
const ALIKE: f64 = 0.02;

/// ... and by less than this one where few readings are nearly interpolated.
const ALIKE_OF_FEW: f64 = 10.0;

/// Within this factor of an end of the range of k1, a descent begins there as well.
const NEAR_END_OF_K1: f64 = 100.0;

/// The factor of k1 to the next valley: more than a step of the grid.
const BESIDE: f64 = 1.4;

/// The factor of k1 by which a valley that is crossed along n may have moved.
const ASLANT: f64 = 1.2;

/// On a plain, a change of ln k1 changes the lobe's column by less than this fraction.
const FLAT: f64 = 1e-3;

/// The refractive indices of other valleys: two, and one across the long steps of the grid before its end.
const OTHER_INDICES: [f64; 2] = [1.1, 1.6];
const ACROSS: [f64; 2] = [3.1, 6.0];

/// Within this factor, a refractive index belongs to the same valley.
const SAME_INDEX: f64 = 1.3;

/// A start without a lobe is moved towards one by up to this difference of ln k1, a step of the grid.
const TOWARDS_LOBE: f64 = 0.25;

/// The largest number of such moves.
const MOST_MOVES: usize = 24;

impl Descent<'_> {
    /// A minimum, or a lower one in another valley.
    pub(super) fn with_other_valleys(&self, here: Local, rows: Rows<'_>) -> (ModelParameters, f64) {
        let mut starts = self.other_valleys(&here, rows);
        starts.extend(self.end_of_plain(&here, rows));
        let mut lowest = here;
        for start in starts {
            let there = self.descend(start, rows);
            let end = self.end_of_plain(&there, rows);
            let beyond = end.map(|end| self.descend(end, rows));
            for found in [Some(there), beyond].into_iter().flatten() {
                if found.error < lowest.error {
                    lowest = found;
                }
            }
        }
        (lowest.at, lowest.error)
    }

    /// The wide end of the plain on which a point lies, if it does: far below the distance of the readings, the
    /// width has no effect, and no slope leads out of there.
    fn end_of_plain(&self, here: &Local, rows: Rows<'_>) -> Option<ModelParameters> {
        let (_, widest) = Parameter::K1.range();
        let slope = here.products.of(2, 2).sqrt() * here.at.k1;
        let is_plain = self.model.frees(Parameter::K1)
            && here.at.k2 > 0.0
            && here.at.k1 < 1.0
            && slope <= FLAT * here.products.of(0, 0).sqrt();
        if !is_plain {
            return None;
        }
        let mut at = here.at;
        while at.k1 * BESIDE < widest {
            let next = ModelParameters {
                k1: at.k1 * BESIDE,
                ..at
            };
            if self.local(next, [false; 3], rows).error > here.error * (1.0 + PLAIN) {
                break;
            }
            at = next;
        }
        (at.k1 != here.at.k1).then_some(at)
    }

    /// Points in other valleys that E does not exclude: widths beside the present one, other refractive
    /// indices, and the ends of the range of k1 where they are near or few readings determine little. A grid
    /// shows two minima as one where they are as close as its steps, and none where E falls ever more slowly.
    fn other_valleys(&self, here: &Local, rows: Rows<'_>) -> Vec<ModelParameters> {
        let at = here.at;
        let (narrowest, widest) = Parameter::K1.range();
        let is_few = self.has_few_readings();
        let alike = if is_few { ALIKE_OF_FEW } else { ALIKE };
        let widths = [
            Some(narrowest).filter(|end| is_few || at.k1 < NEAR_END_OF_K1 * end),
            Some(narrowest.max(at.k1 / BESIDE)),
            Some(widest.min(at.k1 * BESIDE)),
            Some(widest).filter(|end| is_few || at.k1 > end / NEAR_END_OF_K1),
        ];
        let frees = |parameter| self.model.frees(parameter);
        let widths = widths.into_iter().flatten();
        let of_widths = widths.filter(|_| frees(Parameter::K1));
        let [inner, end] = ACROSS;
        let across = if at.n > 0.5 * (inner + end) {
            inner
        } else {
            end
        };
        let is_other = |n: &f64| (n / at.n).max(at.n / n) > SAME_INDEX;
        let of_indices = OTHER_INDICES.into_iter().chain([across]);
        let of_indices = of_indices.filter(|n| frees(Parameter::N) && is_other(n));
        let others = of_widths
            .map(|k1| ModelParameters { k1, ..at })
            .chain(of_indices.map(|n| ModelParameters { n, ..at }));
        let is_alike = |other: &ModelParameters| {
            self.local(*other, [false; 3], rows).error <= here.error * (1.0 + alike)
        };
        let alike = others.filter(|other| (other.k1, other.n) != (at.k1, at.n) && is_alike(other));
        alike
            .flat_map(|other| aslant(other, other.n != at.n))
            .collect()
    }

    /// A point with a lobe near one without, if there is one: where k2 = 0, E has no slope, and the demand for a
    /// lobe shows the way.
    pub(super) fn with_lobe_near(&self, start: Local, free: [bool; 3], rows: Rows<'_>) -> Local {
        let fixed = self.model.fixed_weights();
        if start.at.k2 > 0.0 || fixed[0].is_some() || !free[0] {
            return start;
        }
        let demand = |there: &Local| demand_for_lobe(fixed[1], &there.products.sums());
        let (lowest, highest) = Parameter::K1.range();
        let at = |x: f64| {
            let k1 = (start.at.k1 * x.exp()).clamp(lowest, highest);
            self.local(ModelParameters { k1, ..start.at }, free, rows)
        };
        // Golden section, up to the first point with a lobe.
        let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut low, mut high) = (-TOWARDS_LOBE, TOWARDS_LOBE);
        let mut inner = [high - ratio * (high - low), low + ratio * (high - low)];
        let mut there = inner.map(at);
        for _ in 0..MOST_MOVES {
            let [left, right] = there;
            let is_right = demand(&right) > demand(&left);
            let higher = if is_right { &right } else { &left };
            if higher.at.k2 > 0.0 {
                return if is_right { right } else { left };
            }
            if is_right {
                low = inner[0];
                inner = [inner[1], low + ratio * (high - low)];
                there = [right, at(inner[1])];
            } else {
                high = inner[1];
                inner = [high - ratio * (high - low), inner[0]];
                there = [at(inner[0]), left];
            }
        }
        start
    }
}

/// A point, and widths on both sides of it where the valley is crossed along n: it runs aslant in k1 and n.
fn aslant(at: ModelParameters, is_across: bool) -> impl Iterator<Item = ModelParameters> {
    let (narrowest, widest) = Parameter::K1.range();
    let factors = [1.0, ASLANT, 1.0 / ASLANT];
    let used = if is_across { factors.len() } else { 1 };
    factors.into_iter().take(used).map(move |factor| {
        let k1 = (at.k1 * factor).clamp(narrowest, widest);
        ModelParameters { k1, ..at }
    })
}
