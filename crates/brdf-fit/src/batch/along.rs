//! The minimum of E of one scan along ln k1, between two widths of the grid, with exact columns.

use brdf_core::ModelParameters;

use super::own::OwnScan;
use super::plan::BatchPlan;
use crate::model::K1_RANGE;
use crate::objective::{LobeColumns, ProfileSums, WithLobe, dot_of, solve_for};

/// The largest number of steps.
const MOST_STEPS: usize = 60;

/// The search ends where a further step would gain less than this fraction of E ...
const GAIN: f64 = 1e-13;

/// ... or this fraction of the readings' squares, which is rounding ...
const ROUNDING: f64 = 1e-17;

/// ... or where it is shorter than this in ln k1.
const SHORT: f64 = 1e-10;

/// The widths around a point of the grid that is lower than its neighbours.
pub(super) struct Bracket {
    /// The width of the point, and its logarithm.
    centre: (f64, f64),
    /// ln k1 of the neighbours; of the point itself at an end of the range.
    ends: [f64; 2],
    /// ln k1 of the lowest point of the parabola through the three.
    start: f64,
    /// The second derivative of that parabola of E/2; 0 where there is none.
    bend: f64,
}

impl Bracket {
    /// The bracket of point `i`, with E of each point.
    pub(super) fn new(widths: &[f64], errors: &[f64], i: usize) -> Self {
        let centre = widths[i].ln();
        let end = |i: Option<usize>| i.and_then(|i| widths.get(i)).map_or(centre, |k1| k1.ln());
        let ends = [end(i.checked_sub(1)), end(Some(i + 1))];
        let [mut start, mut bend] = [centre, 0.0];
        if ends[0] < centre && centre < ends[1] {
            let step = 0.5 * (ends[1] - ends[0]);
            let slope = 0.5 * (errors[i + 1] - errors[i - 1]);
            let second = errors[i - 1] - 2.0 * errors[i] + errors[i + 1];
            if second > 0.0 {
                start += step * (-slope / second).clamp(-0.5, 0.5);
                bend = 0.5 * second / (step * step);
            }
        }
        Self {
            centre: (widths[i], centre),
            ends,
            start,
            bend,
        }
    }

    /// The bracket from point `i` to point `j`.
    fn between(widths: &[f64], i: usize, j: usize) -> Self {
        let [from, to] = [i, j].map(|i| widths[i].ln());
        Self {
            centre: (widths[i], from),
            ends: [from.min(to), from.max(to)],
            start: 0.5 * (from + to),
            bend: 0.0,
        }
    }

    fn k1(&self, x: f64) -> f64 {
        if x == self.centre.1 {
            self.centre.0
        } else {
            x.exp().clamp(K1_RANGE.0, K1_RANGE.1)
        }
    }
}

/// E of a scan along ln k1, with the best weights at each width.
pub(super) struct Along<'a> {
    plan: &'a BatchPlan,
    scan: &'a OwnScan,
    /// n and p.
    fixed: [f64; 2],
    has_diffuse: bool,
    /// a.a and a.y.
    diffuse: [f64; 2],
}

/// E at a width.
struct Local {
    error: f64,
    /// The derivative of E/2 with respect to ln k1. Where the best lobe is none, that of the scalar product
    /// of y and the unit column beside the diffuse one, with the opposite sign: it leads to a lobe.
    slope: f64,
    /// The second derivative by Gauss and Newton.
    bend: f64,
    has_lobe: bool,
}

impl<'a> Along<'a> {
    pub(super) fn new(
        plan: &'a BatchPlan,
        scan: &'a OwnScan,
        fixed: [f64; 2],
        has_diffuse: bool,
    ) -> Self {
        let OwnScan { y, diffuse: a, .. } = scan;
        Self {
            plan,
            scan,
            fixed,
            has_diffuse,
            diffuse: [dot_of(a, a), dot_of(a, y)],
        }
    }

    /// k1 of the lowest point near point `i` of the grid, and E there, with E of each point.
    ///
    /// Two minima may lie so close to each other that the grid shows one. Then E falls away from the found one at
    /// one of the widths around it.
    pub(super) fn lowest_near(
        &self,
        widths: &[f64],
        errors: &[f64],
        i: usize,
        columns: &mut LobeColumns,
    ) -> (f64, f64) {
        let found = self.lowest(&Bracket::new(widths, errors, i), columns);
        let right = widths.partition_point(|k1| *k1 <= found.0);
        let sides = [
            (right.checked_sub(1), right.checked_sub(2), 1.0),
            (Some(right), Some(right + 1), -1.0),
        ];
        let mut best = found;
        for (from, to, outwards) in sides {
            let (Some(from), Some(to)) = (from, to) else {
                continue;
            };
            if from.max(to) >= widths.len() {
                continue;
            }
            let there = self.at(widths[from], columns);
            if there.has_lobe && there.slope * outwards > 0.0 {
                let beyond = self.lowest(&Bracket::between(widths, from, to), columns);
                if beyond.1 < best.1 {
                    best = beyond;
                }
            }
        }
        best
    }

