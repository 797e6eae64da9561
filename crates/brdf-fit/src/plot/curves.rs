//! What of the readings and of the theory the figures of the view angle show: readings in the
//! plane of incidence, a few incidences, and the theory's line for each.

use std::fmt::Write as _;

use brdf_core::{AnyBrdf, Geometry};

use super::Sigma;
use super::style::MOST_CURVES;
use crate::measurement::{Incidence, Measurement, Measurements};
use crate::words::{counted, in_degrees};

/// More readings of an incidence than this cannot be told apart in a figure.
const MOST_READINGS: usize = 1000;

/// The line of the theory ends here, in degrees: at 90 deg it may be anything.
const THEORY_END_DEG: f64 = 89.5;

/// The curves of the figures, and what they leave out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curves {
    /// In ascending order of incidence.
    pub(super) curves: Vec<Curve>,
    /// Sentences for the captions, each with a blank before it.
    pub(super) left_out: String,
}

/// One incidence.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curve {
    /// Incidence angle in degrees.
    pub(super) psi_deg: f64,
    /// The readings in the plane of incidence, in ascending order of view angle.
    pub(super) readings: Vec<Reading>,
    /// The theory, in ascending order of view angle.
    pub(super) theory: Vec<Theory>,
}

/// A reading in the plane of incidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reading {
    /// Signed view angle in degrees.
    pub(super) theta_deg: f64,
    /// Measured f_r in 1/sr.
    pub(super) brdf: f64,
    /// Its standard deviation in 1/sr.
    pub(super) sigma: Option<f64>,
    /// Measured less theory in 1/sr.
    pub(super) residual: f64,
}

/// The theory at one view angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Theory {
    /// Signed view angle in degrees.
    pub(super) theta_deg: f64,
    /// f_r in 1/sr.
    pub(super) brdf: f64,
    /// Its standard error in 1/sr, where it is known and positive.
    pub(super) sigma: Option<f64>,
}

impl Curves {
    pub(super) fn of(measurements: &Measurements, brdf: &AnyBrdf, sigma: Sigma) -> Self {
        let readings = measurements.readings();
        let in_plane: Vec<Incidence> = measurements
            .incidences()
            .into_iter()
            .filter_map(|incidence| only_in_plane(incidence, readings))
            .collect();
        let shown = evenly(&in_plane, MOST_CURVES);
        let curves = shown.iter().map(|incidence| Curve {
            psi_deg: in_degrees(incidence.psi),
            readings: shown_readings(incidence, readings, brdf),
            theory: theory(brdf, incidence.psi, sigma),
        });
        Self {
            curves: curves.collect(),
            left_out: left_out(readings.len(), &in_plane, &shown),
        }
    }

    /// The theory alone, at incidence angles in degrees.
    pub(super) fn of_theory(brdf: &AnyBrdf, psi_deg: &[f64]) -> Self {
        let curves = psi_deg.iter().map(|&psi_deg| Curve {
            psi_deg,
            readings: Vec::new(),
            theory: theory(brdf, psi_deg.to_radians(), None),
        });
        Self {
            curves: curves.collect(),
            left_out: String::new(),
        }
    }

    /// All readings that are shown.
    pub(super) fn readings(&self) -> impl Iterator<Item = &Reading> {
        self.curves.iter().flat_map(|curve| &curve.readings)
    }

    /// Readings with the upper ends of their error bars, and the theory with that of its band,
    /// which the axis of a figure has to hold.
    ///
    /// Of the theory that is what lies within the readings of its incidence and not above three
    /// times the largest of all: beyond, it may be many times as large as any reading.
    pub(super) fn values(&self) -> impl Iterator<Item = f64> {
        let measured = self.readings().flat_map(|reading| {
            let sigma = reading.sigma.unwrap_or(0.0);
            [reading.brdf, reading.brdf + sigma]
        });
        let largest = self.readings().map(|reading| reading.brdf);
        let highest = match 3.0 * largest.fold(0.0, f64::max) {
            0.0 => f64::INFINITY,
            highest => highest,
        };
        let theory = self.curves.iter().flat_map(Curve::theory_beside_readings);
        let theory = theory.flat_map(|theory| {
            let sigma = theory.sigma.unwrap_or(0.0);
            [theory.brdf, theory.brdf + sigma]
        });
        measured.chain(theory.filter(move |value| *value <= highest))
    }

    /// The lower ends of the error bars. On a logarithmic axis they may lie at any depth.
    pub(super) fn lower_ends(&self) -> impl Iterator<Item = f64> {
        self.readings()
            .filter_map(|reading| Some(reading.brdf - reading.sigma?))
    }

    /// Whether any reading is shown.
    pub(super) fn measured(&self) -> bool {
        self.readings().next().is_some()
    }

    /// Whether any reading has an error bar.
    pub(super) fn error_bars(&self) -> bool {
        self.readings().any(|reading| reading.sigma.is_some())
    }

    /// Whether the theory has a band.
    pub(super) fn bands(&self) -> bool {
        let mut theory = self.curves.iter().flat_map(|curve| &curve.theory);
        theory.any(|theory| theory.sigma.is_some())
    }
}

impl Curve {
    /// The incidence in words.
    pub(super) fn name(&self) -> String {
        format!("psi = {} deg", (self.psi_deg * 100.0).round() / 100.0)
    }

