//! The initial values of the paper (section 3): both weights from the readings in the mirror
//! direction, the width from the angle at which a peak has fallen to half its height.

use std::fmt;

use brdf_core::fresnel::Dielectric;
use brdf_core::{Geometry, Parameters, mirror_factor};
use serde::{Deserialize, Serialize};

use super::grid_search::GridSearch;
use crate::model::{K1_RANGE, Model};
use crate::objective::{Objective, ProfileSums, solve};
use crate::progress::{Cancelled, Progress};
use crate::scan::Measurement;

/// Two readings on either side of the mirror direction are interpolated if their distance is at most
/// this, in radians (10 deg, more than the step of a usual scan).
const LARGEST_GAP: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// The initial values of the parameters, and how they were found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct InitialValues {
    /// k2, kD and k1.
    pub parameters: Parameters,
    /// The origin of the weights; `None` for values that the caller gave.
    pub weights: Option<WeightsRoute>,
    /// The origin of the width; `None` for a value that the caller gave.
    pub width: Option<WidthRoute>,
}

/// How the initial k2 and kD were found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WeightsRoute {
    /// Steps 1 and 2 of the paper, with the reading at normal incidence and view.
    NormalReading,
    /// Linear least squares over the readings in the mirror direction, as there is no reading at normal
    /// incidence and view.
    MirrorReadings,
    /// The best weights over all readings of the stage, as there are too few mirror readings.
    WholeScan,
}

/// How the initial k1 was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WidthRoute {
    /// Step 3 of the paper: eq. (4) solved where a peak has fallen to half its height.
    HalfHeight,
    /// The best width over all readings of the stage, as no peak falls to half its height.
    WholeScan,
}

impl fmt::Display for InitialValues {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let weights = match self.weights {
            None => return f.write_str("given by the user"),
            Some(WeightsRoute::NormalReading) => {
                "k2, kD from the normal and the mirror readings (steps 1 and 2 of the paper)"
            }
            Some(WeightsRoute::MirrorReadings) => {
                "k2, kD by least squares over the mirror readings (none at normal incidence and view)"
            }
            Some(WeightsRoute::WholeScan) => {
                "k2, kD by least squares over the scan (too few mirror readings)"
            }
        };
        let width = match self.width {
            Some(WidthRoute::HalfHeight) => "k1 from the half height of the peaks (step 3)",
            Some(WidthRoute::WholeScan) | None => "k1 by search (no peak falls to half)",
        };
        write!(f, "{weights}; {width}")
    }
}

/// The readings of one incidence in the plane of incidence, in ascending order of the signed view
/// angle.
pub(crate) struct Section {
    psi: f64,
    /// Signed theta in radians, f_r in 1/sr.
    points: Vec<(f64, f64)>,
}

impl Section {
    /// The section of an incidence, given by the indices of its readings.
    pub(crate) fn new(psi: f64, own: &[usize], readings: &[Measurement]) -> Self {
        let mut points: Vec<(f64, f64)> = own
            .iter()
            .filter_map(|&i| Some((readings[i].in_plane_theta()?, readings[i].brdf)))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { psi, points }
    }

    /// The reading exactly in the mirror direction.
    fn exact_mirror_reading(&self) -> Option<f64> {
        let found = self.points.iter().find(|(theta, _)| *theta == -self.psi);
        found.map(|(_, f)| *f)
    }

    /// f_r in the mirror direction: the reading there, or interpolated between two close readings.
    fn mirror_reading(&self) -> Option<f64> {
        if let Some(exact) = self.exact_mirror_reading() {
            return Some(exact);
        }
        let mirror = -self.psi;
        let after = self.points.partition_point(|(theta, _)| *theta < mirror);
        let right = *self.points.get(after)?;
        let left = *self.points.get(after.checked_sub(1)?)?;
        (right.0 - left.0 <= LARGEST_GAP).then(|| interpolate(left, right, mirror))
    }

    /// The view angles on either side of the mirror direction at which f_r first falls to `level`.
    fn crossings(&self, level: f64) -> impl Iterator<Item = f64> {
        // A reading in the mirror direction itself belongs to both sides.
        let left = &self.points[..self
            .points
            .partition_point(|(theta, _)| *theta <= -self.psi)];
        let right = &self.points[self.points.partition_point(|(theta, _)| *theta < -self.psi)..];
        let falls = move |pair: &[(f64, f64)]| pair[0].1 >= level && pair[1].1 < level;
        let rises = move |pair: &[(f64, f64)]| pair[0].1 < level && pair[1].1 >= level;
        let on_the_right = right.windows(2).find(|pair| falls(pair));
        let on_the_left = left.windows(2).rev().find(|pair| rises(pair));
        let angle = move |pair: &[(f64, f64)]| {
            let swap = |(theta, f): (f64, f64)| (f, theta);
            interpolate(swap(pair[0]), swap(pair[1]), level)
        };
        on_the_right.into_iter().chain(on_the_left).map(angle)
    }
}

