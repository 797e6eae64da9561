//! The weights of the readings in eq. (5).

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::measurement::Measurement;

/// A weight that is a function of one angle: linear between the listed angles, constant beyond the
/// first and the last, 1 everywhere where the list is empty.
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

/// `60=1,70=0.5`: degrees and weights, in ascending order of the degrees.
impl FromStr for AngleWeight {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
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
                        format!("\"{entry}\": expected DEGREES=WEIGHT with a weight >= 0, such as 60=1,70=0.5")
                    })
            })
            .collect::<Result<_, _>>()?;
        if points_deg.windows(2).any(|pair| pair[0].0 >= pair[1].0) {
            return Err(format!("\"{text}\": the angles must ascend"));
        }
        Ok(Self { points_deg })
    }
}

/// The weight of each reading in E: g1(psi) g2(theta), times 1/sigma^2 where asked for.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Weights {
    /// g1 of eq. (5), over the incidence angle psi.
    pub g1: AngleWeight,
    /// g2 of eq. (5), over the signed view angle theta.
    pub g2: AngleWeight,
    /// Multiply by 1/sigma^2 of each reading.
    pub by_sigma: bool,
}

/// Which weights there are besides 1: `g1(psi), 1/sigma^2`, or nothing.
impl fmt::Display for Weights {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all = [
            (!self.g1.points_deg.is_empty()).then_some("g1(psi)"),
            (!self.g2.points_deg.is_empty()).then_some("g2(theta)"),
            self.by_sigma.then_some("1/sigma^2"),
        ];
        let used: Vec<&str> = all.into_iter().flatten().collect();
        f.write_str(&used.join(", "))
    }
}

impl Weights {
    /// The weight of one reading; `None` where sigma is asked for and the reading has none.
    pub fn of(&self, reading: &Measurement) -> Option<f64> {
        let theta = reading.in_plane_theta().unwrap_or(reading.theta);
        let by_angle = self.g1.at(reading.psi) * self.g2.at(theta);
        if self.by_sigma {
            reading.sigma.map(|sigma| by_angle / (sigma * sigma))
        } else {
            Some(by_angle)
        }
    }
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
        assert!(message("60").contains("\"60\""));
        assert!(message("60=-1").contains("\"60=-1\""));
        assert!(message("60=x").contains("\"60=x\""));
        assert!(message("60=1,50=1").contains("ascend"));
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
            by_sigma: true,
            ..Weights::default()
        };
        assert_eq!(Weights::default().of(&reading), Some(1.0));
        assert_eq!(by_sigma.of(&reading), None);
        reading.sigma = Some(0.5);
        assert_eq!(by_sigma.of(&reading), Some(4.0));
    }
}
