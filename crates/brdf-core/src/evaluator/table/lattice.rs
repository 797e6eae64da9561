//! Values on a lattice, with linear interpolation between them, grown until it is good enough.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::TableError;

/// Intervals of each axis to begin with.
const FIRST: usize = 8;

/// Corners of a cell, of at most two dimensions.
const CORNERS: usize = 4;

/// Places of a lattice at which the interpolation along each axis is compared.
const PLACES: usize = 20_000;

/// Nodes at equal distances along one coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Axis {
    from: f64,
    to: f64,
    intervals: usize,
}

impl Axis {
    fn at(&self, node: f64) -> f64 {
        self.from + (self.to - self.from) * node / self.intervals as f64
    }
}

/// Values of a function of D coordinates on a lattice, in `f32`, the last coordinate fastest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RawLattice<D>", into = "RawLattice<D>")]
pub(super) struct Lattice<const D: usize> {
    axes: [Axis; D],
    values: Vec<f32>,
    /// First coordinate and intervals per unit of each axis, as the interpolation wants them.
    scales: [(f32, f32); D],
}

/// A lattice as it stands in a file.
#[derive(Serialize, Deserialize)]
struct RawLattice<const D: usize> {
    axes: Vec<Axis>,
    values: Vec<f32>,
}

impl<const D: usize> From<Lattice<D>> for RawLattice<D> {
    fn from(lattice: Lattice<D>) -> Self {
        Self {
            axes: lattice.axes.to_vec(),
            values: lattice.values,
        }
    }
}

impl<const D: usize> TryFrom<RawLattice<D>> for Lattice<D> {
    type Error = String;

    fn try_from(raw: RawLattice<D>) -> Result<Self, String> {
        let axes: [Axis; D] = raw
            .axes
            .try_into()
            .map_err(|axes: Vec<Axis>| format!("a table of {} axes: expected {D}", axes.len()))?;
        for axis in &axes {
            let ascends = axis.from < axis.to && (axis.to - axis.from).is_finite();
            if axis.intervals == 0 || !ascends {
                return Err(format!(
                    "an axis from {} to {} in {} intervals: expected ascending numbers and at least one interval",
                    axis.from, axis.to, axis.intervals
                ));
            }
        }
        let nodes = count(&axes);
        if nodes != Some(raw.values.len()) {
            return Err(format!(
                "a table of {} values: expected one for each node of its axes",
                raw.values.len()
            ));
        }
        Ok(Self::of(axes, raw.values))
    }
}

/// The nodes of a lattice, if a number can hold them.
fn count(axes: &[Axis]) -> Option<usize> {
    let nodes = |axis: &Axis| axis.intervals.checked_add(1);
    axes.iter()
        .try_fold(1_usize, |all, axis| all.checked_mul(nodes(axis)?))
}

/// What a lattice is made of.
pub(super) struct Wanted<const D: usize, F, U, C> {
    /// First and last coordinate of each axis.
    pub(super) ranges: [(f64, f64); D],
    /// The function.
    pub(super) function: F,
    /// Whether coordinates are used: errors elsewhere do not matter.
    pub(super) used: U,
    /// What is added to the function elsewhere: errors are relative to the sum.
    pub(super) offset: f64,
    /// The largest relative error of a lattice where it is used.
    pub(super) check: C,
    /// What that may be.
    pub(super) tolerance: f64,
    /// The largest memory, in bytes.
    pub(super) limit: usize,
}

impl<const D: usize> Lattice<D> {
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    fn of(axes: [Axis; D], values: Vec<f32>) -> Self {
        let scale = |axis: Axis| {
            let per_unit = axis.intervals as f64 / (axis.to - axis.from);
            (axis.from as f32, per_unit as f32)
        };
        Self {
            axes,
            values,
            scales: axes.map(scale),
        }
    }

