//! The command line: fits goniometer scans and prints, or writes, what came out.

use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use brdf_fit::fit::energy::DEFAULT_LIMIT_DEG;
use brdf_fit::fit::robust::Loss;
use brdf_fit::model::{FixedParameters, Model};
use brdf_fit::objective::weights::{AngleWeight, Weights};
use brdf_fit::output::{self, TakenError, check_outputs, print_error, write_file, write_json};
use brdf_fit::progress::{NoObserver, Observer, Step};
use brdf_fit::read::{LazyScan, ReadError, ReadOptions};
use brdf_fit::report::{
    Depth, Document, DocumentError, ModelChoice, PAGE, Report, write_curves, write_folder,
    write_models, write_parameters,
};
use brdf_fit::scan::{Convention, Format, Side};
use brdf_fit::{FitError, FitOptions, Method, RefractiveIndex};
use clap::builder::PossibleValuesParser;
use clap::{Parser, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

/// Fits the three-parameter BRDF of Li, Yan and Wu (2002) to goniometer scans.
///
/// Each wavelength of each file is fitted by itself: initial values, stage 1 over the incidences
/// up to a limit, stage 2 over all, and a search over k1 that checks the result against the global
/// optimum. A file is a table with the columns psi_deg, theta_deg and brdf_per_sr, and if need be
/// wavelength_um, phi_deg, sigma_per_sr and n, or in another of the formats of --format.
///
/// Exit status: 0 when every fit succeeded, 1 when a fit failed (the others are delivered), 2 for
/// bad usage, unreadable input or output that cannot be written.
#[derive(Parser)]
#[command(version, max_term_width = 100)]
struct Arguments {
    /// Scans, in any of the formats of --format
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// Fit with the options of the fits in this file, which an earlier run wrote with --json: those
    /// of the same wavelength within 1 %, of several those of the same file; it is read as it was,
    /// but for --sample, which is said anew
    #[arg(long, value_name = "FILE", conflicts_with_all = OF_A_FIT)]
    again: Option<PathBuf>,

    /// The model: lambert, specular, three (the paper's), three+n, smith+n, power+n, ggx, ggx+n,
    /// beckmann, beckmann+n; or auto, the smallest of the first six that predicts incidences it was
    /// not fitted to about as well as the best of them does [default: three]
    #[arg(long, value_name = "MODEL", value_parser = parse_model)]
    model: Option<ModelArgument>,

    /// Fit the neighbours GGX and Beckmann as well, at the given n and with n free
    #[arg(long)]
    compare: bool,

    /// Refractive index of the coating relative to air, from 1 to 1e5: one for all wavelengths, or
    /// WAVELENGTH=INDEX pairs in um such as 0.63=1.60,0.85=1.58 (the nearest within 1 % holds)
    /// [default: what the file says in a column n or a line "# refractive_index: 1.5"]
    #[arg(long, value_name = "INDEX")]
    n: Option<RefractiveIndex>,

    /// Parameters to hold at a value instead of fitting them, as NAME=VALUE pairs such as
    /// k1=0.2,kD=0.05; only those that the model fits
    #[arg(long, value_name = "PAIRS")]
    hold: Option<FixedParameters>,

    /// Method of stage 1, or none to leave it out
    #[arg(long, value_name = "METHOD", default_value = "levenberg-marquardt", value_parser = methods_or_none())]
    stage1: String,

    /// Method of stage 2, or none to fit the readings of stage 1 alone
    #[arg(long, value_name = "METHOD", default_value = "levenberg-marquardt", value_parser = methods_or_none())]
    stage2: String,

    /// Largest incidence angle of stage 1, in degrees
    #[arg(long, value_name = "DEGREES", default_value = "60", value_parser = parse_limit)]
    stage1_limit: f64,

    /// Largest number of iterations of each stage
    #[arg(long, value_name = "COUNT", default_value_t = FitOptions::default().max_iterations, value_parser = clap::value_parser!(u64).range(1..))]
    max_iterations: u64,

    /// Weights of the readings in E, beside g1 and g2: none; sigma for 1/sigma^2 by the column
    /// sigma_per_sr, which then also give the errors of the parameters; or solid-angle for the part
    /// of the hemisphere that each reading stands for
    #[arg(long, value_enum, value_name = "WEIGHTS", default_value = "none")]
    weights: ReadingWeights,

    /// Leave out readings that look less than this away from the source, in degrees
    #[arg(long, value_name = "DEGREES", default_value = "0", value_parser = parse_limit)]
    mask_source: f64,

    /// Leave out readings that look less than this away from the mirror direction, in degrees
    #[arg(long, value_name = "DEGREES", default_value = "0", value_parser = parse_limit)]
    mask_mirror: f64,

    /// Loss for data with outliers, instead of the square: huber or tukey; the readings that it
    /// rejects are listed
    #[arg(long, value_name = "LOSS")]
    robust: Option<Loss>,

    /// Fit under rho(psi) <= 1, no more light leaving than arriving, for incidences up to DEGREES
    #[arg(long, value_name = "DEGREES", num_args = 0..=1, require_equals = true,
          default_missing_value = USUAL_LIMIT, value_parser = parse_energy_limit)]
    energy_conserving: Option<f64>,

    /// Weight g1 over the incidence angle psi, as DEGREES=WEIGHT pairs such as 60=1,80=0.5: linear
    /// between them, constant beyond [default: 1]
    #[arg(long, value_name = "PAIRS")]
    g1: Option<AngleWeight>,

    /// Weight g2 over the view angle theta (source side positive), as DEGREES=WEIGHT pairs
    /// [default: 1]
    #[arg(long, value_name = "PAIRS", allow_hyphen_values = true)]
    g2: Option<AngleWeight>,

    /// Format of the files, instead of what their content and their extension say: csv, merl, astm
    /// (E1392, E2387), zemax (tabular BSDF), black-lab, goniometer (incidences in columns, views in
    /// rows)
    #[arg(long, value_name = "FORMAT")]
    format: Option<Format>,

    /// Fit this many readings of each wavelength instead of all, evenly over the angles theta_h,
    /// theta_d and phi_d of half vector and difference
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u64).range(1..))]
    sample: Option<u64>,

    /// The side of the surface normal on which the files count theta positive, source or forward
    /// [default: source; with --again as it was]
    #[arg(long, value_name = "SIDE")]
    theta_positive: Option<Side>,

    /// The side on which the azimuth phi of the files is zero, source or forward [default: source;
    /// with --again as it was]
    #[arg(long, value_name = "SIDE")]
    phi_zero: Option<Side>,

    /// Write everything about every fit to this file, as JSON with a format version
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    /// Write theory and experiment side by side for each incidence to this file, as CSV; of a MERL
    /// table that is every bin
    #[arg(long, value_name = "FILE")]
    curves: Option<PathBuf>,

    /// Draw every fit into this folder, as SVG and PNG, with a page report.html that holds the
    /// pictures and the tables; of a MERL table those readings that a goniometer would take in the
    /// plane of incidence
    #[arg(long, value_name = "FOLDER")]
    plot: Option<PathBuf>,

    /// Print the parameters as CSV, one line a fit, instead of the tables
    #[arg(long)]
    params_only: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum ReadingWeights {
    None,
    Sigma,
    SolidAngle,
}

