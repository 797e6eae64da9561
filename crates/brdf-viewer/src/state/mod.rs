//! What is loaded, chosen and fitted.

pub mod built_in;
mod commands;
mod exporting;
pub mod fitting;
pub mod history;
pub mod interface;
mod opening;
mod running;
pub mod sample;
pub mod saved;
pub mod shown;
mod table;
mod turning;

use std::path::PathBuf;

use brdf_fit::plot::View;
use brdf_fit::scan::Convention;

use crate::intent::{Export, Intent};
use crate::job::{Event, Job};
use fitting::{FitChoice, FitRun};
use history::History;
use interface::{Dialog, Interface, Message, Severity};
use sample::{Sample, SampleId, Scan, ScanId};
use saved::{Reopened, Saved};
use shown::Shown;

/// So many messages are kept; older ones go.
const MOST_MESSAGES: usize = 20;

/// What a change of the state asks of the world around it.
#[derive(Debug)]
pub enum Effect {
    /// Work for the worker.
    Job(Job),
    /// A text for the clipboard.
    Copy(String),
    /// Ask the system's dialog for files to open.
    AskOpen,
    /// Ask the system's dialog where to write.
    AskExport(Export, PathBuf),
    /// Leave.
    Quit,
}

/// Everything that is loaded, chosen and fitted.
#[derive(Debug, Default)]
pub struct State {
    /// The samples that are open.
    pub samples: Vec<Sample>,
    /// The one whose parameters are turned.
    pub active: Option<SampleId>,
    /// How the data are looked at.
    pub view: View,
    /// How many columns of readings the plot can show.
    pub columns: usize,
    /// What of the window is shown.
    pub interface: Interface,
    /// The angular convention in which files are read.
    pub convention: Convention,
    /// The settings of the next fit.
    pub choice: FitChoice,
    /// The fits that run, or ran last.
    pub run: Option<FitRun>,
    /// What can be taken back.
    pub history: History,
    /// What the user is told.
    pub messages: Vec<Message>,
    /// What happened last, in a few words.
    pub status: String,
    /// The dialog that is open.
    pub dialog: Option<Dialog>,
    /// The files that were opened last, the latest first.
    pub recent: Vec<PathBuf>,
    /// How often the zoom was reset: a plot follows when this changes.
    pub zoom_resets: u64,
    /// Whether the system's windows are dark.
    pub system_dark: bool,
    /// How many files are being read.
    pub reading: usize,
    /// What follows from all that.
    pub shown: Shown,
    effects: Vec<Effect>,
    next_id: u64,
}

impl State {
    /// The state of a new window, with what was kept of the last one.
    pub fn new(saved: &Saved) -> Self {
        Self {
            view: saved.view,
            interface: saved.interface.clone(),
            convention: saved.convention,
            choice: saved.choice.clone(),
            recent: saved.recent.clone(),
            columns: 400,
            ..Self::default()
        }
    }

    /// What is to be kept for the next time.
    pub fn saved(&self, window: [f32; 2]) -> Saved {
        Saved {
            view: self.view,
            interface: self.interface.clone(),
            convention: self.convention,
            choice: self.choice.clone(),
            recent: self.recent.clone(),
            open: Reopened::all(&self.samples),
            window,
            ..Saved::default()
        }
    }

    /// What is to be done for the changes so far.
    pub fn take_effects(&mut self) -> Vec<Effect> {
        std::mem::take(&mut self.effects)
    }

    /// The sample whose parameters are turned.
    pub fn active_sample(&self) -> Option<&Sample> {
        self.sample(self.active?)
    }

    /// A sample that is open.
    pub fn sample(&self, id: SampleId) -> Option<&Sample> {
        self.samples.iter().find(|sample| sample.id == id)
    }

    fn sample_mut(&mut self, id: SampleId) -> Option<&mut Sample> {
        self.samples.iter_mut().find(|sample| sample.id == id)
    }

    fn active_mut(&mut self) -> Option<&mut Sample> {
        self.sample_mut(self.active?)
    }

    fn scan(&self, id: ScanId) -> Option<&Scan> {
        self.sample(id.sample)?.scans.get(id.wavelength)
    }

    fn scan_mut(&mut self, id: ScanId) -> Option<&mut Scan> {
        self.sample_mut(id.sample)?.scans.get_mut(id.wavelength)
    }

    /// The samples that are shown.
    pub fn visible(&self) -> impl Iterator<Item = &Sample> {
        self.samples.iter().filter(|sample| sample.visible)
    }

    /// The family of colours of a sample; `None` where it is the only one, whose incidences then have
    /// single colours.
    pub fn family_of(&self, sample: &Sample) -> Option<usize> {
        (self.samples.len() > 1).then_some(sample.family)
    }

    /// Whether the worker fits.
    pub fn is_fitting(&self) -> bool {
        self.run.as_ref().is_some_and(FitRun::is_running)
    }

    /// Whether the worker is at anything.
    pub fn is_busy(&self) -> bool {
        self.is_fitting() || self.reading > 0
    }

