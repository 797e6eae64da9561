//! The jobs that the state requests of the worker, and the events with which the worker answers.
//! The state and the worker both use these types and do not depend on each other.

use std::path::PathBuf;
use std::sync::Arc;

use brdf_fit::Convention;
use brdf_fit::Step;
use brdf_fit::planning::MeasurementPlan;
use brdf_fit::plot::{Ground, View};
use brdf_fit::read::LazyScan;
use brdf_fit::report::{Depth, Report};
use brdf_fit::{FitOptions, Measurements};

use egui::ColorImage;

use crate::cancel::CancelFlag;
use crate::output_kind::{FigureFormat, OutputKind};
use crate::solid::surface::Composition;
use crate::solid::{Camera, LobeScene};
use crate::state::id::{SampleId, ScanId};
use crate::state::parameters::EditedParameters;
use crate::state::sample::{Opened, Sample, Scan};

/// A job of the worker.
#[derive(Debug)]
pub enum Job {
    /// Read or write a file.
    File(FileJob),
    /// Fit scans one after the other.
    Fit(FitJobs),
}

/// A job that reads or writes a file.
#[derive(Debug)]
pub enum FileJob {
    /// Read a scan in an angular convention, or a fit as JSON, which states the convention of its
    /// scan.
    Open(PathBuf, Convention),
    /// Read a scan from the content of a file: its name, its bytes and its angular convention.
    OpenBytes(String, Vec<u8>, Convention),
    /// Draw a figure for the clipboard.
    Draw(Drawing),
    /// Write a file.
    Write(PathBuf, Output),
    /// Plan the next readings of a scan.
    Plan(ScanId, Arc<Measurements>),
}

/// Fits of scans, one after the other.
#[derive(Debug)]
pub struct FitJobs {
    /// The number of the run, which its end states.
    pub run: u64,
    /// The fits.
    pub fits: Vec<FitJob>,
    /// The depth of the analysis of each.
    pub depth: Depth,
}

/// The fit of one scan.
#[derive(Debug)]
pub struct FitJob {
    /// The scan.
    pub scan: ScanId,
    /// The readings that are used.
    pub measurements: Arc<Measurements>,
    /// The indices of the readings of the scan that are not.
    pub left_out: Vec<usize>,
    /// The channel of a table of which all bins are fitted, in place of `measurements`.
    pub table: Option<LazyScan>,
    /// The options of the fit.
    pub options: FitOptions,
    /// Cancels the fit.
    pub cancel: CancelFlag,
}

/// The data of a file that is written.
#[derive(Debug)]
pub enum Output {
    /// A figure.
    Figure(FigureFormat, Drawing),
    /// The mesh of a lobe.
    Mesh(Box<LobeDrawing>),
    /// Readings and theory; without readings, the theory at incidence angles in radians.
    Curves(Arc<Measurements>, EditedParameters, Vec<f64>),
    /// The fits of samples.
    Fit(Vec<Arc<Report>>, Vec<SampleId>),
}

/// What a figure shows.
#[derive(Debug)]
pub enum Drawing {
    /// Curves and readings of samples.
    Curves(Vec<FigureLayer>, View),
    /// The lobe of an incidence.
    Lobe(Box<LobeDrawing>),
    /// Surfaces under light.
    Surface(Composition),
}

/// The data of a lobe that a figure or a mesh shows.
#[derive(Debug, Clone)]
pub struct LobeDrawing {
    /// The lobe with its readings.
    pub scene: LobeScene,
    /// Where it is looked at from.
    pub camera: Camera,
    /// Two lines of title.
    pub title: [String; 2],
    /// The ground of the figure.
    pub ground: Ground,
}

/// The data of a sample that a figure shows.
#[derive(Debug)]
pub struct FigureLayer {
    /// The name of the sample.
    pub name: String,
    /// Its readings.
    pub measurements: Arc<Measurements>,
    /// The parameters of the theory.
    pub parameters: EditedParameters,
    /// The fit with these parameters, if there is one.
    pub fit: Option<Arc<Report>>,
    /// The visible incidence angles, in radians.
    pub incidences: Vec<f64>,
    /// The colour family; `None` if the figure shows only this sample.
    pub family: Option<usize>,
}

impl FigureLayer {
    /// The visible incidences of a scan of a sample, in the colours of a family.
    pub fn new(sample: &Sample, scan: &Scan, family: Option<usize>) -> Self {
        Self {
            name: sample.name_of(scan),
            measurements: Arc::clone(&scan.measurements),
            parameters: scan.parameters,
            fit: scan.current_fit().cloned(),
            incidences: scan.visible_psi(),
            family,
        }
    }
}

/// A result of a job, or an answer of a dialog.
#[derive(Debug)]
pub enum Event {
    /// Something was opened: the path that was requested, if any, and the samples found there.
    Opened(Option<PathBuf>, Vec<Opened>),
    /// Something could not be opened, and the error message.
    OpenFailed(String),
    /// Files to open were chosen in a dialog.
    FilesChosen(Vec<PathBuf>),
    /// The path of a file to write was chosen in a dialog.
    OutputChosen(OutputKind, PathBuf),
    /// A fit made a step.
    Step(ScanId, Step),
    /// The parameters of a fit are known; its analysis follows.
    Found(ScanId, Box<Report>),
    /// A fit has ended with a report, which contains the fit or its error.
    Fitted(ScanId, Box<Report>),
    /// A fit was ended by an internal error, and the error message.
    FitAborted(ScanId, String),
    /// All fits of a run, by its number, have ended or were cancelled.
    FitsEnded(u64),
    /// A file was written, and the samples whose fits it contains.
    Written(PathBuf, Vec<SampleId>),
    /// A figure was drawn for the clipboard.
    Drawn(ColorImage),
    /// A file could not be written, and the error message.
    WriteFailed(String),
    /// The next readings of a scan were planned, or cannot be, with the readings that it has.
    Planned(
        ScanId,
        Arc<Measurements>,
        Result<Box<MeasurementPlan>, String>,
    ),
}
