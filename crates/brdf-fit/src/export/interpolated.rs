//! Tables over three angles, sampled so densely that linear interpolation between their entries
//! stays within a tolerance.
//!
//! Each axis is refined on its own: the error of linear interpolation along it is kept below a
//! fraction of the tolerance at many points of the other two axes. The whole table is then checked
//! between its entries. Where it fails, the failing points are added to those at which the axes are
//! refined, and the fraction is reduced.

use rand::rngs::StdRng;
use rand::{RngExt as _, SeedableRng as _};

/// The largest number of entries, over all channels: a text of larger tables takes hundreds of
/// megabytes.
pub(super) const MAX_ENTRIES: usize = 4_000_000;

/// The largest number of angles on one axis: with more, the other axes would have almost none.
const MAX_ANGLES: usize = 2000;

/// How often a table is refined; each time the allowed error along an axis is multiplied by 0.8.
const MAX_ROUNDS: usize = 16;

/// About the number of cells of a table that are checked, each at two points.
const CHECKED_CELLS: usize = 500_000;

/// About the number of cells that are checked before a table is computed.
const TRIED_CELLS: usize = 4000;

/// How many of the failing points, the worst first, the next round takes into account.
const WORST_POINTS: usize = 200;

/// Three angles, in the order of the axes.
pub(super) type Angles = [f64; 3];

/// What is tabulated: one or more functions of three angles, called channels.
pub(super) trait Tabulated {
    /// The number of functions.
    fn channels(&self) -> usize;
    /// The first and the last angle of each axis.
    fn ranges(&self) -> [(f64, f64); 3];
    /// The value of a function; where it is not defined, that of a continuation.
    fn value(&self, channel: usize, at: Angles) -> f64;
    /// Whether the tolerance applies there.
    fn tolerance_applies(&self, at: Angles) -> bool;
    /// Angles of each axis; their combinations are the points at which the other axes are refined.
    fn samples(&self) -> [Vec<f64>; 3];
    /// Additional points for the refinement of an axis near an angle, where the functions may have
    /// a narrow lobe.
    fn lobe_points(&self, axis: usize, angle: f64) -> Vec<Angles>;
    /// The angle as it is written.
    fn rounded(&self, angle: f64) -> f64;
    /// Whether the functions themselves, not only their continuations, are defined there.
    fn is_defined(&self, at: Angles) -> bool;
}

/// A table within its tolerance.
pub(super) struct Table {
    /// The angles of each axis, ascending.
    pub(super) axes: [Vec<f64>; 3],
    channels: usize,
    values: Vec<f64>,
    /// The largest relative error found between the entries.
    pub(super) largest_error: f64,
    /// The number of points at which the error was computed.
    pub(super) checked: usize,
}

/// Every table within the tolerance is too large.
pub(super) struct Unreachable {
    /// About the smallest tolerance that a table satisfies.
    pub(super) reachable: f64,
}

impl Table {
    /// The table within a relative tolerance.
    ///
    /// # Errors
    ///
    /// It has more than [`MAX_ENTRIES`].
    pub(super) fn within(function: &impl Tabulated, tolerance: f64) -> Result<Self, Unreachable> {
        Self::refined(function, tolerance).ok_or_else(|| Unreachable {
            reachable: reachable_tolerance(function).max(rounded_up(1.4 * tolerance)),
        })
    }

    /// `None` where there are too many entries.
    fn refined(function: &impl Tabulated, tolerance: f64) -> Option<Self> {
        let mut max_error = 0.5 * tolerance;
        let mut failed = Vec::new();
        for _ in 0..MAX_ROUNDS {
            let axes = tried_axes(function, tolerance, &mut max_error, &mut failed)?;
            let mut table = Self::new(function, axes);
            let value = |index, channel| table.value(index, channel);
            let check = Check::new(function, &table.axes, tolerance, CHECKED_CELLS, value);
            (table.largest_error, table.checked) = (check.largest_error, check.checked);
            if check.failed.is_empty() {
                return Some(table);
            }
            failed.extend(check.failed);
            max_error *= 0.8;
        }
        None
    }

