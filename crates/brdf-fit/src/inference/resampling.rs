//! The bootstrap over incidences: how much the parameters depend on which incidences were measured.

use brdf_core::ModelParameters;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use serde::{Deserialize, Serialize};

use super::refit::Refitter;
use crate::model::Parameter;
use crate::progress::Cancelled;

/// The number of resamples. The ends of the 95 % interval are the 6th and the 195th of 200.
pub const RESAMPLES: usize = 200;

/// The seed of the resamples, which are the same in every run.
const SEED: u64 = 2002;

/// The spread of a parameter over the bootstrap resamples.
///
/// A resample consists of as many incidences as the scan has, drawn from them with replacement, and
/// is fitted like the scan. Incidences are drawn as a whole, so that errors that the readings of one
/// incidence have in common, such as those of the model, contribute to the spread; the incidences
/// are assumed to be independent. (The bootstrap of cases with percentile intervals: Efron and
/// Tibshirani, "An Introduction to the Bootstrap", Chapman and Hall 1993, sections 9.5 and 13.3.)
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The parameter.
    pub parameter: Parameter,
    /// Standard deviation over the resamples.
    pub standard_deviation: f64,
    /// Lower end of the interval that contains 95 % of the resamples.
    pub from: f64,
    /// Upper end.
    pub to: f64,
}

/// The spread of each free parameter over [`RESAMPLES`] bootstrap resamples of the incidences; empty
/// with fewer than 3 incidences.
///
/// More than [`MOST_FOLDS`](crate::objective::MOST_FOLDS) incidences are drawn in that many folds of
/// several incidences each.
pub(super) fn bootstrap(refitter: &Refitter<'_>) -> Result<Vec<Spread>, Cancelled> {
    let count = refitter.objective.folds();
    if count < 3 {
        return Ok(Vec::new());
    }
    let mut generator = StdRng::seed_from_u64(SEED);
    let mut resamples = Vec::with_capacity(RESAMPLES);
    for _ in 0..RESAMPLES {
        let mut times = vec![0.0; count];
        for _ in 0..count {
            times[generator.random_range(0..count)] += 1.0;
        }
        resamples.extend(fit_resample(refitter, &times)?);
    }
    let spread = |&parameter: &Parameter| spread(parameter, &resamples);
    Ok(refitter.free().iter().filter_map(spread).collect())
}

/// The fit of a resample in which each fold of the incidences is taken so many `times`; `None` where
/// the drawn incidences do not suffice.
///
/// The minimiser starts from the lowest grid point of the resample, or from the fit of the scan
/// where E is lower there.
fn fit_resample(
    refitter: &Refitter<'_>,
    times: &[f64],
) -> Result<Option<ModelParameters>, Cancelled> {
    refitter.advance()?;
    let objective = refitter.objective;
    let mut factors = vec![0.0; objective.len()];
    let segments = objective.segments().iter();
    for (segment, times) in segments.zip(times.iter().cycle()) {
        factors[segment.rows.clone()].fill(*times);
    }
    let drawn = objective.reweighted(|row| factors[row]).ok();
    let Some(drawn) = drawn.filter(|drawn| drawn.suffices_for(refitter.free())) else {
        return Ok(None);
    };
    let lowest = refitter.lowest(|fold| times[fold]);
    let start = if drawn.error(&lowest) < drawn.error(&refitter.at) {
        lowest
    } else {
        refitter.at
    };
    refitter.minimum(&drawn, start)
}

/// The spread of a parameter; `None` where fewer than half of the resamples could be fitted.
fn spread(parameter: Parameter, resamples: &[ModelParameters]) -> Option<Spread> {
    let mut values: Vec<f64> = resamples.iter().map(|at| parameter.of(at)).collect();
    values.sort_by(f64::total_cmp);
    let count = values.len();
    if count < RESAMPLES / 2 {
        return None;
    }
    let mean = values.iter().sum::<f64>() / count as f64;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    let tail = count / 40;
    Some(Spread {
        parameter,
        standard_deviation: (squares / (count - 1) as f64).sqrt(),
        from: values[tail],
        to: values[count - 1 - tail],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_of_200_resamples_ends_at_the_6th_and_the_195th() {
        let at = |i: usize| ModelParameters {
            k2: ((i * 7) % RESAMPLES + 1) as f64,
            kd: 0.0,
            k1: 1.0,
            n: 1.5,
            p: 1.0,
        };
        let resamples: Vec<ModelParameters> = (0..RESAMPLES).map(at).collect();
        let found = spread(Parameter::K2, &resamples).unwrap();
        assert_eq!((found.from, found.to), (6.0, 195.0));
        // The variance of 1 ... N is N (N + 1)/12.
        assert!((found.standard_deviation - (200.0_f64 * 201.0 / 12.0).sqrt()).abs() < 1e-9);
        assert_eq!(spread(Parameter::K2, &resamples[..99]), None);
    }
}
