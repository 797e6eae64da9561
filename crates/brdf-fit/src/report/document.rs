//! The JSON document of fits: writing and reading it.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::fs;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::error::Category;

use super::run::Report;
use crate::fit::{FORMAT_VERSION, FitOptions};
use crate::output::is_standard_stream;
use crate::scan::WAVELENGTH_TOLERANCE;

/// Reports on fits, as a JSON document.
///
/// It is serialised by [`write_json`](crate::output::write_json).
#[derive(Debug, Serialize, Deserialize)]
pub struct Document {
    /// [`FORMAT_VERSION`] of the program that wrote the document.
    pub format_version: u32,
    /// One report for each file and wavelength.
    pub reports: Vec<Report>,
}

/// Why a file cannot be read as a document of fits.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DocumentError {
    /// The file cannot be opened or read.
    #[error("{}: cannot be read: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        error: io::Error,
    },
    /// The content is not JSON, or JSON of another kind.
    #[error(
        "{}, line {}, column {}: {}: expected {}",
        path.display(), error.line(), error.column(), without_position(.error), expected(.error)
    )]
    Json {
        /// The file.
        path: PathBuf,
        /// The error of the parser.
        error: serde_json::Error,
    },
    /// The document was written by a later version of the program.
    #[error(
        "{}: format_version {found}: expected one from 1 to {FORMAT_VERSION} (was it written by a \
         later version?)",
        path.display()
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
    /// The document contains no fit.
    #[error("{}: contains no fit: expected at least one report with a fit", path.display())]
    NoFits {
        /// The file.
        path: PathBuf,
    },
}

/// The message of a JSON error without the line and column at its end.
pub(crate) fn without_position(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let position = format!(" at line {} column {}", error.line(), error.column());
    text.strip_suffix(&position).unwrap_or(&text).to_owned()
}

fn expected(error: &serde_json::Error) -> &'static str {
    match error.classify() {
        Category::Data => "a document of fits",
        _ => "JSON with a document of fits",
    }
}

/// The part of a document that every version has.
#[derive(Deserialize)]
struct Version {
    format_version: u32,
}

impl Document {
    /// A document of the current version.
    pub fn new(reports: Vec<Report>) -> Self {
        Self {
            format_version: FORMAT_VERSION,
            reports,
        }
    }

    /// Reads a document from a file; `-` reads from standard input.
    ///
    /// # Errors
    ///
    /// See [`from_bytes`](Self::from_bytes); or the file cannot be read.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, DocumentError> {
        let path = path.as_ref();
        let (source, bytes) = if is_standard_stream(path) {
            let mut bytes = Vec::new();
            let read = io::stdin().lock().read_to_end(&mut bytes);
            (Path::new("standard input"), read.map(|_| bytes))
        } else {
            (path, fs::read(path))
        };
        let bytes = bytes.map_err(|error| DocumentError::Io {
            path: source.to_owned(),
            error,
        })?;
        Self::from_bytes(source, &bytes)
    }

    /// Parses a document of the current or an earlier version; `source` names it in errors.
    ///
    /// # Errors
    ///
    /// The content is no such document, or contains no fit.
    pub fn from_bytes(source: impl AsRef<Path>, bytes: &[u8]) -> Result<Self, DocumentError> {
        let path = || source.as_ref().to_owned();
        let json = |error| DocumentError::Json {
            path: path(),
            error,
        };
        let Version { format_version } = serde_json::from_slice(bytes).map_err(json)?;
        if !(1..=FORMAT_VERSION).contains(&format_version) {
            return Err(DocumentError::Version {
                path: path(),
                found: format_version,
            });
        }
        let document: Self = serde_json::from_slice(bytes).map_err(json)?;
        if document.reports.iter().all(|report| report.fit.is_none()) {
            return Err(DocumentError::NoFits { path: path() });
        }
        Ok(document)
    }

    /// The reports by the files that they are on.
    pub fn by_file(&self) -> ByFile<'_> {
        let mut by_file = ByFile {
            reports: &self.reports,
            paths: HashMap::new(),
            names: HashMap::new(),
        };
        for report in &self.reports {
            for file in std::iter::once(&report.file).chain(&report.read_settings.joined) {
                let path = Path::new(file);
                by_file.paths.entry(path).or_default().push(report);
                let of_name = by_file.names.entry(name_of(path)).or_default();
                of_name.push(report);
            }
        }
        by_file
    }
}

/// The reports of a [`Document`] by the files that they are on, for many look-ups.
#[derive(Debug)]
pub struct ByFile<'a> {
    reports: &'a [Report],
    paths: HashMap<&'a Path, Vec<&'a Report>>,
    names: HashMap<&'a OsStr, Vec<&'a Report>>,
}

