//! The readings of a table in fewer rows, without a loss.
//!
//! Facet distribution and Fresnel factor are the same for all readings of one alpha and one gamma,
//! and the V-groove shadowing does not depend on parameters. With the columns y, a and
//! s = a G/(cos psi cos theta) of such readings, E is the sum of
//!
//! ```text
//! |y - kD a - k2 f(alpha)/f(0) R0(gamma) s|^2
//! ```
//!
//! a length that does not change when the rows (a, s, y) are turned into each other: to the
//! triangle of their QR decomposition, three rows however many they were. So E, its derivatives and
//! all scalar products of columns are the same, but for roundings. A MERL table, 180 readings of
//! which have one alpha and one gamma, comes down to an eighth.

use brdf_core::{Geometry, GeometryError};
use rayon::prelude::*;

use super::{Angles, Objective, Segment};
use crate::scan::{Incidence, Measurement};

/// Angles of a table's bins differ by more than this fraction, and by less where they are the same.
const SAME: f64 = 1e-9;

/// The rows of one incidence.
#[derive(Default)]
pub(super) struct Rows {
    measured: Vec<f64>,
    diffuse: Vec<f64>,
    shadowed: Vec<f64>,
    angles: Vec<Angles>,
    readings: usize,
    zero_weight: usize,
}

/// The rows of each incidence, side by side; `row` gives a, s and y of a reading.
pub(super) fn rows(
    incidences: &[Incidence],
    readings: &[Measurement],
    row: impl Fn(usize, &Geometry) -> [f64; 3] + Sync,
) -> Result<Vec<Rows>, GeometryError> {
    let of_one = |incidence: &Incidence| {
        let mut rows = Rows::default();
        let mut cell: Option<(Angles, Triangle)> = None;
        for &i in &incidence.readings {
            let geometry = readings[i].geometry()?;
            let angles = Angles::of(&geometry);
            let row = row(i, &geometry);
            rows.readings += 1;
            rows.zero_weight += usize::from(row[0] == 0.0);
            match &mut cell {
                Some((shared, triangle)) if shared.agree(&angles) => triangle.add(row),
                _ => rows.take(cell.replace((angles, Triangle::of(row)))),
            }
        }
        rows.take(cell);
        Ok(rows)
    };
    incidences.par_iter().map(of_one).collect()
}

impl Rows {
    fn take(&mut self, cell: Option<(Angles, Triangle)>) {
        let Some((angles, triangle)) = cell else {
            return;
        };
        let rows = triangle.0.into_iter().filter(|row| *row != [0.0; 3]);
        for [a, s, y] in rows {
            self.diffuse.push(a);
            self.shadowed.push(s);
            self.measured.push(y);
            self.angles.push(angles);
        }
    }
}

impl Objective {
    /// Takes the rows of an incidence.
    pub(super) fn append(&mut self, psi: f64, rows: Rows) {
        let start = self.len();
        self.measured.extend(rows.measured);
        self.diffuse.extend(rows.diffuse);
        self.shadowed.extend(rows.shadowed);
        self.angles.extend(rows.angles);
        self.segments.push(Segment {
            psi,
            rows: start..self.len(),
            readings: rows.readings,
            zero_weight: rows.zero_weight,
        });
    }
}

impl Angles {
    fn agree(&self, other: &Self) -> bool {
        let same = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs();
        same(self.sec_alpha, other.sec_alpha)
            && same(self.cos_gamma, other.cos_gamma)
            && same(self.tan2_alpha, other.tan2_alpha)
    }
}

/// The triangle that rows have been turned into.
struct Triangle([[f64; 3]; 3]);

impl Triangle {
    fn of(row: [f64; 3]) -> Self {
        Self([row, [0.0; 3], [0.0; 3]])
    }

