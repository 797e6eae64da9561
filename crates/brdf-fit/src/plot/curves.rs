//! The curves of a view: readings and theory of each incidence, as a screen or a figure shows them.

use std::fmt::Write as _;

use brdf_core::{AnyBrdf, Geometry};

use super::palette::{FEW_CURVES, Ground, MarkShape, colour, mark};
use super::selection::Selection;
use super::view::{Scale, View};
use crate::measurement::{Measurement, Measurements};
use crate::words::{counted, in_degrees};

/// The line of the theory ends here, in degrees: at 90 deg it may be anything.
const THEORY_END_DEG: f64 = 89.5;

/// A figure has the width of so many marks.
const FIGURE_COLUMNS: usize = 330;

/// A logarithmic axis has at the most so many decades: a single reading of next to nothing shall
/// not squeeze the others.
pub(super) const DECADES: i32 = 6;

/// The standard error of the theory in 1/sr at a geometry.
pub(super) type Sigma<'a> = Option<&'a dyn Fn(&Geometry) -> f64>;

/// One incidence.
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
    /// Its place among the measurements.
    pub index: usize,
    /// View angle in degrees, signed as the view says.
    pub theta_deg: f64,
    /// What was measured, in the quantity of the view.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: Option<f64>,
    /// The theory there.
    pub theory: f64,
}

/// The theory at one view angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Theory {
    /// View angle in degrees, signed as the view says.
    pub theta_deg: f64,
    /// Its value, in the quantity of the view.
    pub value: f64,
    /// Its standard error, where it is known and positive.
    pub sigma: Option<f64>,
}

impl Reading {
    /// Measured less theory.
    pub fn residual(&self) -> f64 {
        self.value - self.theory
    }
}

/// The curves of a selection, one for each of its traces. `sigma` gives the standard error of the
/// theory in 1/sr at a geometry.
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

/// The theory alone in the plane of incidence, at incidences psi in radians.
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

fn theory(brdf: &AnyBrdf, psi: f64, sigma: Sigma, view: &View) -> Vec<Theory> {
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

/// Half degrees, and closer and closer ones beside the mirror direction, where a peak may be
/// narrower than any step. In degrees.
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

/// The ends of the axis of a view: its readings with their error bars, and the theory beside them.
/// `None` where a logarithmic axis has nothing positive to show.
///
/// Of the theory that is what lies within the readings of its incidence. It and the error bars count
/// up to three times the largest reading of all: beyond, they may be many times as large as any. A
/// logarithmic axis has 6 decades at the most.
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

/// Readings with the upper ends of their error bars, and the theory with that of its band, which
/// the axis of a figure has to hold.
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
    let theory = curves.flat_map(Curve::theory_beside_readings);
    let theory = theory.flat_map(|theory| {
        let sigma = theory.sigma.unwrap_or(0.0);
        [theory.value, theory.value + sigma]
    });
    measured.chain(theory.filter(move |value| *value <= highest))
}

/// The lower ends of the error bars, as far down as the axis goes up. On a logarithmic axis they may
/// lie at any depth.
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
    /// The incidence in words.
    pub(super) fn name(&self) -> String {
        format!(
            "psi = {} deg",
            (in_degrees(self.psi) * 100.0).round() / 100.0
        )
    }

    /// The bands of the theory: view angle in degrees, and its value less and more its standard
    /// error. Where that is not known the band is interrupted.
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
    fn theory_beside_readings(&self) -> impl Iterator<Item = &Theory> {
        let end = |reading: Option<&Reading>, none: f64| reading.map_or(none, |r| r.theta_deg);
        let span = end(self.readings.first(), -90.0)..=end(self.readings.last(), 90.0);
        self.theory
            .iter()
            .filter(move |theory| span.contains(&theory.theta_deg))
    }
}

/// A curve with how it is drawn.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Styled {
    pub(super) curve: Curve,
    /// The name of its sample, where there are several.
    pub(super) sample: Option<String>,
    pub(super) colour: [u8; 3],
    pub(super) mark: MarkShape,
}

/// The curves of a figure, and what they leave out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curves {
    pub(super) view: View,
    /// In ascending order of incidence, sample by sample.
    pub(super) all: Vec<Styled>,
    /// Sentences for the captions, each with a blank before it.
    pub(super) left_out: String,
    /// How many readings are zero or negative, drawn or not.
    pub(super) not_positive: usize,
    /// How many are negative.
    pub(super) negative: usize,
}

