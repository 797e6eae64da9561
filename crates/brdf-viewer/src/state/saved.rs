//! The settings saved between sessions.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use brdf_core::ModelParameters;
use brdf_fit::output::{WriteError, write_file};
use brdf_fit::plot::View;
use brdf_fit::{Convention, Model};
use serde::{Deserialize, Serialize};

use super::fit_settings::FitSettings;
use super::interface::Interface;
use super::parameters::EditedParameters;
use super::sample::{Sample, Scan};
use super::solid::SolidView;

/// Version of the file format.
const VERSION: u32 = 1;

/// The largest number of recent files.
pub const MOST_RECENT: usize = 10;

/// The smallest window into which all panels fit, in points.
pub const SMALLEST_WINDOW: [f32; 2] = [900.0, 600.0];

/// The largest side of a window, in points.
const LARGEST_WINDOW: f32 = 16_384.0;

/// The settings saved between sessions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Saved {
    /// Version of the file format.
    pub version: u32,
    /// The view of the data.
    pub view: View,
    /// The settings of the lobe and of the surface.
    #[serde(default)]
    pub solid: SolidView,
    /// The theme and the visible panels.
    pub interface: Interface,
    /// The angular convention in which files are read.
    pub convention: Convention,
    /// The fit settings.
    #[serde(rename = "choice")]
    pub fit_settings: FitSettings,
    /// The paths of recently opened files, the latest first.
    pub recent: Vec<PathBuf>,
    /// The sources of the open samples.
    pub open: Vec<Reopened>,
    /// The size of the window, in points.
    pub window: [f32; 2],
}

/// The source of a sample that was open, and what the user has set of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reopened {
    /// The path of a file, or the name of a built-in sample.
    pub source: String,
    /// The angular convention in which it was read.
    pub convention: Convention,
    /// The samples of the source, in their order.
    #[serde(default)]
    pub samples: Vec<SavedSample>,
}

/// What the user has set of a sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SavedSample {
    /// The index of the wavelength that is shown.
    pub wavelength: usize,
    /// Whether the sample is shown.
    pub visible: bool,
    /// The scans that differ from a newly opened one, by the index of their wavelength.
    pub scans: Vec<(usize, SavedScan)>,
}

/// What the user has set of a scan. The fit itself is made again: the same readings, model and settings
/// give the same numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SavedScan {
    /// The model.
    pub model: Model,
    /// The values of its parameters.
    pub values: ModelParameters,
    /// The parameters that are fixed.
    pub fixed: [bool; 5],
    /// Whether the values were those of the fit.
    pub fitted: bool,
    /// The indices of the readings that are left out.
    pub left_out: BTreeSet<usize>,
    /// The indices of the hidden incidences.
    pub hidden: BTreeSet<usize>,
}

impl Reopened {
    /// The sources of samples.
    pub fn all(samples: &[Sample]) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for sample in samples {
            let saved = SavedSample::of(sample);
            // A fit of several scans is one source.
            let same =
                |one: &&mut Self| sample.samples_in_source > 1 && one.source == sample.source;
            if let Some(one) = all.iter_mut().find(same) {
                one.samples.push(saved);
                continue;
            }
            all.push(Self {
                source: sample.source.clone(),
                convention: sample.scan().measurements.convention,
                samples: vec![saved],
            });
        }
        all
    }
}

impl SavedSample {
    fn of(sample: &Sample) -> Self {
        let scans = sample.scans.iter().enumerate();
        let saved = scans.filter_map(|(i, scan)| Some((i, SavedScan::of(scan)?)));
        Self {
            wavelength: sample.current,
            visible: sample.visible,
            scans: saved.collect(),
        }
    }

    /// Sets a sample that was opened again as it was. What does not fit to it, because the file has
    /// changed, is left out.
    pub fn restore(&self, sample: &mut Sample) {
        sample.visible = self.visible;
        if self.wavelength < sample.scans.len() {
            sample.current = self.wavelength;
        }
        for (i, saved) in &self.scans {
            if let Some(scan) = sample.scans.get_mut(*i) {
                saved.restore(scan);
            }
        }
    }
}

impl SavedScan {
    fn of(scan: &Scan) -> Option<Self> {
        let saved = Self {
            model: scan.parameters.model,
            values: scan.parameters.values,
            fixed: scan.parameters.fixed,
            fitted: scan.current_fit().is_some(),
            left_out: scan.left_out().clone(),
            hidden: scan.hidden_incidences(),
        };
        let differs = scan.parameters.model != scan.initial.model
            || scan.parameters.fixed != scan.initial.fixed
            || scan.is_edited()
            || !saved.left_out.is_empty()
            || !saved.hidden.is_empty();
        differs.then_some(saved)
    }

    fn restore(&self, scan: &mut Scan) {
        let restored = EditedParameters {
            model: self.model,
            values: self.values,
            fixed: self.fixed,
        };
        scan.leave_out(self.left_out.clone());
        for (i, incidence) in scan.incidences.iter_mut().enumerate() {
            incidence.visible = !self.hidden.contains(&i);
        }
        if restored.brdf().is_none() {
            return;
        }
        scan.parameters = restored;
        scan.committed = restored;
        // The fit that follows replaces parameters that were fitted before, and keeps edited ones.
        if self.fitted && scan.last_fit.is_none() {
            scan.initial = restored;
        }
    }
}

