//! The fits of many scans with a plan.

use std::f64;
use std::ops::ControlFlow;

use brdf_core::ModelParameters;
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::exact::{Weighed, best_weights, standard_errors};
use super::own::{OwnScan, OwnSearch};
use super::plan::{BatchError, BatchPlan};
use super::result::{BatchFit, Row, Status};
use super::scans::Scans;
use super::search::{BLOCK, Found, Search};
use super::table::Table;
use crate::model::{K1_RANGE, Parameter};
use crate::objective::{LobeColumns, PROCESSOR, SIZES, dot_of};
use crate::solver::descent::{Descent, Rows};

/// The number of scans that a thread takes at a time.
const CHUNK: usize = 512;

/// The same where n or p is free and a fit takes some ten times as long.
const CHUNK_OF_DESCENTS: usize = 64;

/// The number of chunks between two calls of the observer.
const REPORTED: usize = 128;

/// Receives the progress of many fits, and may cancel them.
pub trait BatchObserver {
    /// `done` of `total` scans are fitted. [`ControlFlow::Break`] ends the run.
    fn progress(&mut self, done: usize, total: usize) -> ControlFlow<()>;
}

impl<F: FnMut(usize, usize) -> ControlFlow<()>> BatchObserver for F {
    fn progress(&mut self, done: usize, total: usize) -> ControlFlow<()> {
        self(done, total)
    }
}

/// How a run is made.
pub struct BatchRun<'a, T> {
    pub(super) plan: &'a BatchPlan,
    pub(super) scans: Scans<'a, T>,
    pub(super) weights: Option<Scans<'a, T>>,
    pub(super) errors: bool,
    pub(super) one_thread: bool,
}

impl BatchPlan {
    /// Fits scans on the threads of the current rayon pool.
    ///
    /// NaN stands for a reading that was not taken. A scan that cannot be fitted is no error: its
    /// [`Status`] says why, and its columns are NaN.
    ///
    /// # Errors
    ///
    /// The number of readings is not that of the plan.
    pub fn fit_many<T: Copy + Into<f64> + Sync>(
        &self,
        scans: Scans<'_, T>,
    ) -> Result<BatchFit, BatchError> {
        self.run(scans).fit()
    }

    /// A run with further settings.
    pub fn run<'a, T: Copy + Into<f64> + Sync>(&'a self, scans: Scans<'a, T>) -> BatchRun<'a, T> {
        BatchRun {
            plan: self,
            scans,
            weights: None,
            errors: false,
            one_thread: false,
        }
    }
}

impl<'a, T: Copy + Into<f64> + Sync> BatchRun<'a, T> {
    /// Weights of the readings of each scan, beside those of the plan: numbers of at least 0.
    #[must_use]
    pub fn weights(mut self, weights: Scans<'a, T>) -> Self {
        self.weights = Some(weights);
        self
    }

    /// Computes the standard errors for constant noise as well.
    #[must_use]
    pub fn constant_noise_errors(mut self) -> Self {
        self.errors = true;
        self
    }

    /// Fits all scans on the calling thread.
    #[must_use]
    pub fn on_one_thread(mut self) -> Self {
        self.one_thread = true;
        self
    }

    /// Fits the scans.
    ///
    /// # Errors
    ///
    /// The number of readings is not that of the plan, or weights are not valid.
    pub fn fit(self) -> Result<BatchFit, BatchError> {
        self.fit_observed(&mut |_, _| ControlFlow::Continue(()))
    }

