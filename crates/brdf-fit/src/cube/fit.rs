//! The fits of an array, piece by piece.

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::Path;

use super::array::{Cube, Piece};
use super::columns::{Column, Values};
use super::error::CubeError;
use super::npy;
use crate::batch::{BatchError, BatchFit, BatchObserver, BatchOptions, BatchPlan, Scans, Status};
use crate::inference::{ParameterIntervals, intervals_of_many};
use crate::output::write_file;
use crate::read::csv::AngleTable;

/// The readings of a piece, in bytes.
const PIECE: u64 = 32 << 20;

/// At most this many values of a column are kept for its quantiles.
const KEPT: u64 = 100_000;

/// How the fits of an array are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum OutputFormat {
    /// An array of NumPy with named fields, of the shape of the scans.
    Npy,
    /// A Parquet table with a row for each scan.
    #[cfg(feature = "parquet")]
    Parquet,
}

/// How the scans of an array are fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct CubeOptions {
    /// Model, refractive index and weights.
    pub batch: BatchOptions,
    /// Whether the standard errors for constant noise are computed.
    pub constant_noise_errors: bool,
    /// Whether the standard errors and intervals of [`intervals_of_many`] are computed.
    pub intervals: bool,
    /// The form of the output.
    pub format: OutputFormat,
}

/// What became of the scans of an array.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CubeFit {
    /// The number of scans.
    pub scans: u64,
    /// How many scans have each status, in the order of [`Status::ALL`].
    pub statuses: Vec<(Status, u64)>,
    /// The name of each column of parameters and of E, with its values in ascending order: of all fitted scans,
    /// or of evenly chosen ones.
    pub values: Vec<(String, Vec<f64>)>,
    /// Of how many scans one was chosen for the values.
    pub step: u64,
}

impl Cube {
    /// Fits all scans and writes the fits to a file. They equal those of [`BatchPlan::fit_many`].
    ///
    /// # Errors
    ///
    /// The plan cannot be made, the array cannot be read, the observer cancels, or the file cannot be
    /// written. An earlier file of that name is then unchanged.
    pub fn fit(
        &mut self,
        angles: &AngleTable,
        options: &CubeOptions,
        output: &Path,
        observer: &mut dyn BatchObserver,
    ) -> Result<CubeFit, CubeError> {
        let plan = BatchPlan::new(&angles.angles, &options.batch)?;
        let columns = Column::of(options);
        let mut run = Run {
            angles,
            options,
            plan: &plan,
            summary: Summary::new(self.scans(), &columns),
            columns: &columns,
        };
        let mut failure = None;
        let written = write_file(output, |writer| {
            let all = run.all(self, writer, observer);
            all.map_err(|stopped| match stopped {
                Stopped::Writing(error) => error,
                Stopped::Fitting(error) => {
                    failure = Some(error);
                    io::Error::other("the fits are not complete")
                }
            })
        });
        if let Some(error) = failure {
            return Err(error);
        }
        written?;
        Ok(run.summary.finished())
    }
}

/// Why a run ended early.
enum Stopped {
    Fitting(CubeError),
    Writing(io::Error),
}

impl From<CubeError> for Stopped {
    fn from(error: CubeError) -> Self {
        Self::Fitting(error)
    }
}

impl From<io::Error> for Stopped {
    fn from(error: io::Error) -> Self {
        Self::Writing(error)
    }
}

struct Run<'a> {
    angles: &'a AngleTable,
    options: &'a CubeOptions,
    plan: &'a BatchPlan,
    columns: &'a [Column],
    summary: Summary,
}

/// The fits of the scans of a piece.
pub(super) struct PieceFit {
    pub(super) fit: BatchFit,
    /// Empty where they are not asked for.
    pub(super) intervals: Vec<ParameterIntervals>,
}

/// Receives how many scans of a piece are fitted.
type PieceObserver<'a> = dyn FnMut(usize, usize) -> ControlFlow<()> + 'a;

