//! Opening and closing of samples.

use std::path::{Path, PathBuf};

use brdf_fit::Convention;
use brdf_fit::plot::Scale;

use super::id::SampleId;
use super::interface::Dialog;
use super::sample::{Opened, Sample};
use super::saved::{MOST_RECENT, Reopened, SavedSample};
use super::{State, built_in};
use crate::job::{FileJob, Job};

/// Readings that span more than this are shown on a logarithmic axis: two decades.
const LARGE_RANGE: f64 = 100.0;

impl State {
    /// Opens files. Their paths are made absolute, because the next session may start in another
    /// folder.
    pub(super) fn open(&mut self, paths: Vec<PathBuf>) {
        for path in paths {
            let path = std::path::absolute(&path).unwrap_or(path);
            match self.opened_from(&path) {
                None => self.start(Job::File(FileJob::Open(path, self.convention))),
                Some(id) if self.sample(id).is_some_and(|s| s.has_changed_on_disk) => {
                    self.reload(id);
                }
                Some(id) => {
                    self.activate(id);
                    self.status = format!("{} is open already", path.display());
                }
            }
        }
    }

    /// The sample that was opened from a file in the current convention.
    fn opened_from(&mut self, path: &Path) -> Option<SampleId> {
        let path = brdf_fit::output::resolved(path);
        let convention = self.convention;
        let mut samples = self.samples.iter_mut();
        let found = samples
            .find(|sample| sample.was_opened_from(&path) && sample.convention == convention)?;
        found.check_file();
        Some(found.id)
    }

    /// Notes which files have changed since they were opened.
    pub fn check_files(&mut self) {
        for sample in &mut self.samples {
            sample.check_file();
        }
    }

    /// Reads the file of a sample again. Model, parameters and choice of readings are kept.
    pub(super) fn reload(&mut self, id: SampleId) {
        let Some(sample) = self.sample(id) else {
            return;
        };
        let path = PathBuf::from(&sample.source);
        let convention = sample.convention;
        let source = sample.source.clone();
        let of_source: Vec<Sample> = self
            .samples
            .iter()
            .filter(|sample| sample.source == source)
            .cloned()
            .collect();
        self.restoring.extend(Reopened::all(&of_source));
        for sample in of_source {
            self.close(sample.id);
        }
        self.start(Job::File(FileJob::Open(path, convention)));
    }

    pub(super) fn open_bytes(&mut self, name: String, bytes: Vec<u8>) {
        let job = FileJob::OpenBytes(name, bytes, self.convention);
        self.start(Job::File(job));
    }

    pub(super) fn open_built_in(&mut self, entry: usize) {
        match built_in::open(entry) {
            Some(Ok(opened)) => {
                self.choose_scale(std::slice::from_ref(&opened));
                self.add(opened, 1);
            }
            Some(Err(error)) => self.report_error(error.to_string()),
            None => {}
        }
    }

    /// Opens a source of the last session, in the same angular convention.
    pub fn reopen(&mut self, source: &Reopened) {
        self.restoring.push(source.clone());
        if let Some(entry) = built_in::entry_of(&source.source) {
            self.open_built_in(entry);
        } else {
            let path = PathBuf::from(&source.source);
            self.start(Job::File(FileJob::Open(path, source.convention)));
        }
    }

    /// Adds the samples of a source. `file` is its path, if it is a file.
    pub(super) fn add_opened(&mut self, file: Option<PathBuf>, all: Vec<Opened>) {
        self.choose_scale(&all);
        let count = all.len();
        for opened in all {
            self.add(opened, count);
        }
        // What remains was not found in the file again.
        if let Some(path) = &file {
            let source = path.display().to_string();
            self.restoring.retain(|reopened| reopened.source != source);
        }
        if let Some(path) = file {
            self.add_to_recent(path);
        }
    }

