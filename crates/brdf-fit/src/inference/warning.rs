//! Warnings about a fit and its readings.

use std::f64::consts::{PI, TAU};
use std::fmt;

use brdf_core::AnyBrdf;
use serde::{Deserialize, Serialize};

use super::deviations::Quality;
use super::estimate::{Estimate, Knowledge};
use super::hint::{Hint, hints, peaks_towards_source, reinterpretations};
use super::noise::Noise;
use super::physics::violation_deg;
use super::uncertainty::{MOST_READINGS, Uncertainty};
use crate::fit::{Fit, FitOptions, FitProblem, Solution, rms_percent};
use crate::format::{counted, two_digits};
use crate::model::{Model, Parameter};
use crate::progress::{Cancelled, Progress};
use crate::scan::{Measurement, Measurements, RefractiveIndex};
use crate::solver::Termination;

/// With fewer incidences the dependence on the incidence angle is poorly constrained.
const FEW_INCIDENCES: usize = 3;

/// A reading is near the mirror direction when the tilt alpha of its facet is at most this, in
/// radians: 2.5 deg, which is 5 deg of view angle in the plane of incidence.
const NEAR_MIRROR_TILT: f64 = 2.5 * PI / 180.0;

/// Above this reduced chi square the residuals exceed the stated errors by more than chance: they are
/// twice as large.
const LARGE_CHI_SQUARE: f64 = 4.0;

/// Up to this E, in percent, the model describes a scan too well for reversed signs of theta.
const FITS_WELL_PERCENT: f64 = 1.0;

/// Up to this E, in percent, the angles of a scan are as they should be.
const EXACT_PERCENT: f64 = 0.1;

/// Reversed signs of theta describe the readings better when they lower E by this factor.
const REVERSED_GAIN: f64 = 0.5;

/// A property of the readings or of the fit that limits what the fit means.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Warning {
    /// The numbers suggest that the file means other quantities, units or angles.
    Reading(Hint),
    /// The rms error is above 30 %: the model does not describe the sample.
    NotDescribed {
        /// E in percent.
        e_percent: f64,
    },
    /// The readings fit much better with the signs of theta reversed: the file seems to count the
    /// forward side positive.
    #[serde(rename = "turned-round")]
    ThetaReversed {
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
        /// Why, as a clause.
        reason: String,
        /// The lower end of its 95 % interval; `None` where it has none.
        from: Option<f64>,
        /// The upper end.
        to: Option<f64>,
    },
    /// The residuals are larger than the standard deviations that the scan states.
    LargerThanStatedErrors {
        /// The sum of (residual / standard deviation)^2 over the degrees of freedom.
        reduced_chi_square: f64,
    },
    /// There are few incidence angles.
    FewIncidences {
        /// How many.
        count: usize,
    },
    /// Some readings are negative, which is possible by noise; they are kept.
    NegativeReadings {
        /// How many.
        count: usize,
    },
    /// Some readings have a weight of zero and do not influence the fit.
    #[serde(rename = "weightless-readings")]
    ZeroWeightReadings {
        /// How many.
        count: usize,
    },
    /// Some readings are at the same angles as another reading; all are kept.
    RepeatedReadings {
        /// How many there are beyond the first of each direction.
        count: usize,
    },
    /// No reading is near the mirror direction.
    NoMirrorReadings {
        /// The smallest tilt alpha of a facet among the readings, in degrees.
        smallest_tilt_deg: f64,
    },
    /// A stage reached its largest number of iterations.
    IterationLimit {
        /// 1 or 2.
        stage: u8,
    },
}

impl Warning {
    /// The kind of the warning in a word, as in JSON and CSV.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Reading(hint) => hint.kind(),
            Self::NotDescribed { .. } => "not-described",
            Self::ThetaReversed { .. } => "turned-round",
            Self::ReflectanceAboveOne { .. } => "reflectance-above-one",
            Self::NotDetermined { .. } => "not-determined",
            Self::LargerThanStatedErrors { .. } => "larger-than-stated-errors",
            Self::FewIncidences { .. } => "few-incidences",
            Self::NegativeReadings { .. } => "negative-readings",
            Self::ZeroWeightReadings { .. } => "weightless-readings",
            Self::RepeatedReadings { .. } => "repeated-readings",
            Self::NoMirrorReadings { .. } => "no-mirror-readings",
            Self::IterationLimit { .. } => "iteration-limit",
        }
    }
}

