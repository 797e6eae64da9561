//! What is written, and the dialogs that ask for a path.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use brdf_fit::output::resolved;

use super::interface::Dialog;
use super::sample::Sample;
use super::{Effect, State};
use crate::intent::Export;
use crate::job::{Job, Layer, Writing};

impl State {
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

    pub(super) fn confirm(&mut self) {
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

    pub(super) fn browse(&mut self) {
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
    pub(super) fn suggested(&self, what: Export) -> PathBuf {
        let Some(sample) = self.active_sample() else {
            return PathBuf::new();
        };
        let wavelength = sample.scan().wavelength_um();
        let wavelength = wavelength.map_or_else(String::new, |w| format!("_{w}um"));
        let allowed = |c: char| c.is_alphanumeric() || "._-".contains(c);
        let name: String = format!("{}{wavelength}", sample.name)
            .chars()
            .map(|c| if allowed(c) { c } else { '_' })
            .collect();
        PathBuf::from(format!("{name}.{}", what.extension()))
    }

    pub(super) fn write(&mut self, what: Export, path: PathBuf) {
        let writing = match self.refusal(what, &path) {
            None => self.writing(what, &path),
            Some(refusal) => Err(refusal),
        };
        match writing {
            Ok(writing) => self.start(Job::Write(path, writing)),
            Err(words) => self.print_error(words),
        }
    }

    /// Why something shall not be written to a path: it would destroy what is open.
    fn refusal(&self, what: Export, path: &Path) -> Option<String> {
        let target = resolved(path);
        let own = format!("expected a file of its own for the {}", what.name());
        let shown = path.display();
        if self.samples.iter().any(|sample| sample.is_scan_at(&target)) {
            return Some(format!("{shown}: is an open scan: {own}"));
        }
        let of_document = || self.samples.iter().filter(|s| s.is_from(&target));
        let siblings = of_document().next()?.siblings;
        let open = of_document().count();
        let active = self.active_sample().is_some_and(|s| s.is_from(&target));
        if what != Export::Fit || !active {
            Some(format!("{shown}: is the fit of open samples: {own}"))
        } else if open < siblings {
            let of = format!("holds the fits of {siblings} scans, of which {open} are open");
            Some(format!("{shown}: {of}: {own}"))
        } else {
            None
        }
    }

    fn writing(&self, what: Export, path: &Path) -> Result<Writing, String> {
        let sample = self.active_sample().ok_or("no sample is open")?;
        Ok(match what {
            Export::Figure(picture) => {
                let layers: Vec<Layer> = self
                    .visible()
                    .map(|sample| Layer::of(sample, self.family_of(sample)))
                    .collect();
                if layers.iter().all(|layer| layer.incidences.is_empty()) {
                    return Err("the figure would be empty: no incidence is chosen".to_owned());
                }
                Writing::Figure(picture, layers, self.view)
            }
            Export::Curves => {
                let scan = sample.scan();
                let psi = scan.incidences.iter().map(|incidence| incidence.psi);
                Writing::Curves(Arc::clone(&scan.measurements), scan.knobs, psi.collect())
            }
            Export::Fit => {
                let target = resolved(path);
                // The document that a sample is from keeps the fits of the others in it.
                let samples = self.samples.iter();
                let samples = samples.filter(|s| s.id == sample.id || s.is_from(&target));
                let scans = samples.flat_map(|sample: &Sample| &sample.scans);
                Writing::Fit(scans.filter_map(|scan| scan.fitted.clone()).collect())
            }
        })
    }
}
