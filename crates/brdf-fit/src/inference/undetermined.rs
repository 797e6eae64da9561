//! Whether the readings determine a parameter at all, by the profile of E that the global check has
//! computed: the minimum of E over the other parameters, as a function of one of them.

use brdf_core::ModelParameters;

use super::estimate::{Estimate, Interval, Knowledge};
use super::uncertainty::Width;
use crate::fit::Solution;
use crate::fit::grid_search::ProfilePoint;
use crate::model::{K1_RANGE, Parameter};
use crate::objective::solve_for;
use crate::progress::{Cancelled, Progress};
use crate::solver::{polish, unless_cancelled};

/// An interval on a logarithmic scale that reaches this factor up and down says nothing.
const WIDEST_FACTOR: f64 = 10.0;

const NARROWER: &str = "any narrower peak fits equally well: the scan does not resolve its width";
const WIDER: &str = "any wider distribution fits equally well: the readings have no peak";

/// The profile of E along a parameter: the lowest point of the grid at each of its values, in ascending
/// order.
struct Along {
    parameter: Parameter,
    points: Vec<ProfilePoint>,
}

impl Along {
    /// Minimises E at each point over the other free parameters. k1, n and p of a broad lobe have a
    /// valley so narrow that the grid misses it.
    fn polish(&mut self, fitted: &Solution, progress: &Progress<'_>) -> Result<(), Cancelled> {
        let objective = fitted.searched();
        let free = fitted.fit.options.reduced_model().free().to_vec();
        let others: Vec<Parameter> = free.into_iter().filter(|p| *p != self.parameter).collect();
        for point in &mut self.points {
            let polished = polish(objective, point.parameters, &others, progress);
            if let Some(parameters) = unless_cancelled(polished)? {
                *point = ProfilePoint {
                    parameters,
                    error: objective.error(&parameters),
                };
            }
        }
        Ok(())
    }
}

/// What shows that a parameter is not determined.
pub(super) struct Undetermined {
    profiles: Vec<Along>,
    /// The lowest E of the search and the fit.
    least: f64,
    /// E of the best model without a specular part.
    without_lobe: f64,
}

impl Undetermined {
    pub(super) fn new(fitted: &Solution, progress: &Progress<'_>) -> Result<Self, Cancelled> {
        let search = fitted.grid_search(progress)?;
        let (profile, model) = (search.whole(), fitted.fit.options.reduced_model());
        let mut profiles: Vec<Along> = [Parameter::K1, Parameter::N, Parameter::P]
            .into_iter()
            .filter(|parameter| model.free().contains(parameter))
            .map(|parameter| Along {
                parameter,
                points: profile.along(parameter),
            })
            .filter(|along| along.points.len() > 1)
            .collect();
        if let Some(along) = profiles
            .iter_mut()
            .find(|along| along.parameter == Parameter::P)
        {
            along.polish(fitted, progress)?;
        }
        let at = fitted.fit.at();
        let searched = fitted.searched();
        let kd = model.fixed_weights()[1];
        let (_, _, without_lobe) = solve_for([Some(0.0), kd], &searched.profile_sums(&at));
        Ok(Self {
            profiles,
            least: profile.lowest().error.min(searched.error(&at)),
            without_lobe,
        })
    }

    fn points(&self, parameter: Parameter) -> &[ProfilePoint] {
        let along = self
            .profiles
            .iter()
            .find(|along| along.parameter == parameter);
        along.map_or(&[], |along| &along.points)
    }

    /// Whether E is as low as anywhere in an interval of this width.
    fn fits(&self, error: f64, width: &Width) -> bool {
        error - self.least < width.growth_95
    }