    /// k1 of the lowest point of a bracket, and E there: secant steps on the slope, within what its sign
    /// leaves of the bracket.
    fn lowest(&self, bracket: &Bracket, columns: &mut LobeColumns) -> (f64, f64) {
        let [mut low, mut high] = bracket.ends;
        let mut x = bracket.start;
        let mut best = (bracket.centre.0, f64::INFINITY);
        let mut before: Option<(f64, Local)> = None;
        for _ in 0..MOST_STEPS {
            let k1 = bracket.k1(x);
            let here = self.at(k1, columns);
            if here.error < best.1 {
                best = (k1, here.error);
            }
            if here.slope > 0.0 {
                high = x;
            } else if here.slope < 0.0 {
                low = x;
            } else {
                break;
            }
            let before_on_same_side = before.filter(|(_, there)| there.has_lobe == here.has_lobe);
            let bend = match before_on_same_side {
                Some((there_x, there)) => (here.slope - there.slope) / (x - there_x),
                None if here.has_lobe && bracket.bend > 0.0 => bracket.bend,
                None => here.bend,
            };
            let gain = here.slope * here.slope / bend;
            let step = x - here.slope / bend;
            let is_inside = bend > 0.0 && low < step && step < high;
            let least = GAIN * here.error.max(0.0) + ROUNDING;
            if is_inside && here.has_lobe && gain < least {
                break;
            }
            let next = if is_inside { step } else { 0.5 * (low + high) };
            if (next - x).abs() < SHORT {
                break;
            }
            before = Some((x, here));
            x = next;
        }
        best
    }

    fn at(&self, k1: f64, columns: &mut LobeColumns) -> Local {
        let objective = &self.plan.objective;
        let [n, p] = self.fixed;
        let at = ModelParameters {
            k2: 1.0,
            kd: 0.0,
            k1,
            n,
            p,
        };
        objective.with_lobe(&at, true, columns, Evaluate { along: self, k1 })
    }

    /// E from the scalar products of u and of its derivative u' with y, a and themselves.
    fn local(&self, k1: f64, sums: &ProfileSums, [du, da, dy, dd]: [f64; 4]) -> Local {
        let ProfileSums { uu, ua, uy, aa, ay } = *sums;
        let (k2, kd, error) = solve_for(self.plan.model.fixed_weights(), sums);
        if k2 <= 0.0 {
            let [of_mixed, of_measured] = if self.has_diffuse && ay > 0.0 {
                [ua / aa, ay / aa]
            } else {
                [0.0, 0.0]
            };
            let rest = uu - ua * of_mixed;
            let along = uy - ua * of_measured;
            let turned = (dy - da * of_measured) - along * (du - da * of_mixed) / rest;
            let slope = -k1 * turned / rest.sqrt();
            return Local {
                error,
                slope: if slope.is_finite() { slope } else { 0.0 },
                bend: 0.0,
                has_lobe: false,
            };
        }
        let determinant = uu * aa - ua * ua;
        // What the weights that adapt can make up for.
        let explained = if self.has_diffuse && kd > 0.0 && determinant > 1e-14 * uu * aa {
            (aa * du * du - 2.0 * ua * du * da + uu * da * da) / determinant
        } else {
            du * du / uu
        };
        let scale = k1 * k2;
        Local {
            error,
            slope: scale * (k2 * du + kd * da - dy),
            bend: scale * scale * (dd - explained),
            has_lobe: true,
        }
    }
}

/// [`Along::at`] with the columns.
struct Evaluate<'a> {
    along: &'a Along<'a>,
    k1: f64,
}

impl WithLobe for Evaluate<'_> {
    type Output = Local;

    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a function that is not inlined is not compiled for the present processor"
    )]
    fn with_lobe(self, u: &mut [f64], by_k1: &mut [f64]) -> Local {
        let OwnScan {
            y,
            factors,
            diffuse: a,
        } = self.along.scan;
        for ((u, by_k1), factor) in u.iter_mut().zip(by_k1.iter_mut()).zip(factors) {
            *u *= factor;
            *by_k1 *= factor;
        }
        let sums = ProfileSums {
            uu: dot_of(u, u),
            ua: dot_of(u, a),
            uy: dot_of(u, y),
            aa: self.along.diffuse[0],
            ay: self.along.diffuse[1],
        };
        let of_derivative = [
            dot_of(by_k1, u),
            dot_of(by_k1, a),
            dot_of(by_k1, y),
            dot_of(by_k1, by_k1),
        ];
        self.along.local(self.k1, &sums, of_derivative)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bracket_starts_at_the_lowest_point_of_its_parabola() {
        let widths: Vec<f64> = (0..5).map(|i| (0.25 * f64::from(i)).exp()).collect();
        let errors: Vec<f64> = (0..5)
            .map(|i| 3.0 * (0.25 * f64::from(i) - 0.57).powi(2) + 0.1)
            .collect();
        let bracket = Bracket::new(&widths, &errors, 2);
        assert!((bracket.start - 0.57).abs() < 1e-12);
        assert!((bracket.bend - 3.0).abs() < 1e-10);
        let end = Bracket::new(&widths, &errors, 0);
        assert_eq!((end.start, end.ends[0], end.bend), (0.0, 0.0, 0.0));
        assert_eq!(end.k1(0.0), 1.0);
    }
}
