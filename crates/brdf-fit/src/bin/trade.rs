//! The command line that measures the trade of speed for accuracy.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;

use brdf_core::published::PUBLISHED;
use brdf_core::scene::{Azimuth, Coordinates, Domain, Scene};
use brdf_core::{AnyBrdf, ModelParameters, ThreeParameterBrdf};
use brdf_fit::model::Model;
use brdf_fit::output::{self, check_outputs, complain, write_file, write_json};
use brdf_fit::plot::Figure;
use brdf_fit::read::{ReadError, ReadOptions, Scan};
use brdf_fit::report::Document;
use brdf_fit::trade::evaluators::{EvaluatorTrade, trade_evaluators, write_evaluator_trade};
use brdf_fit::trade::fitting::{FitTrade, trade_fits, write_fit_trades};
use brdf_fit::{FitOptions, RefractiveIndex};
use clap::{Args, Parser, Subcommand, ValueEnum};
use serde::Serialize;

/// Measures, on this machine, what speed costs in accuracy.
///
/// Without a subcommand: every way to evaluate a BRDF, over the directions of a scene: time for each
/// evaluation, errors against the exact value, memory; and which of them the scene needs. With `fit`:
/// the ways to fit a scan, time against E and the shift of the parameters.
///
/// Exit status: 0 when everything was measured, 1 when no evaluator is within the tolerance or a
/// scan cannot be fitted (what was measured is delivered), 2 for bad usage, unreadable input or
/// output that cannot be written.
#[derive(Parser)]
#[command(
    name = "trade",
    version,
    max_term_width = 100,
    args_conflicts_with_subcommands = true
)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,

    #[command(flatten)]
    evaluation: Evaluation,

    #[command(flatten)]
    outputs: Outputs,
}

#[derive(Subcommand)]
enum Command {
    /// Ways to fit a scan: method, stages, every 2nd, 4th, 8th reading, fewer incidences, fewer
    /// iterations
    Fit(Fitting),
}

#[derive(Args)]
struct Evaluation {
    /// The BRDF of the first fit in this file, which `fit --json` wrote
    #[arg(long, value_name = "FILE", conflicts_with = "sample")]
    model: Option<PathBuf>,

    /// A row of the paper's Table 1, as "SAMPLE WAVELENGTH" [default: "001 0.91"]
    #[arg(long, value_name = "ROW")]
    sample: Option<Row>,

    /// Incidence angles psi of the scene, in degrees, as FROM:TO, or one angle
    #[arg(long, value_name = "RANGE", default_value = "0:85")]
    incidence: Range,

    /// Magnitudes of the view angle theta of the scene, in degrees, as FROM:TO
    #[arg(long, value_name = "RANGE", default_value = "0:85")]
    view: Range,

    /// All views lie in the plane of incidence
    #[arg(long)]
    in_plane: bool,

    /// How the scene gives its points
    #[arg(
        long,
        value_enum,
        value_name = "COORDINATES",
        default_value = "cosines"
    )]
    coordinates: CoordinatesArgument,

    /// The largest relative error of f_r
    #[arg(long, value_name = "ERROR", default_value = "1e-3", value_parser = positive)]
    tolerance: f64,

    /// The largest memory of a table, in MiB
    #[arg(long, value_name = "MIB", default_value = "64", value_parser = positive)]
    memory: f64,

    /// How many evaluations there will be
    #[arg(long, value_name = "COUNT", default_value = "1e8", value_parser = positive)]
    evaluations: f64,
}

#[derive(Args)]
struct Fitting {
    /// A scan, as the command fit reads it
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// Refractive index, as of the command fit
    #[arg(long, value_name = "INDEX")]
    n: Option<RefractiveIndex>,

    /// The model, as of the command fit
    #[arg(long, value_name = "MODEL", default_value_t = Model::Three)]
    model: Model,

    #[command(flatten)]
    outputs: Outputs,
}

#[derive(Args)]
struct Outputs {
    /// Write the table to this file, as CSV
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,