    /// The interval of the linear theory. With a free exponent it is widened to the points of the profile
    /// that fit as well: the valley of E in k1 and p is bent, and longer than it seems at its lowest
    /// point.
    pub(super) fn widened(&self, parameter: Parameter, own: Interval, width: &Width) -> Interval {
        let along_p = self.points(Parameter::P).iter();
        if along_p.len() == 0 {
            return own;
        }
        let fitting = along_p
            .chain(self.points(parameter))
            .filter(|point| self.fits(point.error, width))
            .map(|point| parameter.of(&point.parameters));
        fitting.fold(own, |interval, value| Interval {
            from: interval.from.map(|from| from.min(value)),
            to: interval.to.map(|to| to.max(value)),
        })
    }

    /// Why a parameter of this value and width is not determined; `None` where it is.
    pub(super) fn reason(
        &self,
        parameter: Parameter,
        value: f64,
        width: &Width,
    ) -> Option<&'static str> {
        let fits =
            |point: Option<&ProfilePoint>| point.is_some_and(|point| self.fits(point.error, width));
        let points = self.points(parameter);
        let (below, above) = (fits(points.first()), fits(points.last()));
        let reaches = |scale: f64| width.half_95 > scale * WIDEST_FACTOR.ln();
        match parameter {
            Parameter::K2 if self.fits(self.without_lobe, width) => {
                Some("the model without a specular part fits equally well")
            }
            Parameter::K1 if below && above => Some("any width fits equally well"),
            Parameter::K1 if below => Some(NARROWER),
            Parameter::K1 if above => Some(WIDER),
            Parameter::N if above => Some("any larger index fits equally well"),
            Parameter::P if below && above => Some("any exponent fits equally well"),
            Parameter::P if below => Some("any smaller exponent fits equally well"),
            Parameter::P if above => Some("any larger exponent fits equally well"),
            Parameter::Kd if value <= width.half_95 && value + width.half_95 >= 1.0 => {
                Some("any weight from 0 to 1 fits equally well")
            }
            Parameter::N if reaches(value - 1.0) => Some(WIDE),
            Parameter::K2 | Parameter::K1 | Parameter::P if reaches(value) => Some(WIDE),
            _ => None,
        }
    }

    /// Why a k1 at the end of its range is not determined.
    pub(super) fn width_at_limit(k1: f64) -> &'static str {
        if k1 <= K1_RANGE.0 { NARROWER } else { WIDER }
    }

    /// Marks k2 as not determined where k1 is not and k2 depends on it: on the flank of a narrow
    /// peak the readings determine only k2 k1^2.
    pub(super) fn release(&self, estimates: &mut [Estimate]) {
        let width = estimates.iter().find(|e| e.parameter == Parameter::K1);
        let Some(Knowledge::NotDetermined { reason, .. }) = width.map(|e| &e.knowledge) else {
            return;
        };
        let (end, next) = match self.points(Parameter::K1) {
            [.., next, end] if reason == WIDER => (end, next),
            [end, next, ..] => (end, next),
            _ => return,
        };
        let logarithm = |of: fn(&ModelParameters) -> f64| {
            (of(&end.parameters) / of(&next.parameters)).ln().abs()
        };
        let follows = logarithm(|at| at.k2) > STEEP * logarithm(|at| at.k1);
        let weight = estimates.iter_mut().find(|e| e.parameter == Parameter::K2);
        if let Some(weight) = weight.filter(|_| follows) {
            weight.knowledge =
                Knowledge::not_determined("it depends on k1, which is not determined");
        }
    }
}

/// k2 depends on k1 where it changes by more than this power of it.
const STEEP: f64 = 0.5;

const WIDE: &str = "its interval of 95 % spans more than a factor of 100";

/// Whether a parameter is on a bound of its range.
pub(super) fn is_on_bound(parameter: Parameter, at: &ModelParameters) -> bool {
    let (lowest, highest) = parameter.range();
    let value = parameter.of(at);
    value <= lowest || value >= highest
}

/// Whether the model depends on a parameter: without a specular lobe neither width nor index nor
/// exponent has an effect.
pub(super) fn has_effect(parameter: Parameter, at: &ModelParameters) -> bool {
    at.k2 > 0.0 || matches!(parameter, Parameter::K2 | Parameter::Kd)
}
