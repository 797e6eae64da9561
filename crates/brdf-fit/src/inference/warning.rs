//! What a user should know before trusting a fit.

use std::f64::consts::{PI, TAU};
use std::fmt;

use brdf_core::AnyBrdf;
use serde::{Deserialize, Serialize};

use crate::fit::Fit;
use crate::fit::grid_search::GridSearch;
use crate::format::counted;
use crate::inference::uncertainty::{Estimate, Knowledge, Noise, Uncertainty};
use crate::model::{Model, Parameter};
use crate::objective::Objective;
use crate::progress::{Cancelled, Progress};
use crate::scan::{Measurement, Measurements};
use crate::solver::Termination;

/// Above this E the model does not describe a sample: the readings are missed by a third of their
/// size (root of 10 %). The paper's own fits have 1.7 ... 6.5 %.
pub const NOT_DESCRIBED_PERCENT: f64 = 10.0;

/// Fewer incidences say little of the dependence on the incidence angle.
const FEW_INCIDENCES: usize = 3;

/// A reading is near the mirror direction when its facet is tilted by no more than this, in
/// radians: 2.5 deg, or 5 deg of view angle in the plane of incidence.
const NEAR_MIRROR_TILT: f64 = 2.5 * PI / 180.0;

/// Residuals twice as large as the stated errors are more than chance.
const LARGE_CHI_SQUARE: f64 = 4.0;

/// Below this E a scan is described well enough as it is.
const FITS_WELL_PERCENT: f64 = 1.0;

/// The other side as positive describes the readings better when it lowers E by this factor.
const TURNED_GAIN: f64 = 0.5;

/// Something about the data or the fit that its user should know.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Warning {
    /// E is too large for the model to describe the sample.
    NotDescribed {
        /// E in percent.
        e_percent: f64,
    },
    /// The readings fit better with the other side counted positive.
    TurnedRound {
        /// E in percent with theta negated.
        e_percent: f64,
    },
    /// The hemispherical reflectance exceeds 1.
    ReflectanceAboveOne {
        /// The incidence angle from which it does, in degrees.
        psi_deg: f64,
    },
    /// The data do not determine a parameter.
    NotDetermined {
        /// The parameter.
        parameter: Parameter,
        /// Why.
        reason: String,
        /// The lower end of its interval of 95 %; `None` where it has none.
        from: Option<f64>,
        /// The upper end.
        to: Option<f64>,
    },
    /// The residuals are larger than the standard deviations that the scan states.
    LargerThanStatedErrors {
        /// The mean square of residual over standard deviation.
        reduced_chi_square: f64,
    },
    /// Few incidence angles.
    FewIncidences {
        /// How many.
        count: usize,
    },
    /// Negative readings, which are noise; they are kept.
    NegativeReadings {
        /// How many.
        count: usize,
    },
    /// Readings with a weight of zero, which have no say.
    #[serde(rename = "weightless-readings")]
    ZeroWeightReadings {
        /// How many.
        count: usize,
    },
    /// Readings at the same angles as another one; they are all kept.
    RepeatedReadings {
        /// How many there are beyond the first of each.
        count: usize,
    },
    /// Nothing was measured near the mirror direction.
    NoMirrorReadings {
        /// The smallest tilt of a facet among the readings, in degrees.
        smallest_tilt_deg: f64,
    },
    /// A stage used up its iterations.
    IterationLimit {
        /// 1 or 2.
        stage: u8,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotDescribed { e_percent } => write!(
                f,
                "the model does not describe this sample: E = {e_percent:.3} % at its optimum, so \
                 that it misses the readings by {:.0} % of their size (root mean square)",
                10.0 * e_percent.sqrt()
            ),
            Self::TurnedRound { e_percent } => write!(
                f,
                "with theta counted the other way round E would be {e_percent:.3} %: does the file \
                 count the forward side positive (--theta-positive forward, or --phi-zero forward)?"
            ),
            Self::ReflectanceAboveOne { psi_deg } => write!(
                f,
                "the hemispherical reflectance is above 1 from psi = {psi_deg:.1} deg on, which no \
                 real surface has"
            ),
            Self::NotDetermined {
                parameter,
                reason,
                from,
                to,
            } => {
                write!(f, "the data do not determine {parameter}: {reason}")?;
                match (from, to) {
                    (Some(from), None) => write!(f, " (above {from:.2e} at 95 %)"),
                    (None, Some(to)) => write!(f, " (below {to:.2e} at 95 %)"),
                    (Some(from), Some(to)) => write!(f, " ({from:.2e} to {to:.2e} at 95 %)"),
                    (None, None) => Ok(()),
                }
            }
            Self::LargerThanStatedErrors { reduced_chi_square } => write!(
                f,
                "the residuals are {:.1} times as large as the standard deviations of the readings \
                 (root mean square): what the model misses is more than noise, and the intervals \
                 are too short",
                reduced_chi_square.sqrt()
            ),
            Self::FewIncidences { count } => {
                let count = counted(*count, "incidence angle");
                write!(f, "{count}: little is known of other incidences")
            }
            Self::NegativeReadings { count } => {
                write!(
                    f,
                    "{} below zero, kept (noise, or a background too large?)",
                    counted(*count, "reading")
                )
            }
            Self::ZeroWeightReadings { count } => {
                write!(
                    f,
                    "{} with a weight of zero, without any say",
                    counted(*count, "reading")
                )
            }
            Self::RepeatedReadings { count } => {
                write!(
                    f,
                    "{} at the same angles as another one, all kept",
                    counted(*count, "reading")
                )
            }
            Self::NoMirrorReadings { smallest_tilt_deg } => write!(
                f,
                "nothing was measured near the mirror direction: no facet is tilted by less than \
                 {smallest_tilt_deg:.1} deg, so k2 and k1 rest on the flanks of the peak"
            ),
            Self::IterationLimit { stage } => {
                write!(
                    f,
                    "stage {stage} used up its iterations before it converged"
                )
            }
        }
    }
}

