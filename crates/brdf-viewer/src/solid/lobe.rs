//! The lobe of an incidence: f_r, or f_r cos theta, over all directions of view.

use brdf_core::AnyBrdf;
use brdf_core::evaluator::{Double, Evaluator as _, Points};
use brdf_fit::plot::Quantity;

use super::directions::{COLUMNS, Directions, ROWS};
use super::vector::{Vector, direction, scaled};
use crate::plot::radius::Radius;

/// A quantity of a BRDF at an incidence, over a grid of directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Lobe {
    /// The incidence angle in radians.
    pub psi: f64,
    /// The quantity.
    pub quantity: Quantity,
    /// The zenith angles of the rows in radians, in ascending order from 0.
    pub theta: Vec<f64>,
    /// The azimuths of the columns in radians, from 0 to 2 pi.
    pub phi: Vec<f64>,
    /// The value in 1/sr at each direction, row by row.
    pub values: Vec<f64>,
}

impl Lobe {
    /// The lobe of a BRDF at an incidence angle psi in radians, in [0, pi/2). A value that is not finite
    /// is 0.
    pub fn new(brdf: &AnyBrdf, psi: f64, quantity: Quantity) -> Self {
        let Directions { theta, phi } = Directions::new(brdf, psi);
        let thetas: Vec<f64> = theta
            .iter()
            .flat_map(|theta| std::iter::repeat_n(*theta, COLUMNS))
            .collect();
        let phis = phi.repeat(ROWS);
        let psis = vec![psi; thetas.len()];
        let mut values = vec![0.0; thetas.len()];
        let points = Points::Angles {
            psi: &psis,
            theta: &thetas,
            phi: &phis,
        };
        // All arrays have one length, so that there is no error.
        let _ = Double::new(*brdf).values(&points, &mut values);
        for (value, theta) in values.iter_mut().zip(&thetas) {
            let shown = quantity.of(*value, theta.cos());
            *value = if shown.is_finite() { shown } else { 0.0 };
        }
        Self {
            psi,
            quantity,
            theta,
            phi,
            values,
        }
    }