    /// The bands of the theory: view angle in degrees, and f_r less and more its standard error.
    /// Where that is not known the band is interrupted.
    pub(super) fn bands(&self) -> Vec<Vec<(f64, [f64; 2])>> {
        let ends = |theory: &Theory| {
            let sigma = theory.sigma?;
            Some((theory.theta_deg, [theory.brdf - sigma, theory.brdf + sigma]))
        };
        self.theory
            .chunk_by(|a, b| a.sigma.is_some() && b.sigma.is_some())
            .map(|run| run.iter().filter_map(ends).collect::<Vec<_>>())
            .filter(|band| band.len() > 1)
            .collect()
    }

    /// The theory between the first and the last reading; all of it where there is no reading.
    fn theory_beside_readings(&self) -> impl Iterator<Item = &Theory> {
        let end = |reading: Option<&Reading>, none: f64| reading.map_or(none, |r| r.theta_deg);
        let span = end(self.readings.first(), -90.0)..=end(self.readings.last(), 90.0);
        self.theory
            .iter()
            .filter(move |theory| span.contains(&theory.theta_deg))
    }
}

fn only_in_plane(mut incidence: Incidence, readings: &[Measurement]) -> Option<Incidence> {
    let in_plane = |i: &usize| readings[*i].in_plane_theta().is_some();
    incidence.readings.retain(in_plane);
    (!incidence.readings.is_empty()).then_some(incidence)
}

/// At most so many of the items, evenly from the first to the last.
fn evenly<T: Clone>(items: &[T], most: usize) -> Vec<T> {
    if items.len() <= most {
        return items.to_vec();
    }
    let last = items.len() - 1;
    (0..most)
        .map(|i| items[i * last / (most - 1)].clone())
        .collect()
}

fn shown_readings(incidence: &Incidence, readings: &[Measurement], brdf: &AnyBrdf) -> Vec<Reading> {
    let of = |reading: &Measurement| {
        Some(Reading {
            theta_deg: reading.in_plane_theta()?.to_degrees(),
            brdf: reading.brdf,
            sigma: reading.sigma,
            residual: reading.brdf - brdf.value(&reading.geometry().ok()?),
        })
    };
    let mut shown: Vec<Reading> = incidence
        .readings
        .iter()
        .filter_map(|&i| of(&readings[i]))
        .collect();
    shown.sort_by(|a, b| a.theta_deg.total_cmp(&b.theta_deg));
    evenly(&shown, MOST_READINGS)
}

fn theory(brdf: &AnyBrdf, psi: f64, sigma: Sigma) -> Vec<Theory> {
    let at = |theta_deg: f64| {
        let geometry = Geometry::in_plane(psi, theta_deg.to_radians()).ok()?;
        let sigma = sigma.map(|sigma| sigma(&geometry));
        Some(Theory {
            theta_deg,
            brdf: brdf.value(&geometry),
            sigma: sigma.filter(|sigma| *sigma > 0.0 && sigma.is_finite()),
        })
    };
    theory_angles(psi.to_degrees())
        .into_iter()
        .filter_map(at)
        .collect()
}

/// Half degrees, and closer and closer ones beside the mirror direction, where a peak may be
/// narrower than any step. In degrees.
fn theory_angles(psi_deg: f64) -> Vec<f64> {
    let half_degrees = (-179..=179).map(|half| 0.5 * f64::from(half));
    let beside = (0..40).map(|i| 10_f64.powf(-0.1 * f64::from(i)));
    let offsets = beside.flat_map(|offset| [-offset, offset]).chain([0.0]);
    let mut angles: Vec<f64> = half_degrees
        .chain(offsets.map(|offset| offset - psi_deg))
        .filter(|angle| angle.abs() <= THEORY_END_DEG)
        .collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    angles
}

fn left_out(readings: usize, in_plane: &[Incidence], shown: &[Incidence]) -> String {
    let mut sentences = String::new();
    let count = |of: &[Incidence]| of.iter().map(|i| i.readings.len()).sum::<usize>();
    let out_of_plane = readings - count(in_plane);
    if out_of_plane > 0 {
        let verb = if out_of_plane == 1 { "is" } else { "are" };
        let count = counted(out_of_plane, "reading");
        let _ = write!(
            sentences,
            " {count} out of the plane of incidence {verb} not shown."
        );
    }
    if shown.len() < in_plane.len() {
        let (some, all) = (shown.len(), in_plane.len());
        let _ = write!(sentences, " {some} of {all} incidences are shown.");
    }
    if shown.iter().any(|i| i.readings.len() > MOST_READINGS) {
        let _ = write!(
            sentences,
            " Of each incidence at most {MOST_READINGS} readings are shown."
        );
    }
    sentences
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_choice_is_even_and_has_both_ends() {
        let all: Vec<usize> = (0..90).collect();
        let chosen = evenly(&all, 8);
        assert_eq!(chosen, [0, 12, 25, 38, 50, 63, 76, 89]);
        assert_eq!(evenly(&all[..3], 8), [0, 1, 2]);
    }

    #[test]
    fn the_mirror_direction_is_among_the_angles() {
        for psi_deg in [0.0, 33.3, 89.0] {
            let angles = theory_angles(psi_deg);
            assert!(angles.contains(&-psi_deg));
            assert!(angles.iter().all(|angle| angle.abs() <= THEORY_END_DEG));
        }
        assert!(!theory_angles(90.0).is_empty());
    }
}
