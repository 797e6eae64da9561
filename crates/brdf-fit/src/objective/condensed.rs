//! The readings of a table in fewer rows, without loss.
//!
//! The facet distribution and the Fresnel factor are the same for all readings with the same alpha
//! and gamma, and the V-groove shadowing does not depend on parameters. With the columns y, a and
//! s = a G/(cos psi cos theta) of such readings, E is the sum of
//!
//! ```text
//! |y - kD a - k2 f(alpha)/f(0) R0(gamma) s|^2
//! ```
//!
//! which is invariant under rotations of the rows (a, s, y). They are replaced by the three rows of
//! the triangle of their QR decomposition, so that E, its derivatives and all scalar products of
//! columns are the same within rounding. A MERL table, in which 180 readings have one alpha and one
//! gamma, is reduced to an eighth of its rows.

use std::sync::Arc;

use brdf_core::shadowing::{Shadowing as _, VGroove};
use brdf_core::{Family, Geometry, GeometryError};
use rayon::prelude::*;

use super::angles::Angles;
use super::error::ObjectiveError;
use super::rows::{Directions, Objective, Segment};
use super::weights::Weights;
use crate::scan::{Incidence, Measurement, Measurements};

/// The relative difference below which the angles of two bins are equal within rounding.
const SAME: f64 = 1e-9;

/// The condensed rows of one incidence.
#[derive(Default)]
struct Rows {
    measured: Vec<f64>,
    diffuse: Vec<f64>,
    shadowed: Vec<f64>,
    angles: Vec<Angles>,
    readings: usize,
    zero_weight: usize,
}

/// The condensed rows of each incidence, computed in parallel; `row` returns a, s and y of a
/// reading.
fn rows(
    incidences: &[Incidence],
    readings: &[Measurement],
    row: impl Fn(usize, &Geometry) -> [f64; 3] + Sync,
) -> Result<Vec<Rows>, GeometryError> {
    let of_one = |incidence: &Incidence| {
        let mut rows = Rows::default();
        let mut cell: Option<(Angles, Triangle)> = None;
        for &i in &incidence.readings {
            let geometry = readings[i].geometry()?;
            let angles = Angles::new(&geometry);
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
    /// The same E in fewer rows, which are not readings, for the measurements of a table: see the
    /// page of this module. Other measurements, and models whose shadowing depends on k1, keep one
    /// row for each reading.
    ///
    /// # Errors
    ///
    /// Those of [`new`](Self::new).
    pub(crate) fn condensed(
        measurements: &Measurements,
        family: Family,
        n: f64,
        weights: &Weights,
    ) -> Result<Self, ObjectiveError> {
        let by_width = matches!(family, Family::Smith | Family::Ggx);
        if by_width || !measurements.is_table() {
            return Self::new(measurements, family, n, weights);
        }
        let weighing = weights
            .weighing(measurements)
            .ok_or(ObjectiveError::NoSigma)?;
        let readings = measurements.readings();
        let row = |i: usize, geometry: &Geometry| {
            let w = weighing.weight(i).sqrt() * geometry.cos_theta();
            let a = w / std::f64::consts::PI;
            [
                a,
                a * VGroove.over_cosines_at(geometry),
                w * readings[i].brdf,
            ]
        };
        let incidences = measurements.incidences();
        let rows = rows(&incidences, readings, row)?;
        let mut objective = Self::with_capacity(family, n, 0);
        objective.noise = None;
        let mut directions = Directions::default();
        for (incidence, rows) in incidences.iter().zip(rows) {
            rows.angles
                .iter()
                .for_each(|row| directions.angles.push(*row));
            objective.append(incidence.psi, rows);
        }
        objective.directions = Arc::new(directions.with_fresnel(n));
        objective.normalised()
    }

    /// Appends the rows of an incidence, without their directions.
    fn append(&mut self, psi: f64, rows: Rows) {
        let start = self.len();
        self.measured.extend(rows.measured);
        self.diffuse.extend(rows.diffuse);
        self.shadowed.extend(rows.shadowed);
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

/// The triangle of the QR decomposition of rows.
struct Triangle([[f64; 3]; 3]);

impl Triangle {
    fn of(row: [f64; 3]) -> Self {
        Self([row, [0.0; 3], [0.0; 3]])
    }

    /// Adds a row to the triangle by Givens rotations.
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
