//! The options of `brdf trade`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::values::{CoordinatesArgument, Row};
use crate::cli::scene::{SceneArguments, positive};
use crate::model::Model;
use crate::scan::RefractiveIndex;

/// Measures on this machine how much accuracy speed costs
///
/// Without a subcommand, it measures every way to evaluate a BRDF over the directions of a scene:
/// the time of an evaluation and the errors relative to the value in double precision;
/// and it names the fastest way within the tolerance. The subcommand fit measures the ways to fit a
/// scan: the time, the error E and the change of the parameters.
///
/// Exit status: 0 if everything was measured; 1 if no evaluator is within the tolerance or a scan
/// cannot be fitted (what was measured is delivered); 2 for incorrect usage, input that cannot be
/// read, or output that cannot be written.
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(in crate::cli) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Option<Command>,

    #[command(flatten)]
    pub(super) evaluation: Evaluation,

    #[command(flatten)]
    pub(super) outputs: Outputs,
}

#[derive(Subcommand)]
pub(super) enum Command {
    /// Compares the ways to fit a scan: the methods, the stages, every 2nd, 4th or 8th reading,
    /// fewer incidence angles, fewer iterations
    Fit(Fitting),
}

#[derive(Args)]
pub(super) struct Evaluation {
    /// Evaluate the BRDF of a fit in this file, as written by brdf fit --json: the first one, or
    /// that of --wavelength; - is standard input
    #[arg(long, value_name = "FILE", conflicts_with = "sample")]
    pub(super) model: Option<PathBuf>,

    /// The wavelength of the fit of --model, in um (the nearest within 1 %)
    #[arg(long, value_name = "UM", requires = "model")]
    pub(super) wavelength: Option<f64>,

    /// Evaluate the BRDF of a row of the paper's Table 1, as "SAMPLE WAVELENGTH" with the wavelength
    /// in um [default: "001 0.91"]
    #[arg(long, value_name = "ROW")]
    pub(super) sample: Option<Row>,

    #[command(flatten)]
    pub(super) scene: SceneArguments,

    /// The form in which the scene supplies its directions
    #[arg(
        long,
        value_enum,
        value_name = "COORDINATES",
        default_value = "cosines"
    )]
    pub(super) coordinates: CoordinatesArgument,

    /// Largest relative error of f_r
    #[arg(long, value_name = "ERROR", default_value = "1e-3", value_parser = positive)]
    pub(super) tolerance: f64,

    /// Number of evaluations that the scene needs
    #[arg(long, value_name = "COUNT", default_value = "1e8", value_parser = positive)]
    pub(super) evaluations: f64,
}

#[derive(Args)]
pub(super) struct Fitting {
    /// A scan, in any format that brdf fit reads; - is standard input
    #[arg(value_name = "FILE")]
    pub(super) file: PathBuf,

    /// Refractive index, as for brdf fit
    #[arg(long, value_name = "INDEX")]
    pub(super) n: Option<RefractiveIndex>,

    /// The model, as for brdf fit
    #[arg(long, value_name = "MODEL", default_value_t = Model::Three)]
    pub(super) model: Model,

    #[command(flatten)]
    pub(super) outputs: Outputs,
}

#[derive(Args)]
pub(super) struct Outputs {
    /// Write the table to this file, as CSV; - is standard output, in place of the printed table
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,

    /// Write all results to this file, as JSON; - is standard output, in place of the printed table
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,

    /// Draw error against time into this file, as SVG; - is standard output, in place of the printed
    /// table
    ///
    /// With several wavelengths, there is one file for each of them, with the wavelength in its
    /// name.
    #[arg(long, value_name = "FILE")]
    pub(super) plot: Option<PathBuf>,
}
