//! Intervals of the parameters of many scans that share their angles.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::estimate::Estimate;
use super::uncertainty::{Tests, Uncertainty};
use crate::batch::{BatchError, BatchObserver, BatchOptions, Scans};
use crate::fit::{FitError, FitOptions, fit_scan};
use crate::model::Parameter;
use crate::progress::{NoObserver, Phase, Progress};
use crate::scan::{Measurement, Measurements, RefractiveIndex};

/// The number of scans of each thread between two calls of the observer: with 112 readings they take 0.03
/// to 0.15 s.
const REPORTED: usize = 64;

/// The intervals of one parameter: one value for each scan in each column, NaN where none is known.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ParameterIntervals {
    /// The parameter.
    pub parameter: Parameter,
    /// The standard error.
    pub standard_error: Vec<f64>,
    /// The lower end of the interval of 95 %.
    pub from: Vec<f64>,
    /// The upper end of the interval of 95 %.
    pub to: Vec<f64>,
}

/// The standard errors and intervals of 95 % of each free parameter, of many scans that share their
/// angles: those of [`Uncertainty`], whose errors of the readings are estimated from the residuals of each
/// scan.
///
/// Each scan is fitted by itself, which takes a few hundred times as long as its fit by a
/// [`BatchPlan`](crate::batch::BatchPlan). NaN stands for a reading that was not taken; a scan that cannot
/// be fitted has no intervals. The scans are divided among the threads of the current rayon pool;
/// [`intervals_of_many_on_one_thread`] needs none.
///
/// # Errors
///
/// The scans have another number of readings than there are angles, or the observer cancels. With angles or a
/// refractive index outside their domain, no scan can be fitted, and all values are NaN.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use brdf_core::Parameters;
/// use brdf_fit::batch::{BatchOptions, Scans};
/// use brdf_fit::{intervals_of_many, synthetic};
///
/// let scan = synthetic::scan(Parameters::new(0.3, 0.1, 0.2)?, 1.5);
/// let error = |i: usize| 1.0 + 0.02 * (2.4 * i as f64).sin();
/// let readings = scan.readings().iter().enumerate();
/// let readings: Vec<f64> = readings.map(|(i, reading)| reading.brdf * error(i)).collect();
/// let scans = Scans::new(&readings, readings.len())?;
/// let options = BatchOptions::default();
/// let intervals =
///     intervals_of_many(scan.readings(), &options, scans, &mut |_, _| ControlFlow::Continue(()))?;
/// let k1 = &intervals[2];
/// assert!(k1.from[0] < 0.2 && 0.2 < k1.to[0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn intervals_of_many<T: Copy + Into<f64> + Sync>(
    angles: &[Measurement],
    options: &BatchOptions,
    scans: Scans<'_, T>,
    observer: &mut dyn BatchObserver,
) -> Result<Vec<ParameterIntervals>, BatchError> {
    all_intervals(angles, options, scans, false, observer)
}

/// The same on the calling thread. From [`PARALLEL_FROM`](crate::PARALLEL_FROM) readings on, the fit of a
/// scan uses the current rayon pool itself.
///
/// # Errors
///
/// Those of [`intervals_of_many`].
pub fn intervals_of_many_on_one_thread<T: Copy + Into<f64> + Sync>(
    angles: &[Measurement],
    options: &BatchOptions,
    scans: Scans<'_, T>,
    observer: &mut dyn BatchObserver,
) -> Result<Vec<ParameterIntervals>, BatchError> {
    all_intervals(angles, options, scans, true, observer)
}

fn all_intervals<T: Copy + Into<f64> + Sync>(
    angles: &[Measurement],
    options: &BatchOptions,
    scans: Scans<'_, T>,
    one_thread: bool,
    observer: &mut dyn BatchObserver,
) -> Result<Vec<ParameterIntervals>, BatchError> {
    scans.check(angles.len())?;
    let fit_options = of_single_scans(options);
    let free = options.model.free();
    let column = || Vec::with_capacity(scans.len());
    let mut all: Vec<ParameterIntervals> = free
        .iter()
        .map(|&parameter| ParameterIntervals {
            parameter,
            standard_error: column(),
            from: column(),
            to: column(),
        })
        .collect();
    let of_one = |scan| uncertainty(angles, &fit_options, &scans, scan);
    let threads = if one_thread {
        1
    } else {
        rayon::current_num_threads()
    };
    let reported = REPORTED * threads;
    for start in (0..scans.len()).step_by(reported) {
        let end = (start + reported).min(scans.len());
        let found: Vec<Option<Uncertainty>> = if one_thread {
            (start..end).map(of_one).collect()
        } else {
            (start..end).into_par_iter().map(of_one).collect()
        };
        for uncertainty in found {
            for column in &mut all {
                column.push(uncertainty.as_ref());
            }
        }
        if observer.progress(end, scans.len()) == ControlFlow::Break(()) {
            return Err(BatchError::Cancelled);
        }
    }
    Ok(all)
}

impl ParameterIntervals {
    fn push(&mut self, uncertainty: Option<&Uncertainty>) {
        let estimate = uncertainty.and_then(|all| all.estimate(self.parameter));
        let interval = estimate.map(Estimate::interval_95);
        let known = |value: Option<f64>| value.unwrap_or(f64::NAN);
        self.standard_error
            .push(known(estimate.and_then(Estimate::standard_error)));
        self.from
            .push(known(interval.and_then(|interval| interval.from)));
        self.to
            .push(known(interval.and_then(|interval| interval.to)));
    }
}