    /// What did not work, in words.
    pub fn errors(&self) -> Vec<String> {
        let errors = self.messages.iter();
        let errors = errors.filter(|message| message.severity == Severity::Error);
        errors.map(|message| message.text.clone()).collect()
    }

    /// Tells the user that something did not work.
    pub fn print_error(&mut self, text: impl Into<String>) {
        self.tell(Severity::Error, text.into());
    }

    /// Tells the user something.
    pub fn note(&mut self, text: impl Into<String>) {
        self.tell(Severity::Note, text.into());
    }

    fn tell(&mut self, severity: Severity, text: String) {
        self.messages.push(Message { severity, text });
        if self.messages.len() > MOST_MESSAGES {
            self.messages.remove(0);
        }
    }

    /// Carries out a wish.
    pub fn apply(&mut self, intent: Intent) {
        match intent {
            Intent::Do(command) => self.command(command),
            Intent::Open(paths) => self.open(paths),
            Intent::OpenBytes(name, bytes) => {
                self.start(Job::ReadBytes(name, bytes, self.convention));
            }
            Intent::OpenBuiltIn(entry) => self.open_built_in(entry),
            Intent::Close(id) => self.close(id),
            Intent::ShowSample(id, visible) => self.change(id, |s| s.visible = visible),
            Intent::Activate(id) => self.activate(id),
            Intent::Wavelength(id, wavelength) => self.wavelength(id, wavelength),
            Intent::ShowIncidence(id, i, shown) => self.change(id, |sample| {
                if let Some(incidence) = sample.scan_mut().incidences.get_mut(i) {
                    incidence.shown = shown;
                }
            }),
            Intent::ShowAllIncidences(id, shown) => self.change(id, |sample| {
                for incidence in &mut sample.scan_mut().incidences {
                    incidence.shown = shown;
                }
            }),
            Intent::Convention(convention) => self.convention = convention,
            Intent::View(view) => self.view = view,
            Intent::Turn(knobs) => self.turn(|_| knobs),
            Intent::Model(model, scope) => self.choose_model(model, scope),
            Intent::Reset(parameter) => self.reset(parameter),
            Intent::FitChoice(choice) => self.choice = choice,
            Intent::Fit(stages, scope) => self.fit(stages, scope),
            Intent::Write(what, path) => self.write(what, path),
            Intent::Tab(tab) => self.interface.tab = tab,
            Intent::Path(text) => {
                if let Some(Dialog::Open { path } | Dialog::Export { path, .. }) = &mut self.dialog
                {
                    *path = text;
                }
            }
            Intent::Confirm => self.confirm(),
            Intent::Browse => self.browse(),
            Intent::CloseDialog => self.dialog = None,
            Intent::Dismiss(i) => {
                if i < self.messages.len() {
                    self.messages.remove(i);
                }
            }
        }
    }

    fn change(&mut self, id: SampleId, change: impl FnOnce(&mut Sample)) {
        if let Some(sample) = self.sample_mut(id) {
            change(sample);
        }
    }

    fn start(&mut self, job: Job) {
        if matches!(job, Job::Read(..) | Job::ReadBytes(..)) {
            self.reading += 1;
        }
        self.effects.push(Effect::Job(job));
    }

    fn activate(&mut self, id: SampleId) {
        if self.sample(id).is_some() {
            self.settle();
            self.active = Some(id);
            self.look_at_a_plane_with_readings();
        }
    }

    fn wavelength(&mut self, id: SampleId, wavelength: usize) {
        self.settle();
        self.change(id, |sample| {
            if wavelength < sample.scans.len() {
                sample.current = wavelength;
            }
        });
        self.look_at_a_plane_with_readings();
    }

    /// A plane without any reading of the active sample is left for one that has some.
    fn look_at_a_plane_with_readings(&mut self) {
        let Some(planes) = self.active_sample().map(|s| s.scan().planes.clone()) else {
            return;
        };
        let here = |plane: &f64| (plane - self.view.azimuth).abs() < 1e-6;
        if !planes.is_empty() && !planes.iter().any(here) {
            self.view.azimuth = planes[0];
        }
    }

    /// Takes over what the worker has done.
    pub fn take(&mut self, event: Event) {
        match event {
            Event::Opened(file, opened) => {
                self.reading = self.reading.saturating_sub(1);
                self.opened(file, opened);
            }
            Event::NotOpened(error) => {
                self.reading = self.reading.saturating_sub(1);
                self.print_error(error);
            }
            Event::Chosen(paths) => self.open(paths),
            Event::ChosenExport(what, path) => self.write(what, path),
            Event::Step(scan, step) => {
                if let Some(run) = &mut self.run {
                    run.step(scan, &step);
                }
            }
            Event::Fitted(scan, report) => self.fitted(scan, *report),
            Event::Broken(scan, failure) => self.not_fitted(scan, failure),
            Event::FitsEnded => self.fits_ended(),
            Event::Written(path) => self.status = format!("{} written", path.display()),
            Event::NotWritten(error) => self.print_error(error),
        }
    }
}
