//! Functions on the unit square that are linear between the nodes of a grid, and the mapping that draws
//! points with such a density.

use super::tensor::Tensor;

/// A function on the unit square: values at the nodes of a grid from end to end, linear in u and v
/// between them.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    columns: usize,
    rows: usize,
    /// Row by row.
    values: Vec<f64>,
}

impl Grid {
    /// The values of a slice of a tensor, the one at `slice` of the dimensions before the last two.
    ///
    /// # Errors
    ///
    /// There are fewer than two rows or columns, or a value is not a number from 0.
    pub(super) fn new(name: &str, tensor: &Tensor<'_>, slice: usize) -> Result<Self, String> {
        let mut sizes = tensor.shape.iter().rev().copied();
        let (columns, rows) = (sizes.next().unwrap_or(0), sizes.next().unwrap_or(0));
        if columns < 2 || rows < 2 {
            return Err(format!(
                "has {rows} x {columns} nodes in the tensor {name}: expected 2 x 2 or more"
            ));
        }
        let count = rows.saturating_mul(columns);
        let start = slice.saturating_mul(count);
        let values: Vec<f64> = (start..start.saturating_add(count))
            .map(|i| tensor.at(i))
            .collect();
        let is_bad = |value: &&f64| !(0.0..=1e60).contains(*value);
        match values.iter().find(is_bad) {
            Some(value) => Err(format!(
                "has the value {value} in the tensor {name}: expected numbers from 0"
            )),
            None => Ok(Self {
                columns,
                rows,
                values,
            }),
        }
    }

    fn at(&self, row: usize, column: usize) -> f64 {
        let position = row * self.columns + column;
        self.values.get(position).copied().unwrap_or(0.0)
    }

    /// The value at (u, v), linear between the nodes.
    pub(super) fn value(&self, [u, v]: [f64; 2]) -> f64 {
        let (column, x) = cell(u, self.columns);
        let (row, y) = cell(v, self.rows);
        let across = |row| lerp(self.at(row, column), self.at(row, column + 1), x);
        lerp(across(row), across(row + 1), y)
    }
}

/// The cell of a position from 0 to 1 between `nodes` nodes, and the position in it from 0 to 1.
fn cell(position: f64, nodes: usize) -> (usize, f64) {
    let last = nodes.saturating_sub(2);
    let scaled = position.clamp(0.0, 1.0) * nodes.saturating_sub(1) as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a position from 0 to the number of nodes"
    )]
    let cell = (scaled as usize).min(last);
    (cell, scaled - cell as f64)
}

fn lerp(a: f64, b: f64, t: f64) -> f64 {
    a * (1.0 - t) + b * t
}

/// The mapping of the unit square to itself that takes equal areas to equal integrals of a density: v by
/// the marginal density, then u by the conditional one.
pub(super) struct Warp {
    density: Grid,
    /// The integral over u from 0 to each node, row by row, in units of the distance of nodes.
    along_rows: Vec<f64>,
    /// The integral of the rows' integrals over v from 0 to each node.
    over_rows: Vec<f64>,
}

impl Warp {
    /// `None` where the density is 0 everywhere.
    pub(super) fn new(density: Grid) -> Option<Self> {
        let mut along_rows = Vec::with_capacity(density.values.len());
        for row in 0..density.rows {
            let values = (0..density.columns).map(|column| density.at(row, column));
            along_rows.extend(integrals(values));
        }
        let columns = density.columns;
        let totals = along_rows
            .iter()
            .copied()
            .skip(columns - 1)
            .step_by(columns);
        let over_rows = integrals(totals);
        let is_positive = over_rows.last().is_some_and(|total| *total > 0.0);
        is_positive.then_some(Self {
            density,
            along_rows,
            over_rows,
        })
    }

    /// The point that (u, v) is taken to, each from 0 to 1.
    pub(super) fn apply(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let (columns, rows) = (self.density.columns, self.density.rows);
        let over_rows = |row: usize| self.over_rows.get(row).copied().unwrap_or(0.0);
        let (row, rest) = cell_of_integral(v, rows, over_rows);
        let along = |row: usize, column: usize| {
            let position = row * columns + column;
            self.along_rows.get(position).copied().unwrap_or(0.0)
        };
        let y = linear_position(along(row, columns - 1), along(row + 1, columns - 1), rest);
        let along_row = |column| lerp(along(row, column), along(row + 1, column), y);
        let (column, rest) = cell_of_integral(u, columns, along_row);
        let density = |column| {
            lerp(
                self.density.at(row, column),
                self.density.at(row + 1, column),
                y,
            )
        };
        let x = linear_position(density(column), density(column + 1), rest);
        let place =
            |cell: usize, within: f64, nodes: usize| (cell as f64 + within) / (nodes - 1) as f64;
        [place(column, x, columns), place(row, y, rows)]
    }
}

