//! How well a fit predicts what was not measured: each incidence from the others, and the spread of
//! the parameters had other incidences been measured.

use brdf_core::ModelParameters;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use serde::{Deserialize, Serialize};

use crate::fit::grid_search::GridSearch;
use crate::model::{Parameter, ReducedModel};
use crate::objective::{IncidenceError, Objective};
use crate::progress::{Cancelled, Progress};
use crate::solver::{polish, unless_cancelled};

/// Resamples of the bootstrap: the ends of its 95 % interval are the 6th and the 195th.
pub const RESAMPLES: usize = 200;

/// The bootstrap draws the same resamples in every run.
const SEED: u64 = 2002;

/// The prediction of each incidence from the others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Prediction {
    /// E of the prediction of each incidence; `None` where the others do not suffice for a fit, or
    /// all its readings are zero.
    pub incidences: Vec<IncidenceError>,
    /// E of all predictions together, in percent: the sum of their squared errors over that of the
    /// readings that were predicted.
    pub e_percent: f64,
}

impl Prediction {
    /// How many incidences could be predicted.
    pub fn count(&self) -> usize {
        let predicted = |incidence: &&IncidenceError| incidence.e_percent.is_some();
        self.incidences.iter().filter(predicted).count()
    }
}

/// Predicts each incidence from a fit of the others; `None` where there is but one incidence.
///
/// More than [`MOST_FOLDS`](crate::objective::MOST_FOLDS) incidences are left out several at a
/// time, in that many folds. Each fit starts from the lowest point of the search over its own
/// incidences, and from the fit of all; the lower minimum counts.
pub(crate) fn leave_one_out(
    objective: &Objective,
    search: &GridSearch,
    model: ReducedModel,
    at: &ModelParameters,
    progress: &Progress<'_>,
) -> Result<Option<Prediction>, Cancelled> {
    let segments = objective.segments();
    let (mut above, mut below) = (0.0, 0.0);
    let folds = objective.folds();
    let fits: Vec<Option<ModelParameters>> = (0..folds)
        .map(|fold| fit_of_others(objective, search, model, at, fold, progress))
        .collect::<Result<_, _>>()?;
    let incidences = segments.iter().enumerate().map(|(i, segment)| {
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
    Ok((below > 0.0).then(|| Prediction {
        incidences,
        e_percent: 100.0 * above / below,
    }))
}

/// The parameters of a fit of all incidences but those of one fold.
fn fit_of_others(
    objective: &Objective,
    search: &GridSearch,
    model: ReducedModel,
    at: &ModelParameters,
    left_out: usize,
    progress: &Progress<'_>,
) -> Result<Option<ModelParameters>, Cancelled> {
    progress.advance()?;
    let folds = objective.folds();
    let others = objective.subset(|i| i % folds != left_out).ok();
    let Some(others) = others.filter(|others| others.suffices_for(model.free())) else {
        return Ok(None);
    };
    let lowest = search
        .profile(|i| if i == left_out { 0.0 } else { 1.0 })
        .lowest();
    let mut ends = Vec::with_capacity(2);
    for start in [lowest.parameters, *at] {
        ends.extend(unless_cancelled(polish(
            &others,
            start,
            model.free(),
            progress,
        ))?);
    }
    let best =
        |a: &ModelParameters, b: &ModelParameters| others.error(a).total_cmp(&others.error(b));
    Ok(ends.into_iter().min_by(best))
}

/// The spread of a parameter over the resamples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The parameter.
    pub parameter: Parameter,
    /// Standard deviation.
    pub standard_deviation: f64,
    /// The ends between which 95 % of the resamples lie.
    pub from: f64,
    /// Upper end.
    pub to: f64,
}

/// Fits [`RESAMPLES`] sets of as many incidences as there are, drawn with repetition from them: the
/// bootstrap over incidences, which knows that the readings of one incidence err together. More than
/// [`MOST_FOLDS`](crate::objective::MOST_FOLDS) incidences are drawn several at a time. Empty where
/// there are fewer than 3.
pub(crate) fn bootstrap(
    objective: &Objective,
    search: &GridSearch,
    model: ReducedModel,
    at: &ModelParameters,
    progress: &Progress<'_>,
) -> Result<Vec<Spread>, Cancelled> {
    let count = objective.folds();
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
        resamples.extend(resample(objective, search, model, at, &times, progress)?);
    }
    let spread = |&parameter: &Parameter| spread(parameter, &resamples);
    Ok(model.free().iter().filter_map(spread).collect())
}

fn resample(
    objective: &Objective,
    search: &GridSearch,
    model: ReducedModel,
    at: &ModelParameters,
    times: &[f64],
    progress: &Progress<'_>,
) -> Result<Option<ModelParameters>, Cancelled> {
    progress.advance()?;
    let mut factors = vec![0.0; objective.len()];
    let segments = objective.segments().iter();
    for (segment, times) in segments.zip(times.iter().cycle()) {
        factors[segment.rows.clone()].fill(*times);
    }
    let drawn = objective.reweighted(|row| factors[row]).ok();
    let Some(drawn) = drawn.filter(|drawn| drawn.suffices_for(model.free())) else {
        return Ok(None);
    };
    let lowest = search.profile(|i| times[i]).lowest().parameters;
    let start = if drawn.error(&lowest) < drawn.error(at) {
        lowest
    } else {
        *at
    };
    unless_cancelled(polish(&drawn, start, model.free(), progress))
}

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