/// The warning as a clause. How to change the reading of the file is for the program to add.
impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Reading(hint) => hint.fmt(f),
            Self::NotDescribed { e_percent } => write!(
                f,
                "the model does not describe this sample: its rms error is {:.0} % of the rms reading",
                rms_percent(*e_percent)
            ),
            Self::ThetaReversed { e_percent } => write!(
                f,
                "with the sign of theta reversed the rms error would be {} %: the file seems to count \
                 the forward side positive",
                two_digits(rms_percent(*e_percent))
            ),
            Self::ReflectanceAboveOne { psi_deg } => write!(
                f,
                "the hemispherical reflectance is above 1 from psi = {psi_deg:.1} deg on, which is \
                 impossible for a real surface"
            ),
            Self::NotDetermined {
                parameter,
                reason,
                from,
                to,
            } => {
                write!(f, "the data do not determine {parameter}: {reason}")?;
                match (from, to) {
                    (Some(from), None) => write!(f, " (above {from:.2e} at 95 % confidence)"),
                    (None, Some(to)) => write!(f, " (below {to:.2e} at 95 % confidence)"),
                    (Some(from), Some(to)) => {
                        write!(f, " ({from:.2e} to {to:.2e} at 95 % confidence)")
                    }
                    (None, None) => Ok(()),
                }
            }
            Self::LargerThanStatedErrors { reduced_chi_square } => write!(
                f,
                "the residuals are {:.1} times as large as the standard deviations of the readings \
                 (root mean square): the model deviates from them by more than noise, which the \
                 intervals allow for",
                reduced_chi_square.sqrt()
            ),
            Self::FewIncidences { count } => write!(
                f,
                "{}: the dependence on the incidence angle is poorly constrained",
                counted(*count, "incidence angle")
            ),
            Self::NegativeReadings { count } => write!(
                f,
                "{} below zero, kept (noise, or too large a background subtracted)",
                counted(*count, "reading")
            ),
            Self::ZeroWeightReadings { count } => write!(
                f,
                "{} with a weight of zero, without influence on the fit",
                counted(*count, "reading")
            ),
            Self::RepeatedReadings { count } => write!(
                f,
                "{} at the same angles as another one, all kept",
                counted(*count, "reading")
            ),
            Self::NoMirrorReadings { smallest_tilt_deg } => write!(
                f,
                "no reading is near the mirror direction: the smallest facet tilt is \
                 {smallest_tilt_deg:.1} deg, so that k2 and k1 depend on the flanks of the peak"
            ),
            Self::IterationLimit { stage } => write!(
                f,
                "stage {stage} reached its iteration limit before it converged"
            ),
        }
    }
}

