//! The curves of a figure with their colours and marks, and what the figure leaves out.

use std::fmt::Write as _;

use brdf_core::AnyBrdf;

use super::curves::{Curve, FIGURE_COLUMNS, Reading, StandardError, curves};
use super::palette::{FEW_CURVES, MarkShape, Rgb, colour, mark};
use super::selection::{Selection, evenly};
use super::view::View;
use crate::format::counted;
use crate::scan::Measurements;

/// A curve with its appearance.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Styled {
    pub(super) curve: Curve,
    /// The name of its sample, where there are several.
    pub(super) sample: Option<String>,
    pub(super) colour: Rgb,
    pub(super) mark: MarkShape,
}

/// The curves of a figure.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curves {
    pub(super) view: View,
    /// In ascending order of incidence, sample by sample.
    pub(super) all: Vec<Styled>,
    /// Sentences for the caption about what is left out, each with a blank before it.
    pub(super) left_out: String,
    /// How many readings are zero or negative, drawn or not.
    pub(super) not_positive: usize,
    /// How many readings are negative, drawn or not.
    pub(super) negative: usize,
}

/// What a figure shows of one sample.
pub(super) struct Source<'a> {
    /// Its name, where there are several samples.
    pub(super) name: Option<&'a str>,
    pub(super) measurements: &'a Measurements,
    pub(super) brdf: &'a AnyBrdf,
    pub(super) sigma: StandardError<'a>,
    /// Incidence angles psi in radians; `None` chooses from those with readings in the plane, evenly
    /// as many as there are distinct colours.
    pub(super) incidences: Option<&'a [f64]>,
    /// The family of colours, where there are several samples.
    pub(super) family: Option<usize>,
}

impl Curves {
    /// The curves of several samples.
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

    /// The theory without readings, at incidence angles in degrees.
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
        let choice = Choice::of(source, &self.view);
        self.left_out += &choice.left_out(source, &self.view);
        let selection = &choice.selection;
        self.not_positive += selection.not_positive();
        self.negative += selection.negative();
        let curves = curves(
            source.measurements,
            selection,
            source.brdf,
            source.sigma,
            &self.view,
        );
        let count = curves.len();
        let styled = curves.into_iter().enumerate().map(|(i, curve)| Styled {
            curve,
            sample: source.name.map(str::to_owned),
            colour: colour(source.family, i, count, self.view.ground),
            mark: mark(source.family, i),
        });
        self.all.extend(styled);
    }

    /// The curves without their appearance.
    pub(super) fn plain(&self) -> impl Iterator<Item = &Curve> + Clone {
        self.all.iter().map(|styled| &styled.curve)
    }

    /// All readings that are drawn.
    pub(super) fn readings(&self) -> impl Iterator<Item = &Reading> {
        self.plain().flat_map(|curve| &curve.readings)
    }

    /// Whether any reading is drawn.
    pub(super) fn has_readings(&self) -> bool {
        self.readings().next().is_some()
    }

    /// Whether any reading has an error bar.
    pub(super) fn has_error_bars(&self) -> bool {
        self.readings().any(|reading| reading.sigma.is_some())
    }

    /// Whether the theory has an error band.
    pub(super) fn has_bands(&self) -> bool {
        let mut theory = self.plain().flat_map(|curve| &curve.theory);
        theory.any(|theory| theory.sigma.is_some())
    }
}

/// The incidences of a sample that are drawn, and their readings.
struct Choice {
    selection: Selection,
    /// How many incidences there were to choose from.
    incidences: usize,
    /// How many readings those have in the plane.
    in_plane: usize,
}

impl Choice {
    fn of(source: &Source, view: &View) -> Self {
        let mut selection =
            Selection::of(source.measurements, view, source.incidences, FIGURE_COLUMNS);
        if source.incidences.is_none() {
            selection.traces.retain(|trace| trace.all > 0);
        }
        let incidences = match source.incidences {
            None => selection.traces.len(),
            Some(_) => source.measurements.incidences().len(),
        };
        let in_plane = selection.all();
        if source.incidences.is_none() {
            selection.traces = evenly(&selection.traces, FEW_CURVES);
        }
        Self {
            selection,
            incidences,
            in_plane,
        }
    }

    /// Sentences about the readings and incidences that are not drawn.
    fn left_out(&self, source: &Source, view: &View) -> String {
        let mut sentences = String::new();
        let readings = source.measurements.readings().len();
        let out_of_plane = readings.saturating_sub(self.in_plane);
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
        let (some, all) = (self.selection.traces.len(), self.incidences);
        if some < all {
            let _ = write!(sentences, " {some} of {all} incidences are shown.");
        }
        let (some, all) = (self.selection.shown(), self.selection.all());
        if some < all {
            let _ = write!(
                sentences,
                " {some} of {all} readings are drawn: of those closer together than a mark is wide \
                 the first, the lowest and the highest."
            );
        }
        sentences
    }
}
