//! Tables over three angles, sampled so densely that linear interpolation between their entries
//! stays within a tolerance.
//!
//! Each axis is refined on its own: the error of linear interpolation along it is kept below a
//! fraction of the tolerance at many points of the other two axes. The whole table is then checked
//! between its entries. Where it fails, the failing points are added to those at which the axes are
//! refined, and the fraction is reduced.

mod few;
mod refinement;

use rand::rngs::StdRng;
use rand::{RngExt as _, SeedableRng as _};

use few::Few;
use refinement::axes;

/// The largest number of entries, over all channels: a text of larger tables takes hundreds of
/// megabytes.
pub(super) const MAX_ENTRIES: usize = 4_000_000;

/// How often a table is refined; each time the allowed error along an axis is multiplied by 0.8.
const MAX_ROUNDS: usize = 16;

/// About the number of cells of a table that are checked, each at two points.
const CHECKED_CELLS: usize = 500_000;

/// About the number of cells that are checked before a table is computed.
const TRIED_CELLS: usize = 4000;

/// About the number of cells by which the error of the largest table is estimated, where a smaller one
/// is asked for.
const SURVEYED_CELLS: usize = 50_000;

/// The largest number of tables that are tried for the estimate of the error of the largest.
const MOST_TRIALS: usize = 6;

/// The smallest error of a table that is reported: less is rounding.
const SMALLEST_ERROR: f64 = 1e-12;

/// A tolerance that is reached exceeds the error of the largest table by this factor: the rounds of a
/// refinement end with an error along the axes between 0.8 of the largest that suffices and that.
const ROUND: f64 = 1.25;

/// How many of the failing points, the worst first, the next round takes into account.
const WORST_POINTS: usize = 200;

/// Three angles, in the order of the axes.
pub(super) type Angles = [f64; 3];

/// What is tabulated: one or more functions of three angles, called channels.
pub(super) trait Tabulated {
    /// Three angles as all functions need them.
    type Point;
    /// The point at these angles.
    fn point(&self, at: Angles) -> Self::Point;
    /// The number of functions.
    fn channels(&self) -> usize;
    /// The first and the last angle of each axis.
    fn ranges(&self) -> [(f64, f64); 3];
    /// The value of a function; where it is not defined, that of a continuation.
    fn value(&self, channel: usize, at: &Self::Point) -> f64;
    /// Whether the tolerance applies there.
    fn tolerance_applies(&self, at: &Self::Point) -> bool;
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
    /// The number of functions in the table.
    pub(super) channels: usize,
}

impl Table {
    /// The table within a relative tolerance.
    ///
    /// # Errors
    ///
    /// It has more than [`MAX_ENTRIES`].
    pub(super) fn within(function: &impl Tabulated, tolerance: f64) -> Result<Self, Unreachable> {
        let points = MAX_ENTRIES / function.channels();
        let few = Few::of(function);
        let refined = match &few {
            // Half as many points again, because the axes of some functions are not exactly among
            // those of all.
            Some(few) if axes(few, &[], 0.5 * tolerance, points + points / 2).is_none() => {
                Err(None)
            }
            _ => Self::refined(function, tolerance, points),
        };
        refined.map_err(|reached| {
            let reached = reached.or_else(|| match &few {
                Some(few) => error_of_largest(few, points),
                None => error_of_largest(function, points),
            });
            let reachable = reached.map_or(1.0, |error| rounded_up(ROUND * error));
            Unreachable {
                reachable: reachable.max(rounded_up(1.4 * tolerance)),
                channels: function.channels(),
            }
        })
    }

