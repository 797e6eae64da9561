//! A subsample of many readings, evenly distributed over the directions.

use std::f64::consts::{FRAC_PI_2, PI};

use brdf_core::Geometry;
use rayon::prelude::*;

use crate::scan::{Measurement, Measurements};

/// The number of steps of each coordinate along the curve: a power of two.
const STEPS: f64 = 1024.0;

/// The number of bits of an index; no scan in memory has more readings.
const INDEX: u64 = (1 << 34) - 1;

impl Measurements {
    /// `count` readings of each wavelength, or all if there are fewer, evenly distributed over
    /// theta_h, theta_d and phi_d and in the order of the file. The choice is deterministic.
    ///
    /// The readings are sorted along a space-filling curve (Morton, "A computer oriented geodetic data
    /// base", IBM 1966) through (sqrt theta_h, theta_d, phi_d), in which the bins of a MERL table are
    /// equally wide. The curve is divided into `count` equal parts, each of which is a block of that
    /// space, and the middle reading of each part is taken.
    #[must_use]
    pub fn sampled(&self, count: usize) -> Self {
        let all = self.readings();
        let mut kept = Vec::new();
        for wavelength in self.wavelengths() {
            let members = all.par_iter().enumerate();
            let members = members.filter(|(_, reading)| reading.wavelength_um == wavelength);
            kept.extend(spread(
                members.map(|(i, reading)| on_curve(reading, i)),
                count,
            ));
        }
        kept.sort_unstable();
        let mut sampled = self.kept(kept);
        if sampled.readings().len() < all.len() {
            sampled.conversions.push(format!(
                "{} of {} readings, evenly over theta_h, theta_d and phi_d",
                sampled.readings().len(),
                all.len()
            ));
        }
        sampled
    }
}

/// The middle reading of each of `count` equal parts of the curve; all readings if there are fewer.
fn spread(places: impl ParallelIterator<Item = u64>, count: usize) -> Vec<usize> {
    let mut places: Vec<u64> = places.collect();
    places.par_sort_unstable();
    let index = |place: u64| (place & INDEX) as usize;
    if places.len() <= count {
        return places.into_iter().map(index).collect();
    }
    let middle = |part: usize| (2 * part + 1) * places.len() / (2 * count);
    (0..count).map(|part| index(places[middle(part)])).collect()
}

/// The position of a reading along the curve in the upper bits, its index in the lower bits.
fn on_curve(reading: &Measurement, index: usize) -> u64 {
    place_on_curve(reading) << INDEX.count_ones() | index as u64 & INDEX
}

/// The position of a reading along the curve.
fn place_on_curve(reading: &Measurement) -> u64 {
    let Ok(geometry) = reading.geometry() else {
        return 0;
    };
    half_difference(&geometry)
        .into_iter()
        .enumerate()
        .fold(0, |place, (axis, position)| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a position from 0 to 1"
            )]
            let step = (position * (STEPS - 1.0)) as u64;
            place | apart(step) << axis
        })
}

/// sqrt(theta_h), theta_d and phi_d, each from 0 to 1 over its range.
///
/// cos psi = cos theta_h cos theta_d - sin theta_h sin theta_d cos phi_d.
fn half_difference(geometry: &Geometry) -> [f64; 3] {
    let theta_h = geometry.tan2_alpha().sqrt().atan();
    let (sin_d, cos_d) = (geometry.sin2_gamma().sqrt(), geometry.cos_gamma());
    let (sin_h, cos_h) = theta_h.sin_cos();
    let cos_phi = (cos_h * cos_d - geometry.cos_psi()) / (sin_h * sin_d);
    // phi_d is undefined where one of the angles vanishes.
    let phi_d = if cos_phi.is_finite() {
        cos_phi.clamp(-1.0, 1.0).acos()
    } else {
        0.0
    };
    [
        (theta_h / FRAC_PI_2).sqrt(),
        sin_d.atan2(cos_d) / FRAC_PI_2,
        phi_d / PI,
    ]
}

/// The bits of a number, each followed by two zero bits.
fn apart(number: u64) -> u64 {
    (0..10).fold(0, |spread, bit| spread | (number >> bit & 1) << (3 * bit))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn reading(wavelength_um: f64, psi: f64, theta: f64, phi: f64) -> Measurement {
        Measurement {
            wavelength_um: Some(wavelength_um),
            psi,
            theta,
            phi,
            brdf: psi + theta,
            sigma: None,
        }
    }

    fn grid(wavelength_um: f64) -> Vec<Measurement> {
        let angles = |count: i32| (0..count).map(move |i| 1.5 * f64::from(i) / f64::from(count));
        let pairs = angles(16).flat_map(|psi| angles(16).map(move |theta| (psi, theta)));
        pairs
            .flat_map(|(psi, theta)| {
                angles(16).map(move |phi| reading(wavelength_um, psi, theta, 2.0 * phi))
            })
            .collect()
    }

    #[test]
    fn each_wavelength_keeps_as_many_and_says_so() {
        let both = [grid(0.5), grid(0.6)].concat();
        let sampled = Measurements::new("x", both).unwrap().sampled(100);
        assert_eq!(
            sampled.conversions,
            ["200 of 8192 readings, evenly over theta_h, theta_d and phi_d"]
        );
        for scan in sampled.by_wavelength() {
            assert_eq!(scan.readings().len(), 100);
        }
    }

    #[test]
    fn fewer_readings_than_wanted_are_all_kept_as_they_are() {
        let all = Measurements::new("x", grid(0.5)).unwrap();
        assert_eq!(all.sampled(5000), all);
    }

    #[test]
    fn every_eighth_of_the_angles_is_represented_by_its_share() {
        let all = Measurements::new("x", grid(0.5)).unwrap();
        let shares = |scan: &Measurements| {
            let mut counts = [0.0; 8];
            for reading in scan.readings() {
                let position = half_difference(&reading.geometry().unwrap());
                let octant = position
                    .iter()
                    .fold(0, |o, x| 2 * o + usize::from(*x >= 0.5));
                counts[octant] += 1.0 / scan.readings().len() as f64;
            }
            counts
        };
        let (of_all, of_sample) = (shares(&all), shares(&all.sampled(512)));
        for (all, sample) in of_all.iter().zip(of_sample) {
            assert!((all - sample).abs() < 0.01, "{of_all:?} {of_sample:?}");
        }
    }

    proptest! {
        #[test]
        fn the_angles_are_those_of_the_half_vector(
            psi in 0.01..1.5, theta in 0.01..1.5, phi in 0.01..3.13,
        ) {
            // By the vectors: the source turned so that the half vector is the normal.
            let geometry = Geometry::new(psi, theta, phi).unwrap();
            let [root_h, part_d, part_phi] = half_difference(&geometry);
            let (theta_h, theta_d) = (FRAC_PI_2 * root_h * root_h, FRAC_PI_2 * part_d);
            let cos_theta = theta_h.cos() * theta_d.cos()
                + theta_h.sin() * theta_d.sin() * (PI * part_phi).cos();
            prop_assert!((cos_theta - theta.cos()).abs() < 1e-9);
        }
    }
}
