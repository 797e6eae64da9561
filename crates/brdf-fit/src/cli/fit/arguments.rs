//! The options of `brdf fit`.

use std::path::PathBuf;

use clap::Parser;

use super::cube::CubeArguments;
use super::values::{
    DEFAULT_LIMIT, ModelArgument, ReadingWeights, methods_or_none, parse_energy_limit, parse_limit,
    parse_model,
};
use crate::cli::reading::ReadingArguments;
use crate::fit::FitOptions;
use crate::fit::robust::Loss;
use crate::model::FixedParameters;
use crate::objective::weights::AngleWeight;
use crate::scan::RefractiveIndex;

/// Fits the three-parameter BRDF of Li, Yan and Wu (2002) to goniometer scans
///
/// Each wavelength of each file is fitted on its own: starting values, stage 1 over the incidence
/// angles up to a limit, stage 2 over all incidence angles, and a search over k1 that checks the
/// result against the global optimum.
///
/// A file is a CSV table with the columns psi_deg, theta_deg and brdf_per_sr and, optionally,
/// wavelength_um, phi_deg, sigma_per_sr and n, or a file in another of the formats of --format. The
/// file - is standard input.
///
/// The tables are printed on standard output. If --json or --curves writes to - (standard output),
/// the tables are left out.
///
/// Exit status: 0 if every fit succeeded; 1 if a fit failed (the remaining results are delivered); 2
/// for incorrect usage, input that cannot be read, or output that cannot be written.
#[derive(Parser)]
#[command(version, max_term_width = 100)]
pub(in crate::cli) struct Arguments {
    /// Scans, in any of the formats of --format; - is standard input
    #[arg(required_unless_present = "cube", value_name = "FILE")]
    pub(super) files: Vec<PathBuf>,

    /// Fit with the options of an earlier run, from the file that it wrote with --json
    ///
    /// Each scan takes the options of the fit at its wavelength (within 1 %), and of several those
    /// of the fit of the same file. The format of the file, the sides of its angles, --columns,
    /// --declare and --join are taken from there as well, each unless it is given; --sample must be
    /// repeated. - is standard input.
    #[arg(long, value_name = "FILE", conflicts_with_all = FIT_OPTIONS)]
    pub(super) again: Option<PathBuf>,

    /// The model: lambert, specular, three, three+n, smith+n, power+n, ggx, ggx+n, beckmann,
    /// beckmann+n, or auto [default: three]
    ///
    /// three is the model of the paper; with +n the refractive index is fitted too. auto is the
    /// smallest of the first six models that predicts each incidence angle, when it is left out of
    /// the fit, about as well as the best of the six does; three where there are too few incidences.
    #[arg(long, value_name = "MODEL", value_parser = parse_model)]
    pub(super) model: Option<ModelArgument>,

    /// Also fit the reference models GGX and Beckmann, with the given n and with n fitted
    #[arg(long)]
    pub(super) compare: bool,

    /// Refractive index of the coating relative to air, from 1 to 1e5 [default: as the file states
    /// it in a column n or in a line "# refractive_index: 1.5"]
    ///
    /// Either one number for all wavelengths, or pairs WAVELENGTH=INDEX with the wavelength in um,
    /// such as 0.63=1.60,0.85=1.58. A scan takes the index of the nearest wavelength, which must be
    /// within 1 % of its own.
    #[arg(long, value_name = "INDEX")]
    pub(super) n: Option<RefractiveIndex>,

    /// Parameters to fix at a value instead of fitting them, as NAME=VALUE pairs such as
    /// k1=0.2,kD=0.05; only parameters that the model fits
    #[arg(long, alias = "hold", value_name = "PAIRS")]
    pub(super) fix: Option<FixedParameters>,

    /// Method of stage 1, or none to omit this stage
    #[arg(long, value_name = "METHOD", default_value = "levenberg-marquardt", value_parser = methods_or_none())]
    pub(super) stage1: String,

