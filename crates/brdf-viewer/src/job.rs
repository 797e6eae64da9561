//! The work that the state asks of the worker, and what the worker answers. Both know these types
//! and not each other.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use brdf_fit::plot::View;
use brdf_fit::progress::Step;
use brdf_fit::report::{Depth, Report};
use brdf_fit::scan::Convention;
use brdf_fit::{FitOptions, Measurements};

use crate::intent::{Export, Picture};
use crate::state::sample::{Knobs, Sample, Scan, ScanId};

/// Work.
#[derive(Debug)]
pub enum Job {
    /// Read a scan in this angular convention, or a fit as JSON, which says in which its scan is.
    Read(PathBuf, Convention),
    /// Read a scan that is already here: its name, its bytes and its angular convention.
    ReadBytes(String, Vec<u8>, Convention),
    /// Fit these scans one after the other.
    Fit(Vec<FitJob>, Depth),
    /// Write a file.
    Write(PathBuf, Writing),
}

/// One fit.
#[derive(Debug)]
pub struct FitJob {
    /// The scan.
    pub scan: ScanId,
    /// Its readings.
    pub measurements: Arc<Measurements>,
    /// The settings.
    pub options: FitOptions,
    /// Ends it.
    pub stop: Stop,
}

/// Ends a fit before its next step, or before its first.
#[derive(Debug, Clone, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Asks the fit to end.
    pub fn ask(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the fit was asked to end.
    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// What is written.
#[derive(Debug)]
pub enum Writing {
    /// A figure of these samples.
    Figure(Picture, Vec<Layer>, View),
    /// Readings and theory; the theory alone at these incidences where there are no readings.
    Curves(Arc<Measurements>, Knobs, Vec<f64>),
    /// Fits.
    Fit(Vec<Arc<Report>>),
}

/// A sample as a figure needs it.
#[derive(Debug)]
pub struct Layer {
    /// Its name.
    pub name: String,
    /// Its readings.
    pub measurements: Arc<Measurements>,
    /// The theory.
    pub knobs: Knobs,
    /// The fit, where the theory is its own.
    pub fitted: Option<Arc<Report>>,
    /// The incidences that are shown, in radians.
    pub incidences: Vec<f64>,
    /// Its family of colours; `None` where it is the only sample.
    pub family: Option<usize>,
}

impl Layer {
    /// A sample as it is shown, in this family of colours.
    pub fn of(sample: &Sample, family: Option<usize>) -> Self {
        let scan = sample.scan();
        Self {
            name: sample.name.clone(),
            measurements: Arc::clone(&scan.measurements),
            knobs: scan.knobs,
            fitted: scan.fit_shown().cloned(),
            incidences: scan.shown_psi(),
            family,
        }
    }
}

/// A scan that was read, with its wavelengths.
#[derive(Debug)]
pub struct Opened {
    /// What was opened: a file, or an entry of the built-in menu.
    pub source: String,
    /// The file of the readings, where they are from one.
    pub file: Option<PathBuf>,
    /// One scan for each wavelength.
    pub scans: Vec<Scan>,
}

/// What the worker has done.
#[derive(Debug)]
pub enum Event {
    /// Something was opened: the file that was asked for, where it was one, and what is in it.
    Opened(Option<PathBuf>, Vec<Opened>),
    /// A source cannot be opened, and why.
    NotOpened(String),
    /// Files were chosen in a dialog.
    Chosen(Vec<PathBuf>),
    /// Where to write was chosen in a dialog.
    ChosenExport(Export, PathBuf),
    /// A fit made a step.
    Step(ScanId, Step),
    /// A fit has ended, well or not: its report says how.
    Fitted(ScanId, Box<Report>),
    /// A fit broke off for a reason that is none of the data, and what is known of it.
    Broken(ScanId, String),
    /// All fits have ended, or were stopped.
    FitsEnded,
    /// A file was written.
    Written(PathBuf),
    /// A file was not written, and why.
    NotWritten(String),
}
