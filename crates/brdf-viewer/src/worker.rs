//! What takes longer than a frame: reading, fitting and writing, each on a thread of its own.
//!
//! It calls `brdf_fit` and nothing else, so that the numbers are those of the command line.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use brdf_core::{AnyBrdf, Geometry};
use brdf_fit::output::write_file;
use brdf_fit::plot::{self, View, figure_of};
use brdf_fit::read::Convention;
use brdf_fit::report::{Depth, Document, ModelChoice, Report, write_theory};
use brdf_fit::watch::{Step, Watch};
use brdf_fit::{FitOptions, Measurements};

use crate::intent::{Export, Picture};
use crate::state::built_in;
use crate::state::sample::{Knobs, Sample, Scan, ScanId};

/// Pixels of a PNG for each unit of its figure: print quality.
const PNG_SCALE: f32 = 3.0;

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
}

/// What is written.
#[derive(Debug)]
pub enum Writing {
    /// A figure of these samples.
    Figure(Picture, Vec<Layer>, View),
    /// Readings and theory.
    Curves(Arc<Measurements>, Knobs),
    /// Fits.
    Fit(Vec<Arc<Report>>),
}

/// A sample as a figure needs it.
#[derive(Debug)]
pub struct Layer {
    name: String,
    measurements: Arc<Measurements>,
    knobs: Knobs,
    fitted: Option<Arc<Report>>,
    incidences: Vec<f64>,
    family: usize,
}

/// What the worker has done.
#[derive(Debug)]
pub enum Event {
    /// A source was opened: what it is called, its file where it is one, and its scans.
    Opened(String, Option<PathBuf>, Vec<Scan>),
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
    /// All fits have ended.
    FitsEnded {
        /// Whether the user stopped them.
        cancelled: bool,
    },
    /// A file was written.
    Written(PathBuf),
    /// A file was not written, and why.
    NotWritten(String),
}

/// Where events go; the window is woken for each.
#[derive(Clone)]
pub struct Events {
    to: Sender<Event>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Events {
    /// Sends an event. Where nobody listens any more, nobody needs it.
    pub fn send(&self, event: Event) {
        let _ = self.to.send(event);
        (self.wake)();
    }
}

/// The threads that work.
pub struct Worker {
    files: Sender<Job>,
    fits: Sender<(Job, Arc<AtomicBool>)>,
    events: Events,
    from: Receiver<Event>,
    cancel: Arc<AtomicBool>,
}

impl Worker {
    /// Starts the threads. `wake` is called when there is an event to look at.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        let (to, from) = channel();
        let wake = Arc::new(wake);
        let events = Events { to, wake };
        let (files, file_jobs) = channel::<Job>();
        let (fits, fit_jobs) = channel::<(Job, Arc<AtomicBool>)>();
        let answers = events.clone();
        thread::spawn(move || {
            for job in file_jobs {
                answers.send(work_on_file(job));
            }
        });
        let answers = events.clone();
        thread::spawn(move || {
            for (job, cancel) in fit_jobs {
                if let Job::Fit(jobs, depth) = job {
                    fit_all(jobs, depth, &cancel, &answers);
                }
            }
        });
        Self {
            files,
            fits,
            events,
            from,
            cancel: Arc::default(),
        }
    }

    /// Gives work to a thread.
    pub fn start(&mut self, job: Job) {
        // A thread ends with its queue only, so that someone takes the job.
        if matches!(job, Job::Fit(..)) {
            self.cancel = Arc::default();
            let _ = self.fits.send((job, Arc::clone(&self.cancel)));
        } else {
            let _ = self.files.send(job);
        }
    }

    /// Stops the fits that were started last.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// Where others than the worker send events.
    pub fn events(&self) -> Events {
        self.events.clone()
    }

    /// What has happened since the last time.
    pub fn take_events(&self) -> Vec<Event> {
        self.from.try_iter().collect()
    }
}

/// Ends what runs.
impl Drop for Worker {
    fn drop(&mut self) {
        self.cancel();
    }
}