impl Default for Saved {
    fn default() -> Self {
        Self {
            version: VERSION,
            view: View::default(),
            solid: SolidView::default(),
            interface: Interface::default(),
            convention: Convention::default(),
            fit_settings: FitSettings::default(),
            recent: Vec::new(),
            open: Vec::new(),
            window: [1280.0, 800.0],
        }
    }
}

/// The result of reading the settings.
#[derive(Debug, Clone, PartialEq)]
pub enum ReadResult {
    /// There is no file, as in the first session.
    Missing,
    /// The settings of the last session.
    Valid(Box<Saved>),
    /// The file cannot be used, and a message for the user.
    Damaged(String),
}

/// Why the settings cannot be saved.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// The folder cannot be created.
    #[error("{}: {error}", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// The error of the system.
        error: std::io::Error,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// The settings with their file.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The file; `None` saves nothing.
    pub path: Option<PathBuf>,
    /// The settings as they were saved last.
    pub saved: Saved,
    /// A message for the user.
    pub note: Option<String>,
}

impl Settings {
    /// Default settings that are not saved.
    pub fn in_memory() -> Self {
        Self {
            path: None,
            saved: Saved::default(),
            note: None,
        }
    }

    /// Reads the settings of a file, or the default ones if it cannot be used.
    pub fn load(path: Option<PathBuf>) -> Self {
        let Some(file) = &path else {
            return Self::in_memory();
        };
        let (saved, note) = match Saved::read(file) {
            ReadResult::Missing => (Saved::default(), None),
            ReadResult::Valid(saved) => (*saved, None),
            ReadResult::Damaged(note) => (Saved::default(), Some(note)),
        };
        Self { path, saved, note }
    }
}

impl Saved {
    /// Reads a file. A damaged file is renamed, so that its content is not lost.
    pub fn read(path: &Path) -> ReadResult {
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return ReadResult::Missing;
            }
            Err(error) => return ReadResult::Damaged(set_aside(path, &error.to_string())),
        };
        match serde_json::from_str::<Self>(&text) {
            Ok(saved) => match saved.problem() {
                None => ReadResult::Valid(Box::new(saved)),
                Some(problem) => ReadResult::Damaged(set_aside(path, &problem)),
            },
            Err(error) => ReadResult::Damaged(set_aside(path, &error.to_string())),
        }
    }

    /// Writes the settings. The file is replaced only when it is complete.
    ///
    /// # Errors
    ///
    /// The folder cannot be created, or the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), SaveError> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(|error| SaveError::Folder {
                folder: folder.to_owned(),
                error,
            })?;
        }
        write_file(path, |writer| {
            serde_json::to_writer_pretty(&mut *writer, self)?;
            writer.write_all(b"\n")
        })?;
        Ok(())
    }

    /// A value that is not valid, as text.
    fn problem(&self) -> Option<String> {
        let [width, height] = self.window;
        let is_possible = |length: f32, least: f32| (least..=LARGEST_WINDOW).contains(&length);
        if self.version != VERSION {
            return Some(format!("version {}: expected {VERSION}", self.version));
        }
        if !is_possible(width, SMALLEST_WINDOW[0]) || !is_possible(height, SMALLEST_WINDOW[1]) {
            return Some(format!("a window of {width} x {height}"));
        }
        if !self.fit_settings.is_valid() {
            return Some("fit settings out of range".to_owned());
        }
        if !self.view.azimuth.is_finite() {
            return Some("an azimuth that is not finite".to_owned());
        }
        if !self.solid.is_valid() {
            return Some("settings of the lobe or the surface out of range".to_owned());
        }
        if self.recent.len() > MOST_RECENT {
            return Some(format!("{} recent files", self.recent.len()));
        }
        None
    }
}

/// Renames a damaged file, and returns a message for the user.
fn set_aside(path: &Path, problem: &str) -> String {
    let aside = path.with_extension("damaged");
    let outcome = match std::fs::rename(path, &aside) {
        Ok(()) => format!("the file is kept as {}", aside.display()),
        Err(error) => format!("the file cannot be renamed ({error})"),
    };
    format!(
        "{}: the saved settings cannot be used ({problem}): expected a file written by the viewer; \
         the defaults are used, and {outcome}",
        path.display()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_settings_are_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep").join("state.json");
        assert_eq!(Saved::read(&path), ReadResult::Missing);
        let mut saved = Saved::default();
        saved.view.residuals = true;
        saved.interface.dark = Some(true);
        saved.recent = vec![PathBuf::from("a.csv")];
        saved.write(&path).unwrap();
        assert_eq!(Saved::read(&path), ReadResult::Valid(Box::new(saved)));
    }

    #[test]
    fn a_damaged_file_is_renamed_and_reported() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state.json");
        let good = serde_json::to_string(&Saved::default()).unwrap();
        let bad = [
            String::new(),
            good[..good.len() / 2].to_owned(),
            good.replace("\"version\":1", "\"version\":7"),
            good.replace("1280.0", "3.0"),
            good.replace("60.0", "1e9"),
            "\u{0}\u{1}".to_owned(),
        ];
        for text in bad {
            assert_ne!(text, good);
            std::fs::write(&path, &text).unwrap();
            let ReadResult::Damaged(note) = Saved::read(&path) else {
                panic!("{text:?} was accepted");
            };
            assert!(
                note.contains("state.json") && note.contains("defaults"),
                "{note}"
            );
            let aside = folder.path().join("state.damaged");
            assert_eq!(std::fs::read_to_string(aside).unwrap(), text);
            assert!(!path.exists());
        }
    }
}
