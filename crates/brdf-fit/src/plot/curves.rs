//! The curves of a view: readings and theory of each incidence, for figures and for screens.

use brdf_core::{AnyBrdf, Geometry};

use super::selection::Selection;
use super::view::{Scale, View};
use crate::format::in_degrees;
use crate::scan::{Measurement, Measurements};

/// The view angle in degrees at which the theory ends: at 90 deg it may diverge.
const THEORY_END_DEG: f64 = 89.5;

/// The width of a figure in marks.
pub(super) const FIGURE_COLUMNS: usize = 330;

/// The most decades of a logarithmic axis, so that a single reading close to zero does not squeeze
/// all other ones.
pub(super) const DECADES: i32 = 6;

/// The standard error of the theory in 1/sr at a geometry.
pub(super) type StandardError<'a> = Option<&'a dyn Fn(&Geometry) -> f64>;

/// Readings and theory of one incidence.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Incidence angle psi in radians.
    pub psi: f64,
    /// The readings, in ascending order of view angle.
    pub readings: Vec<Reading>,
    /// The theory, in ascending order of view angle.
    pub theory: Vec<Theory>,
}

/// A reading as it is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Its index among the measurements.
    pub index: usize,
    /// View angle in degrees, with the sign convention of the view.
    pub theta_deg: f64,
    /// The measured value, in the quantity of the view.
    pub value: f64,
    /// Standard deviation of the measured value.
    pub sigma: Option<f64>,
    /// The theory in the direction of the reading.
    pub theory: f64,
}

/// The theory at one view angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Theory {
    /// View angle in degrees, with the sign convention of the view.
    pub theta_deg: f64,
    /// The value, in the quantity of the view.
    pub value: f64,
    /// Standard error of the value, where it is known and positive.
    pub sigma: Option<f64>,
}

impl Reading {
    /// Measured value minus theory.
    pub fn residual(&self) -> f64 {
        self.value - self.theory
    }
}

/// The curves of a selection, one for each of its traces. `sigma` is the standard error of the
/// theory in 1/sr at a geometry.
///
/// Readings at angles outside the domain of the model are left out.
pub fn curves(
    measurements: &Measurements,
    selection: &Selection,
    brdf: &AnyBrdf,
    sigma: Option<&dyn Fn(&Geometry) -> f64>,
    view: &View,
) -> Vec<Curve> {
    let all = measurements.readings();
    let curve = |psi: f64, readings: &[usize]| Curve {
        psi,
        readings: readings
            .iter()
            .filter_map(|&i| shown_reading(i, &all[i], brdf, view))
            .collect(),
        theory: theory(brdf, psi, sigma, view),
    };
    selection
        .traces
        .iter()
        .map(|trace| curve(trace.psi, &trace.readings))
        .collect()
}

/// The theory without readings in the plane of incidence, at incidence angles psi in radians.
pub fn theory_curves(brdf: &AnyBrdf, incidences: &[f64]) -> Vec<Curve> {
    let (none, view) = (Measurements::default(), View::default());
    let selection = Selection::of(&none, &view, Some(incidences), FIGURE_COLUMNS);
    curves(&none, &selection, brdf, None, &view)
}

fn shown_reading(i: usize, of: &Measurement, brdf: &AnyBrdf, view: &View) -> Option<Reading> {
    let at = of.geometry().ok()?;
    let quantity = |brdf: f64| view.quantity.of(brdf, at.cos_theta());
    Some(Reading {
        index: i,
        theta_deg: view.signed_deg(of.theta_in_plane(view.azimuth)?),
        value: quantity(of.brdf),
        sigma: of.sigma.map(quantity),
        theory: quantity(brdf.value(&at)),
    })
}

fn theory(brdf: &AnyBrdf, psi: f64, sigma: StandardError, view: &View) -> Vec<Theory> {
    let at = |theta_deg: f64| {
        let geometry = Geometry::new(psi, view.theta(theta_deg), view.azimuth).ok()?;
        let quantity = |brdf: f64| view.quantity.of(brdf, geometry.cos_theta());
        let sigma = sigma.map(|sigma| quantity(sigma(&geometry)));
        Some(Theory {
            theta_deg,
            value: quantity(brdf.value(&geometry)),
            sigma: sigma.filter(|sigma| *sigma > 0.0 && sigma.is_finite()),
        })
    };
    theory_angles(view.mirror_deg(psi))
        .into_iter()
        .filter_map(at)
        .collect()
}

/// View angles in degrees: every half degree, and increasingly dense ones towards the mirror
/// direction, where a peak may be narrower than any fixed step.
fn theory_angles(mirror_deg: Option<f64>) -> Vec<f64> {
    let half_degrees = (-179..=179).map(|half| 0.5 * f64::from(half));
    let beside = (0..40).map(|i| 10_f64.powf(-0.1 * f64::from(i)));
    let offsets = beside.flat_map(|offset| [-offset, offset]).chain([0.0]);
    let at_mirror = mirror_deg
        .into_iter()
        .flat_map(|mirror| offsets.clone().map(move |offset| mirror + offset));
    let mut angles: Vec<f64> = half_degrees
        .chain(at_mirror)
        .filter(|angle| angle.abs() <= THEORY_END_DEG)
        .collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    angles
}