    fn new(function: &impl Tabulated, axes: [Vec<f64>; 3]) -> Self {
        let mut table = Self {
            channels: function.channels(),
            values: Vec::new(),
            largest_error: 0.0,
            checked: 0,
            axes,
        };
        let size = table.axes.each_ref().map(Vec::len);
        let defined: Vec<bool> = indices(size)
            .map(|index| function.is_defined(table.angles(index)))
            .collect();
        // Cells that contain a point where the functions are defined have no other corners.
        let needed = |index| adjacent(size, index).any(|other| defined[flat_index(size, other)]);
        let mut values = Vec::with_capacity(defined.len() * table.channels);
        for index in indices(size) {
            let (at, needed) = (table.angles(index), needed(index));
            let value = |channel| {
                if needed {
                    function.value(channel, at)
                } else {
                    0.0
                }
            };
            values.extend((0..table.channels).map(value));
        }
        table.values = values;
        table
    }

    /// The value of an entry, given by its indices on the axes.
    pub(super) fn value(&self, index: [usize; 3], channel: usize) -> f64 {
        let entry = flat_index(self.axes.each_ref().map(Vec::len), index);
        self.values[entry * self.channels + channel]
    }

    fn angles(&self, index: [usize; 3]) -> Angles {
        std::array::from_fn(|axis| self.axes[axis][index[axis]])
    }
}

/// The errors found between the entries of a table.
struct Check {
    largest_error: f64,
    checked: usize,
    /// The points at which the error exceeds the tolerance, the worst first.
    failed: Vec<Angles>,
}

impl Check {
    /// Checks about `most` cells of a table, which is given by its axes and a function for its entries.
    fn new(
        function: &impl Tabulated,
        axes: &[Vec<f64>; 3],
        tolerance: f64,
        most: usize,
        value: impl Fn([usize; 3], usize) -> f64,
    ) -> Self {
        let mut random = StdRng::seed_from_u64(1);
        let cells = axes.each_ref().map(|axis| axis.len() - 1);
        let step = (cells.iter().product::<usize>() / most).max(1);
        let (mut largest_error, mut checked) = (0.0_f64, 0);
        let mut failed = Vec::new();
        for cell in indices(cells).step_by(step) {
            let anywhere = std::array::from_fn(|_| random.random_range(0.0..1.0));
            for within in [[0.5; 3], anywhere] {
                let at = between(axes, cell, within);
                if function.tolerance_applies(at) {
                    let of = |channel| {
                        let found = interpolated(cell, within, |index| value(index, channel));
                        relative_error(found, function.value(channel, at))
                    };
                    let error = (0..function.channels()).map(of).fold(0.0, f64::max);
                    checked += 1;
                    largest_error = largest_error.max(error);
                    if error > tolerance {
                        failed.push((error, at));
                    }
                }
            }
        }
        failed.sort_by(|a, b| b.0.total_cmp(&a.0));
        let worst = failed.into_iter().take(WORST_POINTS);
        Self {
            largest_error,
            checked,
            failed: worst.map(|(_, at)| at).collect(),
        }
    }
}

/// A point of a cell, given by the first corner of the cell; `within` are the coordinates in the cell,
/// each from 0 to 1.
fn between(axes: &[Vec<f64>; 3], cell: [usize; 3], within: [f64; 3]) -> Angles {
    std::array::from_fn(|axis| {
        let (from, to) = (axes[axis][cell[axis]], axes[axis][cell[axis] + 1]);
        from + within[axis] * (to - from)
    })
}

/// Interpolates linearly between the corners of a cell.
fn interpolated(cell: [usize; 3], within: [f64; 3], value: impl Fn([usize; 3]) -> f64) -> f64 {
    let corner = |bits: usize| {
        let upper: [usize; 3] = std::array::from_fn(|axis| bits >> axis & 1);
        let weights = (0..3).map(|axis| match upper[axis] {
            0 => 1.0 - within[axis],
            _ => within[axis],
        });
        let index = std::array::from_fn(|axis| cell[axis] + upper[axis]);
        weights.product::<f64>() * value(index)
    };
    (0..8).map(corner).sum()
}

fn relative_error(found: f64, exact: f64) -> f64 {
    let error = (found - exact).abs();
    if error == 0.0 {
        0.0
    } else {
        error / exact.abs()
    }
}

