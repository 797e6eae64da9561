//! Which model of the hierarchy suffices for a scan, by the prediction of incidences that a model has
//! not seen.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::model_comparison::Candidate;
use crate::format::two_digits;
use crate::model::Model;

/// A model whose typical error exceeds that of the best by no more than this fraction is not told
/// apart from it.
pub const VERDICT_MARGIN: f64 = 0.1;

/// Above this typical error of the best prediction, in percent, no model predicts incidences that it
/// has not seen.
pub const NOT_PREDICTED_PERCENT: f64 = 30.0;

/// The fewest predicted incidences that allow a verdict.
const FEWEST_INCIDENCES: usize = 3;

/// Which model of the hierarchy suffices for a scan.
///
/// Each model is fitted with the weights of relative errors to all incidences but one, which is then
/// predicted: see [`RelativePrediction`](super::RelativePrediction). With L the logarithm of the error of
/// an incidence, a model is not told apart from the best where the mean of its L exceeds that of the
/// best by at most ln 1.1 or one standard error of the difference over incidences, whichever is
/// larger. Of those models the one with the fewest parameters suffices, and of several the one with
/// the best prediction.
///
/// The rule prefers relative accuracy. It compares models with each other; a scan does not show which
/// is true.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The model that suffices; `None` where the best prediction errs by more than
    /// [`NOT_PREDICTED_PERCENT`].
    pub model: Option<Model>,
    /// The model with the best prediction.
    pub best: Model,
    /// The typical error of the prediction of [`model`](Self::model), or of the best where there is
    /// none, in percent.
    #[serde(default)]
    pub within_percent: f64,
    /// The error of its prediction of the largest incidence, in percent: an extrapolation.
    #[serde(default)]
    pub largest_percent: f64,
    /// That incidence in degrees.
    #[serde(default)]
    pub largest_deg: f64,
    /// The other models that are not told apart from the best.
    #[serde(default)]
    pub not_told_apart: Vec<Model>,
}

/// The verdict as a clause.
impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let within = two_digits(self.within_percent);
        let Some(model) = self.model else {
            return write!(
                f,
                "no model of the hierarchy predicts incidences it has not seen: the best, {}, errs by \
                 {within} %",
                self.best
            );
        };
        write!(
            f,
            "{model} suffices: it predicts an incidence it has not seen within {within} % ({} deg, the \
             largest, within {} %)",
            self.largest_deg,
            two_digits(self.largest_percent)
        )?;
        if self.not_told_apart.is_empty() {
            write!(f, "; no other model of the hierarchy predicts as well")
        } else {
            let names: Vec<&str> = self
                .not_told_apart
                .iter()
                .map(|model| model.name())
                .collect();
            write!(f, "; not told apart from it: {}", names.join(", "))
        }
    }
}

/// The verdict on the candidates of the hierarchy; `None` where fewer than three incidences are
/// predicted.
pub(super) fn verdict(candidates: &[Candidate]) -> Option<Verdict> {
    let hierarchy = candidates
        .iter()
        .filter(|candidate| Model::HIERARCHY.contains(&candidate.model))
        .filter_map(|candidate| Some((candidate, candidate.relative_prediction.as_ref()?)));
    // Only predictions of the same incidences are comparable.
    let most = hierarchy
        .clone()
        .map(|(_, prediction)| prediction.incidences.len())
        .max()?;
    if most < FEWEST_INCIDENCES {
        return None;
    }
    let predicted: Vec<_> = hierarchy
        .filter(|(_, prediction)| prediction.incidences.len() == most)
        .collect();
    let (best, prediction) = predicted
        .iter()
        .min_by(|a, b| a.1.score().total_cmp(&b.1.score()))?;
    let not_told_apart = predicted.iter().filter(|(_, other)| {
        let (difference, standard_error) = other.difference(prediction);
        difference <= (1.0 + VERDICT_MARGIN).ln().max(standard_error)
    });
    let (chosen, own) = not_told_apart.clone().min_by(|a, b| {
        let size = |candidate: &Candidate| candidate.estimates.len();
        let by_size = size(a.0).cmp(&size(b.0));
        by_size.then(a.1.score().total_cmp(&b.1.score()))
    })?;
    let predicts = prediction.within_percent() <= NOT_PREDICTED_PERCENT;
    let shown = if predicts { own } else { prediction };
    let largest = shown.incidences.last()?;
    Some(Verdict {
        model: predicts.then_some(chosen.model),
        best: best.model,
        within_percent: shown.within_percent(),
        largest_percent: largest.within_percent(),
        largest_deg: largest.psi_deg,
        not_told_apart: not_told_apart
            .map(|(candidate, _)| candidate.model)
            .filter(|model| *model != chosen.model)
            .collect(),
    })
}

