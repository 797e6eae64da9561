//! What is loaded, chosen and fitted.

pub mod built_in;
pub mod fitting;
pub mod history;
pub mod interface;
pub mod sample;
pub mod saved;
pub mod shown;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use brdf_fit::model::Parameter;
use brdf_fit::plot::{Layout, Quantity, Scale, View};
use brdf_fit::read::Convention;
use brdf_fit::words::digits;

use crate::intent::{Command, Export, Intent};
use crate::worker::{Event, FitJob, Job, Writing};
use fitting::{FitChoice, FitRun, Progress, Scope, Stages};
use history::{Change, History};
use interface::{Dialog, Interface, Message, Severity, Side};
use sample::{Knobs, Sample, SampleId, Scan, ScanId};
use saved::{MOST_RECENT, Opened, Saved};
use shown::Shown;

/// So many messages are kept; older ones go.
const MOST_MESSAGES: usize = 20;

/// What a change of the state asks of the world around it.
#[derive(Debug)]
pub enum Effect {
    /// Work for the worker.
    Job(Job),
    /// Stop the fit.
    Cancel,
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
            open: self.samples.iter().map(Opened::of).collect(),
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

    fn scan_mut(&mut self, id: ScanId) -> Option<&mut Scan> {
        self.sample_mut(id.sample)?.scans.get_mut(id.wavelength)
    }

