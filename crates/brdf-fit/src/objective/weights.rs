//! The weights of the readings in eq. (5).

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt;
use std::str::FromStr;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::format::{ParseError, as_degrees, in_degrees};
use crate::scan::{Measurement, Measurements};

/// A weight as a function of one angle: linear between the listed angles, constant beyond the first
/// and the last, and 1 for an empty list.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct AngleWeight {
    /// Angle in degrees and weight >= 0, ascending by angle.
    points_deg: Vec<(f64, f64)>,
}

impl AngleWeight {
    /// The weight at an angle in radians.
    pub fn at(&self, angle: f64) -> f64 {
        let angle_deg = angle.to_degrees();
        let after = self.points_deg.partition_point(|(a, _)| *a <= angle_deg);
        match (
            self.points_deg.get(after.wrapping_sub(1)),
            self.points_deg.get(after),
        ) {
            (None, None) => 1.0,
            (Some((_, only)), None) | (None, Some((_, only))) => *only,
            (Some((a, low)), Some((b, high))) => low + (high - low) * (angle_deg - a) / (b - a),
        }
    }
}

/// From `60=1,70=0.5`: degrees and weights, in ascending order of the degrees.
impl FromStr for AngleWeight {
    type Err = ParseError;

    fn from_str(text: &str) -> Result<Self, ParseError> {
        let points_deg: Vec<(f64, f64)> = text
            .split(',')
            .map(|entry| {
                let numbers = entry.split_once('=').and_then(|(angle, weight)| {
                    Some((angle.trim().parse().ok()?, weight.trim().parse().ok()?))
                });
                numbers
                    .filter(|(angle, weight): &(f64, f64)| {
                        angle.is_finite() && *weight >= 0.0 && weight.is_finite()
                    })
                    .ok_or_else(|| {
                        ParseError::new(format!(
                            "\"{entry}\": expected DEGREES=WEIGHT with a weight >= 0, such as 60=1,70=0.5"
                        ))
                    })
            })
            .collect::<Result<_, _>>()?;
        if points_deg.windows(2).any(|pair| pair[0].0 >= pair[1].0) {
            return Err(ParseError::new(format!(
                "\"{text}\": the angles must ascend"
            )));
        }
        Ok(Self { points_deg })
    }
}

/// The floor of relative errors, as a fraction of the rms of f_r cos theta.
pub const RELATIVE_FLOOR: f64 = 0.02;

/// The errors that the weights assume.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum AssumedErrors {
    /// Constant in f_r cos theta: the E of the paper.
    #[default]
    Constant,
    /// As the scan states them: weights 1/sigma^2.
    Stated,
    /// In proportion to the model, with a floor: weights 1/(m^2 + (0.02 rms)^2), m being the model's
    /// f_r cos theta and the rms that of the readings'. They follow the fit of constant errors.
    Relative,
}

/// The weights of the readings in E: g = g1(psi) g2(theta), multiplied by those of the assumed errors
/// and by the solid angle if requested, and 0 for masked readings.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "StoredWeights", into = "StoredWeights")]
pub struct Weights {
    /// g1 of eq. (5), over the incidence angle psi.
    pub g1: AngleWeight,
    /// g2 of eq. (5), over the signed view angle theta.
    pub g2: AngleWeight,
    /// The errors that the weights assume (in JSON `by_sigma` and `relative`).
    pub errors: AssumedErrors,
    /// Multiply by the solid angle that each reading represents: see [`solid_angles`].
    pub by_solid_angle: bool,
    /// Mask readings closer to the source direction than this angle, in radians (in JSON in degrees):
    /// the detector blocks the light there, or scatters it.
    pub mask_source: f64,
    /// Mask readings closer to the mirror direction than this angle, in radians (in JSON in degrees).
    pub mask_mirror: f64,
}

/// The weights in the JSON of a fit.
#[derive(Serialize, Deserialize)]
struct StoredWeights {
    g1: AngleWeight,
    g2: AngleWeight,
    #[serde(default)]
    by_sigma: bool,
    #[serde(default)]
    relative: bool,
    #[serde(default)]
    by_solid_angle: bool,
    #[serde(default, rename = "mask_source_deg", with = "as_degrees")]
    mask_source: f64,
    #[serde(default, rename = "mask_mirror_deg", with = "as_degrees")]
    mask_mirror: f64,
}

