//! What the end-to-end tests share: where things are, the built programs, noise, and the
//! independently computed optima.

#![expect(
    clippy::missing_panics_doc,
    reason = "tests panic, that is how they fail"
)]

pub mod coverage;
pub mod data;
pub mod picture;
pub mod planning;
mod python;
pub mod samples;
pub mod textbook;

pub use python::{python, run_python};

use std::ffi::OsStr;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use brdf_core::{AnyBrdf, Parameters};
use brdf_fit::Measurements;
use brdf_fit::export::{Fitted, Material};
use escargot::format::Message as CargoMessage;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use serde_json::Value;

/// A path below the workspace's root.
pub fn in_workspace(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// The folder of measured samples beside the workspace. Where it is absent, says so: the caller
/// has nothing to test then.
pub fn shared_data() -> Option<PathBuf> {
    let folder = in_workspace("../shared/data");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no ../shared/data beside the project");
    None
}

/// Runs the program `fit`.
pub fn run_fit<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Output {
    fit_command()
        .args(arguments)
        .output()
        .expect("the program starts")
}

/// A material of red, green and blue, as of fits to a scan of these wavelengths.
pub fn made_up_material(brdfs: &[AnyBrdf]) -> Material {
    let fits = brdfs.iter().zip([0.62, 0.55, 0.46]);
    let fits = fits.map(|(brdf, um)| Fitted {
        file: "made-up.csv".to_owned(),
        wavelength_um: Some(um),
        brdf: *brdf,
        e_percent: 1.0,
        psi_max_deg: 70.0,
    });
    Material {
        fits: fits.collect(),
    }
}

/// A text with single blanks between its words: sentences of a report without their line breaks.
pub fn unwrapped(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Runs a command with this text as its standard input.
pub fn run_with_input(command: &mut Command, input: &[u8]) -> Output {
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut pipe = child.stdin.take().expect("a pipe");
    // A program that ends on an error of usage does not read its input.
    let _ = pipe.write_all(input);
    drop(pipe);
    child.wait_with_output().expect("the program ends")
}

/// The program `fit`, to be started.
pub fn fit_command() -> Command {
    Command::new(program("fit"))
}

/// The program `brdf`, to be started.
pub fn brdf_command() -> Command {
    Command::new(program("brdf"))
}

/// `brdf trade`, to be started.
pub fn trade_command() -> Command {
    let mut command = brdf_command();
    command.arg("trade");
    command
}

/// `brdf export`, to be started.
pub fn export_command() -> Command {
    let mut command = brdf_command();
    command.arg("export");
    command
}

/// The program `viewer`, to be started.
pub fn viewer_command() -> Command {
    Command::new(program("viewer"))
}

/// A program of the workspace. All programs are built once for all tests of a process.
fn program(name: &str) -> &'static Path {
    static PROGRAMS: OnceLock<Vec<PathBuf>> = OnceLock::new();
    let programs = PROGRAMS.get_or_init(built);
    let found = programs
        .iter()
        .find(|program| program.file_stem().is_some_and(|stem| stem == name));
    found.expect("a program of the workspace")
}

/// The programs of the workspace, built.
///
/// They are built for the whole workspace, as the tests are: Cargo then chooses the same features of
/// the dependencies, and compiles none of them a second time.
fn built() -> Vec<PathBuf> {
    let build = escargot::CargoBuild::new()
        .manifest_path(in_workspace("Cargo.toml"))
        .arg("--workspace")
        .bins()
        .current_release();
    let messages = build.exec().expect("the programs build");
    let programs = messages.filter_map(|message| {
        let message = message.expect("the programs build");
        match message.decode().expect("a message of cargo") {
            CargoMessage::CompilerArtifact(artifact) => Some(artifact.executable?.into_owned()),
            _ => None,
        }
    });
    programs.collect()
}

/// A generator of random numbers that gives the same ones in every run.
pub fn generator(seed: u64) -> StdRng {
    StdRng::seed_from_u64(seed)
}

/// A number from the normal distribution of mean 0 and standard deviation 1.
pub fn normal(generator: &mut StdRng) -> f64 {
    generator.sample(StandardNormal)
}

/// A number between two others.
pub fn uniform(generator: &mut StdRng, from: f64, to: f64) -> f64 {
    generator.random_range(from..to)
}

/// A number between two others, uniform in its logarithm.
pub fn log_uniform(generator: &mut StdRng, from: f64, to: f64) -> f64 {
    generator.random_range(from.ln()..to.ln()).exp()
}

/// One line of the independently computed optima.
#[derive(Debug, Clone)]
pub struct ExpectedOptimum {
    /// The file below the folder of the samples.
    pub file: String,
    /// The wavelength in micrometres.
    pub wavelength_um: f64,
    /// The refractive index.
    pub n: f64,
    /// E over all readings in percent, and the parameters there.
    pub all: (f64, Parameters),
    /// E over the readings up to 60 deg in percent, and the parameters there.
    pub up_to_60: (f64, Parameters),
}

/// The optima that an independent program found, from a table of them.
pub fn expected_optima(table: &Path) -> Vec<ExpectedOptimum> {
    let mut reader = csv::Reader::from_path(table).expect("the optima are there");
    let rows = reader.records().map(|record| {
        let record = record.expect("a row of the optima");
        let number = |i: usize| record[i].parse::<f64>().expect("a number of the optima");
        let optimum = |i: usize| {
            (
                number(i),
                Parameters {
                    k2: number(i + 1),
                    kd: number(i + 2),
                    k1: number(i + 3),
                },
            )
        };
        ExpectedOptimum {
            file: record[0].to_owned(),
            wavelength_um: number(1),
            n: number(2),
            all: optimum(4),
            up_to_60: optimum(9),
        }
    });
    rows.collect()
}

/// The readings of one wavelength of a file.
pub fn one_wavelength(path: &Path, wavelength_um: f64) -> Measurements {
    let scan = Measurements::read_csv(path).expect("a readable sample");
    let mut wavelengths = scan.by_wavelength().into_iter();
    wavelengths
        .find(|scan| scan.wavelengths() == [Some(wavelength_um)])
        .expect("the wavelength is in the file")
}

/// The examples of the README, compiled as documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;

/// The document of a run without what differs from run to run.
pub fn without_times(json: &Path) -> Value {
    fn strip(value: &mut Value) {
        match value {
            Value::Object(fields) => {
                fields.remove("seconds");
                fields.values_mut().for_each(strip);
            }
            Value::Array(values) => values.iter_mut().for_each(strip),
            _ => {}
        }
    }
    let mut document = serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap();
    strip(&mut document);
    document
}
