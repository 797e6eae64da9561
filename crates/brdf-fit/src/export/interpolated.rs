//! Tables over three angles whose entries are so close that what is interpolated linearly between
//! them keeps to a tolerance.
//!
//! Each axis is refined by itself: the error of linear interpolation along it is kept below a
//! share of the tolerance at many places of the other two. The whole table is then checked
//! between its entries; where it fails, these places are added and the share is lowered.

use rand::rngs::StdRng;
use rand::{RngExt as _, SeedableRng as _};

/// More entries are no table that a program wants to read.
pub(super) const MOST_ENTRIES: usize = 4_000_000;

/// More angles on one axis are none either: a table of them has next to none on the others.
const MOST_ANGLES: usize = 2000;

/// Where the search for a tolerance that can be kept to begins.
const SMALLEST_SEARCHED: f64 = 1e-3;

/// So often a table is refined; each time the share is four fifths of what it was.
const ROUNDS: usize = 16;

/// About so many cells are checked, each at two points.
const CHECKED_CELLS: usize = 500_000;

/// Of the places where a table fails so many are looked at in the next round.
const WORST: usize = 200;

/// Three angles, in the order of the axes.
pub(super) type At = [f64; 3];

/// What is tabulated: one function or more, of three angles.
pub(super) trait Tabulated {
    /// How many functions.
    fn channels(&self) -> usize;
    /// From where to where each angle goes.
    fn ranges(&self) -> [(f64, f64); 3];
    /// The value of a function; where it has none, one that continues it.
    fn value(&self, channel: usize, at: At) -> f64;
    /// Whether the tolerance holds there.
    fn is_inside(&self, at: At) -> bool;
    /// Angles of each axis, at which the other axes are refined.
    fn samples(&self) -> [Vec<f64>; 3];
    /// Further places where to look when an axis is refined near an angle: where the function is
    /// narrow.
    fn narrow(&self, axis: usize, angle: f64) -> Vec<At>;
    /// The angle that is written.
    fn rounded(&self, angle: f64) -> f64;
    /// Whether the function itself has a value there.
    fn is_defined(&self, at: At) -> bool;
}

/// A table that keeps to its tolerance.
pub(super) struct Table {
    /// The angles of each axis, ascending.
    pub(super) axes: [Vec<f64>; 3],
    channels: usize,
    values: Vec<f64>,
    /// The largest relative error found between the entries.
    pub(super) largest_error: f64,
    /// At so many points.
    pub(super) checked: usize,
}

/// No table keeps to the tolerance.
pub(super) struct Unreachable {
    /// One that a table does keep to; the next smaller one that was tried is too little.
    pub(super) reachable: f64,
}

impl Table {
    /// The table that keeps to a relative tolerance.
    ///
    /// Errors: it would have too many entries.
    pub(super) fn within(function: &impl Tabulated, tolerance: f64) -> Result<Self, Unreachable> {
        let mut failed = Vec::new();
        if let Some(table) = Self::refined(function, tolerance, &mut failed) {
            return Ok(table);
        }
        let mut reachable = tolerance.max(SMALLEST_SEARCHED);
        loop {
            reachable = in_two_digits(1.4 * reachable);
            let found = Self::refined(function, reachable, &mut failed).is_some();
            // An error of all there is: such a table is none.
            if found || reachable >= 1.0 {
                return Err(Unreachable { reachable });
            }
        }
    }

