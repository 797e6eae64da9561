//! An orthonormal basis of few columns that represents many.

use crate::objective::dot_of as dot;

/// The directions of columns within a tolerance: orthonormal columns of the rows' length.
#[derive(Debug, Clone)]
pub(super) struct Basis {
    /// Orthonormal columns.
    pub(super) columns: Vec<Vec<f64>>,
}

impl Basis {
    /// A basis that begins with `first`, a unit column, and leaves of no unit column more than the
    /// tolerance.
    ///
    /// The column of which most is left is added, until none has more left than the tolerance. Each new
    /// column is made orthogonal twice: the rest of a column that is nearly represented is small, so that
    /// its rounding is not.
    pub(super) fn of(first: Option<&[f64]>, units: &[Vec<f64>], tolerance: f64) -> Self {
        let mut basis = Self {
            columns: first.map(<[f64]>::to_vec).into_iter().collect(),
        };
        let mut rests = units.to_vec();
        for column in &basis.columns {
            for rest in &mut rests {
                remove(rest, column);
            }
        }
        let rows = units.first().map_or(0, Vec::len);
        while basis.columns.len() < rows {
            let norms = rests.iter().map(|rest| norm(rest));
            let largest = norms.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((i, _)) = largest.filter(|(_, norm)| *norm > tolerance) else {
                break;
            };
            let mut column = std::mem::take(&mut rests[i]);
            for earlier in &basis.columns {
                remove(&mut column, earlier);
            }
            let length = norm(&column);
            if length <= 0.5 * tolerance {
                continue;
            }
            for x in &mut column {
                *x /= length;
            }
            for rest in &mut rests {
                remove(rest, &column);
            }
            basis.columns.push(column);
        }
        basis
    }

    /// The number of columns.
    pub(super) fn len(&self) -> usize {
        self.columns.len()
    }

    /// The coordinates of a column.
    pub(super) fn coordinates(&self, column: &[f64]) -> Vec<f64> {
        let product = |own: &Vec<f64>| dot(own, column);
        self.columns.iter().map(product).collect()
    }
}

/// Removes from a column its part along a unit column.
pub(super) fn remove(column: &mut [f64], unit: &[f64]) {
    let along = dot(column, unit);
    for (x, u) in column.iter_mut().zip(unit) {
        *x -= along * u;
    }
}

/// The Euclidean norm.
pub(super) fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn columns_are_represented_within_the_tolerance(
            shifts in proptest::collection::vec(0.1..3.0_f64, 3..20), rows in 2_usize..30,
        ) {
            let unit = |shift: &f64| {
                let column = (0..rows).map(|i| 1.0 / (1.0 + (i as f64 - shift).powi(2)));
                let column: Vec<f64> = column.collect();
                let length = norm(&column);
                column.iter().map(|x| x / length).collect::<Vec<f64>>()
            };
            let units: Vec<Vec<f64>> = shifts.iter().map(unit).collect();
            let basis = Basis::of(Some(&units[0]), &units, 1e-9);
            prop_assert!(basis.len() <= rows.min(units.len()));
            for (i, a) in basis.columns.iter().enumerate() {
                for (j, b) in basis.columns.iter().enumerate() {
                    let expected = f64::from(u8::from(i == j));
                    prop_assert!((dot(a, b) - expected).abs() < 1e-14);
                }
            }
            for column in &units {
                let mut rest = column.clone();
                basis.columns.iter().for_each(|own| remove(&mut rest, own));
                prop_assert!(norm(&rest) <= 1.01e-9, "{}", norm(&rest));
            }
        }
    }
}