/// Hands the steps of a fit on, and stops it.
struct Follow<'a> {
    scan: ScanId,
    cancel: &'a AtomicBool,
    events: &'a Events,
}

impl Watch for Follow<'_> {
    fn step(&self, step: &Step) -> ControlFlow<()> {
        self.events.send(Event::Step(self.scan, *step));
        if self.cancel.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

fn fit_all(jobs: Vec<FitJob>, depth: Depth, cancel: &AtomicBool, events: &Events) {
    for job in jobs {
        let watch = Follow {
            scan: job.scan,
            cancel,
            events,
        };
        let choice = ModelChoice::Given;
        let (report, _) =
            Report::of_watched(&job.measurements, &job.options, choice, depth, &watch);
        if cancel.load(Ordering::Relaxed) {
            break;
        }
        events.send(Event::Fitted(job.scan, Box::new(report)));
    }
    let cancelled = cancel.load(Ordering::Relaxed);
    events.send(Event::FitsEnded { cancelled });
}

fn work_on_file(job: Job) -> Event {
    match job {
        Job::Read(path, convention) => match read(&path, convention) {
            Ok(scans) => Event::Opened(path.display().to_string(), Some(path), scans),
            Err(error) => Event::NotOpened(error),
        },
        Job::ReadBytes(name, bytes, convention) => match read_text(&name, &bytes, convention) {
            Ok(scans) => Event::Opened(name, None, scans),
            Err(error) => Event::NotOpened(error),
        },
        Job::Write(path, writing) => match write(&path, &writing) {
            Ok(()) => Event::Written(path),
            Err(error) => Event::NotWritten(error),
        },
        Job::Fit(..) => Event::NotOpened("a fit is no work for this thread".to_owned()),
    }
}

fn is_fit(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("json"))
}

fn read(path: &Path, convention: Convention) -> Result<Vec<Scan>, String> {
    if is_fit(path) {
        read_fit(path)
    } else {
        read_scan(path, convention)
    }
}

fn read_scan(path: &Path, convention: Convention) -> Result<Vec<Scan>, String> {
    Measurements::read_csv_with(path, convention)
        .map(scans)
        .map_err(|error| error.to_string())
}

fn read_text(name: &str, bytes: &[u8], convention: Convention) -> Result<Vec<Scan>, String> {
    Measurements::from_reader_with(bytes, name, convention)
        .map(scans)
        .map_err(|error| error.to_string())
}

fn scans(measurements: Measurements) -> Vec<Scan> {
    let all = measurements.by_wavelength().into_iter();
    all.map(Scan::new).collect()
}

/// The scans that a document of fits is of, with these fits.
fn read_fit(path: &Path) -> Result<Vec<Scan>, String> {
    let document = Document::read(path).map_err(|error| error.to_string())?;
    let mut all = Vec::new();
    let reports = document.reports.iter();
    let mut files: Vec<(&str, Convention)> = reports
        .map(|report| (report.file.as_str(), report.convention))
        .collect();
    files.dedup();
    for (file, convention) in files {
        let mut scans = read_scan_of(path, file, convention)?;
        for scan in &mut scans {
            let wavelength = scan.wavelength_um();
            let of_this =
                |report: &&Report| report.file == file && report.wavelength_um == wavelength;
            if let Some(report) = document.reports.iter().find(of_this) {
                scan.take(report.clone());
                scan.settled = scan.knobs;
            }
        }
        all.extend(scans);
    }
    Ok(all)
}

/// The scan that a fit names: as it is named, beside the fit, or among the built-in ones.
fn read_scan_of(fit: &Path, file: &str, convention: Convention) -> Result<Vec<Scan>, String> {
    let beside = fit.parent().map(|folder| folder.join(file));
    let same_folder = fit
        .parent()
        .and_then(|folder| Some(folder.join(Path::new(file).file_name()?)));
    for path in [Some(PathBuf::from(file)), beside, same_folder]
        .into_iter()
        .flatten()
    {
        if path.is_file() {
            return read_scan(&path, convention);
        }
    }
    match built_in::text_of(file) {
        Some(text) => read_text(file, text.as_bytes(), convention),
        None => Err(format!(
            "{}: is a fit of {file}, which cannot be found: expected the scan where the fit names \
             it, or beside the fit",
            fit.display()
        )),
    }
}