#[cfg(test)]
mod tests {
    use brdf_core::ModelParameters;

    use super::*;
    use crate::inference::cross_validation::{PredictedIncidence, RelativePrediction};
    use crate::inference::{Estimate, Knowledge};

    fn candidate(model: Model, log_errors: &[f64]) -> Candidate {
        let parameters = ModelParameters {
            k2: 0.1,
            kd: 0.1,
            k1: 0.2,
            n: 1.5,
            p: 1.0,
        };
        let incidences = (1_u8..)
            .zip(log_errors)
            .map(|(i, &error)| PredictedIncidence {
                psi_deg: f64::from(10 * i),
                log_error: Some(error),
            });
        let estimates = model.free().iter().map(|&parameter| Estimate {
            parameter,
            value: parameter.of(&parameters),
            knowledge: Knowledge::ConstrainedByEnergy,
        });
        Candidate {
            model,
            parameters,
            e_percent: 1.0,
            predicted_e_percent: Some(1.0),
            predicted_incidences: 4,
            relative_prediction: Some(RelativePrediction {
                incidences: incidences.collect(),
                not_positive: 0,
            }),
            estimates: estimates.collect(),
            violation_deg: None,
        }
    }

    #[test]
    fn the_smallest_model_that_is_not_told_apart_from_the_best_suffices() {
        let verdict = verdict(&[
            candidate(Model::Lambert, &[0.5, 0.5, 0.5, 0.5]),
            candidate(Model::Three, &[0.108, 0.109, 0.107, 0.108]),
            candidate(Model::ThreeN, &[0.1, 0.1, 0.1, 0.1]),
            candidate(Model::GgxN, &[0.01, 0.01, 0.01, 0.01]),
        ]);
        let verdict = verdict.unwrap();
        assert_eq!(verdict.model, Some(Model::Three));
        assert_eq!(verdict.best, Model::ThreeN);
        assert_eq!(verdict.not_told_apart, [Model::ThreeN]);
        assert_eq!(verdict.largest_deg, 40.0);
        assert!((verdict.within_percent - 11.4).abs() < 0.1);
        assert!(
            verdict
                .to_string()
                .ends_with("not told apart from it: three+n")
        );
    }

    /// A difference that changes its sign from one incidence to the next is no difference.
    #[test]
    fn an_uncertain_difference_does_not_tell_models_apart() {
        let verdict = verdict(&[
            candidate(Model::Three, &[0.1, 0.2, 0.1, 0.3]),
            candidate(Model::ThreeN, &[0.2, 0.1, 0.15, 0.1]),
        ]);
        assert_eq!(verdict.unwrap().model, Some(Model::Three));
    }

    #[test]
    fn a_bad_prediction_and_too_few_incidences_are_no_verdict() {
        let bad = verdict(&[candidate(Model::Three, &[0.4, 0.4, 0.4, 0.4])]).unwrap();
        assert_eq!((bad.model, bad.best), (None, Model::Three));
        assert!(bad.to_string().contains("the best, three, errs by 49 %"));
        assert_eq!(verdict(&[candidate(Model::Three, &[0.1, 0.1])]), None);
        assert_eq!(verdict(&[]), None);
    }
}