impl<'a> ByFile<'a> {
    /// All reports, in the order of the document.
    pub fn reports(&self) -> &'a [Report] {
        self.reports
    }

    /// The reports on a file with this path, and those on a file of this name.
    fn of(&self, source: &Path) -> [&[&'a Report]; 2] {
        let of_path = self.paths.get(source);
        let of_name = self.names.get(name_of(source));
        [of_path, of_name].map(|reports| reports.map_or(&[][..], Vec::as_slice))
    }

    /// The first report on a file with this path, or else with this file name: on the
    /// file alone, or joined with others.
    pub fn report_on(&self, source: &Path) -> Option<&'a Report> {
        let [of_path, of_name] = self.of(source);
        of_path.first().or_else(|| of_name.first()).copied()
    }

    /// The options of the fit that matches a scan of a file at one wavelength, in micrometres.
    ///
    /// A fit matches if its wavelength is within 1 %, or if neither states a wavelength. Among several
    /// matches, the same path takes precedence, then the same file name, then the nearest wavelength,
    /// then the order in the document.
    pub fn options_for(&self, source: &str, wavelength_um: Option<f64>) -> Option<&'a FitOptions> {
        let [of_path, of_name] = self.of(Path::new(source));
        nearest(of_path.iter().copied(), wavelength_um)
            .or_else(|| nearest(of_name.iter().copied(), wavelength_um))
            .or_else(|| nearest(self.reports, wavelength_um))
    }

    /// The indices of the readings that the fit of this file at this wavelength leaves out: see
    /// [`Report::left_out`]. They mean nothing for another file.
    pub fn left_out_of(&self, source: &str, wavelength_um: Option<f64>) -> &'a [usize] {
        let [_, of_name] = self.of(Path::new(source));
        let mut of_name = of_name.iter();
        let same = of_name.find(|report| report.wavelength_um == wavelength_um);
        same.map_or(&[], |report| &report.left_out)
    }
}

/// The file name of a path; empty where it has none.
fn name_of(path: &Path) -> &OsStr {
    path.file_name().unwrap_or_default()
}

/// The options of the fit that is nearest to a wavelength, of those that match it; the first of several.
fn nearest<'a>(
    reports: impl IntoIterator<Item = &'a Report>,
    wavelength_um: Option<f64>,
) -> Option<&'a FitOptions> {
    let matching = reports.into_iter().filter_map(|report| {
        let options = &report.fit.as_ref()?.options;
        Some((distance(report.wavelength_um, wavelength_um)?, options))
    });
    let nearest = matching.min_by(|(a, _), (b, _)| a.total_cmp(b));
    nearest.map(|(_, options)| options)
}

/// The relative difference of a wavelength from a wanted one; `None` if they do not match.
fn distance(wavelength_um: Option<f64>, wanted: Option<f64>) -> Option<f64> {
    match (wavelength_um, wanted) {
        (Some(wavelength), Some(wanted)) => {
            Some((wavelength / wanted - 1.0).abs()).filter(|d| *d <= WAVELENGTH_TOLERANCE)
        }
        (None, None) => Some(0.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::Parameters;

    use super::*;
    use crate::report::run::Depth;
    use crate::scan::synthetic::scan;
    use crate::scan::{Measurements, RefractiveIndex};

    fn report(file: &str, wavelength_um: Option<f64>, max_iterations: u64) -> Report {
        let options = FitOptions {
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            max_iterations,
            ..FitOptions::default()
        };
        let (mut report, _) = Report::new(&measurements(file, wavelength_um), &options, Depth::Fit);
        report.file = file.to_owned();
        report
    }

    fn measurements(file: &str, wavelength_um: Option<f64>) -> Measurements {
        let scan = scan(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5);
        let mut readings = scan.readings().to_vec();
        for reading in &mut readings {
            reading.wavelength_um = wavelength_um;
        }
        Measurements::new(file, readings).unwrap()
    }

    #[test]
    fn options_are_those_of_the_same_file_and_the_nearest_wavelength() {
        let document = Document::new(vec![
            report("a/x.csv", Some(0.5), 1),
            report("b/x.csv", Some(0.5), 2),
            report("b/x.csv", Some(0.503), 3),
            report("b/y.csv", None, 4),
        ]);
        for (file, wavelength_um, expected) in [
            ("a/x.csv", Some(0.5), Some(1)),
            ("b/x.csv", Some(0.5), Some(2)),
            ("b/x.csv", Some(0.503), Some(3)),
            ("c/x.csv", Some(0.5), Some(1)),
            ("z.csv", Some(0.502), Some(3)),
            ("z.csv", None, Some(4)),
            ("b/x.csv", Some(0.6), None),
            ("b/x.csv", None, Some(4)),
        ] {
            let options = document.by_file().options_for(file, wavelength_um);
            let found = options.map(|options| options.max_iterations);
            assert_eq!(found, expected, "{file} {wavelength_um:?}");
        }
    }

    #[test]
    fn a_written_document_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fit.json");
        let document = Document::new(vec![report("x.csv", None, 5)]);
        fs::write(&path, serde_json::to_string(&document).unwrap()).unwrap();
        assert_eq!(Document::read(&path).unwrap().reports, document.reports);
    }

    #[test]
    fn errors_name_the_file_the_position_and_what_was_expected() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fit.json");
        for (text, message) in [
            ("", "line 1, column 0"),
            ("{\n\"format_version\": oops", "line 2, column 19"),
            ("psi_deg,theta_deg", "expected JSON with a document of fits"),
            ("[1]", "expected a document of fits"),
            (
                "{\"format_version\": 99, \"more\": 1}",
                "format_version 99: expected one from 1 to 1",
            ),
            (
                "{\"format_version\": 1, \"reports\": []}",
                "contains no fit",
            ),
            (
                "{\"format_version\": 1, \"reports\": [{}]}",
                "missing field",
            ),
        ] {
            fs::write(&path, text).unwrap();
            let error = Document::read(&path).unwrap_err().to_string();
            assert!(
                error.contains(message) && error.contains("fit.json"),
                "{error}"
            );
        }
        let missing = Document::read(folder.path().join("none")).unwrap_err();
        assert!(missing.to_string().contains("cannot be read"));
    }
}
