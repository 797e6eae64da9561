//! A table of values over theta and phi, and its integral over the hemisphere.

use std::f64::consts::TAU;

use super::lines::Lines;
use crate::read::error::ReadError;
use crate::read::number::{is_angle, is_reading};

/// Angles in degrees that differ by less than this are equal.
const SAME_DEG: f64 = 1e-6;

/// The values of one incidence, row by row: a row for each theta, a column for each phi.
pub(super) struct Table {
    pub(super) thetas_deg: Vec<f64>,
    pub(super) phis_deg: Vec<f64>,
    pub(super) values: Vec<f64>,
    /// The line with the numbers of angles.
    pub(super) line: u64,
}

impl Table {
    /// Memory is allocated for the values in the file, not for the numbers of angles that it claims.
    ///
    /// # Errors
    ///
    /// A line is not as expected, or angles do not ascend.
    pub(super) fn read(lines: &mut Lines<'_>) -> Result<Self, ReadError> {
        let (rows, columns) = lines.two_counts("the numbers of theta and phi")?;
        let line = lines.number;
        let phis_deg = lines.numbers(columns, "phi in degrees", is_angle)?;
        check_ascending(lines, &phis_deg, "phi")?;
        let mut thetas_deg = Vec::new();
        let mut values = Vec::new();
        for _ in 0..rows {
            let expected = "theta and a value for each phi";
            let found = lines.counted_words(columns.saturating_add(1), expected)?;
            for (i, word) in found.into_iter().enumerate() {
                if i == 0 {
                    thetas_deg.push(lines.number_in(word, "theta in degrees", is_theta)?);
                } else {
                    values.push(lines.number_in(word, "a value", is_reading)?);
                }
            }
            let last = thetas_deg.len().saturating_sub(2);
            check_ascending(lines, thetas_deg.get(last..).unwrap_or_default(), "theta")?;
        }
        Ok(Self {
            thetas_deg,
            phis_deg,
            values,
            line,
        })
    }

    /// Theta in degrees and the values of each row.
    pub(super) fn rows(&self) -> impl Iterator<Item = (f64, &[f64])> {
        let rows = self.values.chunks(self.phis_deg.len().max(1));
        self.thetas_deg.iter().copied().zip(rows)
    }

    /// The integral over the hemisphere of v cos theta, or of v for values that contain the cosine, in
    /// the unit of the values times sr. Values are linear between the angles.
    ///
    /// `None` where phi covers neither 180 nor 360 deg.
    pub(super) fn integral(&self, has_cosine: bool) -> Option<f64> {
        let weights = self.weights_of_phi()?;
        let around = |row: &[f64]| {
            let terms = row
                .iter()
                .zip(&weights)
                .map(|(value, weight)| value * weight);
            terms.sum::<f64>()
        };
        let above = self.rows().filter(|(theta_deg, _)| *theta_deg <= 90.0);
        let rows: Vec<(f64, f64)> = above
            .map(|(theta_deg, row)| (theta_deg.to_radians(), around(row)))
            .collect();
        let between = rows.windows(2).map(|pair| match *pair {
            [from, to] => integral_between(from, to, has_cosine),
            _ => 0.0,
        });
        Some(between.sum())
    }

    /// The width in radians that the value of each phi stands for.
    fn weights_of_phi(&self) -> Option<Vec<f64>> {
        let phis = &self.phis_deg;
        let (first, last) = (*phis.first()?, *phis.last()?);
        if phis.len() == 1 {
            return Some(vec![TAU]);
        }
        let steps: Vec<f64> = phis
            .windows(2)
            .map(|pair| {
                pair.iter()
                    .rev()
                    .copied()
                    .reduce(|b, a| b - a)
                    .unwrap_or(0.0)
            })
            .collect();
        let span = last - first;
        let largest = steps.iter().copied().fold(0.0, f64::max);
        // Between the last azimuth and the first one of the next turn.
        let gap = 360.0 - span;
        let (scale, gap) = if (span - 180.0).abs() < SAME_DEG {
            (2.0, 0.0)
        } else if (-SAME_DEG..=1.5 * largest).contains(&gap) {
            (1.0, gap.max(0.0))
        } else {
            return None;
        };
        let mut weights = vec![0.0; phis.len()];
        for (i, step) in steps.into_iter().chain([gap]).enumerate() {
            for place in [i, (i + 1) % phis.len()] {
                if let Some(weight) = weights.get_mut(place) {
                    *weight += scale * step.to_radians() / 2.0;
                }
            }
        }
        Some(weights)
    }
}

