//! Inference from a fit beyond its parameters: their intervals, the errors of the readings, the
//! prediction of other incidences, the model that suffices, and warnings.
//!
//! ```text
//! terms, variance_components -> noise --------+
//! spread, undetermined ------------------------+-> uncertainty --+
//! refit -> cross_validation, sensitivity -----------------------+-> model_comparison -> verdict
//! physics ------------------------------------------------------+-> assessment, warning <- hint
//! ```
//!
//! E of eq. (5) is minimised whatever the errors of the readings are. What is said about the result
//! rests on errors that are estimated from the residuals: a constant, one per reading, one common to
//! neighbouring readings and one per incidence.

mod assessment;
mod cross_validation;
mod deviations;
mod estimate;
mod hint;
mod many;
mod model_comparison;
mod noise;
mod physics;
mod refit;
mod spread;
mod terms;
#[cfg(test)]
mod test_scans;
mod uncertainty;
mod undetermined;
mod variance_components;
mod verdict;
mod warning;

pub use assessment::{Assessment, assess};
pub use cross_validation::{CrossValidation, PredictedIncidence, RelativePrediction};
pub use deviations::{Deviations, Quality};
pub use estimate::{Estimate, Interval, Knowledge};
pub use hint::Hint;
pub use many::{ParameterIntervals, intervals_of_many, intervals_of_many_on_one_thread};
pub use model_comparison::{ASSESSED_BINS, ASSESSED_READINGS, Candidate, LeftOut};
pub use noise::{ErrorSizes, Noise, NoiseTests, TEST_LEVEL};
pub use physics::{Physics, Reflectance};
pub use refit::{Reliance, Without, most_influential, rests_on};
pub use uncertainty::Uncertainty;
pub use verdict::{NOT_PREDICTED_PERCENT, VERDICT_MARGIN, Verdict};
pub use warning::Warning;

pub(crate) use assessment::assess_observed;
pub(crate) use model_comparison::sufficient_model;
pub(crate) use uncertainty::{MOST_READINGS, Tests};
pub(crate) use warning::warnings;