/// The axes of a table that satisfies the tolerance in some of its cells, refined until it does; `None`
/// where there are too many entries. The table itself is not computed.
fn tried_axes(
    function: &impl Tabulated,
    tolerance: f64,
    max_error: &mut f64,
    failed: &mut Vec<Angles>,
) -> Option<[Vec<f64>; 3]> {
    for _ in 0..MAX_ROUNDS {
        let axes = axes(function, failed, *max_error)?;
        let value = |index: [usize; 3], channel| {
            function.value(channel, std::array::from_fn(|axis| axes[axis][index[axis]]))
        };
        let check = Check::new(function, &axes, tolerance, TRIED_CELLS, value);
        if check.failed.is_empty() {
            return Some(axes);
        }
        failed.extend(check.failed);
        *max_error *= 0.8;
    }
    None
}

/// About the smallest tolerance that a table satisfies.
///
/// It is found by the axes of the tables alone, from coarse tables to fine ones, so that a refusal does not
/// compute any table.
fn reachable_tolerance(function: &impl Tabulated) -> f64 {
    let suffices = |tolerance: f64| {
        // Axes that are refined this far have almost always been refined enough.
        axes(function, &[], 0.25 * tolerance).is_some()
    };
    let mut reachable = 1.0;
    for factor in [4.0, 1.4] {
        while reachable > 1e-12 && suffices(reachable / factor) {
            reachable /= factor;
        }
    }
    rounded_up(reachable)
}

/// All indices of a grid, the last axis fastest.
fn indices([first, second, third]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..first).flat_map(move |i| (0..second).flat_map(move |j| (0..third).map(move |k| [i, j, k])))
}

/// The position of an entry in the order of [`indices`].
fn flat_index([_, second, third]: [usize; 3], index: [usize; 3]) -> usize {
    (index[0] * second + index[1]) * third + index[2]
}

/// An entry and those that share a cell with it.
fn adjacent(size: [usize; 3], index: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let from = index.map(|i| i.saturating_sub(1));
    let counts = std::array::from_fn(|axis| (index[axis] + 2).min(size[axis]) - from[axis]);
    indices(counts).map(move |offset| std::array::from_fn(|axis| from[axis] + offset[axis]))
}

/// The axes for a maximum relative error along each of them; `None` where there are too many
/// entries.
fn axes(function: &impl Tabulated, failed: &[Angles], max_error: f64) -> Option<[Vec<f64>; 3]> {
    let samples = function.samples();
    let mut entries = function.channels();
    let mut axes: [Vec<f64>; 3] = Default::default();
    for (axis, angles) in axes.iter_mut().enumerate() {
        let refinement = Refinement::new(function, axis, &samples, failed, max_error);
        *angles = refinement.angles(MAX_ENTRIES / entries)?;
        entries *= angles.len();
    }
    Some(axes)
}

/// Rounds up to two significant digits.
fn rounded_up(number: f64) -> f64 {
    let unit = 10_f64.powf(number.log10().floor() - 1.0);
    (number / unit).ceil() * unit
}

/// The refinement of one axis.
struct Refinement<'a, F> {
    function: &'a F,
    axis: usize,
    /// The points at which the error along the axis is computed; their angle on the axis is
    /// ignored.
    points: Vec<Angles>,
    max_error: f64,
}

impl<'a, F: Tabulated> Refinement<'a, F> {
    fn new(
        function: &'a F,
        axis: usize,
        samples: &[Vec<f64>; 3],
        failed: &[Angles],
        max_error: f64,
    ) -> Self {
        let mut lists = samples.clone();
        lists[axis] = vec![0.0];
        let product = indices(lists.each_ref().map(Vec::len));
        let at = |index: [usize; 3]| std::array::from_fn(|axis| lists[axis][index[axis]]);
        let points = product.map(at).chain(failed.iter().copied()).collect();
        Self {
            function,
            axis,
            points,
            max_error,
        }
    }