    /// Fits the scans and reports the progress.
    ///
    /// # Errors
    ///
    /// As [`fit`](Self::fit); and the observer cancels.
    pub fn fit_observed(self, observer: &mut dyn BatchObserver) -> Result<BatchFit, BatchError> {
        self.check()?;
        let total = self.scans.len();
        let mut fit = BatchFit::with_capacity(total, self.errors);
        let chunk = if self.plan.is_along_k1() {
            CHUNK
        } else {
            CHUNK_OF_DESCENTS
        };
        for start in (0..total).step_by(REPORTED * chunk) {
            let end = (start + REPORTED * chunk).min(total);
            let chunks: Vec<usize> = (start..end).step_by(chunk).collect();
            let one = |from: &usize| self.fit_chunk(*from, (from + chunk).min(end));
            let rows: Vec<Vec<Row>> = if self.one_thread {
                chunks.iter().map(one).collect::<Result<_, _>>()?
            } else {
                chunks.par_iter().map(one).collect::<Result<_, _>>()?
            };
            rows.iter().flatten().for_each(|row| fit.push(row));
            if observer.progress(end, total).is_break() {
                return Err(BatchError::Cancelled);
            }
        }
        Ok(fit)
    }

    fn check(&self) -> Result<(), BatchError> {
        let expected = self.plan.readings();
        let given = [Some(&self.scans), self.weights.as_ref()];
        for scans in given.into_iter().flatten() {
            scans.check(expected)?;
        }
        match &self.weights {
            Some(weights) if weights.len() != self.scans.len() => Err(BatchError::WeightRows {
                found: weights.len(),
                expected: self.scans.len(),
            }),
            _ => Ok(()),
        }
    }

    fn fit_chunk(&self, start: usize, end: usize) -> Result<Vec<Row>, BatchError> {
        let mut chunk = Chunk::new(self);
        let mut first = start;
        while first < end {
            let last = (first + BLOCK).min(end);
            chunk.fit_block(first..last)?;
            first = last;
        }
        chunk.fit_own();
        Ok(chunk.rows)
    }
}

/// How a scan of a block is fitted.
enum Kind {
    /// By the tables of the plan. The sum of the squares of its weighted readings.
    Shared(f64),
    /// By its own scalar products, or not at all.
    Other,
}

/// The fits of some scans on one thread.
struct Chunk<'a, T> {
    run: &'a BatchRun<'a, T>,
    search: Option<Search<'a>>,
    /// The readings of a block, one column for each scan.
    readings: Vec<f64>,
    weights: Vec<f64>,
    /// y of a scan.
    y: Vec<f64>,
    columns: LobeColumns,
    found: Vec<Found>,
    rows: Vec<Row>,
    /// The scans with gaps or with their own weights: the place of the row, the length of y, the number
    /// of readings.
    own: Vec<(usize, f64, usize)>,
    own_scans: Vec<OwnScan>,
}

impl<'a, T: Copy + Into<f64> + Sync> Chunk<'a, T> {
    fn new(run: &'a BatchRun<'a, T>) -> Self {
        let plan = run.plan;
        Self {
            run,
            search: plan
                .table
                .as_ref()
                .filter(|_| plan.has_lobe())
                .map(Search::new),
            readings: vec![0.0; BLOCK * plan.readings],
            weights: Vec::new(),
            y: vec![0.0; plan.factors.len()],
            columns: LobeColumns::default(),
            found: Vec::new(),
            rows: Vec::with_capacity(CHUNK),
            own: Vec::new(),
            own_scans: Vec::new(),
        }
    }

    fn fit_block(&mut self, scans: std::ops::Range<usize>) -> Result<(), BatchError> {
        let kinds = scans
            .clone()
            .enumerate()
            .map(|(i, scan)| self.take(i, scan))
            .collect::<Result<Vec<Kind>, _>>()?;
        // The scans beyond the last one are zero, so that each block has the same sums.
        self.readings[scans.len() * self.run.plan.readings..].fill(0.0);
        if let Some(search) = &mut self.search {
            search.project(&self.readings);
        }
        let first = self.rows.len() - scans.len();
        for (i, kind) in kinds.into_iter().enumerate() {
            if let Kind::Shared(squares) = kind {
                self.rows[first + i] = self.fit_shared(i, squares);
            }
        }
        Ok(())
    }

