//! Leave-one-incidence-out cross-validation: how well the model predicts incidences that it was not
//! fitted to.

use brdf_core::ModelParameters;
use serde::{Deserialize, Serialize};

use super::refit::Refitter;
use crate::objective::IncidenceError;
use crate::progress::Cancelled;

/// The prediction of each incidence from a fit of the other incidences.
///
/// Each incidence is left out once, the model is fitted to the others, and the left-out readings
/// are compared with the prediction. The E of all predictions,
///
/// ```text
/// E = sum over incidences |y_i - f(fit of the others)_i|^2 / sum over incidences |y_i|^2,
/// ```
///
/// estimates the error of the model at incidences that were not measured. It assumes that the
/// incidences are independent of each other, not that the readings of one incidence are. (Stone,
/// "Cross-validatory choice and assessment of statistical predictions", Journal of the Royal
/// Statistical Society B 36, 111, 1974.)
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CrossValidation {
    /// E of the prediction of each incidence; `None` where the other incidences do not suffice for
    /// a fit, and where all readings of the incidence are zero.
    pub incidences: Vec<IncidenceError>,
    /// E of all predictions, in percent.
    pub e_percent: f64,
}

impl CrossValidation {
    /// The number of incidences that are predicted.
    pub fn count(&self) -> usize {
        let predicted = |incidence: &&IncidenceError| incidence.e_percent.is_some();
        self.incidences.iter().filter(predicted).count()
    }
}

/// Predicts each incidence from a fit of the others; `None` where nothing can be predicted, as with
/// a single incidence.
///
/// More than [`MOST_FOLDS`](crate::objective::MOST_FOLDS) incidences are left out in that many
/// folds of several incidences each.
pub(super) fn leave_one_out(refitter: &Refitter<'_>) -> Result<Option<CrossValidation>, Cancelled> {
    let objective = refitter.objective;
    let folds = objective.folds();
    let fits: Vec<Option<ModelParameters>> = (0..folds)
        .map(|fold| fit_without(refitter, fold))
        .collect::<Result<_, _>>()?;
    let (mut above, mut below) = (0.0, 0.0);
    let segments = objective.segments().iter().enumerate();
    let incidences = segments.map(|(i, segment)| {
        let others = fits[i % folds].as_ref();
        let sums = others.map(|others| objective.squares_of(others, segment));
        if let Some((errors, readings)) = sums {
            above += errors;
            below += readings;
        }
        let percent = |(errors, readings): (f64, f64)| 100.0 * errors / readings;
        let sums = sums.filter(|(_, readings)| *readings > 0.0);
        IncidenceError::new(segment, sums.map(percent))
    });
    let incidences = incidences.collect();
    Ok((below > 0.0).then(|| CrossValidation {
        incidences,
        e_percent: 100.0 * above / below,
    }))
}

/// The parameters of a fit of all incidences except those of one fold; `None` where the others do
/// not suffice.
///
/// The minimiser starts from the lowest grid point of those incidences and from the fit of all
/// incidences; the lower of the two minima is taken.
fn fit_without(
    refitter: &Refitter<'_>,
    left_out: usize,
) -> Result<Option<ModelParameters>, Cancelled> {
    refitter.advance()?;
    let folds = refitter.objective.folds();
    let others = refitter.objective.subset(|i| i % folds != left_out).ok();
    let Some(others) = others.filter(|others| others.suffices_for(refitter.free())) else {
        return Ok(None);
    };
    let lowest = refitter.lowest(|fold| if fold == left_out { 0.0 } else { 1.0 });
    let mut minima = Vec::with_capacity(2);
    for start in [lowest, refitter.at] {
        minima.extend(refitter.minimum(&others, start)?);
    }
    let by_error =
        |a: &ModelParameters, b: &ModelParameters| others.error(a).total_cmp(&others.error(b));
    Ok(minima.into_iter().min_by(by_error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::fit_scan;
    use crate::inference::test_scans::{options, rippled};
    use crate::progress::{NoObserver, Phase, Progress};

    #[test]
    fn the_prediction_of_an_incidence_is_the_fit_of_the_scan_without_it() {
        let scan = rippled([0.3, 0.1, 0.2], 1.5, 0.02);
        let fitted = fit_scan(&scan, &options(), &NoObserver).unwrap();
        let progress = Progress::new(&NoObserver, Phase::Assessment);
        let refitter = Refitter::new(&fitted, &progress).unwrap();
        let found = leave_one_out(&refitter).unwrap().unwrap();
        assert_eq!(found.count(), scan.incidences().len());
        let without: Vec<usize> = scan.incidences()[1..]
            .iter()
            .flat_map(|incidence| incidence.readings.iter().copied())
            .collect();
        let others = fit_scan(&scan.kept(without), &options(), &NoObserver).unwrap();
        let expected = fitted.objective.by_incidence(&others.fit.at())[0];
        let ratio = found.incidences[0].e_percent.unwrap() / expected.e_percent.unwrap();
        assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
    }
}