/// All warnings about a fit of these measurements, the most serious first. Each width of the search
/// with reversed signs of theta is reported.
pub(crate) fn warnings(
    measurements: &Measurements,
    fitted: Solution,
    uncertainty: &Uncertainty,
    progress: &Progress<'_>,
) -> Result<Vec<Warning>, Cancelled> {
    let fit = &fitted.fit;
    let mut warnings: Vec<Warning> = hints(measurements)
        .into_iter()
        .map(Warning::Reading)
        .collect();
    warnings.extend(other_angles(measurements, fit, progress)?);
    if Quality::of(fit) == Quality::Poor {
        warnings.push(Warning::NotDescribed {
            e_percent: fit.e_percent,
        });
    }
    let reversed = theta_reversed(measurements, fit, progress)?;
    // Where the model describes the readings on neither side, the places of the peaks still tell it.
    warnings.extend(reversed.or_else(|| peaks_towards_source(measurements).map(Warning::Reading)));
    warnings.extend(uncertainty.estimates.iter().filter_map(not_determined));
    warnings.extend(larger_than_stated_errors(uncertainty));
    warnings.extend(reflectance_above_one(fit, uncertainty));
    warnings.extend(iteration_limits(fit));
    // The objective of a large scan is freed before its readings are sorted.
    let fit = fitted.into_fit();
    warnings.extend(about_readings(measurements, &fit));
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

/// Readings that represent those of a large scan where other meanings of its angles are tried; `None`
/// where all are tried.
fn few_readings(measurements: &Measurements) -> Option<Measurements> {
    let large = measurements.readings().len() > MOST_READINGS;
    large.then(|| measurements.thinned(MOST_READINGS))
}

fn theta_reversed(
    measurements: &Measurements,
    fit: &Fit,
    progress: &Progress<'_>,
) -> Result<Option<Warning>, Cancelled> {
    // The format of a table defines the sides.
    if fit.e_percent <= FITS_WELL_PERCENT || measurements.is_table() {
        return Ok(None);
    }
    let few = few_readings(measurements);
    let measurements = few.as_ref().unwrap_or(measurements);
    let reversed: Vec<Measurement> = measurements
        .readings()
        .iter()
        .map(|r| Measurement {
            theta: -r.theta,
            ..*r
        })
        .collect();
    let Ok(reversed) = Measurements::new("", reversed) else {
        return Ok(None);
    };
    let reversed = lowest_e_percent(&reversed, fit, progress)?;
    let is_better = |than: f64| reversed.is_some_and(|reversed| reversed < REVERSED_GAIN * than);
    if !is_better(fit.e_percent) {
        return Ok(None);
    }
    let as_read = lowest_e_percent(measurements, fit, progress)?;
    let better = reversed.filter(|_| as_read.is_some_and(is_better));
    Ok(better.map(|e_percent| Warning::ThetaReversed { e_percent }))
}

/// The other meaning of the view angles with which the model describes the readings best, if it
/// describes them much better than as they were read.
fn other_angles(
    measurements: &Measurements,
    fit: &Fit,
    progress: &Progress<'_>,
) -> Result<Option<Warning>, Cancelled> {
    if fit.e_percent <= EXACT_PERCENT {
        return Ok(None);
    }
    let others = reinterpretations(measurements);
    if others.is_empty() {
        return Ok(None);
    }
    let few = few_readings(measurements);
    let measurements = few.as_ref().unwrap_or(measurements);
    let mut best: Option<(f64, Hint)> = None;
    for other in others {
        let Some(scan) = other.of(measurements) else {
            continue;
        };
        let lowest = lowest_e_percent(&scan, fit, progress)?.unwrap_or(f64::INFINITY);
        if best
            .as_ref()
            .is_none_or(|(e_percent, _)| lowest < *e_percent)
        {
            best = Some((lowest, other.hint));
        }
    }
    let Some((e_percent, hint)) = best else {
        return Ok(None);
    };
    let as_read = lowest_e_percent(measurements, fit, progress)?;
    let gain = REVERSED_GAIN * as_read.unwrap_or(0.0).min(fit.e_percent);
    Ok((e_percent < gain).then_some(Warning::Reading(hint)))
}

/// The lowest E of the paper's model at the n of a fit, in percent, to the grid of the search. It
/// distinguishes the sides as well as any other model.
fn lowest_e_percent(
    scan: &Measurements,
    fit: &Fit,
    progress: &Progress<'_>,
) -> Result<Option<f64>, Cancelled> {
    let options = FitOptions {
        model: Model::Three,
        refractive_index: Some(RefractiveIndex::Same(fit.n)),
        weights: fit.options.weights.clone(),
        ..FitOptions::default()
    };
    let Ok(problem) = FitProblem::new(scan, &options) else {
        return Ok(None);
    };
    let lowest = problem.grid_search(progress)?.whole().lowest();
    Ok(Some(100.0 * lowest.error))
}

/// The reflectance of a fit that describes the sample and all of whose parameters are determined: that
/// of an arbitrary value means nothing.
fn reflectance_above_one(fit: &Fit, uncertainty: &Uncertainty) -> Option<Warning> {
    let is_determined = uncertainty.estimates.iter().all(Estimate::is_determined);
    if !is_determined || Quality::of(fit) == Quality::Poor {
        return None;
    }
    let brdf = AnyBrdf::new(fit.model().family(), &fit.at()).ok()?;
    let psi_deg = violation_deg(&brdf)?;
    // Beyond the limit of the condition rho(psi) <= 1 the fit is free to exceed 1.
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
    // The readings of an incidence without E are zero, or have a weight of zero.
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

/// The number of readings in the same direction as an earlier one, in whichever way their angles
/// express it.
fn repeated_readings(readings: &[Measurement]) -> usize {
    let mut directions: Vec<[i64; 3]> = readings.iter().map(direction).collect();
    let total = directions.len();
    directions.sort_unstable();
    directions.dedup();
    total - directions.len()
}

/// psi, |theta| and the azimuth in [0, 2 pi), in units of 1e-9 rad; the azimuth of a view along the
/// normal is 0.
#[expect(
    clippy::cast_possible_truncation,
    reason = "angles of a few rad are far from 2^63 units"
)]
fn direction(reading: &Measurement) -> [i64; 3] {
    let units = |angle: f64| (angle * 1e9).round() as i64;
    let half_turn = if reading.theta < 0.0 { PI } else { 0.0 };
    let phi = units((reading.phi + half_turn).rem_euclid(TAU)) % units(TAU);
    let (psi, theta) = (units(reading.psi), units(reading.theta.abs()));
    [psi, theta, if theta == 0 { 0 } else { phi }]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{FitOptions, fit_scan};
    use crate::inference::Tests;
    use crate::inference::test_scans::{self, options};
    use crate::progress::{NoObserver, Phase};

    fn warnings_of(readings: Vec<Measurement>, change: impl Fn(&mut FitOptions)) -> Vec<Warning> {
        let scan = Measurements::new("test", readings).unwrap();
        let mut options = options();
        change(&mut options);
        let progress = Progress::new(&NoObserver, Phase::Uncertainty);
        let fitted = fit_scan(&scan, &options, &progress).unwrap();
        let uncertainty = Uncertainty::of_fit(&scan, &fitted, Tests::Omitted, &progress).unwrap();
        warnings(&scan, fitted, &uncertainty, &progress).unwrap()
    }

    /// A scan with 2 % of ripple, which the model fits well and no parameter follows.
    fn rippled(k2: f64, kd: f64, k1: f64) -> Vec<Measurement> {
        let scan = test_scans::rippled([k2, kd, k1], 1.5, 0.02);
        scan.readings().to_vec()
    }

    #[test]
    fn the_kind_of_a_warning_is_that_of_its_json() {
        let all = [
            Warning::NotDescribed { e_percent: 20.0 },
            Warning::ThetaReversed { e_percent: 1.0 },
            Warning::ReflectanceAboveOne { psi_deg: 80.0 },
            Warning::NotDetermined {
                parameter: Parameter::K1,
                reason: String::new(),
                from: None,
                to: None,
            },
            Warning::LargerThanStatedErrors {
                reduced_chi_square: 9.0,
            },
            Warning::FewIncidences { count: 2 },
            Warning::NegativeReadings { count: 1 },
            Warning::ZeroWeightReadings { count: 1 },
            Warning::RepeatedReadings { count: 1 },
            Warning::NoMirrorReadings {
                smallest_tilt_deg: 5.0,
            },
            Warning::IterationLimit { stage: 1 },
        ];
        for warning in all {
            let json = serde_json::to_value(&warning).unwrap();
            assert_eq!(json["kind"], warning.kind());
        }
    }

    #[test]
    fn a_good_scan_has_no_warning() {
        assert_eq!(warnings_of(rippled(0.1, 0.1, 0.2), |_| ()), []);
    }

    #[test]
    fn the_width_of_a_peak_between_the_readings_is_not_determined() {
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
    fn readings_on_the_flank_alone_do_not_determine_the_weights() {
        // Far from the mirror direction the lobe is k2 k1^2 / tan^2 alpha: k2 k1^2 is all it shows.
        let readings = rippled(0.1, 0.1, 0.02);
        let flank = readings
            .into_iter()
            // A view at 5 deg from the normal is at the limit of the tilt, on a side that rounding decides.
            .filter(|r| r.psi < 0.4 && r.theta > 0.1)
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
    fn a_reflectance_above_one_is_reported_with_its_angle() {
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
            all.iter()
                .any(|w| matches!(w, Warning::ThetaReversed { .. })),
            "{all:?}"
        );
    }

    #[test]
    fn a_reached_iteration_limit_is_reported() {
        let all = warnings_of(rippled(0.1, 0.1, 0.2), |options| options.max_iterations = 1);
        assert!(all.contains(&Warning::IterationLimit { stage: 1 }));
        assert!(all.contains(&Warning::IterationLimit { stage: 2 }));
    }

    #[test]
    fn each_repeated_direction_is_counted() {
        let mut readings = rippled(0.1, 0.1, 0.2);
        // One reading repeated as it is, and another twice with other angles of its direction.
        let theta = readings[7].theta;
        let mut repeated = [readings[3], readings[7], readings[7]];
        (repeated[1].theta, repeated[1].phi) = (-theta, PI);
        repeated[2].phi = TAU;
        readings.extend(repeated);
        let all = warnings_of(readings, |_| ());
        assert!(
            all.contains(&Warning::RepeatedReadings { count: 3 }),
            "{all:?}"
        );
    }

    #[test]
    fn the_serialised_kinds_are_those_of_the_file_format() {
        let kind = |warning: &Warning| serde_json::to_value(warning).unwrap()["kind"].clone();
        assert_eq!(
            kind(&Warning::ThetaReversed { e_percent: 1.0 }),
            "turned-round"
        );
        assert_eq!(
            kind(&Warning::ZeroWeightReadings { count: 1 }),
            "weightless-readings"
        );
        assert_eq!(
            kind(&Warning::IterationLimit { stage: 1 }),
            "iteration-limit"
        );
    }
}