/// The options that say how to fit, which a document says as well.
const OF_A_FIT: [&str; 14] = [
    "model",
    "n",
    "hold",
    "stage1",
    "stage2",
    "stage1_limit",
    "max_iterations",
    "weights",
    "mask_source",
    "mask_mirror",
    "robust",
    "energy_conserving",
    "g1",
    "g2",
];

/// What `--model` says.
#[derive(Clone, Copy, PartialEq)]
enum ModelArgument {
    Auto,
    Given(Model),
}

/// [`DEFAULT_LIMIT_DEG`] as clap wants it.
const USUAL_LIMIT: &str = "85";
const _: () = assert!(DEFAULT_LIMIT_DEG == 85.0);

fn parse_model(text: &str) -> Result<ModelArgument, String> {
    match text {
        "auto" => Ok(ModelArgument::Auto),
        _ => text
            .parse()
            .map(ModelArgument::Given)
            .map_err(|error| format!("{error}, or auto")),
    }
}

fn parse_energy_limit(text: &str) -> Result<f64, String> {
    let limit = parse_limit(text)?;
    if limit < 90.0 {
        Ok(limit)
    } else {
        Err("expected degrees from 0 to below 90".to_owned())
    }
}

fn methods_or_none() -> PossibleValuesParser {
    PossibleValuesParser::new(["levenberg-marquardt", "lm", "nelder-mead", "nm", "none"])
}

