//! What is kept between two starts.

use std::path::{Path, PathBuf};

use brdf_fit::output::write_file;
use brdf_fit::plot::View;
use brdf_fit::scan::Convention;
use serde::{Deserialize, Serialize};

use super::fitting::FitChoice;
use super::interface::Interface;
use super::sample::Sample;

/// Version of the file.
const VERSION: u32 = 1;

/// So many recent files are kept.
pub const MOST_RECENT: usize = 10;

/// The smallest window that everything fits into, in points.
pub const SMALLEST_WINDOW: [f32; 2] = [900.0, 600.0];

/// A window is not larger than this, in points.
const LARGEST_WINDOW: f32 = 16_384.0;

/// What is kept between two starts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Saved {
    /// Version of the file.
    pub version: u32,
    /// How the data are looked at.
    pub view: View,
    /// What of the window is shown.
    pub interface: Interface,
    /// The angular convention in which files are read.
    pub convention: Convention,
    /// The settings of the fit.
    pub choice: FitChoice,
    /// The files that were opened last, the latest first.
    pub recent: Vec<PathBuf>,
    /// What was open: files, and entries of the built-in menu.
    pub open: Vec<Reopened>,
    /// The size of the window, in points.
    pub window: [f32; 2],
}

/// Something that was open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reopened {
    /// A file, or an entry of the built-in menu.
    pub source: String,
    /// The angular convention of the file.
    pub convention: Convention,
}

impl Reopened {
    /// What samples were opened from, each source once.
    pub fn all(samples: &[Sample]) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for sample in samples {
            // A fit with several scans is opened once.
            if sample.siblings > 1 && all.iter().any(|one| one.source == sample.source) {
                continue;
            }
            all.push(Self {
                source: sample.source.clone(),
                convention: sample.scan().measurements.convention,
            });
        }
        all
    }
}

impl Default for Saved {
    fn default() -> Self {
        Self {
            version: VERSION,
            view: View::default(),
            interface: Interface::default(),
            convention: Convention::default(),
            choice: FitChoice::default(),
            recent: Vec::new(),
            open: Vec::new(),
            window: [1280.0, 800.0],
        }
    }
}

/// What was found of the last time.
#[derive(Debug, Clone, PartialEq)]
pub enum Found {
    /// Nothing: this is the first start.
    Nothing,
    /// What was kept.
    Kept(Saved),
    /// A file that cannot be used, and why.
    Damaged(String),
}

/// Where the settings are kept, and what was found there.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The file; `None` keeps nothing.
    pub path: Option<PathBuf>,
    /// What was found.
    pub saved: Saved,
    /// What to tell the user of it.
    pub note: Option<String>,
}

impl Settings {
    /// Settings that are not kept.
    pub fn unkept() -> Self {
        Self {
            path: None,
            saved: Saved::default(),
            note: None,
        }
    }

    /// The settings of a file.
    pub fn of(path: Option<PathBuf>) -> Self {
        let Some(file) = &path else {
            return Self::unkept();
        };
        let (saved, note) = match Saved::read(file) {
            Found::Nothing => (Saved::default(), None),
            Found::Kept(saved) => (saved, None),
            Found::Damaged(note) => (Saved::default(), Some(note)),
        };
        Self { path, saved, note }
    }
}

impl Saved {
    /// Reads what was kept. A damaged file is set aside under another name, so that nothing is lost.
    pub fn read(path: &Path) -> Found {
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Found::Nothing,
            Err(error) => return Found::Damaged(set_aside(path, &error.to_string())),
        };
        match serde_json::from_str::<Self>(&text) {
            Ok(saved) => match saved.problem() {
                None => Found::Kept(saved),
                Some(problem) => Found::Damaged(set_aside(path, &problem)),
            },
            Err(error) => Found::Damaged(set_aside(path, &error.to_string())),
        }
    }

    /// Writes it, whole or not at all.
    ///
    /// Errors: what the system says.
    pub fn write(&self, path: &Path) -> Result<(), String> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)
                .map_err(|error| format!("{}: {error}", folder.display()))?;
        }
        write_file(path, |writer| {
            serde_json::to_writer_pretty(&mut *writer, self)?;
            writer.write_all(b"\n")
        })
        .map_err(|error| error.to_string())
    }

    /// What of it cannot be.
    fn problem(&self) -> Option<String> {
        let [width, height] = self.window;
        let possible = |length: f32, least: f32| (least..=LARGEST_WINDOW).contains(&length);
        if self.version != VERSION {
            return Some(format!("version {}: expected {VERSION}", self.version));
        }
        if !possible(width, SMALLEST_WINDOW[0]) || !possible(height, SMALLEST_WINDOW[1]) {
            return Some(format!("a window of {width} x {height}"));
        }
        if !self.choice.is_valid() {
            return Some("settings of the fit out of their ranges".to_owned());
        }
        if !self.view.azimuth.is_finite() {
            return Some("an azimuth that is no number".to_owned());
        }
        if self.recent.len() > MOST_RECENT {
            return Some(format!("{} recent files", self.recent.len()));
        }
        None
    }
}

/// Sets a damaged file aside, and says so.
fn set_aside(path: &Path, problem: &str) -> String {
    let aside = path.with_extension("damaged");
    let kept = match std::fs::rename(path, &aside) {
        Ok(()) => format!("it is kept as {}", aside.display()),
        Err(error) => format!("it cannot be set aside ({error})"),
    };
    format!(
        "{}: the settings of the last time cannot be used ({problem}): expected the file as the \
         viewer writes it; defaults are taken, {kept}",
        path.display()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep").join("state.json");
        assert_eq!(Saved::read(&path), Found::Nothing);
        let mut saved = Saved::default();
        saved.view.residuals = true;
        saved.interface.dark = Some(true);
        saved.recent = vec![PathBuf::from("a.csv")];
        saved.write(&path).unwrap();
        assert_eq!(Saved::read(&path), Found::Kept(saved));
    }

    #[test]
    fn a_damaged_file_is_set_aside_and_told() {
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
            let Found::Damaged(note) = Saved::read(&path) else {
                panic!("{text:?} was taken");
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