    /// `None` where there are too many entries. `failed` are places where a table failed before.
    fn refined(function: &impl Tabulated, tolerance: f64, failed: &mut Vec<At>) -> Option<Self> {
        let mut share = 0.5 * tolerance;
        for _ in 0..ROUNDS {
            let mut table = Self::new(function, axes(function, failed, share)?);
            failed.extend(table.check(function, tolerance));
            if table.largest_error <= tolerance {
                return Some(table);
            }
            share *= 0.8;
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
        let defined: Vec<bool> = places(size)
            .map(|place| function.is_defined(table.at(place)))
            .collect();
        // Further from where the function has values no cell reaches.
        let needed = |place| near(size, place).any(|beside| defined[entry(size, beside)]);
        let mut values = Vec::with_capacity(defined.len() * table.channels);
        for place in places(size) {
            let (at, needed) = (table.at(place), needed(place));
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

    /// The value of an entry, given by its places on the axes.
    pub(super) fn value(&self, place: [usize; 3], channel: usize) -> f64 {
        let entry = entry(self.axes.each_ref().map(Vec::len), place);
        self.values[entry * self.channels + channel]
    }

    fn at(&self, place: [usize; 3]) -> At {
        std::array::from_fn(|axis| self.axes[axis][place[axis]])
    }

    /// Interpolates in a cell, given by its first corner and the place in it, each from 0 to 1.
    fn interpolated(&self, cell: [usize; 3], within: At, channel: usize) -> f64 {
        let corner = |bits: usize| {
            let upper: [usize; 3] = std::array::from_fn(|axis| bits >> axis & 1);
            let weights = (0..3).map(|axis| match upper[axis] {
                0 => 1.0 - within[axis],
                _ => within[axis],
            });
            let place = std::array::from_fn(|axis| cell[axis] + upper[axis]);
            weights.product::<f64>() * self.value(place, channel)
        };
        (0..8).map(corner).sum()
    }

    /// Finds the largest error between the entries; the places with more than the tolerance, the
    /// worst first.
    fn check(&mut self, function: &impl Tabulated, tolerance: f64) -> Vec<At> {
        let mut random = StdRng::seed_from_u64(1);
        let cells = self.axes.each_ref().map(|axis| axis.len() - 1);
        let step = (cells.iter().product::<usize>() / CHECKED_CELLS).max(1);
        let mut failed = Vec::new();
        for cell in places(cells).step_by(step) {
            let anywhere = std::array::from_fn(|_| random.random_range(0.0..1.0));
            for within in [[0.5; 3], anywhere] {
                let at = self.between(cell, within);
                if function.is_inside(at) {
                    let error = self.error(function, cell, within, at);
                    self.checked += 1;
                    self.largest_error = self.largest_error.max(error);
                    if error > tolerance {
                        failed.push((error, at));
                    }
                }
            }
        }
        failed.sort_by(|a, b| b.0.total_cmp(&a.0));
        failed.into_iter().take(WORST).map(|(_, at)| at).collect()
    }

    fn between(&self, cell: [usize; 3], within: At) -> At {
        std::array::from_fn(|axis| {
            let (from, to) = (self.axes[axis][cell[axis]], self.axes[axis][cell[axis] + 1]);
            from + within[axis] * (to - from)
        })
    }

    fn error(&self, function: &impl Tabulated, cell: [usize; 3], within: At, at: At) -> f64 {
        let of = |channel| {
            let exact = function.value(channel, at);
            let error = (self.interpolated(cell, within, channel) - exact).abs();
            if error == 0.0 {
                0.0
            } else {
                error / exact.abs()
            }
        };
        (0..self.channels).map(of).fold(0.0, f64::max)
    }
}

/// All places of a grid, the last axis fastest.
fn places([first, second, third]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..first).flat_map(move |i| (0..second).flat_map(move |j| (0..third).map(move |k| [i, j, k])))
}

/// The number of an entry in their order.
fn entry([_, second, third]: [usize; 3], place: [usize; 3]) -> usize {
    (place[0] * second + place[1]) * third + place[2]
}

/// The entries beside one, and itself.
fn near(size: [usize; 3], place: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let from = place.map(|at| at.saturating_sub(1));
    let counts = std::array::from_fn(|axis| (place[axis] + 2).min(size[axis]) - from[axis]);
    places(counts).map(move |offset| std::array::from_fn(|axis| from[axis] + offset[axis]))
}

/// The axes for a share of the tolerance; `None` where there are too many entries.
fn axes(function: &impl Tabulated, failed: &[At], share: f64) -> Option<[Vec<f64>; 3]> {
    let samples = function.samples();
    let mut entries = function.channels();
    let mut axes: [Vec<f64>; 3] = Default::default();
    for (axis, angles) in axes.iter_mut().enumerate() {
        let refinement = Refinement::new(function, axis, &samples, failed, share);
        *angles = refinement.angles(MOST_ENTRIES / entries)?;
        entries *= angles.len();
    }
    Some(axes)
}

/// Rounded up.
fn in_two_digits(number: f64) -> f64 {
    let unit = 10_f64.powf(number.log10().floor() - 1.0);
    (number / unit).ceil() * unit
}

/// One axis that is refined.
struct Refinement<'a, F> {
    function: &'a F,
    axis: usize,
    /// Places of the other two.
    places: Vec<At>,
    share: f64,
}

impl<'a, F: Tabulated> Refinement<'a, F> {
    fn new(
        function: &'a F,
        axis: usize,
        samples: &[Vec<f64>; 3],
        failed: &[At],
        share: f64,
    ) -> Self {
        let mut lists = samples.clone();
        lists[axis] = vec![0.0];
        let product = places(lists.each_ref().map(Vec::len));
        let at = |place: [usize; 3]| std::array::from_fn(|axis| lists[axis][place[axis]]);
        let places = product.map(at).chain(failed.iter().copied()).collect();
        Self {
            function,
            axis,
            places,
            share,
        }
    }

