//! `brdf fit --cube`: fits the scans of an array that share their angles.

use std::ffi::OsStr;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use clap::Args;

use super::arguments::Arguments;
use super::values::ModelArgument;
use crate::batch::BatchOptions;
use crate::cli::failure::Failure;
use crate::cli::outcome::{Outcome, print_failures};
use crate::cli::progress::bar;
use crate::cli::stream;
use crate::cube::{Cube, CubeFit, CubeOptions, OutputFormat};
use crate::fit::FitError;
use crate::format::{counted, shortest};
use crate::model::{Model, Parameter};
use crate::output;
use crate::read::ReadOptions;
use crate::read::csv::AngleTable;

/// The options that have no effect on the fits of an array.
const OF_SINGLE_SCANS: [&str; 18] = [
    "files",
    "again",
    "compare",
    "fix",
    "stage1",
    "max_iterations",
    "robust",
    "energy_conserving",
    "format",
    "join",
    "sample",
    "json",
    "curves",
    "plot",
    "verbose",
    "params_only",
    "theta_positive",
    "phi_zero",
];

/// Fits of many scans of the same angles
#[derive(Args)]
#[command(next_help_heading = "Many scans of the same angles")]
pub(super) struct CubeArguments {
    /// Fit all scans of this array of NumPy, .npy, instead of FILE: one dimension runs over the readings
    /// of a scan, the others over the scans, such as the pixels of an image
    ///
    /// Each scan is fitted to the optimum of stage 2, or with --stage2 none to that of stage 1, at some
    /// microseconds a scan. The elements are 32 or 64 bit
    /// numbers: f_r in 1/sr, or what --declare states, as in --declare quantity=reflectance_factor. NaN
    /// is a reading that was not taken. The array is read in pieces and need not fit into memory.
    #[arg(long, value_name = "ARRAY", requires = "angles", requires = "output", conflicts_with_all = OF_SINGLE_SCANS)]
    pub(super) cube: Option<PathBuf>,

    /// The angles of --cube: a table with the columns psi_deg, theta_deg and, optionally, phi_deg,
    /// and a row for each reading of a scan
    #[arg(long, value_name = "TABLE", requires = "cube")]
    pub(super) angles: Option<PathBuf>,

    /// The dimension of --cube that runs over the readings, from 0 [default: the only one that has as many
    /// elements as there are angles]
    #[arg(long, value_name = "DIMENSION", requires = "cube")]
    pub(super) axis: Option<usize>,

    /// Compute the standard errors of the parameters of --cube and their intervals of 95 %, as those of single
    /// scans: at some hundred times the cost of the fits
    #[arg(long, requires = "cube")]
    pub(super) intervals: bool,

    /// Compute the standard errors of the parameters of --cube as well, for errors of the readings that are
    /// independent and of one size: real scans have others too, and these are then too small
    #[arg(long, requires = "cube")]
    pub(super) constant_noise_errors: bool,

    /// Where the fits of --cube are written: FILE.npy, an array of NumPy with named fields, or, in programs that are
    /// built with the feature parquet, FILE.parquet
    #[arg(long, short, value_name = "FILE", requires = "cube")]
    pub(super) output: Option<PathBuf>,
}

/// The files of a run.
struct Files<'a> {
    cube: &'a Path,
    angles: &'a Path,
    output: &'a Path,
}

impl CubeArguments {
    fn files(&self) -> Option<Files<'_>> {
        Some(Files {
            cube: self.cube.as_deref()?,
            angles: self.angles.as_deref()?,
            output: self.output.as_deref()?,
        })
    }

    /// Whether the scans of an array are fitted.
    pub(super) fn is_given(&self) -> bool {
        self.files().is_some()
    }
}

/// Fits the scans of an array, and prints what became of them.
pub(super) fn run(arguments: &Arguments) -> Outcome {
    match arguments.cube.files().map(|files| fit(arguments, &files)) {
        Some(Err(failure)) => print_failures([failure]),
        Some(Ok(outcome)) => outcome,
        None => Outcome::Failed,
    }
}