    /// Doubles the intervals of the axes until the lattice passes the check.
    ///
    /// Errors: it would need more memory than allowed.
    pub(super) fn grown<F, U, C>(wanted: &Wanted<D, F, U, C>) -> Result<Self, TableError>
    where
        F: Fn([f64; D]) -> f64 + Sync,
        U: Fn([f64; D]) -> bool + Sync,
        C: Fn(&Self) -> f64,
    {
        let mut axes = wanted.ranges.map(|(from, to)| Axis {
            from,
            to,
            intervals: FIRST,
        });
        let mut reached = f64::INFINITY;
        loop {
            let needed = count(&axes)
                .unwrap_or(usize::MAX)
                .saturating_mul(size_of::<f32>());
            if needed > wanted.limit {
                return Err(TableError::Memory {
                    needed,
                    limit: wanted.limit,
                    reached,
                });
            }
            let lattice = Self::filled(axes, &wanted.function);
            let errors: [f64; D] = std::array::from_fn(|d| lattice.error_along(d, wanted));
            let worst = errors.iter().copied().fold(0.0, f64::max);
            let share = wanted.tolerance / (2 * D) as f64;
            if worst <= share || worst <= 0.5 * wanted.tolerance {
                reached = (wanted.check)(&lattice);
                if reached <= wanted.tolerance {
                    return Ok(lattice);
                }
            }
            for (axis, error) in axes.iter_mut().zip(errors) {
                if error > share || error == worst {
                    axis.intervals = axis.intervals.saturating_mul(2);
                }
            }
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    fn filled(axes: [Axis; D], function: &(impl Fn([f64; D]) -> f64 + Sync)) -> Self {
        let nodes = count(&axes).unwrap_or(0);
        let value = |index| function(coordinates(&axes, index, |_| 0.0)) as f32;
        let values = (0..nodes).into_par_iter().map(value).collect();
        Self::of(axes, values)
    }

    /// The largest relative error half way between two nodes along axis d.
    fn error_along<F, U, C>(&self, d: usize, wanted: &Wanted<D, F, U, C>) -> f64
    where
        F: Fn([f64; D]) -> f64 + Sync,
        U: Fn([f64; D]) -> bool + Sync,
    {
        let (function, used, offset) = (&wanted.function, &wanted.used, wanted.offset);
        let nodes = self.values.len();
        // All nodes, or as many spread over the lattice as are enough.
        let step = (nodes / PLACES).max(1);
        let error = |place: usize| {
            // Steps of one length would hit the same nodes of the last axis again and again.
            let index = (place * step + place % step) % nodes;
            let at = coordinates(&self.axes, index, |axis| if axis == d { 0.5 } else { 0.0 });
            if at[d] > self.axes[d].to || !used(at) {
                return 0.0;
            }
            let exact = function(at);
            let error = f64::from(self.interpolated(at.map(single))) - exact;
            error.abs() / (exact + offset).abs()
        };
        let all = (0..nodes.div_ceil(step)).into_par_iter().map(error);
        all.reduce(|| 0.0, f64::max)
    }

    /// The value between the nodes; beyond the ends, that at the end.
    #[inline]
    pub(super) fn interpolated(&self, at: [f32; D]) -> f32 {
        let mut first = 0;
        let mut fractions = [0.0; D];
        let mut strides = [1; D];
        for d in 0..D {
            let (from, per_unit) = self.scales[d];
            let intervals = self.axes[d].intervals;
            let t = ((at[d] - from) * per_unit).clamp(0.0, intervals as f32);
            let cell = whole_part(t).min(intervals - 1);
            fractions[d] = t - cell as f32;
            first = first * (intervals + 1) + cell;
            for stride in &mut strides[..d] {
                *stride *= intervals + 1;
            }
        }
        self.between(first, strides, fractions)
    }

    /// The value within the cell of a first node: its corners, interpolated along one axis after the
    /// other, the last one first.
    #[inline]
    fn between(&self, first: usize, strides: [usize; D], fractions: [f32; D]) -> f32 {
        let mut corners = [0.0; CORNERS];
        for (corner, value) in corners[..1 << D].iter_mut().enumerate() {
            let along = |d: usize| strides[d] * ((corner >> (D - 1 - d)) & 1);
            *value = self.values[first + (0..D).map(along).sum::<usize>()];
        }
        for d in (0..D).rev() {
            for pair in 0..1 << d {
                let (low, high) = (corners[2 * pair], corners[2 * pair + 1]);
                corners[pair] = low + fractions[d] * (high - low);
            }
        }
        corners[0]
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.values.as_slice())
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
fn single(x: f64) -> f32 {
    x as f32
}

/// Of a number that is not negative; 0 of NaN, which the fraction then hands on.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the whole part of a number that is not negative is meant"
)]
#[inline]
fn whole_part(x: f32) -> usize {
    x as usize
}

/// The coordinates of a node, moved by some intervals along each axis.
fn coordinates<const D: usize>(
    axes: &[Axis; D],
    mut index: usize,
    moved: impl Fn(usize) -> f64,
) -> [f64; D] {
    let mut at = [0.0; D];
    for d in (0..D).rev() {
        let nodes = axes[d].intervals + 1;
        at[d] = axes[d].at((index % nodes) as f64 + moved(d));
        index /= nodes;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grown(tolerance: f64, limit: usize) -> Result<Lattice<2>, TableError> {
        Lattice::grown(&Wanted {
            ranges: [(0.0, 2.0), (-1.0, 1.0)],
            function: |[x, y]: [f64; 2]| (x * x).exp() * (2.0 + y),
            used: |_| true,
            offset: 0.0,
            check: |lattice: &Lattice<2>| {
                let value = lattice.interpolated([1.234, 0.321]);
                (f64::from(value) / ((1.234_f64 * 1.234).exp() * 2.321) - 1.0).abs()
            },
            tolerance,
            limit,
        })
    }

    #[test]
    fn it_grows_where_the_function_is_curved() {
        let lattice = grown(1e-3, 1 << 20).unwrap();
        assert!(lattice.axes[0].intervals > 50);
        assert_eq!(lattice.axes[1].intervals, FIRST);
        assert_eq!(lattice.bytes(), 4 * lattice.values.len());
    }

    #[test]
    fn it_stops_at_the_memory_that_is_allowed() {
        let error = grown(1e-6, 1 << 12).unwrap_err();
        assert!(error.to_string().contains("4096"), "{error}");
    }

    #[test]
    fn beyond_the_ends_it_is_constant_and_nan_stays_nan() {
        let lattice = grown(1e-2, 1 << 20).unwrap();
        assert_eq!(
            lattice.interpolated([5.0, 0.0]),
            lattice.interpolated([2.0, 0.0])
        );
        assert_eq!(lattice.interpolated([0.0, 9.0]), 3.0);
        assert!(lattice.interpolated([f32::NAN, 0.0]).is_nan());
    }

    #[test]
    fn it_comes_back_from_a_file_or_is_refused() {
        let lattice = grown(1e-2, 1 << 20).unwrap();
        let json = serde_json::to_string(&lattice).unwrap();
        assert_eq!(serde_json::from_str::<Lattice<2>>(&json).unwrap(), lattice);
        for (from, to, message) in [
            (
                "\"intervals\":8",
                "\"intervals\":9",
                "expected one for each node",
            ),
            (
                "\"intervals\":8",
                "\"intervals\":0",
                "at least one interval",
            ),
            ("\"from\":0.0", "\"from\":7.0", "expected ascending"),
        ] {
            let changed = json.replacen(from, to, 1);
            let error = serde_json::from_str::<Lattice<2>>(&changed).unwrap_err();
            assert!(error.to_string().contains(message), "{error}");
        }
    }
}