fn interpolate(left: (f64, f64), right: (f64, f64), x: f64) -> f64 {
    left.1 + (right.1 - left.1) * (x - left.0) / (right.0 - left.0)
}

/// The initial values for the sections of some incidences, with the objective over the same readings.
/// They are those of the paper's model for every family of the objective.
pub(crate) fn initial_values(
    sections: &[Section],
    n: f64,
    objective: &Objective,
    progress: &Progress<'_>,
) -> Result<InitialValues, Cancelled> {
    let search = || GridSearch::new(objective, Model::Three.into(), progress);
    let fresnel = Dielectric::new(n);
    let Some((k2, kd, weights)) = weights_of_mirror_readings(sections, &fresnel) else {
        let point = search()?.whole().lowest();
        return Ok(InitialValues {
            parameters: point.parameters.parameters(),
            weights: Some(WeightsRoute::WholeScan),
            width: Some(WidthRoute::WholeScan),
        });
    };
    let (k1, width) = match width_at_half_height(sections, &fresnel, k2, kd) {
        Some(k1) => (k1, WidthRoute::HalfHeight),
        None => (
            search()?.whole().lowest().parameters.k1,
            WidthRoute::WholeScan,
        ),
    };
    Ok(InitialValues {
        parameters: Parameters { k2, kd, k1 },
        weights: Some(weights),
        width: Some(width),
    })
}

/// Steps 1 and 2. In the mirror direction pi f_r = k2 c + kD with c = R0(psi)/cos^2 psi.
fn weights_of_mirror_readings(
    sections: &[Section],
    fresnel: &Dielectric,
) -> Option<(f64, f64, WeightsRoute)> {
    let factor = |psi: f64| fresnel.relative(psi.cos()) / psi.cos().powi(2);
    // Pairs (c, pi f_r).
    let mirror: Vec<(f64, f64)> = sections
        .iter()
        .filter_map(|s| Some((factor(s.psi), std::f64::consts::PI * s.mirror_reading()?)))
        .collect();
    // An interpolated value would be too low at a peak, and all initial values depend on it.
    let normal = sections
        .iter()
        .find(|s| s.psi == 0.0)
        .and_then(Section::exact_mirror_reading);
    let (k2, kd, route) = match normal {
        Some(normal) if mirror.len() > 1 => {
            let sum = std::f64::consts::PI * normal;
            let q = ratio_of_weights(&mirror, sum)?;
            (
                sum / (1.0 + q),
                sum * q / (1.0 + q),
                WeightsRoute::NormalReading,
            )
        }
        _ => {
            let (k2, kd) = weights_by_least_squares(&mirror)?;
            (k2, kd, WeightsRoute::MirrorReadings)
        }
    };
    (k2 > 0.0 && kd >= 0.0 && k2.is_finite() && kd.is_finite()).then_some((k2, kd, route))
}

/// q = kD/k2 from f(psi)/f(0) (1 + q) = c(psi) + q, by least squares over the mirror readings;
/// `sum` is pi f(0) = k2 + kD.
fn ratio_of_weights(mirror: &[(f64, f64)], sum: f64) -> Option<f64> {
    let (mut above, mut below) = (0.0, 0.0);
    for (c, reading) in mirror {
        let excess = reading / sum - 1.0;
        above += (c - reading / sum) * excess;
        below += excess * excess;
    }
    (below > 0.0).then(|| (above / below).max(0.0))
}

fn weights_by_least_squares(mirror: &[(f64, f64)]) -> Option<(f64, f64)> {
    if mirror.len() < 2 {
        return None;
    }
    let sum = |term: fn(f64, f64) -> f64| mirror.iter().map(|(c, y)| term(*c, *y)).sum();
    let (k2, kd, _) = solve(&ProfileSums {
        uu: sum(|c, _| c * c),
        ua: sum(|c, _| c),
        uy: sum(|c, y| c * y),
        aa: sum(|_, _| 1.0),
        ay: sum(|_, y| y),
    });
    Some((k2, kd))
}

/// Step 3: the median of k1 over all peaks and both of their sides.
fn width_at_half_height(
    sections: &[Section],
    fresnel: &Dielectric,
    k2: f64,
    kd: f64,
) -> Option<f64> {
    let mut widths: Vec<f64> = sections
        .iter()
        .filter_map(|section| Some((section, 0.5 * section.mirror_reading()?)))
        .flat_map(|(section, half)| {
            section.crossings(half).filter_map(move |theta| {
                width_from_level(section.psi, theta, half, fresnel, k2, kd)
            })
        })
        .collect();
    widths.sort_by(f64::total_cmp);
    widths.get(widths.len() / 2).copied()
}