    /// Loads scan `scan` as column `i` of the block. A scan that the tables do not describe is kept for
    /// later, or gets its row at once.
    fn take(&mut self, i: usize, scan: usize) -> Result<Kind, BatchError> {
        let (run, plan) = (self.run, self.run.plan);
        let column = i * plan.readings..(i + 1) * plan.readings;
        let squares = PROCESSOR.dispatch(Load {
            plan,
            scans: &run.scans,
            scan,
            readings: &mut self.readings[column],
            y: &mut self.y,
        });
        let shared = run.weights.is_none() && (self.search.is_some() || !plan.has_lobe());
        let sizes = SIZES.start().powi(2)..=SIZES.end().powi(2);
        if shared && sizes.contains(&squares) {
            if plan.used <= plan.free() {
                let used = u32::try_from(plan.used).unwrap_or(u32::MAX);
                self.rows
                    .push(Row::without_fit(Status::TooFewReadings, used));
                return Ok(Kind::Other);
            }
            self.rows.push(Row::without_fit(Status::Fitted, 0));
            return Ok(Kind::Shared(squares));
        }
        self.take_own(i, scan)?;
        Ok(Kind::Other)
    }

    /// Keeps a scan with gaps or with its own weights, or gives it the row of one that is not fitted.
    fn take_own(&mut self, i: usize, scan: usize) -> Result<(), BatchError> {
        let (run, plan) = (self.run, self.run.plan);
        let readings = &mut self.readings[i * plan.readings..(i + 1) * plan.readings];
        self.weights.clear();
        self.weights.resize(plan.readings, 1.0);
        if let Some(weights) = &run.weights {
            weights.load(scan, &mut self.weights);
            let wrong = |(_, weight): &(usize, &f64)| !(**weight >= 0.0 && weight.is_finite());
            if let Some((reading, &weight)) = self.weights.iter().enumerate().find(wrong) {
                return Err(BatchError::Weight {
                    scan,
                    reading,
                    weight,
                });
            }
        }
        let (mut own, used) = OwnScan::new(plan, readings, &self.weights);
        let largest = own.y.iter().fold(0.0_f64, |max, y| max.max(y.abs()));
        // The columns of the block stay free of NaN.
        readings.fill(0.0);
        let status = match largest {
            _ if used <= plan.free() => Some(Status::TooFewReadings),
            0.0 => Some(Status::AllZero),
            largest if !SIZES.contains(&largest) => Some(Status::OutOfRange),
            _ => None,
        };
        let used_count = u32::try_from(used).unwrap_or(u32::MAX);
        let row = Row::without_fit(status.unwrap_or_default(), used_count);
        if status.is_none() {
            let length = own.normalise(largest);
            self.own.push((self.rows.len(), length, used));
            self.own_scans.push(own);
        }
        self.rows.push(row);
        Ok(())
    }

    /// Fits scan `i` of the block by the tables of the plan.
    fn fit_shared(&mut self, i: usize, squares: f64) -> Row {
        let plan = self.run.plan;
        let readings = &self.readings[i * plan.readings..(i + 1) * plan.readings];
        let length = squares.sqrt();
        PROCESSOR.dispatch(Weight {
            plan,
            readings,
            common: 1.0 / length,
            y: &mut self.y,
        });
        if let Some(search) = &mut self.search {
            search.optima(i, squares, &mut self.found);
        } else {
            self.found.clear();
            self.found.push(Found::without_lobe(plan.objective.n()));
        }
        let rows = Rows {
            y: &self.y,
            factors: None,
        };
        let descent = Descent {
            objective: &plan.objective,
            model: plan.model,
        };
        let (_, diffuse) = plan.objective.fixed_columns();
        let by_k1 = self.run.errors && plan.is_along_k1();
        let parameters = |found: &Found| {
            let [k1, n, p] = found.at;
            let (k2, kd) = (0.0, 0.0);
            ModelParameters { k2, kd, k1, n, p }
        };
        let is_minimum = |found: &&Found| {
            let accurate = |table: &Table| table.is_accurate_at(found.point);
            plan.table.as_ref().is_none_or(accurate)
        };
        let starts = self.found.iter().filter(|found| !is_minimum(found));
        let descended = descent.lowest(starts.map(parameters), rows);
        let minima = self.found.iter().filter(is_minimum).map(parameters);
        let mut best: Option<Weighed> = None;
        for at in minima.chain(descended.map(|(at, _)| at)) {
            let here = best_weights(plan, at, rows, diffuse, by_k1, &mut self.columns);
            if best.is_none_or(|best| here.error < best.error) {
                best = Some(here);
            }
        }
        match best {
            Some(best) => self.row(&best, length, plan.used, rows),
            None => Row::without_fit(Status::OutOfRange, 0),
        }
    }