impl From<Weights> for StoredWeights {
    fn from(weights: Weights) -> Self {
        Self {
            g1: weights.g1,
            g2: weights.g2,
            by_sigma: weights.errors == AssumedErrors::Stated,
            relative: weights.errors == AssumedErrors::Relative,
            by_solid_angle: weights.by_solid_angle,
            mask_source: weights.mask_source,
            mask_mirror: weights.mask_mirror,
        }
    }
}

impl From<StoredWeights> for Weights {
    fn from(stored: StoredWeights) -> Self {
        let errors = match (stored.by_sigma, stored.relative) {
            (true, _) => AssumedErrors::Stated,
            (false, true) => AssumedErrors::Relative,
            (false, false) => AssumedErrors::Constant,
        };
        Self {
            g1: stored.g1,
            g2: stored.g2,
            errors,
            by_solid_angle: stored.by_solid_angle,
            mask_source: stored.mask_source,
            mask_mirror: stored.mask_mirror,
        }
    }
}

/// The weights in use, such as `g1(psi), 1/sigma^2`; empty if all weights are 1.
impl fmt::Display for Weights {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = |used: bool, word: &str| used.then(|| word.to_owned());
        let mask = |angle: f64, what: &str| {
            (angle > 0.0).then(|| format!("0 within {} deg of the {what}", in_degrees(angle)))
        };
        let all = [
            word(!self.g1.points_deg.is_empty(), "g1(psi)"),
            word(!self.g2.points_deg.is_empty(), "g2(theta)"),
            word(self.errors == AssumedErrors::Stated, "1/sigma^2"),
            word(self.errors == AssumedErrors::Relative, "1/model^2"),
            word(self.by_solid_angle, "solid angle"),
            mask(self.mask_source, "source"),
            mask(self.mask_mirror, "mirror direction"),
        ];
        let used: Vec<String> = all.into_iter().flatten().collect();
        f.write_str(&used.join(", "))
    }
}

impl Weights {
    /// The weights of all readings; `None` if 1/sigma^2 is requested and a reading has no sigma.
    pub fn for_readings(&self, measurements: &Measurements) -> Option<Vec<f64>> {
        let weighing = self.weighing(measurements)?;
        let readings = 0..measurements.readings().len();
        Some(readings.map(|i| weighing.weight(i)).collect())
    }

    /// As [`for_readings`](Self::for_readings), with each weight computed where it is needed.
    pub(crate) fn weighing<'a>(&'a self, measurements: &'a Measurements) -> Option<Weighing<'a>> {
        let readings = measurements.readings();
        let is_known = |reading| self.of(reading).is_some();
        if self.errors == AssumedErrors::Stated && !readings.iter().all(is_known) {
            return None;
        }
        Some(Weighing {
            weights: self,
            readings,
            solid_angles: self.by_solid_angle.then(|| solid_angles(measurements)),
        })
    }

    /// The weight of one reading without its solid angle; `None` if 1/sigma^2 is requested and the
    /// reading has no sigma.
    fn of(&self, reading: &Measurement) -> Option<f64> {
        if self.masks(reading) {
            return Some(0.0);
        }
        let theta = reading.in_plane_theta().unwrap_or(reading.theta);
        let by_angle = self.g1.at(reading.psi) * self.g2.at(theta);
        if self.errors == AssumedErrors::Stated {
            reading.sigma.map(|sigma| by_angle / (sigma * sigma))
        } else {
            Some(by_angle)
        }
    }

    fn masks(&self, reading: &Measurement) -> bool {
        if self.mask_source <= 0.0 && self.mask_mirror <= 0.0 {
            return false;
        }
        // A half turn about the normal maps the mirror direction to the source direction.
        let angle_to = |phi: f64| {
            let source = direction(reading.psi, 0.0);
            source.angle(&direction(reading.theta, phi))
        };
        angle_to(reading.phi) < self.mask_source || angle_to(reading.phi + PI) < self.mask_mirror
    }
}

/// The weights of the readings of a scan, all of which are known.
pub(crate) struct Weighing<'a> {
    weights: &'a Weights,
    readings: &'a [Measurement],
    solid_angles: Option<Vec<f64>>,
}