fn parse_limit(text: &str) -> Result<f64, String> {
    let limit: f64 = text
        .parse()
        .map_err(|_| "expected a number of degrees".to_owned())?;
    if (0.0..=90.0).contains(&limit) {
        Ok(limit)
    } else {
        Err("expected degrees from 0 to 90".to_owned())
    }
}

impl Arguments {
    fn options(&self) -> FitOptions {
        let method = |name: &str| name.parse::<Method>().ok();
        FitOptions {
            model: match self.model {
                Some(ModelArgument::Given(model)) => model,
                _ => Model::Three,
            },
            refractive_index: self.n.clone(),
            weights: Weights {
                g1: self.g1.clone().unwrap_or_default(),
                g2: self.g2.clone().unwrap_or_default(),
                by_sigma: matches!(self.weights, ReadingWeights::Sigma),
                by_solid_angle: matches!(self.weights, ReadingWeights::SolidAngle),
                mask_source: self.mask_source.to_radians(),
                mask_mirror: self.mask_mirror.to_radians(),
            },
            stage1: method(&self.stage1),
            stage1_limit: self.stage1_limit.to_radians(),
            stage2: method(&self.stage2),
            max_iterations: self.max_iterations,
            robust: self.robust,
            energy_limit: self.energy_conserving.map(f64::to_radians),
            fixed: self.hold.unwrap_or_default(),
            ..FitOptions::default()
        }
    }

    /// How much is worked out beside the fits: nothing that is neither printed nor written.
    fn depth(&self) -> Depth {
        let only_parameters = self.params_only && self.json.is_none() && self.plot.is_none();
        match (only_parameters, self.compare) {
            (true, _) => Depth::Fit,
            (false, false) => Depth::Assessed,
            (false, true) => Depth::Compared,
        }
    }

    /// Whether there is a line for each of the compared models: with `--params-only --compare`.
    fn fits_every_model(&self) -> bool {
        self.params_only && self.compare
    }

    /// The options of a scan, for each of its models.
    fn models(&self, options: FitOptions) -> Vec<FitOptions> {
        if !self.fits_every_model() {
            return vec![options];
        }
        let of = |&model: &Model| options.of_model(model);
        Model::WITH_REFERENCES.iter().map(of).collect()
    }

    fn choice(&self) -> ModelChoice {
        if self.model == Some(ModelArgument::Auto) && !self.fits_every_model() {
            ModelChoice::Auto
        } else {
            ModelChoice::Given
        }
    }

    /// No output takes the place of an input or of another output.
    fn check_outputs(&self) -> Result<(), TakenError> {
        let inputs = self.files.iter().chain(&self.again);
        let page = self.plot.as_ref().map(|folder| folder.join(PAGE));
        let outputs = [&self.json, &self.curves, &page].into_iter().flatten();
        check_outputs(inputs.map(PathBuf::as_path), outputs.map(PathBuf::as_path))
    }

    /// What `--again` names.
    fn document(&self) -> Result<Option<Document>, DocumentError> {
        self.again.as_ref().map(Document::read).transpose()
    }

    /// How a file is read: as the options say, else as the document says of it, and where that
    /// says nothing of the file, on the sides that its first file was told to be on.
    fn read_options(&self, file: &Path, document: Option<&Document>) -> ReadOptions {
        let known = document.and_then(|document| document.report_on(file));
        let told = document
            .map(|document| &document.reports[0])
            .filter(|first| {
                matches!(first.format, Format::Csv | Format::Goniometer)
                    && first.convention != Convention::default()
            });
        let sides = known.or(told).map(|report| report.convention);
        ReadOptions {
            format: self.format.or(known.map(|report| report.format)),
            theta_positive: self
                .theta_positive
                .or(sides.map(|sides| sides.theta_positive)),
            phi_zero: self.phi_zero.or(sides.map(|sides| sides.phi_zero)),
            sample: self.sample.and_then(|count| usize::try_from(count).ok()),
        }
    }
}

