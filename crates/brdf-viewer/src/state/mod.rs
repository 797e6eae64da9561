//! The state of the viewer: samples, settings and fits.
//!
//! This file defines [`State`] with its data and their accessors. Operations are in files of their
//! own, each an `impl State`; from the bottom: `editing` (parameters, undo and redo), `fitting`,
//! `opening`, `exporting` and `parameter_table`, `commands`, and `apply`, which dispatches intents
//! and events to them.

pub mod angle_range;
mod apply;
pub mod built_in;
mod commands;
pub mod convergence;
pub mod derived;
mod editing;
mod exporting;
pub mod fit_run;
pub mod fit_settings;
mod fitting;
pub mod ghost;
pub mod history;
pub mod id;
pub mod interface;
mod opening;
mod parameter_table;
pub mod parameters;
mod planning;
pub mod sample;
pub mod saved;
pub mod solid;

use std::path::PathBuf;

use brdf_fit::Convention;
use brdf_fit::plot::{View, Zoom};

use egui::ColorImage;

use crate::job::{FileJob, Job};
use crate::output_kind::OutputKind;
use angle_range::AngleRange;
use derived::Derived;
use fit_run::FitRun;
use fit_settings::{FitSettings, Scope};
use ghost::Ghost;
use history::History;
use id::{SampleId, ScanId};
use interface::{Dialog, Interface, Message, Severity};
use sample::{Sample, Scan};
use saved::{Reopened, Saved};
use solid::SolidView;
use solid::derived::DerivedSolid;

/// The largest number of messages. Older ones are removed.
const MOST_MESSAGES: usize = 20;

/// The number of pixels along the picture of a surface until its place is known.
const SURFACE_SIDE: usize = 256;

/// An action that a change of the state requests of the application.
#[derive(Debug)]
pub enum Effect {
    /// Start a job of the worker.
    Job(Job),
    /// Copy a text to the clipboard.
    Copy(String),
    /// Copy a picture to the clipboard.
    CopyImage(ColorImage),
    /// Ask for files to open.
    AskOpen,
    /// Ask for the path of a file to write, and suggest one.
    AskExport(OutputKind, PathBuf),
    /// Quit the program.
    Quit,
}

/// A scan in the plot.
#[derive(Debug, Clone, Copy)]
pub struct Plotted<'a> {
    /// Its identifier.
    pub id: ScanId,
    /// Its sample.
    pub sample: &'a Sample,
    /// The scan.
    pub scan: &'a Scan,
    /// Its colour family; `None` for a single scan.
    pub family: Option<usize>,
}

/// The samples, the settings and the fits.
#[derive(Debug, Default)]
pub struct State {
    /// The open samples.
    pub samples: Vec<Sample>,
    /// The active sample, whose parameters are edited.
    pub active: Option<SampleId>,
    /// The view of the data.
    pub view: View,
    /// The settings of the lobe and of the surface.
    pub solid: SolidView,
    /// The number of pixels along the picture of a surface.
    pub surface_side: usize,
    /// The number of columns of readings that fit into the plot.
    pub columns: usize,
    /// The theme and the visible panels.
    pub interface: Interface,
    /// The angular convention in which files are read.
    pub convention: Convention,
    /// The settings of the next fit.
    pub fit_settings: FitSettings,
    /// The limit of stage 1 after the last finished change, to which undo returns; `None` before the
    /// first frame.
    committed_stage1_limit_deg: Option<f64>,
    /// The current or the last run of fits.
    pub fit_run: Option<FitRun>,
    /// Whether a click or a rectangle in the plot chooses readings, instead of moving the plot.
    pub choosing: bool,
    /// The theories that stay in the plot.
    pub ghosts: Vec<Ghost>,
    /// The parameter changes that can be undone and redone.
    pub history: History,
    /// The messages, the latest last.
    pub messages: Vec<Message>,
    /// The last action, for the status line.
    pub status: String,
    /// The open dialog.
    pub dialog: Option<Dialog>,
    /// The paths of recently opened files, the latest first.
    pub recent: Vec<PathBuf>,
    /// The part of the plot that is shown; `None` is all of it.
    pub zoom: Option<Zoom>,
    /// The number of zoom resets. A plot resets its zoom when this number changes.
    pub zoom_resets: u64,
    /// Whether the theme of the system is dark.
    pub system_dark: bool,
    /// The number of files that are being read.
    pub files_being_read: usize,
    /// The number of plans of readings that the worker makes.
    pub plans_being_made: usize,
    /// The values derived from the data, the view and the parameters.
    pub derived: Derived,
    /// The lobe and the pictures of the surface.
    pub derived_solid: DerivedSolid,
    effects: Vec<Effect>,
    next_id: u64,
    /// The number of the next run of fits.
    next_run: u64,
    /// The opened scans that are to be fitted.
    to_fit: Vec<ScanId>,
    /// The sources that are being opened again, with what was set of them.
    restoring: Vec<Reopened>,
}

impl State {
    /// The initial state, with the settings of the last session.
    pub fn new(saved: &Saved) -> Self {
        Self {
            view: saved.view,
            interface: saved.interface.clone(),
            convention: saved.convention,
            fit_settings: saved.fit_settings.clone(),
            recent: saved.recent.clone(),
            solid: saved.solid,
            surface_side: SURFACE_SIDE,
            columns: 400,
            ..Self::default()
        }
    }

    /// The settings to save for the next session. `window` is the size of the window in points.
    pub fn saved(&self, window: [f32; 2]) -> Saved {
        Saved {
            view: self.view,
            solid: self.solid,
            interface: self.interface.clone(),
            convention: self.convention,
            fit_settings: self.fit_settings.clone(),
            recent: self.recent.clone(),
            open: Reopened::all(&self.samples),
            window,
            ..Saved::default()
        }
    }