    /// The largest value.
    pub fn largest(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::max)
    }

    /// The smallest value above 0 of the rows up to 80 deg, below which the cosine lets f_r cos theta
    /// vanish.
    pub fn least(&self) -> Option<f64> {
        let rows = self.theta.iter().zip(self.values.chunks(COLUMNS));
        let values = rows
            .filter(|(theta, _)| **theta < 80_f64.to_radians())
            .flat_map(|(_, row)| row);
        values
            .copied()
            .filter(|value| *value > 0.0)
            .min_by(f64::total_cmp)
    }

    /// The unit vectors of the directions, row by row.
    pub fn directions(&self) -> impl Iterator<Item = Vector> {
        let rows = self.theta.iter();
        rows.flat_map(|theta| self.phi.iter().map(|phi| direction(*theta, *phi)))
    }

    /// The points of the lobe, row by row: each direction as far away as its value is large, 1 at the
    /// outermost circle of the radius.
    pub fn points(&self, radius: Radius) -> Vec<Vector> {
        let values = self.directions().zip(&self.values);
        values
            .map(|(direction, value)| scaled(direction, radius.fraction(*value).unwrap_or(0.0)))
            .collect()
    }

    /// The corners of the faces as indices of points: each by its upper left, upper right, lower left
    /// and lower right corner, where rows run downwards and columns to the right.
    pub fn faces(&self) -> impl Iterator<Item = [usize; 4]> {
        (0..ROWS - 1).flat_map(|row| {
            (0..COLUMNS - 1).map(move |column| {
                let i = row * COLUMNS + column;
                [i, i + 1, i + COLUMNS, i + COLUMNS + 1]
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::{Family, ModelParameters};
    use brdf_fit::plot::Scale;

    use super::super::vector::dot;
    use super::*;

    fn brdf(family: Family, [k2, kd, k1]: [f64; 3]) -> AnyBrdf {
        let (n, p) = (1.5, 1.3);
        AnyBrdf::new(family, &ModelParameters { k2, kd, k1, n, p }).unwrap()
    }

    /// The solid angle integral of the radii of the drawn points, in the unit of the values.
    fn integral(lobe: &Lobe) -> f64 {
        let radius = Radius::new((lobe.largest(), lobe.largest()), Scale::Linear);
        let points = lobe.points(radius);
        let radii: Vec<f64> = points.iter().map(|p| dot(*p, *p).sqrt()).collect();
        let faces = lobe.faces().map(|corners| {
            let [first, _, _, last] = corners;
            let theta = [first, last].map(|i| lobe.theta[i / COLUMNS]);
            let phi = [first, last].map(|i| lobe.phi[i % COLUMNS]);
            let solid_angle = (theta[0].cos() - theta[1].cos()) * (phi[1] - phi[0]);
            let mean = corners.iter().map(|i| radii[*i]).sum::<f64>() / 4.0;
            mean * solid_angle
        });
        faces.sum::<f64>() * radius.outermost()
    }

    #[test]
    fn the_integral_of_the_radii_is_the_hemispherical_reflectance() {
        for family in Family::ALL {
            for k1 in [0.005, 0.03, 0.2, 0.8] {
                for psi_deg in [0.0_f64, 2.0, 30.0, 60.0, 80.0] {
                    let brdf = brdf(family, [0.3, 0.05, k1]);
                    let psi = psi_deg.to_radians();
                    let found = integral(&Lobe::new(&brdf, psi, Quantity::BrdfCosine));
                    let expected = brdf.hemispherical_reflectance(psi, 1e-6).unwrap();
                    let off = found / expected - 1.0;
                    assert!(off.abs() < 0.01, "{family:?} {k1} {psi_deg}: {off}");
                }
            }
        }
    }

    #[test]
    fn a_lambertian_lobe_is_a_hemisphere_or_a_sphere() {
        let brdf = brdf(Family::Paper, [0.0, 0.6, 0.2]);
        let radius = Radius::new((0.1, 0.2), Scale::Linear);
        let expected = 0.6 / std::f64::consts::PI / radius.outermost();
        for point in Lobe::new(&brdf, 0.7, Quantity::Brdf).points(radius) {
            assert!((dot(point, point).sqrt() - expected).abs() < 1e-12);
        }
        // A sphere that touches the surface: its centre is half its diameter above.
        for [x, y, z] in Lobe::new(&brdf, 0.7, Quantity::BrdfCosine).points(radius) {
            let from_centre = [x, y, z - 0.5 * expected];
            let distance = dot(from_centre, from_centre).sqrt();
            assert!((distance - 0.5 * expected).abs() < 1e-12);
        }
    }

    #[test]
    fn indices_are_in_range_and_no_point_is_undefined() {
        for family in Family::ALL {
            for psi in [0.0, 0.9, 89.9_f64.to_radians()] {
                for scale in [Scale::Linear, Scale::Logarithmic] {
                    let lobe = Lobe::new(&brdf(family, [0.4, 0.0, 0.001]), psi, Quantity::Brdf);
                    let radius = Radius::new((1e-3, lobe.largest().max(1.0)), scale);
                    let points = lobe.points(radius);
                    assert!(points.iter().flatten().all(|x| x.is_finite()));
                    assert!(lobe.faces().flatten().all(|i| i < points.len()));
                }
            }
        }
    }

    #[test]
    fn a_narrow_lobe_has_its_height() {
        let brdf = brdf(Family::Ggx, [0.4, 0.1, 0.002]);
        let lobe = Lobe::new(&brdf, 1.0, Quantity::Brdf);
        let mirror = brdf_core::Geometry::in_plane(1.0, -1.0).unwrap();
        assert!(lobe.largest() >= brdf.value(&mirror) * (1.0 - 1e-9));
    }
}