/// Eq. (4) solved for k1 where f_r has the given level:
/// k1^2 = F tan^2 alpha / (sec alpha - F), where F is the value of f(alpha)/f(0) at that level.
fn width_from_level(
    psi: f64,
    theta: f64,
    level: f64,
    fresnel: &Dielectric,
    k2: f64,
    kd: f64,
) -> Option<f64> {
    let geometry = Geometry::in_plane(psi, theta).ok()?;
    let mirror = mirror_factor(fresnel, &geometry);
    let facet = (std::f64::consts::PI * level - kd) / (k2 * mirror);
    let k1_squared = facet * geometry.tan2_alpha() / (geometry.sec_alpha() - facet);
    (k1_squared > 0.0).then(|| k1_squared.sqrt().clamp(K1_RANGE.0, K1_RANGE.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objective::weights::Weights;
    use crate::progress::{NoObserver, Phase};
    use crate::scan::synthetic::scan;
    use crate::scan::{Incidence, Measurements};

    fn initial(readings: Vec<Measurement>) -> InitialValues {
        let scan = Measurements::new("test", readings).unwrap();
        let family = brdf_core::Family::Paper;
        let objective = Objective::new(&scan, family, 1.5, &Weights::default()).unwrap();
        let progress = Progress::new(&NoObserver, Phase::Stage1);
        let section = |i: &Incidence| Section::new(i.psi, &i.readings, scan.readings());
        let sections: Vec<Section> = scan.incidences().iter().map(section).collect();
        initial_values(&sections, 1.5, &objective, &progress).unwrap()
    }

    fn truth() -> Parameters {
        Parameters::new(0.3, 0.1, 0.2).unwrap()
    }

    #[test]
    fn steps_1_and_2_recover_the_weights_of_a_scan_with_a_normal_reading() {
        let mut readings = scan(truth(), 1.5).readings().to_vec();
        let mut normal = readings[0];
        (normal.psi, normal.theta, normal.brdf) = (0.0, 0.0, 0.4 / std::f64::consts::PI);
        readings.push(normal);
        let found = initial(readings);
        assert_eq!(found.weights, Some(WeightsRoute::NormalReading));
        assert!((found.parameters.k2 - 0.3).abs() < 1e-12);
        assert!((found.parameters.kd - 0.1).abs() < 1e-12);
    }

    #[test]
    fn without_a_normal_reading_the_mirror_readings_give_the_weights() {
        let readings = scan(truth(), 1.5).readings().to_vec();
        let found = initial(readings.into_iter().filter(|r| r.psi > 0.0).collect());
        assert_eq!(found.weights, Some(WeightsRoute::MirrorReadings));
        assert!((found.parameters.k2 - 0.3).abs() < 1e-12);
        assert!((found.parameters.kd - 0.1).abs() < 1e-12);
        assert_eq!(found.width, Some(WidthRoute::HalfHeight));
        // The half height is interpolated between readings 5 deg apart.
        assert!((found.parameters.k1 / 0.2 - 1.0).abs() < 0.2, "{found:?}");
    }

    #[test]
    fn without_mirror_readings_the_whole_scan_serves() {
        let readings = scan(truth(), 1.5).readings().to_vec();
        let found = initial(readings.into_iter().filter(|r| r.theta > 0.0).collect());
        assert_eq!(found.weights, Some(WeightsRoute::WholeScan));
        assert!((found.parameters.k1 / 0.2).ln().abs() <= 0.25);
    }

    #[test]
    fn without_a_peak_the_width_is_searched() {
        let flat = Parameters::new(0.05, 0.5, 0.8).unwrap();
        // At larger incidences the Fresnel factor makes a peak even of these parameters.
        let readings = scan(flat, 1.5).readings().to_vec();
        let found = initial(readings.into_iter().filter(|r| r.psi < 0.7).collect());
        assert_eq!(found.weights, Some(WeightsRoute::MirrorReadings));
        assert_eq!(found.width, Some(WidthRoute::WholeScan));
    }

    #[test]
    fn the_width_solves_eq_4() {
        let brdf = brdf_core::ThreeParameterBrdf::new(truth(), 1.5).unwrap();
        let level = brdf.value(&Geometry::in_plane(0.5, -0.9).unwrap());
        let fresnel = Dielectric::new(1.5);
        let k1 = width_from_level(0.5, -0.9, level, &fresnel, 0.3, 0.1).unwrap();
        assert!((k1 - 0.2).abs() < 1e-12);
        assert_eq!(width_from_level(0.5, -0.9, 0.01, &fresnel, 0.3, 0.1), None);
    }
}