    /// Removes and returns the requested effects.
    pub fn take_effects(&mut self) -> Vec<Effect> {
        std::mem::take(&mut self.effects)
    }

    /// Updates the derived values that have changed.
    pub fn refresh(&mut self) {
        let (view, settings) = (&self.view, &self.fit_settings);
        self.derived
            .refresh(&self.samples, self.active, view, self.columns, settings);
        self.derived
            .refresh_ghosts(&self.ghosts, &self.samples, view);
        self.refresh_solid();
    }

    /// The active sample.
    pub fn active_sample(&self) -> Option<&Sample> {
        self.sample(self.active?)
    }

    /// The view angles of the readings of the active scan; `None` where none is used, and for a table,
    /// of which all bins are fitted.
    pub fn active_angle_range(&self) -> Option<&AngleRange> {
        let sample = self.active_sample()?;
        let is_table = sample.scan().table.is_some();
        self.derived
            .angle_range(sample.scan_id())
            .filter(|_| !is_table)
    }

    /// An open sample.
    pub fn sample(&self, id: SampleId) -> Option<&Sample> {
        self.samples.iter().find(|sample| sample.id == id)
    }

    fn sample_mut(&mut self, id: SampleId) -> Option<&mut Sample> {
        self.samples.iter_mut().find(|sample| sample.id == id)
    }

    fn active_sample_mut(&mut self) -> Option<&mut Sample> {
        self.sample_mut(self.active?)
    }

    fn scan(&self, id: ScanId) -> Option<&Scan> {
        self.sample(id.sample)?.scans.get(id.wavelength)
    }

    fn scan_mut(&mut self, id: ScanId) -> Option<&mut Scan> {
        self.sample_mut(id.sample)?.scans.get_mut(id.wavelength)
    }

    /// The scans within a scope.
    fn scans_in(&self, scope: Scope) -> Vec<ScanId> {
        let active = self.active_sample().map(Sample::scan_id);
        let is_in_scope = |id: &ScanId| match scope {
            Scope::Wavelength => Some(*id) == active,
            Scope::Sample => Some(id.sample) == active.map(|active| active.sample),
            Scope::All => true,
        };
        let all = self.samples.iter().flat_map(Sample::scan_ids);
        all.filter(is_in_scope).collect()
    }

    /// The visible samples.
    pub fn visible(&self) -> impl Iterator<Item = &Sample> {
        self.samples.iter().filter(|sample| sample.visible)
    }

    /// The colour family of the current scan of a sample. `None` for a single scan, whose incidences
    /// have colours from all families.
    pub fn family_of(&self, sample: &Sample) -> Option<usize> {
        let is_single = self.samples.len() == 1 && sample.plotted().count() == 1;
        (!is_single).then_some(sample.family)
    }

    /// The plotted scans of the visible samples, each with its sample and its colour family. Those
    /// beside the current one of a sample have families that no sample has.
    pub fn plotted(&self) -> Vec<Plotted<'_>> {
        let families = self.samples.iter().map(|sample| sample.family);
        let mut free = families.max().map_or(0, |family| family + 1)..;
        let mut all = Vec::new();
        for sample in self.visible() {
            for (wavelength, scan) in sample.plotted() {
                let family = if wavelength == sample.current {
                    self.family_of(sample)
                } else {
                    free.next()
                };
                all.push(Plotted {
                    id: sample.id_of(wavelength),
                    sample,
                    scan,
                    family,
                });
            }
        }
        all
    }

    /// Whether the worker is fitting.
    pub fn is_fitting(&self) -> bool {
        self.fit_run.as_ref().is_some_and(FitRun::is_running)
    }

    /// Whether the worker is making fits that the user has asked for.
    pub fn is_fitting_on_request(&self) -> bool {
        let running = self.fit_run.as_ref().filter(|run| run.is_running());
        running.is_some_and(|run| !run.automatic)
    }

    /// Whether the worker is fitting or reading.
    pub fn is_busy(&self) -> bool {
        self.is_fitting() || self.files_being_read + self.plans_being_made > 0
    }

    /// The texts of all error messages.
    pub fn errors(&self) -> Vec<String> {
        let errors = self.messages.iter();
        let errors = errors.filter(|message| message.severity == Severity::Error);
        errors.map(|message| message.text.clone()).collect()
    }

    /// The texts that come from files and their names, in any script.
    pub fn texts_of_files(&self) -> impl Iterator<Item = &str> {
        let samples = self.samples.iter();
        let of_samples = samples.flat_map(|sample| [&*sample.source, &*sample.description]);
        let messages = self.messages.iter().map(|message| &*message.text);
        let recent = self.recent.iter().filter_map(|path| path.to_str());
        of_samples.chain(messages).chain(recent)
    }

    /// Shows an error message.
    pub fn report_error(&mut self, text: impl Into<String>) {
        self.push_message(Severity::Error, text.into());
    }

    /// Shows a note.
    pub fn report_note(&mut self, text: impl Into<String>) {
        self.push_message(Severity::Note, text.into());
    }

    fn push_message(&mut self, severity: Severity, text: String) {
        let message = Message { severity, text };
        // The same message is told once, as the latest.
        self.messages.retain(|known| *known != message);
        self.messages.push(message);
        if self.messages.len() > MOST_MESSAGES {
            self.messages.remove(0);
        }
    }

    fn change(&mut self, id: SampleId, change: impl FnOnce(&mut Sample)) {
        if let Some(sample) = self.sample_mut(id) {
            change(sample);
        }
    }

    fn start(&mut self, job: Job) {
        if matches!(job, Job::File(FileJob::Open(..) | FileJob::OpenBytes(..))) {
            self.files_being_read += 1;
        }
        self.effects.push(Effect::Job(job));
    }
}
