//! Inference from a fit beyond its parameters: their uncertainty, the prediction of other
//! incidences, the model that suffices, and warnings.
//!
//! ```text
//! estimate, covariance -> profile_likelihood -> uncertainty --+
//! refit -> cross_validation, resampling ----------------------+-> model_comparison -> assessment, warning
//! physics ----------------------------------------------------+
//! ```
//!
//! E of eq. (5) is a sum of squares: its minimum is the maximum of the likelihood where the terms
//! under the sum have independent normal errors of equal variance. The deviations of a model from a
//! real sample are systematic and rarely such errors, so that intervals and AICc are optimistic. The
//! bootstrap over incidences and the cross-validation assume only that the incidences are
//! independent of each other.

mod assessment;
mod covariance;
mod cross_validation;
mod estimate;
mod model_comparison;
mod physics;
mod profile_likelihood;
mod refit;
mod resampling;
#[cfg(test)]
mod test_scans;
mod uncertainty;
mod warning;

pub use assessment::{Assessment, assess};
pub use covariance::Noise;
pub use cross_validation::CrossValidation;
pub use estimate::{Estimate, Interval, Knowledge};
pub use model_comparison::{
    ASSESSED_BINS, ASSESSED_READINGS, Candidate, LeftOut, NOT_DESCRIBED_PERCENT, VERDICT_MARGIN,
    Verdict,
};
pub use physics::{Physics, Reflectance};
pub use resampling::{RESAMPLES, Spread};
pub use uncertainty::Uncertainty;
pub use warning::Warning;

pub(crate) use assessment::assess_observed;
pub(crate) use model_comparison::sufficient_model;
pub(crate) use warning::warnings;