    /// Write everything to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    /// Draw error against time into this file, as SVG; with several wavelengths, one file for each,
    /// the wavelength in its name
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum CoordinatesArgument {
    Cosines,
    Angles,
    Directions,
}

/// A row of Table 1.
#[derive(Clone)]
struct Row {
    name: String,
    brdf: AnyBrdf,
}

impl FromStr for Row {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let name = |row: &brdf_core::published::PublishedSample| {
            format!("{} {}", row.sample, row.wavelength_um)
        };
        let words: Vec<&str> = text.split_whitespace().collect();
        let row = PUBLISHED.iter().find(|row| name(row) == words.join(" "));
        let row = row.ok_or_else(|| {
            let names: Vec<String> = PUBLISHED
                .iter()
                .map(|row| format!("\"{}\"", name(row)))
                .collect();
            format!("expected one of {}", names.join(", "))
        })?;
        let brdf = ThreeParameterBrdf::new(row.parameters, row.n).map_err(|e| e.to_string())?;
        Ok(Self {
            name: format!("Table 1, {} {} um", row.sample, row.wavelength_um),
            brdf: AnyBrdf::Paper(brdf),
        })
    }
}

/// A range of angles, in radians.
#[derive(Clone, Copy)]
struct Range(f64, f64);

impl FromStr for Range {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let degrees = |text: &str| {
            let angle: f64 = text.parse().ok()?;
            (0.0..90.0).contains(&angle).then(|| angle.to_radians())
        };
        let (from, to) = text.split_once(':').unwrap_or((text, text));
        match (degrees(from), degrees(to)) {
            (Some(from), Some(to)) if from <= to => Ok(Self(from, to)),
            _ => Err("expected degrees from 0 to below 90, as FROM:TO".to_owned()),
        }
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && f64::is_finite(number) => Ok(number),
        _ => Err("expected a number above 0".to_owned()),
    }
}

/// Everything that was measured, delivered; whether all of it could be.
type Outcome = Result<bool, Vec<String>>;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let outcome = match &arguments.command {
        Some(Command::Fit(fitting)) => compare_fits(fitting),
        None => compare_evaluators(&arguments.evaluation, &arguments.outputs),
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(messages) => {
            for message in messages {
                complain(&message);
            }
            ExitCode::from(2)
        }
    }
}

fn compare_evaluators(evaluation: &Evaluation, outputs: &Outputs) -> Outcome {
    outputs.check(evaluation.model.as_deref())?;
    let (name, brdf) = evaluation.brdf().map_err(|message| vec![message])?;
    let scene = evaluation.scene().map_err(|message| vec![message])?;
    let trade: EvaluatorTrade = trade_evaluators(&name, &brdf, &scene);
    let figures = [(None, trade.figure())];
    let csv = |writer: &mut dyn Write| write_evaluator_trade(&trade, writer);
    outputs.deliver(&trade.text(), &trade, csv, figures)?;
    Ok(trade.plan.is_some())
}

impl Evaluation {
    /// What is evaluated, and its name.
    fn brdf(&self) -> Result<(String, AnyBrdf), String> {
        let Some(path) = &self.model else {
            let row = self.sample.clone().map_or_else(|| "001 0.91".parse(), Ok);
            return row.map(|Row { name, brdf }| (name, brdf));
        };
        let document = Document::read(path).map_err(|error| error.to_string())?;
        let mut reports = document.reports.iter();
        let found = reports.find_map(|report| Some((report, report.fit.as_ref()?)));
        let (report, fit) = found.ok_or_else(|| format!("{}: holds no fit", path.display()))?;
        let at = ModelParameters {
            p: fit.p,
            ..ModelParameters::three(fit.parameters, fit.n)
        };
        let brdf = AnyBrdf::new(fit.options.model.family(), &at)
            .map_err(|error| format!("{}: {error}", path.display()))?;
        let wavelength = fit
            .wavelength_um
            .map_or_else(String::new, |w| format!(", {w} um"));
        Ok((format!("{}{wavelength}", report.file), brdf))
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a positive number of bytes; more than there can be is no limit"
    )]
    fn scene(&self) -> Result<Scene, String> {
        let azimuth = if self.in_plane {
            Azimuth::InPlane
        } else {
            Azimuth::Full
        };
        let (incidence, view) = (self.incidence, self.view);
        let domain = Domain::new((incidence.0, incidence.1), (view.0, view.1), azimuth);
        Ok(Scene {
            domain: domain.map_err(|error| error.to_string())?,
            coordinates: match self.coordinates {
                CoordinatesArgument::Cosines => Coordinates::Cosines,
                CoordinatesArgument::Angles => Coordinates::Angles,
                CoordinatesArgument::Directions => Coordinates::Directions,
            },
            tolerance: self.tolerance,
            memory_limit: (self.memory * 1024.0 * 1024.0) as usize,
            evaluations: self.evaluations,
        })
    }
}