/// The ends of the axis of values: the range of the readings with their error bars and of the theory
/// between them. `None` where a logarithmic axis has nothing positive to show.
///
/// The theory counts between the first and the last reading of its incidence. Theory and error bars
/// count only up to three times the largest reading, because they may exceed all readings many
/// times. A logarithmic axis has at most 6 decades.
pub fn value_range<'a>(
    curves: impl Iterator<Item = &'a Curve> + Clone,
    scale: Scale,
) -> Option<(f64, f64)> {
    let high = values(curves.clone()).fold(f64::NEG_INFINITY, f64::max);
    match scale {
        Scale::Linear => {
            let low = values(curves.clone()).chain(lower_ends(curves));
            let low = low.fold(0.0, f64::min);
            let high = high.max(0.0);
            let margin = 0.04 * (high - low);
            let below = if low < 0.0 { margin } else { 0.0 };
            (high > low).then_some((low - below, high + margin))
        }
        Scale::Logarithmic => {
            let low = values(curves).filter(|value| *value > 0.0);
            let low = low.fold(f64::INFINITY, f64::min);
            let least = high * 10_f64.powi(-DECADES);
            (high > 0.0 && low.is_finite()).then_some((low.max(least) / 1.2, high * 1.2))
        }
    }
}

/// The values that determine the upper end of an axis: readings, upper ends of their error bars,
/// theory, and upper ends of its error band.
pub(super) fn values<'a>(
    curves: impl Iterator<Item = &'a Curve> + Clone,
) -> impl Iterator<Item = f64> {
    let readings = curves.clone().flat_map(|curve| &curve.readings);
    let largest = readings.clone().map(|reading| reading.value);
    let highest = match 3.0 * largest.fold(0.0, f64::max) {
        0.0 => f64::INFINITY,
        highest => highest,
    };
    let upper_ends = readings
        .clone()
        .filter_map(|reading| Some(reading.value + reading.sigma?));
    let measured = readings
        .map(|reading| reading.value)
        .chain(upper_ends.filter(move |end| *end <= highest));
    let theory = curves.flat_map(Curve::theory_between_readings);
    let theory = theory.flat_map(|theory| {
        let sigma = theory.sigma.unwrap_or(0.0);
        [theory.value, theory.value + sigma]
    });
    measured.chain(theory.filter(move |value| *value <= highest))
}

/// The lower ends of the error bars, no further below zero than the largest value is above it.
pub(super) fn lower_ends<'a>(
    curves: impl Iterator<Item = &'a Curve> + Clone,
) -> impl Iterator<Item = f64> {
    let highest = values(curves.clone()).fold(0.0, f64::max);
    curves
        .flat_map(|curve| &curve.readings)
        .filter_map(|reading| Some(reading.value - reading.sigma?))
        .filter(move |end| *end >= -highest)
}

impl Curve {
    /// The incidence as text.
    pub(super) fn name(&self) -> String {
        format!(
            "psi = {} deg",
            (in_degrees(self.psi) * 100.0).round() / 100.0
        )
    }

    /// The error bands of the theory: view angle in degrees, and value minus and plus standard error.
    /// Where the standard error is not known the band is interrupted.
    pub(super) fn bands(&self) -> Vec<Vec<(f64, [f64; 2])>> {
        let ends = |theory: &Theory| {
            let sigma = theory.sigma?;
            let ends = [theory.value - sigma, theory.value + sigma];
            Some((theory.theta_deg, ends))
        };
        self.theory
            .chunk_by(|a, b| a.sigma.is_some() && b.sigma.is_some())
            .map(|run| run.iter().filter_map(ends).collect::<Vec<_>>())
            .filter(|band| band.len() > 1)
            .collect()
    }

    /// The theory between the first and the last reading; all of it where there is no reading.
    fn theory_between_readings(&self) -> impl Iterator<Item = &Theory> {
        let end = |reading: Option<&Reading>, none: f64| reading.map_or(none, |r| r.theta_deg);
        let span = end(self.readings.first(), -90.0)..=end(self.readings.last(), 90.0);
        self.theory
            .iter()
            .filter(move |theory| span.contains(&theory.theta_deg))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mirror_direction_is_among_the_angles() {
        for psi_deg in [0.0, 33.3, 89.0] {
            let angles = theory_angles(Some(-psi_deg));
            assert!(angles.contains(&-psi_deg));
            assert!(angles.iter().all(|angle| angle.abs() <= THEORY_END_DEG));
        }
        assert!(!theory_angles(None).is_empty());
    }
}