/// What came of a run, for the exit status.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Outcome {
    AllFitted,
    SomeFailed,
    BadUsageOrFile,
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        Self::from(match outcome {
            Outcome::AllFitted => 0,
            Outcome::SomeFailed => 1,
            Outcome::BadUsageOrFile => 2,
        })
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if let Err(error) = arguments.check_outputs() {
        print_error(&error.to_string());
        return Outcome::BadUsageOrFile.into();
    }
    let document = match arguments.document() {
        Ok(document) => document,
        Err(error) => {
            print_error(&error.to_string());
            return Outcome::BadUsageOrFile.into();
        }
    };
    let (scans, read) = read_all(&arguments, document.as_ref());
    let (jobs, planned) = plan(&scans, &arguments, document.as_ref());
    let mut outcome = read.max(planned);
    let fits = fit_all(&jobs, &arguments);
    let (mut scans, mut reports) = (Vec::new(), Vec::new());
    for ((scan, _), fit) in jobs.iter().zip(fits) {
        match fit {
            Ok((report, error)) => {
                if let Some(error) = error {
                    outcome = outcome.max(told(&report, &error, &arguments));
                }
                scans.push(*scan);
                reports.push(report);
            }
            Err(error) => {
                print_error(&error.to_string());
                outcome = Outcome::BadUsageOrFile;
            }
        }
    }
    if let Err(messages) = deliver(&arguments, &scans, reports) {
        for message in messages {
            print_error(&message);
        }
        outcome = Outcome::BadUsageOrFile;
    }
    outcome.into()
}

/// Complains about a fit that failed.
fn told(report: &Report, error: &FitError, arguments: &Arguments) -> Outcome {
    let model = if arguments.fits_every_model() {
        format!(", {}", report.model)
    } else {
        String::new()
    };
    let scan = named(&report.file, report.wavelength_um);
    print_error(&format!("{scan}{model}: {error}"));
    if error.is_usage() {
        Outcome::BadUsageOrFile
    } else {
        Outcome::SomeFailed
    }
}

/// Reads every file, and complains about those that cannot be read.
fn read_all(arguments: &Arguments, document: Option<&Document>) -> (Vec<LazyScan>, Outcome) {
    let files: Vec<Result<Vec<LazyScan>, ReadError>> = arguments
        .files
        .par_iter()
        .map(|file| LazyScan::open(file, &arguments.read_options(file, document)))
        .collect();
    let mut outcome = Outcome::AllFitted;
    let mut scans = Vec::new();
    for file in files {
        match file {
            Ok(of_file) => scans.extend(of_file),
            Err(error) => {
                print_error(&error.to_string());
                outcome = Outcome::BadUsageOrFile;
            }
        }
    }
    (scans, outcome)
}

/// A scan of one wavelength, and how it is fitted.
type Job<'a> = (&'a LazyScan, FitOptions);

/// The fits of all scans, in the order of the files, wavelengths and models; complains about scans
/// of which the document says nothing.
fn plan<'a>(
    scans: &'a [LazyScan],
    arguments: &Arguments,
    document: Option<&Document>,
) -> (Vec<Job<'a>>, Outcome) {
    let mut jobs = Vec::new();
    let mut outcome = Outcome::AllFitted;
    for scan in scans {
        let (source, wavelength_um) = (scan.source(), scan.wavelength_um());
        let options = match document {
            None => Some(arguments.options()),
            Some(document) => document.options_for(&source, wavelength_um).cloned(),
        };
        if let Some(options) = options {
            let models = arguments.models(options);
            jobs.extend(models.into_iter().map(|options| (scan, options)));
        } else {
            let scan = named(&source, wavelength_um);
            print_error(&format!(
                "{scan}: no fit of this wavelength in the file of --again"
            ));
            outcome = Outcome::BadUsageOrFile;
        }
    }
    (jobs, outcome)
}

