//! The distribution of facet normals, eq. (2).

use std::f64::consts::TAU;

use crate::Geometry;

/// The paper's facet distribution: in polar coordinates an ellipsoid of revolution that touches
/// the surface at the origin, k1 being its transverse axis over its axis along the normal.
///
/// ```text
/// f(alpha) / f(0) = k1^2 cos alpha / (1 + (k1^2 - 1) cos^2 alpha)
///                 = k1^2 sec alpha / (tan^2 alpha + k1^2)
/// ```
///
/// A small k1 is a narrow lobe, k1 = 1 the sphere cos alpha. The second form has no difference
/// and is the one that is evaluated. (Eq. 2 of Li, Yan and Wu 2002.)
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid {
    k1: f64,
    k1_squared: f64,
}

impl Ellipsoid {
    /// The distribution of width k1 > 0.
    ///
    /// k1 is not checked here; [`Parameters`](crate::Parameters) does that.
    pub fn new(k1: f64) -> Self {
        Self {
            k1,
            k1_squared: k1 * k1,
        }
    }

    /// The width k1.
    pub fn k1(&self) -> f64 {
        self.k1
    }

    /// f(alpha)/f(0), dimensionless: 1 at alpha = 0.
    #[inline]
    pub fn value(&self, geometry: &Geometry) -> f64 {
        self.k1_squared * geometry.sec_alpha / (geometry.tan2_alpha + self.k1_squared)
    }

    /// The derivative of f(alpha)/f(0) by k1:
    /// 2 k1 sec alpha tan^2 alpha / (tan^2 alpha + k1^2)^2.
    #[inline]
    pub fn derivative_k1(&self, geometry: &Geometry) -> f64 {
        let denominator = geometry.tan2_alpha + self.k1_squared;
        2.0 * self.k1 * geometry.sec_alpha * (geometry.tan2_alpha / denominator) / denominator
    }

    /// f(0) in 1/sr, from the normalisation: the integral of f(alpha) cos alpha over the
    /// hemisphere of facet normals is 1.
    ///
    /// With x = cos alpha the integral of x^2 k1^2 / (1 + (k1^2 - 1) x^2) over [0, 1] has a closed
    /// form; within 0.1 of k1 = 1 it is summed as a series in 1 - k1^2, since the closed form
    /// loses digits there.
    pub fn peak_density(&self) -> f64 {
        let deviation = 1.0 - self.k1_squared;
        let integral = if deviation.abs() < 0.1 {
            // Sum of k1^2 deviation^m / (2m + 3): 16 terms leave less than 1e-17.
            self.k1_squared
                * (0..16)
                    .rev()
                    .fold(0.0, |sum, m| sum * deviation + 1.0 / f64::from(2 * m + 3))
        } else if deviation > 0.0 {
            let root = deviation.sqrt();
            // artanh(root) = ln((1 + root)/k1), without 1 - root.
            self.k1_squared / deviation * (((1.0 + root) / self.k1).ln() / root - 1.0)
        } else {
            let root = (-deviation).sqrt();
            self.k1_squared / -deviation * (1.0 - root.atan() / root)
        };
        1.0 / (TAU * integral)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn at_tilt(alpha: f64) -> Geometry {
        // Looking back along the source direction, the facet is tilted by psi.
        Geometry::in_plane(alpha, alpha).unwrap()
    }

    #[test]
    fn equals_the_printed_formula() {
        for k1 in [0.05_f64, 0.5, 1.0, 1.338, 7.0] {
            for alpha in [0.0_f64, 0.1, 0.8, 1.5] {
                let c = alpha.cos();
                let printed = k1 * k1 * c / (1.0 + (k1 * k1 - 1.0) * c * c);
                let value = Ellipsoid::new(k1).value(&at_tilt(alpha));
                assert!(
                    (value / printed - 1.0).abs() < 1e-12,
                    "{k1} {alpha}: {value} {printed}"
                );
            }
        }
    }

    #[test]
    fn k1_of_one_is_the_cosine() {
        for alpha in [0.0_f64, 0.4, 1.2] {
            let value = Ellipsoid::new(1.0).value(&at_tilt(alpha));
            assert!((value - alpha.cos()).abs() < 1e-15);
        }
    }

    #[test]
    fn the_peak_is_one_for_any_width() {
        for k1 in [1e-8, 0.1, 1.0, 1e8] {
            assert_eq!(Ellipsoid::new(k1).value(&at_tilt(0.0)), 1.0);
        }
    }

    #[test]
    fn the_peak_density_normalises() {
        // Midpoint rule over cos alpha of the normalisation integral.
        for k1 in [
            0.2_f64, 0.94, 0.95, 0.96, 1.0, 1.04, 1.05, 1.06, 1.338, 20.0,
        ] {
            let steps = 20_000;
            let sum: f64 = (0..steps)
                .map(|i| {
                    let x = (f64::from(i) + 0.5) / f64::from(steps);
                    k1 * k1 * x * x / (1.0 + (k1 * k1 - 1.0) * x * x)
                })
                .sum();
            let integral = TAU * sum / f64::from(steps);
            let peak = Ellipsoid::new(k1).peak_density();
            assert!(
                (peak * integral - 1.0).abs() < 1e-6,
                "{k1}: {}",
                peak * integral
            );
        }
    }

    #[test]
    fn the_peak_density_has_no_step_where_its_forms_meet() {
        for deviation in [0.1_f64, -0.1] {
            let k1 = (1.0 - deviation).sqrt();
            let below = Ellipsoid::new(k1 * (1.0 - 1e-9)).peak_density();
            let above = Ellipsoid::new(k1 * (1.0 + 1e-9)).peak_density();
            assert!((below / above - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn published_samples_have_the_known_peak_density() {
        assert!((Ellipsoid::new(0.071).peak_density() - 13.393).abs() < 5e-4);
        assert!((Ellipsoid::new(0.166).peak_density() - 3.703).abs() < 5e-4);
    }

    proptest! {
        #[test]
        fn falls_with_the_tilt_for_narrow_lobes(k1 in 1e-3..1.0, alpha in 0.0..1.5, step in 1e-3..0.05) {
            let facet = Ellipsoid::new(k1);
            prop_assert!(facet.value(&at_tilt(alpha + step)) < facet.value(&at_tilt(alpha)));
        }

        #[test]
        fn derivative_is_that_of_the_value(log_k1 in -3.0..3.0_f64, alpha in 0.0..1.5) {
            let k1 = log_k1.exp();
            let step = 1e-5 * k1;
            let at = |k1| Ellipsoid::new(k1).value(&at_tilt(alpha));
            let difference = (at(k1 + step) - at(k1 - step)) / (2.0 * step);
            let derivative = Ellipsoid::new(k1).derivative_k1(&at_tilt(alpha));
            prop_assert!((derivative - difference).abs() < 1e-7 * (1.0 / k1).max(derivative.abs()));
        }
    }
}