    /// The table of at most so many points.
    ///
    /// # Errors
    ///
    /// There are too many points: the error of the largest table that was computed, if there was one.
    fn refined(
        function: &impl Tabulated,
        tolerance: f64,
        points: usize,
    ) -> Result<Self, Option<f64>> {
        let mut max_error = 0.5 * tolerance;
        let (mut failed, mut reached) = (Vec::new(), None);
        for _ in 0..MAX_ROUNDS {
            let axes = tried_axes(function, tolerance, points, &mut max_error, &mut failed);
            let mut table = Self::new(function, axes.ok_or(reached)?);
            let entry = |index| table.entry(index);
            let value = |entry: &&[f64], channel: usize| entry[channel];
            let check = Check::new(
                function,
                &table.axes,
                tolerance,
                CHECKED_CELLS,
                entry,
                value,
            );
            (table.largest_error, table.checked) = (check.largest_error, check.checked);
            if check.failed.is_empty() {
                return Ok(table);
            }
            reached = Some(table.largest_error);
            failed.extend(check.failed);
            max_error *= 0.8;
        }
        Err(reached)
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
            let point = needed.then(|| function.point(at));
            let value = |channel| match &point {
                Some(point) => function.value(channel, point),
                None => 0.0,
            };
            values.extend((0..table.channels).map(value));
        }
        table.values = values;
        table
    }

    /// The value of an entry, given by its indices on the axes.
    pub(super) fn value(&self, index: [usize; 3], channel: usize) -> f64 {
        self.entry(index)[channel]
    }

    /// The values of an entry, one for each channel.
    fn entry(&self, index: [usize; 3]) -> &[f64] {
        let entry = flat_index(self.axes.each_ref().map(Vec::len), index);
        &self.values[entry * self.channels..][..self.channels]
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
    /// Checks about `most` cells of a table, which is given by its axes, its entries and the value of an
    /// entry for each channel.
    fn new<E>(
        function: &impl Tabulated,
        axes: &[Vec<f64>; 3],
        tolerance: f64,
        most: usize,
        entry: impl Fn([usize; 3]) -> E,
        value: impl Fn(&E, usize) -> f64,
    ) -> Self {
        let mut random = StdRng::seed_from_u64(1);
        let cells = axes.each_ref().map(|axis| axis.len() - 1);
        let step = (cells.iter().product::<usize>() / most).max(1);
        let (mut largest_error, mut checked) = (0.0_f64, 0);
        let mut failed = Vec::new();
        for cell in indices(cells).step_by(step) {
            let anywhere = std::array::from_fn(|_| random.random_range(0.0..1.0));
            let corners: [E; 8] = std::array::from_fn(|bits| entry(corner(cell, bits)));
            for within in [[0.5; 3], anywhere] {
                let at = between(axes, cell, within);
                let point = function.point(at);
                if function.tolerance_applies(&point) {
                    let of = |channel| {
                        let found = interpolated(within, |bits| value(&corners[bits], channel));
                        relative_error(found, function.value(channel, &point))
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

    /// [`new`](Self::new) without a table, whose entries are computed where they are needed.
    fn without_table<F: Tabulated>(
        function: &F,
        axes: &[Vec<f64>; 3],
        tolerance: f64,
        most: usize,
    ) -> Self {
        let angles = |index: [usize; 3]| std::array::from_fn(|axis| axes[axis][index[axis]]);
        let entry = |index| function.point(angles(index));
        let value = |point: &F::Point, channel| function.value(channel, point);
        Self::new(function, axes, tolerance, most, entry, value)
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

/// The index of a corner of a cell: a bit for each axis says whether it is the upper one.
fn corner(cell: [usize; 3], bits: usize) -> [usize; 3] {
    std::array::from_fn(|axis| cell[axis] + (bits >> axis & 1))
}

/// Interpolates linearly between the corners of a cell, of which `value` is the value.
fn interpolated(within: [f64; 3], value: impl Fn(usize) -> f64) -> f64 {
    let weighted = |bits: usize| {
        let weights = (0..3).map(|axis| match bits >> axis & 1 {
            0 => 1.0 - within[axis],
            _ => within[axis],
        });
        weights.product::<f64>() * value(bits)
    };
    (0..8).map(weighted).sum()
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
    points: usize,
    max_error: &mut f64,
    failed: &mut Vec<Angles>,
) -> Option<[Vec<f64>; 3]> {
    for _ in 0..MAX_ROUNDS {
        let axes = axes(function, failed, *max_error, points)?;
        let check = Check::without_table(function, &axes, tolerance, TRIED_CELLS);
        if check.failed.is_empty() {
            return Some(axes);
        }
        failed.extend(check.failed);
        *max_error *= 0.8;
    }
    None
}

/// About the largest error of the largest table of at most so many points; `None` where an error of a
/// quarter along each axis takes more. The table itself is not computed.
///
/// The number of points is about proportional to the power -5/3 of the error along the axes: to -3/2 where
/// the steps are small, because the error of linear interpolation is proportional to the square of the
/// step.
fn error_of_largest(function: &impl Tabulated, points: usize) -> Option<f64> {
    let fitting = |max_error| axes(function, &[], max_error, points);
    let coarse = [0.06, 0.25].into_iter();
    let mut trials = coarse.map(|max_error| Some((max_error, fitting(max_error)?)));
    let (mut max_error, mut largest) = trials.find_map(|trial| trial)?;
    let mut too_small = 0.0_f64;
    for _ in 0..MOST_TRIALS {
        let count: usize = largest.iter().map(Vec::len).product();
        let full = 1.05 * max_error * (count as f64 / points as f64).powf(0.6);
        let next = if full > too_small {
            full.max(0.02 * max_error)
        } else {
            (too_small * max_error).sqrt()
        };
        if next > 0.8 * max_error {
            break;
        }
        match fitting(next) {
            Some(axes) => (max_error, largest) = (next, axes),
            None => too_small = next,
        }
    }
    let check = Check::without_table(function, &largest, f64::INFINITY, SURVEYED_CELLS);
    Some(check.largest_error.max(SMALLEST_ERROR))
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

/// Rounds up to two significant digits.
fn rounded_up(number: f64) -> f64 {
    let unit = 10_f64.powf(number.log10().floor() - 1.0);
    (number / unit).ceil() * unit
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Ridges along the diagonal of the first two axes, one for each width, which count their evaluations.
    pub(super) struct Ridges {
        widths: Vec<f64>,
        pub(super) evaluations: Cell<usize>,
    }

    impl Ridges {
        pub(super) fn new(widths: impl IntoIterator<Item = f64>) -> Self {
            Self {
                widths: widths.into_iter().collect(),
                evaluations: Cell::new(0),
            }
        }
    }

    impl Tabulated for Ridges {
        type Point = Angles;

        fn point(&self, at: Angles) -> Angles {
            at
        }

        fn channels(&self) -> usize {
            self.widths.len()
        }

        fn ranges(&self) -> [(f64, f64); 3] {
            [(0.0, 1.0), (0.0, 1.0), (0.0, 2.0)]
        }

        fn value(&self, channel: usize, &[x, y, z]: &Angles) -> f64 {
            self.evaluations.update(|count| count + 1);
            1.0 / (1.0 + ((x - y) / self.widths[channel]).powi(2)) + 0.1 + z
        }

        fn tolerance_applies(&self, [x, ..]: &Angles) -> bool {
            *x <= 0.9
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
        let ridge = Ridges::new([0.1]);
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
            let exact = ridge.value(0, &at);
            let found = interpolated(within, |bits| table.value(corner(cell, bits), 0));
            let error = (found / exact - 1.0).abs();
            assert!(error < 1.3e-2, "{error} at {at:?}");
        }
    }

    #[test]
    fn a_tolerance_that_is_too_small_is_refused_with_one_that_is_reached() {
        for tolerance in [1e-300, 1e-5] {
            let ridge = Ridges::new([0.05]);
            let refused = Table::within(&ridge, tolerance).err().unwrap();
            let evaluations = ridge.evaluations.get();
            assert!(evaluations < 4_000_000, "{evaluations}");
            let reachable = refused.reachable;
            assert!((1e-5..1.0).contains(&reachable), "{reachable}");
            assert!(Table::within(&ridge, reachable).is_ok(), "{reachable}");
        }
    }

    #[test]
    fn thousands_of_functions_with_narrow_lobes_are_refused_by_a_few_of_them() {
        let ridges = Ridges::new((0..60_000).map(|i| 1e-3 + 1e-9 * f64::from(i)));
        let refused = Table::within(&ridges, 1e-2).err().unwrap();
        assert_eq!(refused.reachable, 1.0);
        assert!(
            ridges.evaluations.get() < 100_000,
            "{}",
            ridges.evaluations.get()
        );
    }
}