/// A file and its wavelength, in the words of a message.
fn named(file: &str, wavelength_um: Option<f64>) -> String {
    let wavelength = wavelength_um.map_or_else(String::new, |w| format!(", {w} um"));
    format!("{file}{wavelength}")
}

/// A report and why there is no fit in it; or why its readings are not to be had.
type Made = Result<(Report, Option<FitError>), ReadError>;

/// Tells the phase of a fit beside the bar.
struct PhaseMessage<'a> {
    bar: &'a ProgressBar,
    scan: String,
}

impl Observer for PhaseMessage<'_> {
    fn step(&self, step: &Step) -> ControlFlow<()> {
        if step.iteration == 0 {
            self.bar
                .set_message(format!("{}: {}", self.scan, step.phase));
        }
        ControlFlow::Continue(())
    }
}

/// Makes all fits side by side, but one after the other those of tables, of whose readings no more
/// than one channel is in memory at once.
fn fit_all(jobs: &[Job<'_>], arguments: &Arguments) -> Vec<Made> {
    let (choice, depth) = (arguments.choice(), arguments.depth());
    // Drawn on standard error, and there only if that is a terminal.
    let bar = ProgressBar::new(jobs.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("fitting {bar:40} {pos}/{len} {msg}") {
        bar.set_style(style);
    }
    let make = |(scan, options): &Job<'_>, observer: &dyn Observer| {
        let measurements = scan.measurements()?;
        let made = Report::observed(&measurements, options, choice, depth, observer);
        bar.inc(1);
        Ok(made)
    };
    let of_table = |job: &Job<'_>| {
        let scan = named(&job.0.source(), job.0.wavelength_um());
        make(job, &PhaseMessage { bar: &bar, scan })
    };
    let in_file = |(scan, _): &Job<'_>| scan.is_in_file();
    let mut of_tables = jobs
        .iter()
        .filter(|job| in_file(job))
        .map(of_table)
        .collect::<Vec<_>>()
        .into_iter();
    let others = jobs.par_iter().filter(|job| !in_file(job));
    let others = others.map(|job| make(job, &NoObserver));
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

/// Writes the files and prints; what fails keeps nothing else from being delivered.
fn deliver(
    arguments: &Arguments,
    scans: &[&LazyScan],
    reports: Vec<Report>,
) -> Result<(), Vec<String>> {
    let scans = scans.iter().copied();
    let mut failed = Vec::new();
    if let Some(folder) = &arguments.plot {
        let reports: Vec<(&LazyScan, &Report)> = scans.clone().zip(&reports).collect();
        failed.extend(
            write_folder(&reports, folder)
                .err()
                .map(|error| error.to_string()),
        );
    }
    if let Some(path) = &arguments.curves {
        let fits = scans.zip(&reports);
        let fits = fits.filter_map(|(scan, report)| Some((scan, report.fit.as_ref()?)));
        let written = write_file(path, |writer| write_curves(fits, writer));
        failed.extend(written.err().map(|error| error.to_string()));
    }
    let document = Document::new(reports);
    if let Some(path) = &arguments.json {
        let written = write_json(path, &document);
        failed.extend(written.err().map(|error| error.to_string()));
    }
    let printed = print(arguments, &document.reports);
    failed.extend(
        printed
            .err()
            .map(|error| format!("standard output: {error}")),
    );
    if failed.is_empty() {
        Ok(())
    } else {
        Err(failed)
    }
}

/// Prints to standard output.
fn print(arguments: &Arguments, reports: &[Report]) -> io::Result<()> {
    let mut buffer = Vec::new();
    if arguments.params_only {
        if arguments.compare || arguments.model.is_some() {
            write_models(reports, &mut buffer)?;
        } else {
            write_parameters(reports, &mut buffer)?;
        }
    } else {
        let texts: Vec<String> = reports.iter().map(Report::text).collect();
        buffer.extend(texts.join("\n").bytes());
    }
    output::print(&buffer)
}