    /// Method of stage 2, or none to fit only the readings of stage 1
    #[arg(long, value_name = "METHOD", default_value = "levenberg-marquardt", value_parser = methods_or_none())]
    pub(super) stage2: String,

    /// Largest incidence angle of stage 1, in degrees
    #[arg(long, value_name = "DEGREES", default_value = "60", value_parser = parse_limit)]
    pub(super) stage1_limit: f64,

    /// Largest number of iterations of each stage
    #[arg(long, value_name = "COUNT", default_value_t = FitOptions::default().max_iterations, value_parser = clap::value_parser!(u64).range(1..))]
    pub(super) max_iterations: u64,

    /// Weights of the readings in the error E, in addition to g1 and g2
    #[arg(long, value_enum, value_name = "WEIGHTS", default_value = "none")]
    pub(super) weights: ReadingWeights,

    /// Leave out readings whose view direction is closer to the source than this, in degrees
    #[arg(long, value_name = "DEGREES", default_value = "0", value_parser = parse_limit)]
    pub(super) mask_source: f64,

    /// Leave out readings whose view direction is closer to the mirror direction than this, in
    /// degrees
    #[arg(long, value_name = "DEGREES", default_value = "0", value_parser = parse_limit)]
    pub(super) mask_mirror: f64,

    /// Loss for data with outliers: huber or tukey; rejected readings are listed [default: the
    /// square of the residual]
    #[arg(long, value_name = "LOSS")]
    pub(super) robust: Option<Loss>,

    /// Fit under the constraint that no more light is reflected than arrives, rho(psi) <= 1, for
    /// incidence angles up to DEGREES, which is 85 if no number follows
    ///
    /// The number may follow as --energy-conserving=80 or as --energy-conserving 80.
    #[arg(long, value_name = "DEGREES", num_args = 0..=1, require_equals = true,
          default_missing_value = DEFAULT_LIMIT, value_parser = parse_energy_limit)]
    pub(super) energy_conserving: Option<f64>,

    /// Weight g1 as a function of the incidence angle psi, as DEGREES=WEIGHT pairs such as
    /// 60=1,80=0.5: linear between the pairs, constant beyond them [default: 1]
    #[arg(long, value_name = "PAIRS")]
    pub(super) g1: Option<AngleWeight>,

    /// Weight g2 as a function of the view angle theta (positive on the side of the source), as
    /// DEGREES=WEIGHT pairs such as -80=0.5,0=1 [default: 1]
    #[arg(long, value_name = "PAIRS", allow_hyphen_values = true)]
    pub(super) g2: Option<AngleWeight>,

    #[command(flatten)]
    pub(super) reading: ReadingArguments,

    /// Fit only this many readings of each wavelength, spread evenly over the angles theta_h,
    /// theta_d and phi_d between half vector and directions [default: all]
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u64).range(1..))]
    pub(super) sample: Option<u64>,

    /// Write all results to this file, as JSON with a format version; - is standard output
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,

    /// Write the measured and the fitted f_r of every reading to this file, as CSV; - is standard
    /// output
    #[arg(long, value_name = "FILE")]
    pub(super) curves: Option<PathBuf>,

    /// Draw every fit into this folder, as SVG and PNG, with a page report.html of all figures and
    /// tables
    ///
    /// The folder is created if it does not exist. Of a MERL table, the figures show the bins that
    /// a goniometer would measure in the plane of incidence.
    #[arg(long, value_name = "FOLDER")]
    pub(super) plot: Option<PathBuf>,

    /// Print the stages, the incidences, the compared models and the reflectance as well
    #[arg(long, short)]
    pub(super) verbose: bool,

    /// Print the parameters as CSV, one line for each fit, instead of the tables
    #[arg(long)]
    pub(super) params_only: bool,

    #[command(flatten)]
    pub(super) cube: CubeArguments,
}

/// The options of a fit, which `--again` takes from a file.
const FIT_OPTIONS: [&str; 14] = [
    "model",
    "n",
    "fix",
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