/// All warnings about a fit of these measurements with its uncertainty, the gravest first.
///
/// The widths of a search for a scan that is turned round are told.
pub(crate) fn warnings(
    measurements: &Measurements,
    fit: &Fit,
    uncertainty: &Uncertainty,
    progress: &Progress<'_>,
) -> Result<Vec<Warning>, Cancelled> {
    let mut warnings = Vec::new();
    if fit.e_percent > NOT_DESCRIBED_PERCENT {
        warnings.push(Warning::NotDescribed {
            e_percent: fit.e_percent,
        });
    }
    warnings.extend(turned_round(measurements, fit, progress)?);
    warnings.extend(uncertainty.estimates.iter().filter_map(not_determined));
    warnings.extend(larger_than_stated_errors(uncertainty));
    warnings.extend(reflectance_above_one(fit));
    warnings.extend(iteration_limits(fit));
    warnings.extend(about_readings(measurements, fit));
    Ok(warnings)
}

fn not_determined(estimate: &Estimate) -> Option<Warning> {
    let Knowledge::NotDetermined {
        reason,
        interval_95,
    } = &estimate.knowledge
    else {
        return None;
    };
    Some(Warning::NotDetermined {
        parameter: estimate.parameter,
        reason: reason.clone(),
        from: interval_95.from,
        to: interval_95.to,
    })
}

fn larger_than_stated_errors(uncertainty: &Uncertainty) -> Option<Warning> {
    match uncertainty.noise {
        Noise::Given { reduced_chi_square } if reduced_chi_square > LARGE_CHI_SQUARE => {
            Some(Warning::LargerThanStatedErrors { reduced_chi_square })
        }
        _ => None,
    }
}

fn turned_round(
    measurements: &Measurements,
    fit: &Fit,
    progress: &Progress<'_>,
) -> Result<Option<Warning>, Cancelled> {
    // A table's format leaves no doubt about the sides.
    if fit.e_percent <= FITS_WELL_PERCENT || measurements.is_table() {
        return Ok(None);
    }
    let turned: Vec<Measurement> = measurements
        .readings()
        .iter()
        .map(|r| Measurement {
            theta: -r.theta,
            ..*r
        })
        .collect();
    let Ok(turned) = Measurements::new("", turned) else {
        return Ok(None);
    };
    let turned = lowest_e_percent(&turned, fit, progress)?;
    let straight = lowest_e_percent(measurements, fit, progress)?;
    let better = turned
        .zip(straight)
        .filter(|(turned, straight)| *turned < TURNED_GAIN * straight.min(fit.e_percent));
    Ok(better.map(|(e_percent, _)| Warning::TurnedRound { e_percent }))
}