    /// The angles, as far from each other as the share allows; `None` where they are more than
    /// `most`.
    fn angles(&self, most: usize) -> Option<Vec<f64>> {
        let (from, to) = self.function.ranges()[self.axis];
        let smallest = (to - from) * 1e-6;
        let (mut angles, mut angle) = (vec![from], from);
        let most = most.min(MOST_ANGLES);
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

    /// Whether the functions may be taken for linear between two angles.
    fn is_linear(&self, from: f64, to: f64) -> bool {
        let narrow = self.function.narrow(self.axis, 0.5 * (from + to));
        let mut places = self.places.iter().chain(&narrow);
        places.all(|place| {
            (0..self.function.channels()).all(|channel| self.is_linear_at(place, channel, from, to))
        })
    }

    fn is_linear_at(&self, place: &At, channel: usize, from: f64, to: f64) -> bool {
        let at = |angle: f64| {
            let mut at = *place;
            at[self.axis] = angle;
            at
        };
        let value = |angle| self.function.value(channel, at(angle));
        let mut ends = None;
        [0.5, 0.25, 0.75].into_iter().all(|within| {
            let between = from + within * (to - from);
            if !self.function.is_inside(at(between)) {
                return true;
            }
            let (first, last) = *ends.get_or_insert_with(|| (value(from), value(to)));
            let exact = value(between);
            (first + within * (last - first) - exact).abs() <= self.share * exact.abs()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ridge along the diagonal of the first two.
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

        fn value(&self, _: usize, [x, y, z]: At) -> f64 {
            1.0 / (1.0 + ((x - y) / self.width).powi(2)) + 0.1 + z
        }

        fn is_inside(&self, [x, ..]: At) -> bool {
            x <= 0.9
        }

        fn samples(&self) -> [Vec<f64>; 3] {
            [vec![0.1, 0.5], vec![0.1, 0.5], vec![0.0, 1.0]]
        }

        fn narrow(&self, _: usize, _: f64) -> Vec<At> {
            Vec::new()
        }

        fn rounded(&self, angle: f64) -> f64 {
            angle
        }

        fn is_defined(&self, _: At) -> bool {
            true
        }
    }

    #[test]
    fn a_table_keeps_to_its_tolerance_where_nobody_looked() {
        let ridge = Ridge { width: 0.1 };
        let table = Table::within(&ridge, 1e-2).ok().unwrap();
        assert!(table.largest_error <= 1e-2 && table.checked > 100);
        let mut random = StdRng::seed_from_u64(7);
        for _ in 0..100_000 {
            let at: At =
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
            let error = (table.interpolated(cell, within, 0) / exact - 1.0).abs();
            assert!(error < 1.3e-2, "{error} at {at:?}");
        }
    }

    #[test]
    fn what_no_table_can_keep_to_says_what_one_can() {
        let ridge = Ridge { width: 1e-3 };
        let unreachable = Table::within(&ridge, 1e-6).err().unwrap();
        let reachable = unreachable.reachable;
        assert!((1e-5..1.0).contains(&reachable), "{reachable}");
    }
}