    /// The angles, as far apart as the maximum error allows; `None` where they are more than
    /// `most`.
    fn angles(&self, most: usize) -> Option<Vec<f64>> {
        let (from, to) = self.function.ranges()[self.axis];
        let smallest = (to - from) * 1e-6;
        let (mut angles, mut angle) = (vec![from], from);
        let most = most.min(MAX_ANGLES);
        let mut step = (to - from) / 64.0;
        while angle < to {
            step = (2.0 * step).min(to - angle);
            while step > smallest && !self.is_linear(angle, angle + step) {
                step *= 0.8;
            }
            let next = self.function.rounded(angle + step).min(to);
            angle = if next > angle {
                next
            } else {
                (angle + smallest).min(to)
            };
            if angles.len() >= most {
                return None;
            }
            angles.push(angle);
        }
        Some(angles)
    }

    /// Whether linear interpolation between two angles is within the maximum error at all points.
    fn is_linear(&self, from: f64, to: f64) -> bool {
        let lobe = self.function.lobe_points(self.axis, 0.5 * (from + to));
        let mut points = self.points.iter().chain(&lobe);
        points.all(|point| {
            (0..self.function.channels()).all(|channel| self.is_linear_at(point, channel, from, to))
        })
    }

    fn is_linear_at(&self, point: &Angles, channel: usize, from: f64, to: f64) -> bool {
        let at = |angle: f64| {
            let mut at = *point;
            at[self.axis] = angle;
            at
        };
        let value = |angle| self.function.value(channel, at(angle));
        let mut ends = None;
        [0.5, 0.25, 0.75].into_iter().all(|within| {
            let between = from + within * (to - from);
            if !self.function.tolerance_applies(at(between)) {
                return true;
            }
            let (first, last) = *ends.get_or_insert_with(|| (value(from), value(to)));
            let exact = value(between);
            (first + within * (last - first) - exact).abs() <= self.max_error * exact.abs()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ridge along the diagonal of the first two axes.
    struct Ridge {
        width: f64,
    }

    impl Tabulated for Ridge {
        fn channels(&self) -> usize {
            1
        }

        fn ranges(&self) -> [(f64, f64); 3] {
            [(0.0, 1.0), (0.0, 1.0), (0.0, 2.0)]
        }

        fn value(&self, _: usize, [x, y, z]: Angles) -> f64 {
            1.0 / (1.0 + ((x - y) / self.width).powi(2)) + 0.1 + z
        }

        fn tolerance_applies(&self, [x, ..]: Angles) -> bool {
            x <= 0.9
        }

        fn samples(&self) -> [Vec<f64>; 3] {
            [vec![0.1, 0.5], vec![0.1, 0.5], vec![0.0, 1.0]]
        }

        fn lobe_points(&self, _: usize, _: f64) -> Vec<Angles> {
            Vec::new()
        }

        fn rounded(&self, angle: f64) -> f64 {
            angle
        }

        fn is_defined(&self, _: Angles) -> bool {
            true
        }
    }

    #[test]
    fn a_table_is_within_its_tolerance_at_points_that_were_not_checked() {
        let ridge = Ridge { width: 0.1 };
        let table = Table::within(&ridge, 1e-2).ok().unwrap();
        assert!(table.largest_error <= 1e-2 && table.checked > 100);
        let mut random = StdRng::seed_from_u64(7);
        for _ in 0..100_000 {
            let at: Angles =
                std::array::from_fn(|axis| random.random_range(0.0..[0.9, 1.0, 2.0][axis]));
            let cell = std::array::from_fn(|axis| {
                table.axes[axis]
                    .partition_point(|&angle| angle <= at[axis])
                    .max(1)
                    - 1
            });
            let within = std::array::from_fn(|axis| {
                let (from, to) = (
                    table.axes[axis][cell[axis]],
                    table.axes[axis][cell[axis] + 1],
                );
                (at[axis] - from) / (to - from)
            });
            let exact = ridge.value(0, at);
            let found = interpolated(cell, within, |index| table.value(index, 0));
            let error = (found / exact - 1.0).abs();
            assert!(error < 1.3e-2, "{error} at {at:?}");
        }
    }

    #[test]
    fn a_tolerance_that_is_too_small_is_reported_with_one_that_is_not() {
        let ridge = Ridge { width: 1e-3 };
        let unreachable = Table::within(&ridge, 1e-6).err().unwrap();
        let reachable = unreachable.reachable;
        assert!((1e-5..1.0).contains(&reachable), "{reachable}");
    }
}