/// The options of a single scan that is fitted as those of a batch: within the limit of the first stage by
/// this stage alone.
fn of_single_scans(options: &BatchOptions) -> FitOptions {
    let mut single = FitOptions {
        model: options.model,
        refractive_index: Some(RefractiveIndex::Same(options.n)),
        weights: options.weights.clone(),
        ..FitOptions::default()
    };
    if let Some(limit) = options.stage1_limit {
        single.stage1_limit = limit;
        single.stage2 = None;
    }
    single
}

/// The uncertainty of one scan; `None` where it cannot be fitted.
fn uncertainty<T: Copy + Into<f64>>(
    angles: &[Measurement],
    options: &FitOptions,
    scans: &Scans<'_, T>,
    scan: usize,
) -> Option<Uncertainty> {
    let mut values = vec![0.0; angles.len()];
    scans.load(scan, &mut values);
    let readings = angles
        .iter()
        .zip(values)
        .filter(|(_, value)| !value.is_nan());
    let readings = readings.map(|(angle, brdf)| Measurement {
        brdf,
        wavelength_um: None,
        ..*angle
    });
    let scan = Measurements::new("scan", readings.collect()).ok()?;
    let progress = Progress::new(&NoObserver, Phase::Uncertainty);
    let fitted: Result<_, FitError> = fit_scan(&scan, options, &progress);
    Uncertainty::of_fit(&scan, &fitted.ok()?, Tests::Omitted, &progress).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::fit;
    use crate::inference::test_scans::{options, rippled};
    use crate::report::{Depth, Report};

    fn all(values: &[f64], scan: &Measurements, options: &BatchOptions) -> Vec<ParameterIntervals> {
        let scans = Scans::new(values, scan.readings().len()).unwrap();
        let mut observer = |_, _| ControlFlow::Continue(());
        let found = intervals_of_many(scan.readings(), options, scans, &mut observer).unwrap();
        let alone = intervals_of_many_on_one_thread(scan.readings(), options, scans, &mut observer);
        // NaN is equal to NaN in the text, which has all digits.
        assert_eq!(format!("{:?}", alone.unwrap()), format!("{found:?}"));
        found
    }

    #[test]
    fn an_observer_ends_the_work() {
        let scan = rippled([0.3, 0.1, 0.2], 1.5, 0.02);
        let count = scan.readings().len();
        let values = vec![0.0; 3 * REPORTED * count];
        let scans = Scans::new(&values, count).unwrap();
        let mut calls = Vec::new();
        let mut observer = |done, total| {
            calls.push((done, total));
            ControlFlow::Break(())
        };
        let ended = intervals_of_many_on_one_thread(
            scan.readings(),
            &BatchOptions::default(),
            scans,
            &mut observer,
        );
        assert_eq!(ended, Err(BatchError::Cancelled));
        assert_eq!(calls, [(REPORTED, 3 * REPORTED)]);
    }

    #[test]
    fn the_intervals_are_those_of_the_report() {
        compare_with_reports(&BatchOptions::default(), &options());
    }

    #[test]
    fn the_intervals_of_the_first_stage_are_those_of_its_report() {
        let limit = 40_f64.to_radians();
        let of_many = BatchOptions {
            stage1_limit: Some(limit),
            ..BatchOptions::default()
        };
        let of_one = FitOptions {
            stage1_limit: limit,
            stage2: None,
            ..options()
        };
        compare_with_reports(&of_many, &of_one);
    }

    fn compare_with_reports(of_many: &BatchOptions, of_one: &FitOptions) {
        let scans = [[0.3, 0.1, 0.2], [0.1, 0.3, 0.5]].map(|at| rippled(at, 1.5, 0.02));
        let values = scans.iter().flat_map(Measurements::readings);
        let values: Vec<f64> = values.map(|reading| reading.brdf).collect();
        let found = all(&values, &scans[0], of_many);
        for (i, scan) in scans.iter().enumerate() {
            assert!(fit(scan, of_one).is_ok());
            let (report, _) = Report::new(scan, of_one, Depth::Fit);
            for estimate in &report.uncertainty.unwrap().estimates {
                let of_parameter =
                    |column: &&ParameterIntervals| column.parameter == estimate.parameter;
                let column = found.iter().find(of_parameter).unwrap();
                let interval = estimate.interval_95();
                assert_eq!(Some(column.standard_error[i]), estimate.standard_error());
                assert_eq!(
                    (Some(column.from[i]), Some(column.to[i])),
                    (interval.from, interval.to)
                );
            }
        }
    }

    #[test]
    fn scans_that_cannot_be_fitted_have_no_interval() {
        let scan = rippled([0.3, 0.1, 0.2], 1.5, 0.02);
        let count = scan.readings().len();
        let found = all(&vec![0.0; count], &scan, &BatchOptions::default());
        assert!(found.iter().all(|column| column.standard_error[0].is_nan()));
        let found = all(&vec![f64::NAN; count], &scan, &BatchOptions::default());
        assert!(
            found
                .iter()
                .all(|column| column.from[0].is_nan() && column.to[0].is_nan())
        );
    }
}