/// The lowest E of the paper's model at the n of a fit, which tells the sides apart as well as any.
fn lowest_e_percent(
    scan: &Measurements,
    fit: &Fit,
    progress: &Progress<'_>,
) -> Result<Option<f64>, Cancelled> {
    let (family, weights) = (Model::Three.family(), &fit.options.weights);
    let Ok(objective) = Objective::new(scan, family, fit.n, weights) else {
        return Ok(None);
    };
    let search = GridSearch::new(&objective, Model::Three.into(), progress)?;
    Ok(Some(100.0 * search.whole().lowest().error))
}

fn reflectance_above_one(fit: &Fit) -> Option<Warning> {
    let brdf = AnyBrdf::new(fit.model().family(), &fit.at()).ok()?;
    let psi_deg = brdf.energy_violation_angle()?.to_degrees();
    // Beyond the limit that the user has set it is no news.
    if fit
        .energy
        .is_some_and(|energy| psi_deg > energy.limit_deg - 0.1)
    {
        return None;
    }
    Some(Warning::ReflectanceAboveOne { psi_deg })
}

fn iteration_limits(fit: &Fit) -> impl Iterator<Item = Warning> {
    let stages = [fit.stage1, fit.stage2];
    (1..).zip(stages).filter_map(|(stage, result)| {
        (result?.termination == Termination::IterationLimit)
            .then_some(Warning::IterationLimit { stage })
    })
}

fn about_readings(measurements: &Measurements, fit: &Fit) -> impl Iterator<Item = Warning> {
    let readings = measurements.readings();
    // Those without an E weigh nothing, or are zero.
    let incidences = fit
        .incidences
        .iter()
        .filter(|i| i.e_percent.is_some())
        .count();
    let zero_weight = fit.zero_weight;
    let negative = readings.iter().filter(|r| r.brdf < 0.0).count();
    // The bins of a table are different directions.
    let repeated = if measurements.is_table() {
        0
    } else {
        repeated_readings(readings)
    };
    let smallest_tilt = readings
        .iter()
        .filter_map(|r| r.geometry().ok())
        .map(|geometry| geometry.tan2_alpha().sqrt().atan())
        .fold(f64::INFINITY, f64::min);
    [
        (incidences < FEW_INCIDENCES).then_some(Warning::FewIncidences { count: incidences }),
        (smallest_tilt > NEAR_MIRROR_TILT).then(|| Warning::NoMirrorReadings {
            smallest_tilt_deg: smallest_tilt.to_degrees(),
        }),
        (zero_weight > 0).then_some(Warning::ZeroWeightReadings { count: zero_weight }),
        (negative > 0).then_some(Warning::NegativeReadings { count: negative }),
        (repeated > 0).then_some(Warning::RepeatedReadings { count: repeated }),
    ]
    .into_iter()
    .flatten()
}

/// Readings in the same direction as an earlier one, however their angles are written.
fn repeated_readings(readings: &[Measurement]) -> usize {
    let mut directions: Vec<[i64; 3]> = readings.iter().map(direction).collect();
    let total = directions.len();
    directions.sort_unstable();
    directions.dedup();
    total - directions.len()
}

/// psi, |theta| and the azimuth in [0, 2 pi), in units of 1e-9 rad; the azimuth is 0 for a view
/// along the normal, which has none.
#[expect(
    clippy::cast_possible_truncation,
    reason = "angles of a few rad are far from 2^63 units"
)]
fn direction(reading: &Measurement) -> [i64; 3] {
    let units = |angle: f64| (angle * 1e9).round() as i64;
    let turned = if reading.theta < 0.0 { PI } else { 0.0 };
    let phi = units((reading.phi + turned).rem_euclid(TAU)) % units(TAU);
    let (psi, theta) = (units(reading.psi), units(reading.theta.abs()));
    [psi, theta, if theta == 0 { 0 } else { phi }]
}

#[cfg(test)]
mod tests {
    use brdf_core::Parameters;

    use super::*;
    use crate::fit::{FitOptions, fit_scan};
    use crate::progress::{NoObserver, Phase};
    use crate::scan::RefractiveIndex;
    use crate::scan::synthetic::scan;