impl Layer {
    /// A sample as it is shown.
    pub fn of(sample: &Sample) -> Self {
        let scan = sample.scan();
        Self {
            name: sample.name.clone(),
            measurements: Arc::clone(&scan.measurements),
            knobs: scan.knobs,
            fitted: scan.fit_shown().cloned(),
            incidences: scan.shown_psi(),
            family: sample.family,
        }
    }
}

fn write(path: &Path, writing: &Writing) -> Result<(), String> {
    let bytes = match writing {
        Writing::Figure(picture, layers, view) => figure(*picture, layers, view)?,
        Writing::Curves(measurements, knobs) => curves(measurements, knobs)?,
        Writing::Fit(reports) => fits(reports)?,
    };
    write_file(path, |writer| writer.write_all(&bytes)).map_err(|error| error.to_string())
}

/// The standard error of the theory at a geometry.
type Band<'a> = Box<dyn Fn(&Geometry) -> f64 + 'a>;

fn figure(picture: Picture, layers: &[Layer], view: &View) -> Result<Vec<u8>, String> {
    let mut brdfs: Vec<AnyBrdf> = Vec::new();
    for layer in layers {
        let knobs = &layer.knobs;
        let brdf = AnyBrdf::new(knobs.model.family(), &knobs.at);
        brdfs.push(brdf.map_err(|error| format!("{}: {error}", layer.name))?);
    }
    let bands: Vec<Option<Band>> = layers
        .iter()
        .zip(&brdfs)
        .map(|(layer, brdf)| {
            let uncertainty = layer.fitted.as_ref()?.uncertainty.as_ref()?;
            let band = move |at: &Geometry| uncertainty.band(brdf, at);
            Some(Box::new(band) as Band)
        })
        .collect();
    let layers: Vec<plot::Layer> = layers
        .iter()
        .zip(&brdfs)
        .zip(&bands)
        .map(|((layer, brdf), band)| plot::Layer {
            name: layer.name.clone(),
            measurements: &layer.measurements,
            brdf: *brdf,
            theory: theory_in_words(&layer.knobs),
            sigma: band.as_deref(),
            incidences: Some(&layer.incidences),
            family: layer.family,
        })
        .collect();
    let figure = figure_of(&layers, view).map_err(|error| error.to_string())?;
    match picture {
        Picture::Svg => Ok(figure.svg.into_bytes()),
        Picture::Png => figure.png(PNG_SCALE).map_err(|error| error.to_string()),
    }
}

/// The model and its parameters in words.
fn theory_in_words(knobs: &Knobs) -> String {
    let values = knobs.parameters().into_iter();
    let values: Vec<String> = values
        .map(|p| format!("{p} = {:.4}", p.of(&knobs.at)))
        .collect();
    format!("{}: {}", knobs.model, values.join(", "))
}

fn curves(measurements: &Measurements, knobs: &Knobs) -> Result<Vec<u8>, String> {
    let brdf = AnyBrdf::new(knobs.model.family(), &knobs.at).map_err(|error| error.to_string())?;
    let mut bytes = Vec::new();
    write_theory(measurements, &brdf, &mut bytes).map_err(|error| error.to_string())?;
    Ok(bytes)
}

fn fits(reports: &[Arc<Report>]) -> Result<Vec<u8>, String> {
    let reports = reports.iter().map(|report| (**report).clone()).collect();
    let mut bytes =
        serde_json::to_vec_pretty(&Document::new(reports)).map_err(|error| error.to_string())?;
    bytes.push(b'\n');
    Ok(bytes)
}
