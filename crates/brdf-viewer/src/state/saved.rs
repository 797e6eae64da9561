//! The settings saved between sessions.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use brdf_core::ModelParameters;
use brdf_fit::plot::View;
use brdf_fit::{Convention, Model};
use serde::{Deserialize, Serialize};

use super::fit_settings::FitSettings;
use super::interface::Interface;
use super::parameters::EditedParameters;
use super::sample::{Sample, Scan};
use super::solid::SolidView;
use crate::platform::{SaveError, Storage};

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

/// The settings with the place that keeps them.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The place; `None` saves nothing.
    pub storage: Option<Rc<dyn Storage>>,
    /// The settings as they were saved last.
    pub saved: Saved,
    /// A message for the user.
    pub note: Option<String>,
}

impl Settings {
    /// Default settings that are not saved.
    pub fn in_memory() -> Self {
        Self {
            storage: None,
            saved: Saved::default(),
            note: None,
        }
    }

    /// Reads the settings, or takes the default ones if they cannot be used. A damaged text is set aside,
    /// so that it is not lost.
    pub fn load(storage: Option<Rc<dyn Storage>>) -> Self {
        let Some(place) = storage else {
            return Self::in_memory();
        };
        let read = match place.read() {
            Ok(None) => Ok(Saved::default()),
            Ok(Some(text)) => Saved::parse(&text),
            Err(error) => Err(error.to_string()),
        };
        let (saved, note) = match read {
            Ok(saved) => (saved, None),
            Err(problem) => (Saved::default(), Some(set_aside(&*place, &problem))),
        };
        Self {
            storage: Some(place),
            saved,
            note,
        }
    }

    /// Writes the settings, and returns what the user must know. `files` are those of the session.
    ///
    /// # Errors
    ///
    /// The settings cannot be written.
    pub fn write(&self, files: &[&Path]) -> Result<Vec<String>, SaveError> {
        match &self.storage {
            Some(place) => place.write(&self.saved.text(), files),
            None => Ok(Vec::new()),
        }
    }
}

impl Saved {
    /// Parses a text that the viewer has written.
    ///
    /// # Errors
    ///
    /// What is wrong with it.
    fn parse(text: &str) -> Result<Self, String> {
        let saved: Self = serde_json::from_str(text).map_err(|error| error.to_string())?;
        match saved.problem() {
            None => Ok(saved),
            Some(problem) => Err(problem),
        }
    }

    /// The settings as text.
    fn text(&self) -> String {
        // Neither the keys nor the values of the settings can fail to be written.
        let text = serde_json::to_string_pretty(self).unwrap_or_default();
        format!("{text}\n")
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

/// Sets a damaged text aside, and returns a message for the user.
fn set_aside(place: &dyn Storage, problem: &str) -> String {
    let outcome = match place.set_aside() {
        Ok(aside) => format!("the file is kept as {aside}"),
        Err(error) => format!("the file cannot be renamed ({error})"),
    };
    format!(
        "{}: the saved settings cannot be used ({problem}): expected a file written by the viewer; \
         the defaults are used, and {outcome}",
        place.name()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::current::SettingsFile;

    fn file(path: &Path) -> Rc<dyn Storage> {
        Rc::new(SettingsFile::new(path.to_owned()))
    }

    #[test]
    fn written_settings_are_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep").join("state.json");
        let mut settings = Settings::load(Some(file(&path)));
        assert_eq!(settings.saved, Saved::default());
        settings.saved.view.residuals = true;
        settings.saved.interface.dark = Some(true);
        settings.saved.recent = vec![PathBuf::from("a.csv")];
        assert_eq!(settings.write(&[]).unwrap(), Vec::<String>::new());
        let again = Settings::load(Some(file(&path)));
        assert_eq!((again.saved, again.note), (settings.saved, None));
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
            let settings = Settings::load(Some(file(&path)));
            assert_eq!(settings.saved, Saved::default(), "{text:?}");
            let note = settings.note.unwrap();
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