    /// The samples that are shown.
    pub fn visible(&self) -> impl Iterator<Item = &Sample> {
        self.samples.iter().filter(|sample| sample.visible)
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
    pub fn complain(&mut self, text: impl Into<String>) {
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
            Intent::Model(model) => self.turn(|knobs| Knobs {
                model,
                at: model.start(knobs.at),
                ..knobs
            }),
            Intent::Reset(parameter) => self.reset(parameter),
            Intent::FitChoice(choice) => self.choice = choice,
            Intent::Fit(stages, scope) => self.fit(stages, scope),
            Intent::Write(what, path) => self.write(what, path),
            Intent::Tab(tab) => self.interface.tab = tab,
            Intent::Side(side, shown) => *self.side_mut(side) = shown,
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

    fn command(&mut self, command: Command) {
        if !self.is_enabled(command) {
            return;
        }
        match command {
            Command::Open => self.effects.push(Effect::AskOpen),
            Command::OpenPath => self.ask_path(),
            Command::Close => {
                if let Some(id) = self.active {
                    self.close(id);
                }
            }
            Command::CloseAll => {
                let all: Vec<SampleId> = self.samples.iter().map(|sample| sample.id).collect();
                for id in all {
                    self.close(id);
                }
            }
            Command::Export(what) => {
                let path = self.suggested(what);
                self.effects.push(Effect::AskExport(what, path));
            }
            Command::CopyParameters => self.copy_parameters(),
            Command::Quit => self.effects.push(Effect::Quit),
            Command::Undo => self.undo(),
            Command::Redo => self.redo(),
            Command::ResetAll => self.reset_all(),
            Command::Fit => self.fit(Stages::Both, Scope::Active),
            Command::FitAll => self.fit(Stages::Both, Scope::All),
            Command::Cancel => self.cancel(),
            Command::Logarithmic => {
                self.view.scale = match self.view.scale {
                    Scale::Linear => Scale::Logarithmic,
                    Scale::Logarithmic => Scale::Linear,
                }
            }
            Command::TimesCosine => {
                self.view.quantity = match self.view.quantity {
                    Quantity::Brdf => Quantity::BrdfCosine,
                    Quantity::BrdfCosine => Quantity::Brdf,
                }
            }
            Command::Residuals => self.view.residuals ^= true,
            Command::Together => self.view.layout = Layout::Together,
            Command::Panels => self.view.layout = Layout::Panels,
            Command::Polar => self.view.layout = Layout::Polar,
            Command::ResetZoom => self.zoom_resets += 1,
            Command::Samples => self.interface.samples ^= true,
            Command::Parameters => self.interface.parameters ^= true,
            Command::Results => self.interface.results ^= true,
            Command::Dark => {
                self.interface.dark = Some(!self.interface.dark.unwrap_or(false));
            }
            Command::About => self.dialog = Some(Dialog::About),
        }
    }

    /// Whether a command can be carried out now.
    pub fn is_enabled(&self, command: Command) -> bool {
        let active = self.active_sample();
        let scan = active.map(Sample::scan);
        match command {
            Command::Close | Command::CopyParameters => active.is_some(),
            Command::CloseAll => !self.samples.is_empty(),
            Command::Export(Export::Figure(_)) => self.visible().next().is_some(),
            Command::Export(Export::Curves) => scan.is_some_and(|scan| scan.readings() > 0),
            Command::Export(Export::Fit) => scan.is_some_and(|scan| scan.fitted.is_some()),
            Command::Undo => self.history.can_undo(),
            Command::Redo => self.history.can_redo(),
            Command::ResetAll => scan.is_some_and(|scan| scan.fitted_knobs() != scan.knobs),
            Command::Fit => !self.is_fitting() && scan.is_some_and(|scan| scan.readings() > 0),
            Command::FitAll => !self.is_fitting() && self.scans_with_readings().next().is_some(),
            Command::Cancel => self.is_fitting(),
            Command::Residuals => self.view.layout != Layout::Polar,
            _ => true,
        }
    }

    /// Whether a command that switches something is on; `None` where it switches nothing.
    pub fn is_on(&self, command: Command) -> Option<bool> {
        Some(match command {
            Command::Logarithmic => self.view.scale == Scale::Logarithmic,
            Command::TimesCosine => self.view.quantity == Quantity::BrdfCosine,
            Command::Residuals => self.view.residuals,
            Command::Together => self.view.layout == Layout::Together,
            Command::Panels => self.view.layout == Layout::Panels,
            Command::Polar => self.view.layout == Layout::Polar,
            Command::Samples => self.interface.samples,
            Command::Parameters => self.interface.parameters,
            Command::Results => self.interface.results,
            Command::Dark => self.interface.dark.unwrap_or(false),
            _ => return None,
        })
    }

    fn side_mut(&mut self, side: Side) -> &mut bool {
        match side {
            Side::Samples => &mut self.interface.samples,
            Side::Parameters => &mut self.interface.parameters,
            Side::Results => &mut self.interface.results,
        }
    }

    fn start(&mut self, job: Job) {
        if matches!(job, Job::Read(..) | Job::ReadBytes(..)) {
            self.reading += 1;
        }
        self.effects.push(Effect::Job(job));
    }

    fn open(&mut self, paths: Vec<PathBuf>) {
        for path in paths {
            self.start(Job::Read(path, self.convention));
        }
    }

    fn open_built_in(&mut self, entry: usize) {
        match built_in::open(entry) {
            Some(Ok((source, scans))) => self.add(&source, scans),
            Some(Err(error)) => self.complain(error.to_string()),
            None => {}
        }
    }

    /// Opens what was open the last time, under the name and in the convention that it then had.
    pub fn reopen(&mut self, opened: &Opened) {
        match built_in::entry_of(&opened.source) {
            Some(entry) => self.open_built_in(entry),
            None => self.start(Job::Read(PathBuf::from(&opened.source), opened.convention)),
        }
    }

    fn add(&mut self, source: &str, scans: Vec<Scan>) {
        if scans.is_empty() {
            return;
        }
        let id = SampleId(self.next_id);
        self.next_id += 1;
        let taken = |family: &usize| self.samples.iter().any(|s| s.family == *family);
        // Of so many one more than there are samples, one is free.
        let family = (0..=self.samples.len()).find(|family| !taken(family));
        let family = family.unwrap_or(0);
        let sample = Sample::new(id, source, family, scans);
        self.status = format!("{source} opened");
        self.samples.push(sample);
        self.zoom_resets += 1;
        self.activate(id);
    }

    fn close(&mut self, id: SampleId) {
        if self.run.as_ref().is_some_and(|run| run.scan.sample == id) {
            self.cancel();
        }
        self.samples.retain(|sample| sample.id != id);
        self.history.forget(id);
        if self.active == Some(id) {
            self.active = self.samples.last().map(|sample| sample.id);
        }
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

    fn turn(&mut self, change: impl FnOnce(Knobs) -> Knobs) {
        if let Some(sample) = self.active_mut() {
            let scan = sample.scan_mut();
            scan.knobs = change(scan.knobs);
        }
    }

    fn reset(&mut self, parameter: Parameter) {
        let Some(fitted) = self.active_sample().map(|s| s.scan().fitted_knobs()) else {
            return;
        };
        self.turn(|mut knobs| {
            parameter.set(&mut knobs.at, parameter.of(&fitted.at));
            knobs
        });
    }

    fn reset_all(&mut self) {
        if let Some(fitted) = self.active_sample().map(|s| s.scan().fitted_knobs()) {
            self.turn(|_| fitted);
            self.settle();
        }
    }

    /// Ends a change of the parameters: from here on it can be taken back as one.
    pub fn settle(&mut self) {
        let Some(sample) = self.active_mut() else {
            return;
        };
        let scan = sample.scan_id();
        let turned = sample.scan_mut();
        if turned.knobs != turned.settled {
            let change = Change {
                scan,
                before: turned.settled,
                after: turned.knobs,
            };
            turned.settled = turned.knobs;
            self.history.push(change);
        }
    }

    fn undo(&mut self) {
        self.settle();
        if let Some(change) = self.history.undo() {
            self.restore(change.scan, change.before);
        }
    }

    fn redo(&mut self) {
        if let Some(change) = self.history.redo() {
            self.restore(change.scan, change.after);
        }
    }

    /// Sets the parameters of a scan, and shows it: a change that is not seen is not believed.
    fn restore(&mut self, id: ScanId, knobs: Knobs) {
        self.change(id.sample, |sample| {
            sample.current = id.wavelength;
            let scan = sample.scan_mut();
            (scan.knobs, scan.settled) = (knobs, knobs);
        });
        self.active = Some(id.sample);
    }

    fn scans_with_readings(&self) -> impl Iterator<Item = (ScanId, &Scan)> {
        self.samples.iter().flat_map(|sample| {
            let scans = sample.scans.iter().enumerate();
            let scans = scans.filter(|(_, scan)| scan.readings() > 0);
            scans.map(|(wavelength, scan)| {
                let sample = sample.id;
                (ScanId { sample, wavelength }, scan)
            })
        })
    }

    fn fit(&mut self, stages: Stages, scope: Scope) {
        if self.is_fitting() {
            return;
        }
        self.settle();
        let active = self.active_sample().map(Sample::scan_id);
        let chosen = |id: &ScanId| scope == Scope::All || Some(*id) == active;
        let jobs: Vec<FitJob> = self
            .scans_with_readings()
            .filter(|(id, _)| chosen(id))
            .map(|(scan, of)| FitJob {
                scan,
                measurements: Arc::clone(&of.measurements),
                options: self.choice.options(&of.knobs, stages),
            })
            .collect();
        let Some(first) = jobs.first() else {
            return;
        };
        self.run = Some(FitRun::new(jobs.len(), first.scan));
        self.start(Job::Fit(jobs, self.choice.depth()));
    }

    fn cancel(&mut self) {
        if let Some(run) = self.run.as_mut().filter(|run| run.is_running()) {
            run.progress = Progress::Cancelling;
            self.effects.push(Effect::Cancel);
        }
    }

    fn copy_parameters(&mut self) {
        let Some(sample) = self.active_sample() else {
            return;
        };
        let text = parameter_table(sample);
        "parameters copied".clone_into(&mut self.status);
        self.effects.push(Effect::Copy(text));
    }

    /// Asks for a path in the viewer's own box, where the system has no dialog.
    pub fn ask_path(&mut self) {
        self.dialog = Some(Dialog::Open {
            path: String::new(),
        });
    }

    /// Asks where to write in the viewer's own box.
    pub fn ask_export(&mut self, what: Export, path: &Path) {
        let path = path.display().to_string();
        self.dialog = Some(Dialog::Export { what, path });
    }

    fn confirm(&mut self) {
        match self.dialog.take() {
            Some(Dialog::Open { path }) if !path.trim().is_empty() => {
                self.open(vec![PathBuf::from(path.trim())]);
            }
            Some(Dialog::Export { what, path }) if !path.trim().is_empty() => {
                self.write(what, PathBuf::from(path.trim()));
            }
            Some(Dialog::About) | None => {}
            empty => self.dialog = empty,
        }
    }

    fn browse(&mut self) {
        match self.dialog.take() {
            Some(Dialog::Open { .. }) => self.effects.push(Effect::AskOpen),
            Some(Dialog::Export { what, path }) => {
                let path = PathBuf::from(path);
                self.effects.push(Effect::AskExport(what, path));
            }
            other => self.dialog = other,
        }
    }

    /// The name of a file for what is written of the active sample.
    fn suggested(&self, what: Export) -> PathBuf {
        let Some(sample) = self.active_sample() else {
            return PathBuf::new();
        };
        let wavelength = sample.scan().wavelength_um();
        let wavelength = wavelength.map_or_else(String::new, |w| format!("_{w}um"));
        let name: String = format!("{}{wavelength}", sample.name)
            .chars()
            .map(|c| {
                if c.is_alphanumeric() || "._-".contains(c) {
                    c
                } else {
                    '_'
                }
            })
            .collect();
        PathBuf::from(format!("{name}.{}", what.extension()))
    }

    fn write(&mut self, what: Export, path: PathBuf) {
        let target = brdf_fit::output::resolved(&path);
        let is_scan =
            |sample: &&Sample| brdf_fit::output::resolved(Path::new(&sample.source)) == target;
        if let Some(sample) = self.samples.iter().find(is_scan) {
            let source = sample.source.clone();
            self.complain(format!(
                "{source}: is an open scan: expected a file of its own for the {}",
                what.name()
            ));
            return;
        }
        let writing = match what {
            Export::Figure(picture) => {
                let layers = self.visible().map(crate::worker::Layer::of).collect();
                Writing::Figure(picture, layers, self.view)
            }
            Export::Curves => {
                let Some(sample) = self.active_sample() else {
                    return;
                };
                let scan = sample.scan();
                Writing::Curves(Arc::clone(&scan.measurements), scan.knobs)
            }
            Export::Fit => {
                let fitted = self.active_sample().map(|sample| {
                    let scans = sample.scans.iter();
                    scans.filter_map(|scan| scan.fitted.clone()).collect()
                });
                Writing::Fit(fitted.unwrap_or_default())
            }
        };
        self.start(Job::Write(path, writing));
    }

    /// Takes over what the worker has done.
    pub fn take(&mut self, event: Event) {
        match event {
            Event::Opened(source, file, scans) => {
                self.reading = self.reading.saturating_sub(1);
                self.add(&source, scans);
                if let Some(path) = file {
                    self.remember(path);
                }
            }
            Event::NotOpened(error) => {
                self.reading = self.reading.saturating_sub(1);
                self.complain(error);
            }
            Event::Chosen(paths) => self.open(paths),
            Event::ChosenExport(what, path) => self.write(what, path),
            Event::Step(scan, step) => {
                if let Some(run) = &mut self.run {
                    run.step(scan, &step);
                }
            }
            Event::Fitted(scan, report) => self.fitted(scan, *report),
            Event::FitsEnded { cancelled } => self.fits_ended(cancelled),
            Event::Written(path) => self.status = format!("{} written", path.display()),
            Event::NotWritten(error) => self.complain(error),
        }
    }

    fn remember(&mut self, path: PathBuf) {
        self.recent.retain(|known| *known != path);
        self.recent.insert(0, path);
        self.recent.truncate(MOST_RECENT);
    }

    fn fitted(&mut self, scan: ScanId, report: brdf_fit::report::Report) {
        let failure = report.error.as_ref().map(|error| {
            let wavelength = report.wavelength_um;
            let wavelength = wavelength.map_or_else(String::new, |w| format!(", {w} um"));
            format!("{}{wavelength}: {error}", report.file)
        });
        if let Some(run) = &mut self.run {
            run.done += 1;
            run.failed.extend(failure.clone());
        }
        if let Some(failure) = failure {
            self.complain(failure);
            return;
        }
        self.settle();
        let Some(of) = self.scan_mut(scan) else {
            return;
        };
        let before = of.settled;
        of.take(report);
        of.settled = of.knobs;
        let after = of.knobs;
        if before != after {
            self.history.push(Change {
                scan,
                before,
                after,
            });
        }
    }

    fn fits_ended(&mut self, cancelled: bool) {
        let Some(run) = &mut self.run else {
            return;
        };
        run.progress = if cancelled {
            Progress::Cancelled
        } else {
            Progress::Done
        };
        let (done, jobs) = (run.fitted(), run.jobs);
        let seconds = run.started.elapsed().as_secs_f64();
        self.status = if cancelled {
            format!("fit cancelled: {done} of {jobs} were done")
        } else {
            format!("{done} of {jobs} fitted in {seconds:.2} s")
        };
    }
}

/// The parameters of the scan that is shown, as a table for other programs: columns separated by
/// tabs.
fn parameter_table(sample: &Sample) -> String {
    let scan = sample.scan();
    let knobs = scan.knobs;
    let mut text = "parameter\tvalue\tstandard error\t95 % from\t95 % to\n".to_owned();
    let uncertainty = scan
        .fit_shown()
        .and_then(|report| report.uncertainty.as_ref());
    for parameter in knobs.parameters() {
        let estimate = uncertainty.and_then(|u| u.estimate(parameter));
        let interval = estimate.map(brdf_fit::uncertainty::Estimate::interval_95);
        let end = |end: Option<f64>| end.map_or_else(String::new, digits);
        let error = estimate.and_then(brdf_fit::uncertainty::Estimate::standard_error);
        let _ = writeln!(
            text,
            "{parameter}\t{}\t{}\t{}\t{}",
            parameter.of(&knobs.at),
            end(error),
            end(interval.and_then(|i| i.from)),
            end(interval.and_then(|i| i.to)),
        );
    }
    text
}