impl Weighing<'_> {
    /// The weight of a reading.
    pub(crate) fn weight(&self, reading: usize) -> f64 {
        let own = self.weights.of(&self.readings[reading]).unwrap_or(0.0);
        self.solid_angles
            .as_ref()
            .map_or(own, |angles| own * angles[reading])
    }
}

fn direction(zenith: f64, azimuth: f64) -> Vector3<f64> {
    let (sin, cos) = zenith.sin_cos();
    Vector3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos)
}

/// The solid angle in sr that each reading represents among those of its incidence.
///
/// The hemisphere of view directions is divided half way between adjacent readings: into sectors of
/// azimuth around the half-planes with readings, and each sector into rings of theta. The outermost
/// ring extends outwards as far as inwards.
pub fn solid_angles(measurements: &Measurements) -> Vec<f64> {
    let readings = measurements.readings();
    let mut angles = vec![0.0; readings.len()];
    for incidence in measurements.incidences() {
        let mut half_planes = half_planes(readings, &incidence.readings);
        let azimuths: Vec<f64> = half_planes.iter().map(|(azimuth, _)| *azimuth).collect();
        for (i, (_, members)) in half_planes.iter_mut().enumerate() {
            let sector = sector(&azimuths, i);
            members.sort_by(|a, b| {
                readings[*a]
                    .theta
                    .abs()
                    .total_cmp(&readings[*b].theta.abs())
            });
            let thetas: Vec<f64> = members.iter().map(|&i| readings[i].theta.abs()).collect();
            for (&member, area) in members.iter().zip(rings(&thetas)) {
                angles[member] = sector * area;
            }
        }
    }
    angles
}

/// Azimuths that differ by less than this are one half-plane, in radians (0.05 deg).
const SAME_AZIMUTH: f64 = 0.05 * PI / 180.0;

/// The azimuth in [0, 2 pi) and the readings of each half-plane, in ascending order. A view along the
/// normal has no azimuth and belongs to the first half-plane.
fn half_planes(readings: &[Measurement], members: &[usize]) -> Vec<(f64, Vec<usize>)> {
    let azimuth = |i: usize| {
        let turned = if readings[i].theta < 0.0 { PI } else { 0.0 };
        let azimuth = (readings[i].phi + turned).rem_euclid(TAU);
        if TAU - azimuth < SAME_AZIMUTH {
            0.0
        } else {
            azimuth
        }
    };
    let (normal, mut inclined): (Vec<usize>, Vec<usize>) =
        members.iter().partition(|&&i| readings[i].theta == 0.0);
    inclined.sort_by(|&a, &b| azimuth(a).total_cmp(&azimuth(b)));
    let mut planes: Vec<(f64, Vec<usize>)> = Vec::new();
    for i in inclined {
        match planes.last_mut() {
            Some((plane, members)) if azimuth(i) - *plane < SAME_AZIMUTH => members.push(i),
            _ => planes.push((azimuth(i), vec![i])),
        }
    }
    match planes.first_mut() {
        Some((_, members)) => members.extend(normal),
        None => planes.push((0.0, normal)),
    }
    planes
}

/// The width of the sector around an azimuth in radians.
fn sector(azimuths: &[f64], i: usize) -> f64 {
    let count = azimuths.len();
    if count == 1 {
        return TAU;
    }
    let to_next = |i: usize| {
        let gap = azimuths[(i + 1) % count] - azimuths[i];
        if i + 1 == count { gap + TAU } else { gap }
    };
    0.5 * (to_next(i) + to_next((i + count - 1) % count))
}

