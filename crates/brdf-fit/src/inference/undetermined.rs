//! Whether the readings determine a parameter at all, by the profile of E that the global check has
//! computed: the minimum of E over the other parameters, as a function of one of them.

use brdf_core::ModelParameters;

use super::estimate::{Estimate, Knowledge};
use super::uncertainty::Width;
use crate::fit::Solution;
use crate::fit::grid_search::{ProfilePoint, fixed_weights, solve_for};
use crate::model::{K1_RANGE, Parameter};
use crate::progress::{Cancelled, Progress};

/// An interval on a logarithmic scale that reaches this factor up and down says nothing.
const WIDEST_FACTOR: f64 = 10.0;

const NARROWER: &str = "any narrower peak fits equally well: the scan does not resolve its width";
const WIDER: &str = "any wider distribution fits equally well: the readings have no peak";

/// The ends of the profile of E along a parameter, each with the point next to it.
struct Ends {
    parameter: Parameter,
    lowest: [ProfilePoint; 2],
    highest: [ProfilePoint; 2],
}

/// What shows that a parameter is not determined.
pub(super) struct Undetermined {
    ends: Vec<Ends>,
    /// The lowest E of the search and the fit.
    least: f64,
    /// E of the best model without a specular part.
    without_lobe: f64,
}

impl Undetermined {
    pub(super) fn new(fitted: &Solution, progress: &Progress<'_>) -> Result<Self, Cancelled> {
        let search = fitted.grid_search(progress)?;
        let (profile, model) = (search.whole(), fitted.fit.options.reduced_model());
        let ends = [Parameter::K1, Parameter::N, Parameter::P]
            .into_iter()
            .filter(|parameter| model.free().contains(parameter))
            .filter_map(|parameter| {
                let points = profile.along(parameter);
                let [.., next, last] = *points else {
                    return None;
                };
                Some(Ends {
                    parameter,
                    lowest: [points[0], points[1]],
                    highest: [last, next],
                })
            })
            .collect();
        let at = fitted.fit.at();
        let searched = fitted.searched();
        let kd = fixed_weights(model)[1];
        let (_, _, without_lobe) = solve_for([Some(0.0), kd], &searched.profile_sums(&at));
        Ok(Self {
            ends,
            least: profile.lowest().error.min(searched.error(&at)),
            without_lobe,
        })
    }

    fn ends(&self, parameter: Parameter) -> Option<&Ends> {
        self.ends.iter().find(|ends| ends.parameter == parameter)
    }

    /// Why a parameter of this value and width is not determined; `None` where it is.
    pub(super) fn reason(
        &self,
        parameter: Parameter,
        value: f64,
        width: &Width,
    ) -> Option<&'static str> {
        let fits = |error: f64| error - self.least < width.growth_95;
        let (below, above) = self.ends(parameter).map_or((false, false), |ends| {
            (fits(ends.lowest[0].error), fits(ends.highest[0].error))
        });
        let reaches = |scale: f64| width.half_95 > scale * WIDEST_FACTOR.ln();
        match parameter {
            Parameter::K2 if fits(self.without_lobe) => {
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
    pub(super) fn width_at_limit(&self, k1: f64) -> &'static str {
        if k1 <= K1_RANGE.0 { NARROWER } else { WIDER }
    }

    /// Marks k2 as not determined where k1 is not and k2 depends on it: on the flank of a narrow
    /// peak the readings determine only k2 k1^2.
    pub(super) fn release(&self, estimates: &mut [Estimate]) {
        let width = estimates.iter().find(|e| e.parameter == Parameter::K1);
        let Some(Knowledge::NotDetermined { reason, .. }) = width.map(|e| &e.knowledge) else {
            return;
        };
        let Some(ends) = self.ends(Parameter::K1) else {
            return;
        };
        let [end, next] = if reason == WIDER {
            ends.highest
        } else {
            ends.lowest
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