    /// Turns a row into the triangle, column by column (Givens).
    fn add(&mut self, mut row: [f64; 3]) {
        for (column, upper) in self.0.iter_mut().enumerate() {
            if row[column] == 0.0 {
                continue;
            }
            let length = upper[column].hypot(row[column]);
            let (cos, sin) = (upper[column] / length, row[column] / length);
            for (above, below) in upper.iter_mut().zip(&mut row).skip(column) {
                (*above, *below) = (cos * *above + sin * *below, cos * *below - sin * *above);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::{Family, ModelParameters};
    use proptest::prelude::*;

    use super::*;
    use crate::model::Parameter;
    use crate::objective::weights::Weights;
    use crate::read::merl::Bins;
    use crate::scan::Measurements;

    const BINS: Bins = Bins {
        theta_h: 12,
        theta_d: 10,
        phi_d: 24,
    };

    /// The bins of a table, with a value that no model has.
    fn table() -> Measurements {
        let bins = (0..BINS.count()).map(|bin| [bin / 240, bin / 24 % 10, bin % 24]);
        let readings = bins.filter_map(|bin| {
            let [psi, theta, phi] = BINS.centre(bin)?;
            let [i, j, k] = bin.map(|x| x as f64);
            Some(Measurement {
                wavelength_um: None,
                psi,
                theta,
                phi,
                brdf: 0.1 + 0.05 * (i + 0.3 * j * k).sin() + 1.0 / (1.0 + i * i),
                sigma: None,
            })
        });
        let mut table = Measurements::new("table", readings.collect()).unwrap();
        table.incidence_class = Some(0.2);
        table
    }

    fn both(family: Family, weights: &Weights) -> [Objective; 2] {
        let table = table();
        [
            Objective::condensed(&table, family, 1.5, weights).unwrap(),
            Objective::new(&table, family, 1.5, weights).unwrap(),
        ]
    }

    #[test]
    fn there_are_fewer_rows_for_as_many_readings() {
        let weights = Weights {
            mask_mirror: 0.3,
            ..Weights::default()
        };
        let [condensed, whole] = both(Family::Paper, &weights);
        assert!(
            3 * condensed.len() < whole.len(),
            "{} {}",
            condensed.len(),
            whole.len()
        );
        assert_eq!(condensed.count(), whole.count());
        assert_eq!(condensed.zero_weight(), whole.zero_weight());
        assert!(condensed.zero_weight() > 0);
    }

    #[test]
    fn where_the_shadowing_depends_on_the_width_each_reading_is_a_row() {
        let [condensed, whole] = both(Family::Ggx, &Weights::default());
        assert_eq!(condensed.len(), whole.len());
    }

    #[test]
    fn a_triangle_has_the_scalar_products_of_its_rows() {
        let rows = [
            [1.0, 2.0, -3.0],
            [0.5, 0.0, 4.0],
            [0.0, -1.0, 2.0],
            [3.0, 3.0, 0.1],
        ];
        let mut triangle = Triangle::of(rows[0]);
        rows[1..].iter().for_each(|row| triangle.add(*row));
        let product = |rows: &[[f64; 3]], i: usize, j: usize| -> f64 {
            rows.iter().map(|row| row[i] * row[j]).sum()
        };
        for (i, j) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] {
            let expected = product(&rows, i, j);
            assert!((product(&triangle.0, i, j) - expected).abs() < 1e-13);
        }
        assert_eq!(
            [triangle.0[1][0], triangle.0[2][0], triangle.0[2][1]],
            [0.0; 3]
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn error_and_derivatives_are_those_of_all_readings(
            k2 in 0.0..2.0, kd in 0.0..1.0, log_k1 in -4.0..1.0_f64, n in 1.1..3.0, p in 0.5..4.0,
        ) {
            let at = ModelParameters { k2, kd, k1: log_k1.exp(), n, p };
            for family in [Family::Paper, Family::Power, Family::Beckmann] {
                let [condensed, whole] = both(family, &Weights::default());
                let close = |a: f64, b: f64| (a - b).abs() <= 1e-11 * (1.0 + b.abs());
                prop_assert!(close(condensed.error(&at), whole.error(&at)));
                let free = [Parameter::K2, Parameter::Kd, Parameter::K1, Parameter::N, Parameter::P];
                let equations = [&condensed, &whole].map(|c| c.normal_equations(&at, &free));
                let pairs = equations[0].matrix.iter().zip(equations[1].matrix.iter());
                let slopes = equations[0].gradient.iter().zip(equations[1].gradient.iter());
                for (a, b) in pairs.chain(slopes) {
                    prop_assert!(close(*a, *b), "{a} {b}");
                }
                let by_incidence = [&condensed, &whole].map(|c| c.by_incidence(&at));
                for (a, b) in by_incidence[0].iter().zip(&by_incidence[1]) {
                    prop_assert_eq!((a.psi_deg, a.readings), (b.psi_deg, b.readings));
                    prop_assert!(close(a.e_percent.unwrap(), b.e_percent.unwrap()));
                }
            }
        }
    }
}
