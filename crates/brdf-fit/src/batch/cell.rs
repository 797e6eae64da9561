//! The columns of a model between the widths of the grid, as polynomials of ln k1.

#![expect(
    clippy::inline_always,
    reason = "a function that is not inlined is not compiled for the present processor"
)]

use super::table::Angle;
use nalgebra::SMatrix;

/// The number of coefficients of a polynomial. The nearest singularity of the paper's model is at pi/2 from
/// a cell of 2 * 0.25 in ln k1, so that degree 11 leaves rounding. Each cell measures its own error.
const COEFFICIENTS: usize = 12;

/// The columns around a point of the grid as polynomials of t = (ln k1 - ln k1 of the point) / step, over
/// the steps to the adjacent points.
#[derive(Debug, Clone)]
pub(super) struct Cell {
    /// The largest error of a coordinate between the nodes.
    pub(super) error: f64,
    /// ln k1 of the point.
    centre: f64,
    /// The step of ln k1.
    step: f64,
    /// The ends of t: -1 and 1, 0 at an end of the range of k1.
    pub(super) ends: [f64; 2],
    cos: Polynomial,
    sin: Polynomial,
    /// The polynomial of each coordinate of v.
    directions: Vec<Polynomial>,
}

/// A polynomial, by ascending powers.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Polynomial([f64; COEFFICIENTS]);

impl Polynomial {
    /// The value, the first and the second derivative.
    #[inline(always)]
    pub(super) fn at(&self, t: f64) -> [f64; 3] {
        let [mut value, mut slope, mut half_bend] = [0.0; 3];
        for c in self.0.iter().rev() {
            half_bend = half_bend * t + slope;
            slope = slope * t + value;
            value = value * t + c;
        }
        [value, slope, 2.0 * half_bend]
    }
}

/// What a cell is for one scan.
pub(super) struct Line {
    pub(super) cos: Polynomial,
    pub(super) sin: Polynomial,
    /// The scalar product of the readings and v.
    pub(super) beside: Polynomial,
}

impl Cell {
    /// The cell around a width, with a function that gives the angle and the coordinates of v at a width.
    /// `None` where that function has no value.
    pub(super) fn around(
        widths: &[f64],
        i: usize,
        at: impl Fn(f64) -> Option<(Angle, Vec<f64>)>,
    ) -> Option<Self> {
        let centre = widths[i].ln();
        let other = if i == 0 {
            widths.get(1)?
        } else {
            widths.get(i - 1)?
        };
        let step = (other.ln() - centre).abs();
        let nodes: [f64; COEFFICIENTS] = std::array::from_fn(|j| {
            let angle = std::f64::consts::PI * (j as f64 + 0.5) / COEFFICIENTS as f64;
            angle.cos()
        });
        let values: Vec<(Angle, Vec<f64>)> = nodes
            .iter()
            .map(|t| at((centre + step * t).exp()))
            .collect::<Option<_>>()?;
        let powers = SMatrix::<f64, COEFFICIENTS, COEFFICIENTS>::from_fn(|j, k| {
            nodes[j].powi(i32::try_from(k).unwrap_or(0))
        });
        let inverse = powers.try_inverse()?;
        let coefficient = |k: usize, value: &dyn Fn(usize) -> f64| -> f64 {
            (0..COEFFICIENTS).map(|j| inverse[(k, j)] * value(j)).sum()
        };
        let dimension = values[0].1.len();
        let directions = (0..dimension)
            .map(|c| Polynomial(std::array::from_fn(|k| coefficient(k, &|j| values[j].1[c]))))
            .collect();
        let of_angle = |part: fn(&Angle) -> f64| {
            Polynomial(std::array::from_fn(|k| {
                coefficient(k, &|j| part(&values[j].0))
            }))
        };
        let mut cell = Self {
            error: 0.0,
            centre,
            step,
            ends: [
                if i == 0 { 0.0 } else { -1.0 },
                if i + 1 == widths.len() { 0.0 } else { 1.0 },
            ],
            cos: of_angle(|angle| angle.cos),
            sin: of_angle(|angle| angle.sin),
            directions,
        };
        cell.error = cell.largest_error(at);
        Some(cell)
    }

    /// The cell for a scan, given by the coordinates of its readings.
    #[inline(always)]
    pub(super) fn of(&self, coordinates: &[f64]) -> Line {
        let mut beside = [0.0; COEFFICIENTS];
        for (Polynomial(direction), coordinate) in self.directions.iter().zip(coordinates) {
            for (sum, coefficient) in beside.iter_mut().zip(direction) {
                *sum += coefficient * coordinate;
            }
        }
        Line {
            cos: self.cos,
            sin: self.sin,
            beside: Polynomial(beside),
        }
    }

    /// The largest difference of the interpolated columns from those of a function, between the nodes.
    fn largest_error(&self, at: impl Fn(f64) -> Option<(Angle, Vec<f64>)>) -> f64 {
        let difference = |t: f64| {
            let Some((angle, v)) = at(self.k1(t)) else {
                return f64::INFINITY;
            };
            let of_v = v.iter().zip(&self.directions);
            let of_v = of_v.map(|(v, direction)| (v - direction.at(t)[0]).abs());
            of_v.fold((angle.cos - self.cos.at(t)[0]).abs(), f64::max)
        };
        [-0.99, -0.5, 0.0, 0.5, 0.99]
            .map(difference)
            .into_iter()
            .fold(0.0, f64::max)
    }

    /// k1 at t.
    #[inline]
    pub(super) fn k1(&self, t: f64) -> f64 {
        (self.centre + self.step * t).exp()
    }

    /// A bound of the second derivative of v and of the unit column with respect to t at the centre.
    pub(super) fn curvature(&self) -> f64 {
        let [v, v1, v2] = [0, 1, 2].map(|k| {
            let coefficients: Vec<f64> = self.directions.iter().map(|line| line.0[k]).collect();
            super::basis::norm(&coefficients)
        });
        let [_, _, cos2] = self.cos.at(0.0);
        let [sin0, sin1, sin2] = self.sin.at(0.0);
        let lobe = cos2.abs() + sin2.abs() * v + 2.0 * sin1.abs() * v1 + sin0.abs() * 2.0 * v2;
        lobe.max(2.0 * v2)
    }
}
