//! Reads the scans of `brdf fit` and fits them.

use rayon::prelude::*;

use super::arguments::Arguments;
use super::cube;
use super::output::deliver;
use crate::cli::explain;
use crate::cli::failure::Failure;
use crate::cli::outcome::{Outcome, print_failures};
use crate::cli::problems::{Place, Problems, place};
use crate::cli::progress::{PhaseMessage, bar};
use crate::cli::reading::joined;
use crate::cli::stream;
use crate::fit::{FitError, FitOptions};
use crate::progress::{NoObserver, Observer};
use crate::read::{LazyScan, ReadError};
use crate::report::{ByFile, Document, Report};

/// Fits all scans, and prints and writes the results. A problem with one scan or one output does
/// not prevent the others.
pub(in crate::cli) fn run(arguments: &Arguments) -> Outcome {
    if arguments.cube.is_given() {
        return cube::run(arguments);
    }
    let prepared = arguments
        .check_files()
        .and_then(|in_use| Ok((in_use, arguments.document()?)));
    let (in_use, document) = match prepared {
        Ok(prepared) => prepared,
        Err(failure) => return print_failures([failure]),
    };
    let mut problems = Problems::default();
    let document = document.as_ref().map(Document::by_file);
    let scans = read_all(arguments, document.as_ref(), &mut problems);
    let jobs = plan(&scans, arguments, document.as_ref(), &mut problems);
    if let Err(failure) = arguments.check_figures(&jobs, &in_use) {
        return problems.print().max(print_failures([failure]));
    }
    let fits = fit_all(&jobs, arguments);
    let (mut scans, mut reports) = (Vec::new(), Vec::new());
    for (job, fit) in jobs.iter().zip(fits) {
        match fit {
            Ok((report, error)) => {
                if let Some(error) = error {
                    add_error(&mut problems, &report, &error, arguments);
                }
                scans.push(job.scan);
                reports.push(report);
            }
            Err(error) => problems.add(&Failure::from(error), Outcome::Failed),
        }
    }
    let fitted = problems.print();
    fitted.max(print_failures(deliver(arguments, &scans, reports)))
}

/// Adds the error of a fit that failed.
fn add_error(problems: &mut Problems, report: &Report, error: &FitError, arguments: &Arguments) {
    let place = Place {
        file: report.file.clone(),
        wavelength_um: report.wavelength_um,
        model: arguments.fits_every_model().then_some(report.model),
    };
    if error.is_usage() {
        problems.add_usage(place, explain::fit(error));
    } else {
        problems.add_fit(&place, &explain::fit(error));
    }
}

/// Reads every file.
fn read_all(
    arguments: &Arguments,
    document: Option<&ByFile<'_>>,
    problems: &mut Problems,
) -> Vec<LazyScan> {
    let files: Vec<Result<Vec<LazyScan>, ReadError>> = arguments
        .files
        .par_iter()
        .map(|file| stream::scans(file, &arguments.read_options(file, document)))
        .collect();
    let mut scans = Vec::new();
    let mut all_read = true;
    for file in files {
        match file {
            Ok(of_file) => scans.extend(of_file),
            Err(error) => {
                all_read = false;
                problems.add(&Failure::from(error), Outcome::Failed);
            }
        }
    }
    match arguments.joins(document) {
        false => scans,
        // A sample of which a part is missing is not fitted.
        true if !all_read => Vec::new(),
        true => joined(scans).unwrap_or_else(|failure| {
            problems.add(&failure, Outcome::Failed);
            Vec::new()
        }),
    }
}

/// A scan of one wavelength, and how it is fitted.
pub(super) struct Job<'a> {
    pub(super) scan: &'a LazyScan,
    /// The indices of the readings that the earlier fit left out.
    pub(super) left_out: &'a [usize],
    pub(super) options: FitOptions,
}

/// The fits of all scans, in the order of the files, wavelengths and models.
fn plan<'a>(
    scans: &'a [LazyScan],
    arguments: &Arguments,
    document: Option<&ByFile<'a>>,
    problems: &mut Problems,
) -> Vec<Job<'a>> {
    let mut jobs = Vec::new();
    for scan in scans {
        let (source, wavelength_um) = (scan.source(), scan.wavelength_um());
        let options = match document {
            None => Some(arguments.options()),
            Some(document) => document.options_for(&source, wavelength_um).cloned(),
        };
        if let Some(options) = options {
            let each = arguments.for_each_model(options);
            let left_out = document.map_or(&[][..], |document| {
                document.left_out_of(&source, wavelength_um)
            });
            jobs.extend(each.into_iter().map(|options| Job {
                scan,
                left_out,
                options,
            }));
        } else {
            let place = Place {
                file: source.into_owned(),
                wavelength_um,
                model: None,
            };
            let message = "no fit of this wavelength in the file of --again";
            problems.add_usage(place, message.to_owned());
        }
    }
    jobs
}

/// A report and why it contains no fit; or why the readings of its scan cannot be read.
type Fitted = Result<(Report, Option<FitError>), ReadError>;

/// Fits all scans in parallel, except those of MERL tables: these are fitted one after the other,
/// so that the readings of only one channel are in memory.
fn fit_all(jobs: &[Job<'_>], arguments: &Arguments) -> Vec<Fitted> {
    let (choice, depth) = (arguments.choice(), arguments.depth());
    let bar = bar(jobs.len());
    let fit = |job: &Job<'_>, observer: &dyn Observer| {
        let all = job.scan.measurements()?;
        let used = (!job.left_out.is_empty()).then(|| all.without(job.left_out));
        let used = used.as_ref().unwrap_or(&all);
        let (mut report, error) = Report::observed(used, &job.options, choice, depth, observer);
        report.left_out = job.left_out.to_vec();
        bar.inc(1);
        Ok((report, error))
    };
    let fit_channel = |job: &Job<'_>| {
        let scan = place(&job.scan.source(), job.scan.wavelength_um());
        fit(job, &PhaseMessage { bar: &bar, scan })
    };
    let in_file = |job: &Job<'_>| job.scan.is_in_file();
    let mut of_tables = jobs
        .iter()
        .filter(|job| in_file(job))
        .map(fit_channel)
        .collect::<Vec<_>>()
        .into_iter();
    let others = jobs.par_iter().filter(|job| !in_file(job));
    let others = others.map(|job| fit(job, &NoObserver));
    let mut others = others.collect::<Vec<_>>().into_iter();
    let next = |job| {
        if in_file(job) {
            of_tables.next()
        } else {
            others.next()
        }
    };
    let all = jobs.iter().filter_map(next).collect();
    bar.finish_and_clear();
    all
}