/// The integral from the first node to each node, of values that are linear between the nodes.
fn integrals(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut before: Option<f64> = None;
    let mut sum = 0.0;
    values
        .map(|value| {
            sum += before.map_or(0.0, |before| 0.5 * (before + value));
            before = Some(value);
            sum
        })
        .collect()
}

/// The cell in which an integral reaches the part `part` of its value at the last of `nodes` nodes, and
/// what is left of it from the cell's first node.
fn cell_of_integral(part: f64, nodes: usize, integral: impl Fn(usize) -> f64) -> (usize, f64) {
    let target = part * integral(nodes - 1);
    // Cells without density at the ends are no place for a point.
    let is_before = |node: usize| {
        let integral = integral(node);
        integral < target || (target == 0.0 && integral <= 0.0)
    };
    let (mut low, mut high) = (0, nodes - 1);
    while high - low > 1 {
        let middle = low.midpoint(high);
        if is_before(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low, (target - integral(low)).max(0.0))
}

/// The position t from 0 to 1 up to which a density that is linear from a to b has the integral
/// `integral`: a t + (b - a) t^2 / 2 = integral.
fn linear_position(a: f64, b: f64, integral: f64) -> f64 {
    let root = (a * a + 2.0 * (b - a) * integral).max(0.0).sqrt();
    let divisor = a + root;
    if divisor > 0.0 {
        (2.0 * integral / divisor).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn grid(columns: usize, values: Vec<f64>) -> Grid {
        Grid {
            columns,
            rows: values.len() / columns,
            values,
        }
    }

    /// The integral from 0 to `end` of a function that is linear between `nodes` nodes from 0 to 1.
    fn integral_to(end: f64, nodes: usize, function: impl Fn(f64) -> f64) -> f64 {
        let step = 1.0 / (nodes - 1) as f64;
        let between = (0..nodes)
            .map(|i| i as f64 * step)
            .filter(|node| *node < end);
        let places: Vec<f64> = between.chain([end]).collect();
        let trapezium = |pair: &[f64]| {
            let [from, to] = [pair[0], pair[1]];
            0.5 * (to - from) * (function(from) + function(to))
        };
        places.windows(2).map(trapezium).sum()
    }

    /// The parts of the integral of the density that lie before (x, y): at y over u up to x, and over
    /// all u up to y.
    fn parts(grid: &Grid, [x, y]: [f64; 2]) -> [f64; 2] {
        let row = |end: f64, y: f64| integral_to(end, grid.columns, |x| grid.value([x, y]));
        let below = |end: f64| integral_to(end, grid.rows, |y| row(1.0, y));
        [row(x, y) / row(1.0, y), below(y) / below(1.0)]
    }

    #[test]
    fn a_constant_density_maps_points_to_themselves() {
        let warp = Warp::new(grid(3, vec![2.0; 12])).unwrap();
        for point in [[0.0, 0.0], [1.0, 1.0], [0.3, 0.7], [0.5, 0.25]] {
            let [x, y] = warp.apply(point);
            assert!((x - point[0]).abs() < 1e-14 && (y - point[1]).abs() < 1e-14);
        }
    }

    #[test]
    fn ends_without_density_are_left() {
        let values = vec![
            0.0, 0.0, 0.0, 0.0, 0.0, //
            0.0, 0.0, 1.0, 0.0, 0.0, //
            0.0, 0.0, 1.0, 0.0, 0.0, //
            0.0, 0.0, 0.0, 0.0, 0.0, //
            0.0, 0.0, 0.0, 0.0, 0.0,
        ];
        let warp = Warp::new(grid(5, values)).unwrap();
        assert_eq!(warp.apply([0.5, 0.0])[1], 0.0);
        let [x, y] = warp.apply([1.0, 1.0]);
        assert!(
            (x - 0.75).abs() < 1e-12 && (y - 0.75).abs() < 1e-12,
            "{x} {y}"
        );
        assert!((warp.apply([0.0, 0.5])[0] - 0.25).abs() < 1e-12);
        assert!(Warp::new(grid(2, vec![0.0; 4])).is_none());
    }

    proptest! {
        #[test]
        fn the_integral_up_to_the_point_is_the_part(
            values in proptest::collection::vec(0.01..10.0_f64, 12),
            u in 0.01..1.0_f64,
            v in 0.01..1.0_f64,
        ) {
            let grid = grid(4, values);
            let warp = Warp::new(grid.clone()).unwrap();
            let [across, below] = parts(&grid, warp.apply([u, v]));
            prop_assert!((across - u).abs() < 1e-12, "{across} {u}");
            prop_assert!((below - v).abs() < 1e-12, "{below} {v}");
        }
    }
}