fn fit(arguments: &Arguments, files: &Files<'_>) -> Result<Outcome, Failure> {
    let format = output_format(files.output)?;
    let inputs = [("--cube", files.cube), ("--angles", files.angles)];
    stream::check(inputs, [("--output", files.output)], None)?;
    let angles = AngleTable::read(files.angles, &read_options(arguments))?;
    let mut cube = Cube::open(files.cube, angles.angles.len(), arguments.cube.axis)?;
    let options = CubeOptions {
        batch: batch_options(arguments, &angles)?,
        constant_noise_errors: arguments.cube.constant_noise_errors,
        intervals: arguments.cube.intervals,
        format,
    };
    let read = description(&cube, files, &angles, &options.batch);
    let bar = bar(usize::try_from(cube.scans()).unwrap_or(usize::MAX));
    let fitted = cube.fit(&angles, &options, files.output, &mut |done, _| {
        bar.set_position(done as u64);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    let fitted = fitted?;
    let text = format!(
        "{read}{}{}: written\n",
        summary(&fitted),
        files.output.display()
    );
    output::print_text(&text).map_err(Failure::Print)?;
    let without: u64 = fitted
        .statuses
        .iter()
        .filter(|(status, _)| !status.is_fitted())
        .map(|(_, count)| count)
        .sum();
    Ok(match without {
        0 => Outcome::Complete,
        _ => Outcome::Incomplete,
    })
}

fn read_options(arguments: &Arguments) -> ReadOptions {
    ReadOptions {
        columns: arguments.reading.columns().to_vec(),
        declarations: arguments.reading.declare.clone(),
        ..ReadOptions::default()
    }
}

fn output_format(path: &Path) -> Result<OutputFormat, Failure> {
    let extension = path.extension().map(OsStr::to_ascii_lowercase);
    match extension.as_ref().and_then(|extension| extension.to_str()) {
        Some("npy") => Ok(OutputFormat::Npy),
        #[cfg(feature = "parquet")]
        Some("parquet") => Ok(OutputFormat::Parquet),
        _ => Err(Failure::CubeOutput(path.to_owned())),
    }
}

fn batch_options(arguments: &Arguments, angles: &AngleTable) -> Result<BatchOptions, Failure> {
    let options = arguments.options();
    let model = match arguments.model {
        Some(ModelArgument::Auto) => return Err(Failure::CubeModel),
        Some(ModelArgument::Given(model)) => model,
        None => Model::Three,
    };
    let index = arguments.n.as_ref().or(angles.refractive_index.as_ref());
    let needed = !model.frees(Parameter::N) && model.frees(Parameter::K2);
    let n = match index.and_then(|index| index.at(None)) {
        Some(n) => n,
        None if needed => return Err(FitError::NoRefractiveIndex(None).into()),
        None => BatchOptions::default().n,
    };
    Ok(BatchOptions {
        model,
        n,
        weights: options.weights,
        stage1_limit: options.stage2.is_none().then_some(options.stage1_limit),
    })
}

/// What was understood of the files.
fn description(
    cube: &Cube,
    files: &Files<'_>,
    angles: &AngleTable,
    options: &BatchOptions,
) -> String {
    let shape: Vec<String> = cube.scan_shape().iter().map(u64::to_string).collect();
    let quantity = if angles.readings_are_brdf() {
        "the readings are taken as f_r in 1/sr".to_owned()
    } else {
        angles.conversions.join("; ")
    };
    let index = if options.model.frees(Parameter::N) {
        String::new()
    } else {
        format!(", n = {}", options.n)
    };
    format!(
        "read:  {}: {} scans of {} along dimension {}, {}; {quantity}\n       {}: {}\nmodel: {}{index}\n",
        files.cube.display(),
        if shape.is_empty() {
            "1".to_owned()
        } else {
            shape.join(" x ")
        },
        counted(angles.angles.len(), "reading"),
        cube.axis(),
        cube.element(),
        files.angles.display(),
        counted(angles.angles.len(), "direction"),
        options.model,
    )
}

/// What became of the scans, and the distribution of each parameter.
fn summary(fitted: &CubeFit) -> String {
    let statuses = fitted.statuses.iter().filter(|(_, count)| *count > 0);
    let mut lines: Vec<String> = statuses
        .map(|(status, count)| {
            let number = *status as u8;
            format!("{count:>12} {} (status {number})", status.description())
        })
        .collect();
    let columns = fitted
        .values
        .iter()
        .filter(|(_, values)| !values.is_empty());
    let rows: Vec<String> = columns
        .map(|(name, values)| quantiles(name, values))
        .collect();
    if !rows.is_empty() {
        lines.push(format!(
            "{:<12}{:>12}{:>12}{:>12}",
            "", "5 %", "median", "95 %"
        ));
    }
    lines.extend(rows);
    if fitted.step > 1 {
        lines.push(format!("(of one scan in {})", fitted.step));
    }
    lines.push(String::new());
    lines.join("\n")
}

/// A line of the table of quantiles, from ascending values.
fn quantiles(name: &str, values: &[f64]) -> String {
    let at = |percent: usize| shortest(values[(values.len() - 1) * percent / 100]);
    format!("{name:<12}{:>12}{:>12}{:>12}", at(5), at(50), at(95))
}