impl Run<'_> {
    fn all(
        &mut self,
        cube: &mut Cube,
        writer: &mut dyn Write,
        observer: &mut dyn BatchObserver,
    ) -> Result<(), Stopped> {
        match self.options.format {
            OutputFormat::Npy => {
                npy::write_header(writer, cube, self.columns)?;
                let columns = self.columns;
                self.pieces(cube, observer, |fit| npy::write_rows(writer, columns, fit))
            }
            #[cfg(feature = "parquet")]
            OutputFormat::Parquet => {
                let mut table = super::parquet::Table::new(cube, self.columns)?;
                self.pieces(cube, observer, |fit| table.write_rows(writer, fit))?;
                Ok(table.finish(writer)?)
            }
        }
    }

    fn pieces(
        &mut self,
        cube: &mut Cube,
        observer: &mut dyn BatchObserver,
        mut write: impl FnMut(&PieceFit) -> io::Result<()>,
    ) -> Result<(), Stopped> {
        let all = cube.scans();
        let size = (PIECE / (8 * cube.readings()).max(1)).max(1);
        let mut first = 0;
        while first < all {
            let count = size.min(all - first);
            let piece = cube.read(first, count)?;
            let mut progress =
                |done: usize, _| observer.progress(count_of(first + done as u64), count_of(all));
            let fit = self.fit(piece, &mut progress).map_err(CubeError::from)?;
            self.summary.add(first, &fit);
            write(&fit)?;
            first += count;
        }
        Ok(())
    }

    fn fit(&self, piece: Piece, observer: &mut PieceObserver<'_>) -> Result<PieceFit, BatchError> {
        let readings = self.plan.readings();
        match piece {
            Piece::Float32(values) if self.angles.readings_are_brdf() => {
                self.fit_scans(Scans::new(&values, readings)?, observer)
            }
            Piece::Float64(values) if self.angles.readings_are_brdf() => {
                self.fit_scans(Scans::new(&values, readings)?, observer)
            }
            Piece::Float32(values) => {
                self.fit_converted(values.into_iter().map(f64::from), observer)
            }
            Piece::Float64(values) => self.fit_converted(values.into_iter(), observer),
        }
    }

    fn fit_converted(
        &self,
        values: impl Iterator<Item = f64>,
        observer: &mut PieceObserver<'_>,
    ) -> Result<PieceFit, BatchError> {
        let readings = self.plan.readings();
        let values = values.enumerate();
        let brdf = |(i, value)| self.angles.to_brdf(i % readings, value);
        let values: Vec<f64> = values.map(brdf).collect();
        self.fit_scans(Scans::new(&values, readings)?, observer)
    }

    fn fit_scans<T: Copy + Into<f64> + Sync>(
        &self,
        scans: Scans<'_, T>,
        mut observer: &mut PieceObserver<'_>,
    ) -> Result<PieceFit, BatchError> {
        let CubeOptions {
            batch,
            constant_noise_errors,
            intervals,
            ..
        } = self.options;
        let mut run = self.plan.run(scans);
        if *constant_noise_errors {
            run = run.constant_noise_errors();
        }
        if !intervals {
            let fit = run.fit_observed(&mut observer)?;
            return Ok(PieceFit {
                fit,
                intervals: Vec::new(),
            });
        }
        // The fits take no time beside their intervals.
        let fit = run.fit()?;
        let intervals = intervals_of_many(&self.angles.angles, batch, scans, &mut observer)?;
        Ok(PieceFit { fit, intervals })
    }
}

fn count_of(scans: u64) -> usize {
    usize::try_from(scans).unwrap_or(usize::MAX)
}

/// What is counted while the pieces are fitted.
struct Summary {
    fit: CubeFit,
    columns: Vec<Column>,
}

impl Summary {
    fn new(scans: u64, columns: &[Column]) -> Self {
        let shown = |column: &&Column| matches!(column, Column::Value(_) | Column::EPercent);
        let columns: Vec<Column> = columns.iter().filter(shown).copied().collect();
        Self {
            fit: CubeFit {
                scans,
                statuses: Status::ALL.map(|status| (status, 0)).to_vec(),
                values: columns
                    .iter()
                    .map(|column| (column.name(), Vec::new()))
                    .collect(),
                step: scans.div_ceil(KEPT).max(1),
            },
            columns,
        }
    }

    /// Adds the fits of a piece that begins with scan `first`.
    fn add(&mut self, first: u64, fit: &PieceFit) {
        for status in &fit.fit.status {
            self.fit.statuses[*status as usize].1 += 1;
        }
        let step = self.fit.step;
        let skipped = count_of((step - first % step) % step);
        for (column, (_, kept)) in self.columns.iter().zip(&mut self.fit.values) {
            if let Values::Float(values) = column.values(fit) {
                let chosen = values.iter().skip(skipped).step_by(count_of(step));
                kept.extend(chosen.filter(|value| !value.is_nan()));
            }
        }
    }

    fn finished(mut self) -> CubeFit {
        for (_, values) in &mut self.fit.values {
            values.sort_by(f64::total_cmp);
        }
        self.fit
    }
}