fn compare_fits(fitting: &Fitting) -> Outcome {
    fitting.outputs.check(Some(&fitting.file))?;
    let read = |error: ReadError| vec![error.to_string()];
    let scans = Scan::of_file(&fitting.file, &ReadOptions::default()).map_err(read)?;
    let options = FitOptions {
        model: fitting.model,
        refractive_index: fitting.n.clone(),
        ..FitOptions::default()
    };
    let mut trades: Vec<FitTrade> = Vec::new();
    let mut failed = false;
    for scan in scans {
        match trade_fits(&*scan.measurements().map_err(read)?, &options) {
            Ok(trade) => trades.push(trade),
            Err(error) if error.is_usage() => {
                return Err(vec![format!("{}: {error}", fitting.file.display())]);
            }
            Err(error) => {
                failed = true;
                complain(&format!("{}: {error}", fitting.file.display()));
            }
        }
    }
    let texts: Vec<String> = trades.iter().map(FitTrade::text).collect();
    let several = trades.len() > 1;
    let figures = trades
        .iter()
        .map(|trade| (trade.wavelength_um.filter(|_| several), trade.figure()));
    let csv = |writer: &mut dyn Write| write_fit_trades(&trades, writer);
    fitting
        .outputs
        .deliver(&texts.join("\n"), &trades, csv, figures)?;
    Ok(!failed)
}

impl Outputs {
    /// No output takes the place of the input or of another output.
    fn check(&self, input: Option<&Path>) -> Result<(), Vec<String>> {
        let outputs = [&self.csv, &self.json, &self.plot].into_iter().flatten();
        check_outputs(input, outputs.map(PathBuf::as_path)).map_err(|error| vec![error.to_string()])
    }

    /// Writes the files and prints; what fails keeps nothing else from being delivered.
    fn deliver(
        &self,
        text: &str,
        document: &impl Serialize,
        csv: impl FnOnce(&mut dyn Write) -> io::Result<()>,
        figures: impl IntoIterator<Item = (Option<f64>, Figure)>,
    ) -> Result<(), Vec<String>> {
        let mut failed = Vec::new();
        if let Some(path) = &self.csv {
            failed.extend(write_file(path, csv).err().map(|error| error.to_string()));
        }
        if let Some(path) = &self.json {
            let written = write_json(path, document);
            failed.extend(written.err().map(|error| error.to_string()));
        }
        if let Some(path) = &self.plot {
            for (wavelength_um, figure) in figures {
                failed.extend(write_picture(&named(path, wavelength_um), &figure).err());
            }
        }
        let printed = output::print(text.as_bytes());
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
}

fn write_picture(path: &Path, figure: &Figure) -> Result<(), String> {
    write_file(path, |writer| writer.write_all(figure.svg.as_bytes()))
        .map_err(|error| error.to_string())
}

/// `trade.svg` as `trade_0.63um.svg`.
fn named(path: &Path, wavelength_um: Option<f64>) -> PathBuf {
    let Some(wavelength_um) = wavelength_um else {
        return path.to_owned();
    };
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path
        .extension()
        .map_or_else(String::new, |e| format!(".{}", e.display()));
    path.with_file_name(format!("{stem}_{wavelength_um}um{extension}"))
}
