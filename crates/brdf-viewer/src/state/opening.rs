//! What is opened and closed.

use std::path::{Path, PathBuf};

use super::sample::{Sample, SampleId};
use super::saved::{MOST_RECENT, Reopened};
use super::{State, built_in};
use crate::job::{Job, Opened};

impl State {
    /// Opens files. They keep their whole path: the next start may be in another folder.
    pub(super) fn open(&mut self, paths: Vec<PathBuf>) {
        for path in paths {
            let path = std::path::absolute(&path).unwrap_or(path);
            self.start(Job::Read(path, self.convention));
        }
    }

    pub(super) fn open_built_in(&mut self, entry: usize) {
        match built_in::open(entry) {
            Some(Ok(opened)) => self.add(opened, 1),
            Some(Err(error)) => self.print_error(error.to_string()),
            None => {}
        }
    }

    /// Opens what was open the last time, under the name and in the convention that it then had.
    pub fn reopen(&mut self, opened: &Reopened) {
        match built_in::entry_of(&opened.source) {
            Some(entry) => self.open_built_in(entry),
            None => self.start(Job::Read(PathBuf::from(&opened.source), opened.convention)),
        }
    }

    /// Takes over what was opened from a source.
    pub(super) fn opened(&mut self, file: Option<PathBuf>, all: Vec<Opened>) {
        let siblings = all.len();
        for opened in all {
            self.add(opened, siblings);
        }
        if let Some(path) = file {
            self.remember(path);
        }
    }

    fn add(&mut self, opened: Opened, siblings: usize) {
        if opened.scans.is_empty() {
            return;
        }
        let id = SampleId(self.next_id);
        self.next_id += 1;
        let taken = |family: &usize| self.samples.iter().any(|s| s.family == *family);
        // Of so many one more than there are samples, one is free.
        let family = (0..=self.samples.len()).find(|family| !taken(family));
        self.status = format!("{} opened", opened.source);
        let mut sample = Sample::new(id, opened, family.unwrap_or(0), siblings);
        sample.name = self.own_name(&sample.name);
        self.samples.push(sample);
        self.zoom_resets += 1;
        self.activate(id);
    }

    /// A name that no other sample has: "a", "a (2)".
    fn own_name(&self, name: &str) -> String {
        let taken = |name: &String| self.samples.iter().any(|sample| sample.name == *name);
        let numbered = (2..).map(|number| format!("{name} ({number})"));
        let mut names = std::iter::once(name.to_owned()).chain(numbered);
        names.find(|name| !taken(name)).unwrap_or_default()
    }

    pub(super) fn close(&mut self, id: SampleId) {
        if let Some(run) = &mut self.run {
            run.leave_out(id);
        }
        self.samples.retain(|sample| sample.id != id);
        self.history.forget(id);
        if self.active == Some(id) {
            self.active = self.samples.last().map(|sample| sample.id);
        }
    }

    fn remember(&mut self, path: PathBuf) {
        self.recent.retain(|known| *known != path);
        self.recent.insert(0, path);
        self.recent.truncate(MOST_RECENT);
    }

    /// Whether a path leads to something that is open: a scan, or the fit that it came with.
    pub fn is_open(&self, path: &Path) -> bool {
        let target = brdf_fit::output::resolved(path);
        let mut samples = self.samples.iter();
        samples.any(|sample| sample.is_scan_at(&target) || sample.is_from(&target))
    }
}