    fn warnings_of(readings: Vec<Measurement>, change: impl Fn(&mut FitOptions)) -> Vec<Warning> {
        let scan = Measurements::new("test", readings).unwrap();
        let mut options = FitOptions {
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            ..FitOptions::default()
        };
        change(&mut options);
        let progress = Progress::new(&NoObserver, Phase::Uncertainty);
        let fitted = fit_scan(&scan, &options, &progress).unwrap();
        let uncertainty = Uncertainty::of_fit(&fitted, &progress).unwrap();
        warnings(&scan, &fitted.fit, &uncertainty, &progress).unwrap()
    }

    /// A scan with 2 % of ripple, which the model fits well and no parameter follows.
    fn rippled(k2: f64, kd: f64, k1: f64) -> Vec<Measurement> {
        let mut readings = scan(Parameters::new(k2, kd, k1).unwrap(), 1.5)
            .readings()
            .to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= 1.0 + 0.02 * (2.4 * i as f64).sin();
        }
        readings
    }

    #[test]
    fn a_good_scan_has_no_warning() {
        assert_eq!(warnings_of(rippled(0.1, 0.1, 0.2), |_| ()), []);
    }

    #[test]
    fn a_peak_between_the_readings_has_no_width() {
        let mut readings = rippled(0.1, 0.1, 0.2);
        for reading in &mut readings {
            let is_mirror = reading.theta == -reading.psi;
            reading.brdf = if is_mirror { 1e3 } else { reading.brdf };
        }
        let all = warnings_of(readings, |_| ());
        let narrower = |w: &Warning| matches!(w, Warning::NotDetermined { reason, .. } if reason.contains("narrower"));
        assert!(all.iter().any(narrower), "{all:?}");
    }

    #[test]
    fn a_lambertian_scan_has_neither_width_nor_specular_weight() {
        let readings = rippled(0.0, 0.3, 1.0);
        let all = warnings_of(readings, |_| ());
        let open = |w: &Warning| matches!(w, Warning::NotDetermined { .. });
        assert!(all.iter().any(open), "{all:?}");
    }

    #[test]
    fn readings_on_the_flank_alone_leave_the_weights_open() {
        // Far from the mirror direction the lobe is k2 k1^2 / tan^2 alpha: one number for two.
        let readings = rippled(0.1, 0.1, 0.02);
        let flank = readings
            .into_iter()
            .filter(|r| r.psi < 0.4 && r.theta > 0.0)
            .collect();
        let all = warnings_of(flank, |_| ());
        assert!(
            all.iter()
                .any(|w| matches!(w, Warning::NoMirrorReadings { .. })),
            "{all:?}"
        );
        let open = |w: &Warning| {
            matches!(
                w,
                Warning::NotDetermined {
                    parameter: Parameter::K2,
                    ..
                }
            )
        };
        assert!(all.iter().any(open), "{all:?}");
    }

    #[test]
    fn too_much_reflectance_is_told_with_its_angle() {
        let all = warnings_of(rippled(0.156, 0.584, 1.338), |_| ());
        let angle = all.iter().find_map(|w| match w {
            Warning::ReflectanceAboveOne { psi_deg } => Some(*psi_deg),
            _ => None,
        });
        assert!((40.0..65.0).contains(&angle.unwrap()));
    }

    #[test]
    fn a_scan_in_the_other_convention_is_noticed() {
        let mut readings = rippled(0.1, 0.1, 0.2);
        for reading in &mut readings {
            reading.theta = -reading.theta;
        }
        let all = warnings_of(readings, |_| ());
        assert!(
            all.iter().any(|w| matches!(w, Warning::TurnedRound { .. })),
            "{all:?}"
        );
    }

    #[test]
    fn used_up_iterations_are_told() {
        let all = warnings_of(rippled(0.1, 0.1, 0.2), |options| options.max_iterations = 1);
        assert!(all.contains(&Warning::IterationLimit { stage: 1 }));
        assert!(all.contains(&Warning::IterationLimit { stage: 2 }));
    }

    #[test]
    fn each_repeated_direction_is_counted() {
        let mut readings = rippled(0.1, 0.1, 0.2);
        // Once more as it is, and twice as the same direction in other words.
        let theta = readings[7].theta;
        let mut turned = [readings[3], readings[7], readings[7]];
        (turned[1].theta, turned[1].phi) = (-theta, PI);
        turned[2].phi = TAU;
        readings.extend(turned);
        let all = warnings_of(readings, |_| ());
        assert!(
            all.contains(&Warning::RepeatedReadings { count: 3 }),
            "{all:?}"
        );
    }
}