/// The difference of cos theta between the inner and the outer edge of the ring of each zenith
/// angle; the angles ascend.
fn rings(thetas: &[f64]) -> Vec<f64> {
    let last = thetas.len() - 1;
    // A single reading at the normal represents its whole sector.
    if thetas[last] == 0.0 {
        return vec![1.0 / thetas.len() as f64; thetas.len()];
    }
    let inner = |i: usize| {
        if i == 0 {
            0.0
        } else {
            0.5 * (thetas[i - 1] + thetas[i])
        }
    };
    let outer = |i: usize| {
        if i < last {
            inner(i + 1)
        } else {
            (2.0 * thetas[i] - inner(i)).min(FRAC_PI_2)
        }
    };
    (0..=last)
        .map(|i| inner(i).cos() - outer(i).cos())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_listed_weighs_one() {
        assert_eq!(AngleWeight::default().at(0.3), 1.0);
    }

    #[test]
    fn weights_are_linear_between_and_constant_beyond() {
        let weight: AngleWeight = "0=1, 60=1,80=0.5".parse().unwrap();
        let at = |degrees: f64| weight.at(degrees.to_radians());
        assert_eq!(at(-10.0), 1.0);
        assert_eq!(at(30.0), 1.0);
        assert!((at(70.0) - 0.75).abs() < 1e-12);
        assert_eq!(at(85.0), 0.5);
    }

    #[test]
    fn what_is_not_a_weight_is_named() {
        let message = |text: &str| text.parse::<AngleWeight>().unwrap_err();
        assert!(message("60").to_string().contains("\"60\""));
        assert!(message("60=-1").to_string().contains("\"60=-1\""));
        assert!(message("60=x").to_string().contains("\"60=x\""));
        assert!(message("60=1,50=1").to_string().contains("ascend"));
    }

    #[test]
    fn sigma_is_needed_only_where_asked_for() {
        let mut reading = Measurement {
            wavelength_um: None,
            psi: 0.1,
            theta: 0.2,
            phi: 0.0,
            brdf: 0.1,
            sigma: None,
        };
        let by_sigma = Weights {
            errors: AssumedErrors::Stated,
            ..Weights::default()
        };
        assert_eq!(Weights::default().of(&reading), Some(1.0));
        assert_eq!(by_sigma.of(&reading), None);
        reading.sigma = Some(0.5);
        assert_eq!(by_sigma.of(&reading), Some(4.0));
    }

    fn readings(angles: &[(f64, f64, f64)]) -> Measurements {
        let reading = |&(psi, theta, phi): &(f64, f64, f64)| Measurement {
            wavelength_um: None,
            psi: psi.to_radians(),
            theta: theta.to_radians(),
            phi: phi.to_radians(),
            brdf: 0.1,
            sigma: None,
        };
        Measurements::new("test", angles.iter().map(reading).collect()).unwrap()
    }

    #[test]
    fn the_solid_angles_of_a_full_scan_make_the_hemisphere() {
        let mut grid = vec![(20.0, 0.0, 0.0)];
        for theta in [10, 20, 30, 40, 50, 60, 70, 80] {
            for phi in [0, 30, 60, 90, 120, 180, 270] {
                grid.push((20.0, f64::from(theta), f64::from(phi)));
            }
        }
        let scan = readings(&grid);
        let all = Weights {
            by_solid_angle: true,
            ..Weights::default()
        };
        let sum: f64 = all.for_readings(&scan).unwrap().iter().sum();
        // The last ring ends at 85 deg; the normal takes its share from one sector alone.
        let expected = TAU * (1.0 - 85_f64.to_radians().cos());
        assert!((sum / expected - 1.0).abs() < 0.01, "{sum} {expected}");
    }

    #[test]
    fn in_the_plane_a_solid_angle_is_the_ring_of_its_side() {
        let scan = readings(&[
            (30.0, -20.0, 0.0),
            (30.0, -10.0, 0.0),
            (30.0, 10.0, 0.0),
            (30.0, 40.0, 0.0),
        ]);
        let ring = |from: f64, to: f64| PI * (from.to_radians().cos() - to.to_radians().cos());
        let expected = [
            ring(15.0, 25.0),
            ring(0.0, 15.0),
            ring(0.0, 25.0),
            ring(25.0, 55.0),
        ];
        for (angle, expected) in solid_angles(&scan).iter().zip(expected) {
            assert!((angle - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn masks_leave_out_what_is_near_the_source_or_the_mirror_direction() {
        let scan = readings(&[
            (30.0, 29.0, 0.0),
            (30.0, 33.0, 0.0),
            (30.0, -31.0, 0.0),
            (30.0, 31.0, 180.0),
            (30.0, 30.0, 178.0),
            (30.0, -34.0, 0.0),
        ]);
        let weights = Weights {
            mask_source: 2_f64.to_radians(),
            mask_mirror: 3_f64.to_radians(),
            ..Weights::default()
        };
        assert_eq!(
            weights.for_readings(&scan),
            Some(vec![0.0, 1.0, 0.0, 0.0, 0.0, 1.0])
        );
    }
}