    fn add(&mut self, opened: Opened, samples_in_source: usize) {
        if opened.scans.is_empty() {
            return;
        }
        let id = SampleId(self.next_id);
        self.next_id += 1;
        let is_taken = |family: &usize| self.samples.iter().any(|s| s.family == *family);
        // With one more family than samples, one is free.
        let family = (0..=self.samples.len()).find(|family| !is_taken(family));
        self.status = format!("{} opened", opened.source);
        let mut sample = Sample::new(id, opened, family.unwrap_or(0), samples_in_source);
        sample.name = self.unique_name(&sample.name);
        sample.convention = self.convention;
        if let Some((saved, convention)) = self.take_saved(&sample.source) {
            sample.convention = convention;
            saved.restore(&mut sample);
        }
        self.samples.push(sample);
        self.zoom_resets += 1;
        self.activate(id);
        self.fit_opened(id);
    }

    /// Chooses a logarithmic axis where the readings of a new sample span many decades.
    fn choose_scale(&mut self, opened: &[Opened]) {
        let is_restored = |opened: &Opened| {
            let mut restoring = self.restoring.iter();
            restoring.any(|reopened| reopened.source == opened.source)
        };
        if opened.iter().any(is_restored) {
            return;
        }
        let mut scans = opened.iter().flat_map(|opened| &opened.scans);
        if scans.any(|scan| scan.dynamic_range() > LARGE_RANGE) {
            self.view.scale = Scale::Logarithmic;
        }
    }

    /// What was saved of the next sample of a source that is opened again, and its convention.
    fn take_saved(&mut self, source: &str) -> Option<(SavedSample, Convention)> {
        let mut restoring = self.restoring.iter_mut();
        let found = restoring.find(|reopened| reopened.source == source)?;
        let convention = found.convention;
        let saved = (!found.samples.is_empty()).then(|| found.samples.remove(0));
        self.restoring
            .retain(|reopened| !reopened.samples.is_empty());
        Some((saved?, convention))
    }

    /// A name that no other sample has: "a", "a (2)".
    fn unique_name(&self, name: &str) -> String {
        let is_taken = |name: &String| self.samples.iter().any(|sample| sample.name == *name);
        let numbered = (2..).map(|number| format!("{name} ({number})"));
        let mut names = std::iter::once(name.to_owned()).chain(numbered);
        names.find(|name| !is_taken(name)).unwrap_or_default()
    }

    /// Closes samples, and asks before if a fit or a choice of readings would be lost.
    pub(super) fn ask_to_close(&mut self, samples: Vec<SampleId>) {
        let is_unsaved = |id: &SampleId| self.sample(*id).is_some_and(Sample::has_unsaved_work);
        if samples.iter().any(is_unsaved) {
            self.dialog = Some(Dialog::Close { samples });
            return;
        }
        for id in samples {
            self.close(id);
        }
    }

    pub(super) fn close(&mut self, id: SampleId) {
        if let Some(run) = &mut self.fit_run {
            run.remove_sample(id);
        }
        self.samples.retain(|sample| sample.id != id);
        self.history.remove_sample(id);
        self.ghosts.retain(|ghost| ghost.sample != id);
        if self.active == Some(id) {
            self.active = self.samples.last().map(|sample| sample.id);
        }
    }

    fn add_to_recent(&mut self, path: PathBuf) {
        self.recent.retain(|known| *known != path);
        self.recent.insert(0, path);
        self.recent.truncate(MOST_RECENT);
    }

    /// The files that the next session needs: those of the open samples, and the recently opened ones.
    pub fn files_of_session(&self) -> Vec<&Path> {
        let samples = self.samples.iter();
        let of_samples = samples.flat_map(|sample| {
            let joined = &sample.scan().measurements.read_settings.joined;
            let joined = joined.iter().map(|file| Path::new(file.as_str()));
            let own = [Path::new(&sample.source)].into_iter();
            own.chain(sample.file.as_deref()).chain(joined)
        });
        of_samples
            .chain(self.recent.iter().map(PathBuf::as_path))
            .collect()
    }

    /// Whether a path leads to an open scan, or to the fit that contains it.
    pub fn is_open(&self, path: &Path) -> bool {
        let path = brdf_fit::output::resolved(path);
        let mut samples = self.samples.iter();
        samples.any(|sample| sample.has_readings_from(&path) || sample.was_opened_from(&path))
    }
}