    /// Fits the scans with gaps or with their own weights.
    fn fit_own(&mut self) {
        let plan = self.run.plan;
        let by_k1 = self.run.errors && plan.is_along_k1();
        let scans = std::mem::take(&mut self.own_scans);
        let places = std::mem::take(&mut self.own);
        let mut search = OwnSearch::new(plan);
        for (scans, places) in scans
            .chunks(super::own::BLOCK)
            .zip(places.chunks(super::own::BLOCK))
        {
            search.project(scans);
            for (i, (scan, &(place, length, used))) in scans.iter().zip(places).enumerate() {
                let rows = scan.rows();
                let at = search.optimum(i, scan, used, &mut self.columns);
                let best = best_weights(plan, at, rows, &scan.diffuse, by_k1, &mut self.columns);
                self.rows[place] = self.row(&best, length, used, rows);
            }
        }
    }

    /// The row of the best parameters of a scan, of which y is divided by `length`.
    fn row(&self, best: &Weighed, length: f64, used: usize, rows: Rows<'_>) -> Row {
        let plan = self.run.plan;
        let Weighed { mut at, error, .. } = *best;
        let frees = |parameter| plan.model.frees(parameter);
        let status = if frees(Parameter::K2) && at.k2 == 0.0 {
            Status::NoLobe
        } else if frees(Parameter::K1) && (at.k1 <= K1_RANGE.0 || at.k1 >= K1_RANGE.1) {
            Status::WidthAtEnd
        } else if frees(Parameter::Kd) && at.kd == 0.0 {
            Status::NoDiffuse
        } else {
            Status::Fitted
        };
        let mut errors = [f64::NAN; 5];
        if self.run.errors {
            errors = standard_errors(plan, best, used, rows);
            for error in &mut errors[..2] {
                *error *= length;
            }
        }
        at.k2 *= length;
        at.kd *= length;
        if status == Status::NoLobe {
            let lost = [Parameter::K1, Parameter::N, Parameter::P].into_iter();
            lost.filter(|parameter| frees(*parameter))
                .for_each(|parameter| parameter.set(&mut at, f64::NAN));
        }
        let readings = u32::try_from(used).unwrap_or(u32::MAX);
        Row {
            at,
            error,
            readings,
            status,
            errors,
        }
    }
}

/// Loads a scan and its y; the sum of the squares of y.
struct Load<'a, 'b, T> {
    plan: &'a BatchPlan,
    scans: &'a Scans<'b, T>,
    scan: usize,
    readings: &'a mut [f64],
    y: &'a mut [f64],
}

impl<T: Copy + Into<f64>> WithSimd for Load<'_, '_, T> {
    type Output = f64;

    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a function that is not inlined is not compiled for the present processor"
    )]
    fn with_simd<V: Simd>(self, _: V) -> f64 {
        self.scans.load(self.scan, self.readings);
        self.plan.weighted(self.readings, 1.0, self.y);
        dot_of(self.y, self.y)
    }
}

/// [`BatchPlan::weighted`].
struct Weight<'a> {
    plan: &'a BatchPlan,
    readings: &'a [f64],
    common: f64,
    y: &'a mut [f64],
}

impl WithSimd for Weight<'_> {
    type Output = ();

    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a function that is not inlined is not compiled for the present processor"
    )]
    fn with_simd<V: Simd>(self, _: V) {
        self.plan.weighted(self.readings, self.common, self.y);
    }
}
