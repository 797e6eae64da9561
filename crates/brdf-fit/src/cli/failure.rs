//! Why a command failed, with the options of the command line named.

use std::io;
use std::path::{Path, PathBuf};

use brdf_core::ParameterError;
use brdf_core::scene::DomainError;

use super::explain;
use super::stream::{StreamError, shown};
use crate::cube::CubeError;
use crate::export::{ExportError, MaterialError, SelectionError};
use crate::fit::FitError;
use crate::format::listed;
use crate::output::{TakenError, WriteError};
use crate::planning::PlanError;
use crate::plot::FolderError;
use crate::plot::PlotError;
use crate::read::ReadError;
use crate::report::DocumentError;
use crate::tradeoff::fitting::TradeoffError;

/// Why a command failed, or one of its outputs.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
    #[error(transparent)]
    Stream(#[from] StreamError),
    #[error(transparent)]
    Taken(#[from] TakenError),
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error(transparent)]
    Folder(#[from] FolderError),
    #[error(transparent)]
    Plot(#[from] PlotError),
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(transparent)]
    Domain(#[from] DomainError),
    #[error("{}", explain::read(.0))]
    Read(#[from] ReadError),
    #[error("{}", explain::document(.0))]
    Document(#[from] DocumentError),
    #[error("{}", explain::material(.0))]
    Material(#[from] MaterialError),
    #[error("{}", explain::selection(.0))]
    Selection(#[from] SelectionError),
    #[error("{}", explain::export(.0))]
    Export(#[from] ExportError),
    #[error("{}", explain::fit(.0))]
    Fit(#[from] FitError),
    #[error("{}", explain::cube(.0))]
    Cube(#[from] CubeError),
    #[error("{}: {}", .0.display(), explain::cube_output())]
    CubeOutput(PathBuf),
    #[error(
        "--model auto chooses a model for each scan: expected one model for all scans of --cube"
    )]
    CubeModel,
    #[error("{}", explain::tradeoff(.0))]
    Tradeoff(#[from] TradeoffError),
    #[error("{}", explain::plan(.0))]
    Plan(#[from] PlanError),
    /// A scan without the wavelength that is planned for.
    #[error("no scan of {wavelength_um} um: {}", expected_wavelengths(.found))]
    NoScan {
        wavelength_um: f64,
        found: Vec<String>,
    },
    #[error("the files state different refractive indices: expected one sample for --join")]
    Join,
    #[error("{0} files: expected one, or --join for the files of one sample")]
    SeveralFiles(usize),
    /// A failure that concerns one file, or one wavelength of it.
    #[error("{place}: {failure}")]
    At { place: String, failure: Box<Self> },
    #[error("standard output: {0}")]
    Print(io::Error),
    /// A row of Table 1 that does not exist.
    #[error("{0}")]
    Row(String),
    #[error("{}: holds no fit", shown(.0).display())]
    NoFit(PathBuf),
    #[error("{}: no fit of {wavelength_um} um: expected one of {}", shown(.path).display(), listed(.found, ", "))]
    NoSuchWavelength {
        path: PathBuf,
        wavelength_um: f64,
        found: Vec<String>,
    },
    #[error("--{option} has no effect on the format {format}")]
    NoEffect {
        option: &'static str,
        format: &'static str,
    },
    #[error(
        "the format {format} is two files, FILE and one with the extension {extension}: expected -o \
         FILE"
    )]
    TwoFiles {
        format: &'static str,
        extension: &'static str,
    },
    #[error(
        "--plot: there are {0} figures, one for each wavelength: standard output takes only one"
    )]
    SeveralFigures(usize),
}

/// The wavelengths that an option could name; without any, the scan has none.
fn expected_wavelengths(found: &[String]) -> String {
    if found.is_empty() {
        "the file states no wavelength, expected no --wavelength".to_owned()
    } else {
        format!("expected one of {}", listed(found, ", "))
    }
}

impl Failure {
    /// The same failure, of a file or of a part of it.
    pub(super) fn at(self, place: impl Into<String>) -> Self {
        Self::At {
            place: place.into(),
            failure: Box::new(self),
        }
    }

    /// The same failure, of a file that the command line names.
    pub(super) fn in_file(self, path: &Path) -> Self {
        self.at(shown(path).display().to_string())
    }
}