/// The integral of a value that is linear in theta from (theta, value) to another, times sin theta cos
/// theta, or times sin theta for values that contain the cosine.
///
/// With v = a + b theta, the antiderivatives are a (sin theta)^2 / 2 + b (sin 2 theta - 2 theta cos 2
/// theta) / 8, and -a cos theta + b (sin theta - theta cos theta).
fn integral_between(from: (f64, f64), to: (f64, f64), has_cosine: bool) -> f64 {
    let slope = (to.1 - from.1) / (to.0 - from.0);
    let constant = from.1 - slope * from.0;
    let antiderivative = |theta: f64| {
        let (sin, cos) = theta.sin_cos();
        if has_cosine {
            -constant * cos + slope * (sin - theta * cos)
        } else {
            let (sin_2, cos_2) = (2.0 * theta).sin_cos();
            constant * sin * sin / 2.0 + slope * (sin_2 - 2.0 * theta * cos_2) / 8.0
        }
    };
    antiderivative(to.0) - antiderivative(from.0)
}

fn is_theta(degrees: f64) -> bool {
    (0.0..=180.0).contains(&degrees)
}

fn check_ascending(lines: &Lines<'_>, degrees: &[f64], name: &str) -> Result<(), ReadError> {
    let descends = |pair: &&[f64]| !pair.is_sorted_by(|a, b| a < b);
    match degrees.windows(2).find(descends) {
        Some([before, after]) => {
            let message = format!("{name} {after} follows {before}: expected ascending angles");
            Err(lines.error(message))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn table(phis_deg: &[f64], thetas_deg: &[f64], value: impl Fn(f64) -> f64) -> Table {
        let row = |theta: &f64| vec![value(*theta); phis_deg.len()];
        Table {
            thetas_deg: thetas_deg.to_vec(),
            phis_deg: phis_deg.to_vec(),
            values: thetas_deg.iter().flat_map(row).collect(),
            line: 1,
        }
    }

    fn evenly(last: f64, count: u32) -> Vec<f64> {
        let step = last / f64::from(count);
        (0..=count).map(|i| step * f64::from(i)).collect()
    }

    #[test]
    fn a_perfect_diffuser_reflects_pi_times_its_value() {
        let turns = [
            evenly(360.0, 12),
            evenly(350.0, 35),
            evenly(180.0, 6),
            vec![0.0],
        ];
        for phis in turns {
            for thetas in [evenly(90.0, 9), vec![0.0, 20.0, 90.0]] {
                let integral = table(&phis, &thetas, |_| 0.5).integral(false).unwrap();
                assert!((integral / (0.5 * PI) - 1.0).abs() < 1e-14, "{integral}");
            }
            // The intensity of a diffuser follows the cosine, which is not linear in theta.
            let intensities = table(&phis, &evenly(90.0, 900), |t| 0.5 * t.to_radians().cos());
            let integral = intensities.integral(true).unwrap();
            assert!((integral / (0.5 * PI) - 1.0).abs() < 1e-6, "{integral}");
        }
    }

    #[test]
    fn values_are_linear_between_the_angles() {
        // The integral of theta sin theta cos theta over the hemisphere is pi^2 / 4.
        for count in [1, 9] {
            let linear = table(&[0.0], &evenly(90.0, count), f64::to_radians);
            let integral = linear.integral(false).unwrap();
            assert!(
                (integral / (PI * PI / 4.0) - 1.0).abs() < 1e-14,
                "{integral}"
            );
        }
    }

    #[test]
    fn azimuths_that_cover_no_half_turn_have_no_integral() {
        let quarter = table(&evenly(90.0, 9), &evenly(90.0, 9), |_| 1.0);
        assert_eq!(quarter.integral(false), None);
    }
}
