//! How far the fit is from the readings: the rms error, and relative errors.

use std::fmt;

use brdf_core::AnyBrdf;
use serde::{Deserialize, Serialize};

use crate::fit::Fit;
use crate::format::in_degrees;
use crate::scan::{Measurement, Measurements};

/// Up to this rms error, in percent, a model describes a sample.
const DESCRIBED_PERCENT: f64 = 10.0;

/// Above this rms error, in percent, a model does not describe a sample.
const NOT_DESCRIBED_PERCENT: f64 = 30.0;

/// How well a model describes a sample, in a word, by the rms error sqrt(E): up to 10 %, up to 30 %, or
/// above.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quality {
    /// The model describes the sample.
    Good,
    /// The model follows the sample roughly.
    Fair,
    /// The model does not describe the sample.
    Poor,
}

impl Quality {
    /// The quality of an rms error in percent.
    pub fn of_rms(percent: f64) -> Self {
        if percent <= DESCRIBED_PERCENT {
            Self::Good
        } else if percent <= NOT_DESCRIBED_PERCENT {
            Self::Fair
        } else {
            Self::Poor
        }
    }

    /// The quality of a fit, over the readings that a robust loss does not reject.
    pub fn of(fit: &Fit) -> Self {
        Self::of_rms(fit.accepted_rms_percent())
    }

    /// `good`, `fair` or `poor`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Fair => "fair",
            Self::Poor => "poor",
        }
    }
}

/// As a clause about the model.
impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Good => "the model describes the sample",
            Self::Fair => "the model follows the sample roughly",
            Self::Poor => "the model does not describe the sample",
        })
    }
}

/// The relative errors |model/measured - 1| of the readings above zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Deviations {
    /// Half of the readings are within this error, in percent.
    pub median_percent: f64,
    /// 90 % of the readings are within this error, in percent.
    pub ninety_percent: f64,
    /// The median of each incidence: its angle in degrees, and the error in percent.
    pub incidences: Vec<(f64, f64)>,
}

impl Deviations {
    /// The relative errors of a fit over the readings that it uses; `None` without a reading above
    /// zero, and where an error is larger than any number.
    pub(crate) fn of(measurements: &Measurements, fit: &Fit) -> Option<Self> {
        let brdf = AnyBrdf::new(fit.model().family(), &fit.at()).ok()?;
        let weighing = fit.options.weights.weighing(measurements)?;
        let readings = measurements.readings();
        let error = |reading: &Measurement| {
            let geometry = reading.geometry().ok()?;
            (reading.brdf > 0.0).then(|| (brdf.value(&geometry) / reading.brdf - 1.0).abs())
        };
        let mut all = Vec::with_capacity(readings.len());
        let mut incidences = Vec::new();
        for incidence in measurements.incidences() {
            let used = incidence
                .readings
                .iter()
                .filter(|i| weighing.weight(**i) > 0.0);
            let mut own: Vec<f64> = used.filter_map(|&i| error(&readings[i])).collect();
            own.sort_by(f64::total_cmp);
            if let Some(median) = quantile(&own, 0.5) {
                incidences.push((in_degrees(incidence.psi), 100.0 * median));
            }
            all.append(&mut own);
        }
        all.sort_by(f64::total_cmp);
        let deviations = Self {
            median_percent: 100.0 * quantile(&all, 0.5)?,
            ninety_percent: 100.0 * quantile(&all, 0.9)?,
            incidences,
        };
        // Against readings next to zero, an error may be larger than any number.
        let are_finite = deviations.ninety_percent.is_finite()
            && deviations
                .incidences
                .iter()
                .all(|(_, error)| error.is_finite());
        are_finite.then_some(deviations)
    }
}

/// The smallest value that the given share of ascending values does not exceed.
fn quantile(ascending: &[f64], share: f64) -> Option<f64> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a count, not negative"
    )]
    let rank = (share * ascending.len() as f64).ceil() as usize;
    ascending.get(rank.saturating_sub(1)).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_values_are_within_the_median() {
        let values = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0];
        assert_eq!(quantile(&values, 0.5), Some(5.0));
        assert_eq!(quantile(&values, 0.9), Some(9.0));
        assert_eq!(quantile(&values[..1], 0.5), Some(1.0));
        assert_eq!(quantile(&[], 0.5), None);
    }

    #[test]
    fn the_quality_is_that_of_the_rms_error() {
        let words = [5.0, 10.0, 20.0, 31.0].map(|rms| Quality::of_rms(rms).word());
        assert_eq!(words, ["good", "good", "fair", "poor"]);
    }
}