/// What a figure shows of one sample.
pub(super) struct Source<'a> {
    /// Its name, where there are several.
    pub(super) name: Option<&'a str>,
    pub(super) measurements: &'a Measurements,
    pub(super) brdf: &'a AnyBrdf,
    pub(super) sigma: Sigma<'a>,
    /// Angles psi in radians; `None` takes those with readings in the plane, evenly as many as have
    /// colours of their own.
    pub(super) incidences: Option<&'a [f64]>,
    pub(super) family: Option<usize>,
}

impl Curves {
    /// The curves of some samples.
    pub(super) fn of(sources: &[Source], view: &View) -> Self {
        let mut all = Self {
            view: *view,
            all: Vec::new(),
            left_out: String::new(),
            not_positive: 0,
            negative: 0,
        };
        for source in sources {
            all.add(source);
        }
        all
    }

    /// The theory alone, at incidence angles in degrees.
    pub(super) fn of_theory(brdf: &AnyBrdf, psi_deg: &[f64]) -> Self {
        let incidences: Vec<f64> = psi_deg.iter().map(|psi| psi.to_radians()).collect();
        let source = Source {
            name: None,
            measurements: &Measurements::default(),
            brdf,
            sigma: None,
            incidences: Some(&incidences),
            family: None,
        };
        Self::of(&[source], &View::default())
    }

    fn add(&mut self, source: &Source) {
        let view = self.view;
        let of = |incidences: Option<&[f64]>| {
            Selection::of(source.measurements, &view, incidences, FIGURE_COLUMNS)
        };
        let mut selection = of(source.incidences);
        if source.incidences.is_none() {
            selection.traces.retain(|trace| trace.all > 0);
        }
        let known = selection.traces.len();
        let in_plane = selection.all();
        if source.incidences.is_none() {
            selection.traces = evenly(&selection.traces, FEW_CURVES);
        }
        self.left_out += &left_out(source, &view, &selection, known, in_plane);
        self.not_positive += selection.not_positive();
        self.negative += selection.negative();
        let all = curves(
            source.measurements,
            &selection,
            source.brdf,
            source.sigma,
            &view,
        );
        let count = all.len();
        for (i, curve) in all.into_iter().enumerate() {
            self.all.push(Styled {
                curve,
                sample: source.name.map(str::to_owned),
                colour: colour(source.family, i, count, Ground::Light),
                mark: mark(source.family, i),
            });
        }
    }

    /// The curves without their looks.
    pub(super) fn plain(&self) -> impl Iterator<Item = &Curve> + Clone {
        self.all.iter().map(|styled| &styled.curve)
    }

    /// All readings that are shown.
    pub(super) fn readings(&self) -> impl Iterator<Item = &Reading> {
        self.plain().flat_map(|curve| &curve.readings)
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
        let mut theory = self.plain().flat_map(|curve| &curve.theory);
        theory.any(|theory| theory.sigma.is_some())
    }
}

/// At most so many of the items, evenly from the first to the last.
pub(super) fn evenly<T: Clone>(items: &[T], most: usize) -> Vec<T> {
    if items.len() <= most {
        return items.to_vec();
    }
    let last = items.len() - 1;
    (0..most)
        .map(|i| items[i * last / (most - 1)].clone())
        .collect()
}

/// What is not shown of a sample; `known` incidences with `in_plane` readings could be.
fn left_out(
    source: &Source,
    view: &View,
    selection: &Selection,
    known: usize,
    in_plane: usize,
) -> String {
    let mut sentences = String::new();
    let readings = source.measurements.readings().len();
    let out_of_plane = readings.saturating_sub(in_plane);
    if source.incidences.is_none() && out_of_plane > 0 {
        let verb = if out_of_plane == 1 { "is" } else { "are" };
        let count = counted(out_of_plane, "reading");
        let plane = if view.in_plane() {
            "the plane of incidence"
        } else {
            "this plane"
        };
        let _ = write!(sentences, " {count} out of {plane} {verb} not shown.");
    }
    let all = match source.incidences {
        None => known,
        Some(_) => source.measurements.incidences().len(),
    };
    let some = selection.traces.len();
    if some < all {
        let _ = write!(sentences, " {some} of {all} incidences are shown.");
    }
    if selection.shown() < selection.all() {
        let (some, all) = (selection.shown(), selection.all());
        let _ = write!(
            sentences,
            " {some} of {all} readings are drawn: of those closer together than a mark is wide the \
             first, the lowest and the highest."
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
            let angles = theory_angles(Some(-psi_deg));
            assert!(angles.contains(&-psi_deg));
            assert!(angles.iter().all(|angle| angle.abs() <= THEORY_END_DEG));
        }
        assert!(!theory_angles(None).is_empty());
    }
}
