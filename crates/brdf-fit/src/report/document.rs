//! The JSON document of a run, written and read again.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::error::Category;

use super::Report;
use crate::fit::{FORMAT_VERSION, FitOptions};
use crate::scan::WAVELENGTH_TOLERANCE;

/// The JSON document of a run.
#[derive(Debug, Serialize, Deserialize)]
pub struct Document {
    /// [`FORMAT_VERSION`] of the program that wrote it.
    pub format_version: u32,
    /// One report for each file and wavelength.
    pub reports: Vec<Report>,
}

/// Why a file cannot be read as the document of a run.
#[derive(Debug, thiserror::Error)]
pub enum DocumentError {
    /// The file cannot be opened or read.
    #[error("{}: cannot be read: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// It is no JSON, or JSON of something else.
    #[error(
        "{}, line {}, column {}: {}: expected {}",
        path.display(), error.line(), error.column(), plain(.error), expected(.error)
    )]
    Json {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        error: serde_json::Error,
    },
    /// It was written by a later version of the program.
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
    /// There is no fit in it.
    #[error("{}: holds no fit: expected at least one report with a fit", path.display())]
    NoFits {
        /// The file.
        path: PathBuf,
    },
}

/// What is wrong, without the place that the message has already.
pub(crate) fn plain(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    text.strip_suffix(&place).unwrap_or(&text).to_owned()
}

fn expected(error: &serde_json::Error) -> &'static str {
    match error.classify() {
        Category::Data => "the document that fit --json writes",
        _ => "JSON, as fit --json writes it",
    }
}

/// What every version has.
#[derive(Deserialize)]
struct Version {
    format_version: u32,
}

impl Document {
    /// A document of this version.
    pub fn new(reports: Vec<Report>) -> Self {
        Self {
            format_version: FORMAT_VERSION,
            reports,
        }
    }

    /// Reads a document with at least one fit, of this version or an earlier one.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, DocumentError> {
        let path = path.as_ref();
        let bytes = fs::read(path).map_err(|error| DocumentError::Io {
            path: path.to_owned(),
            error,
        })?;
        Self::of_bytes(path, &bytes)
    }

    /// The same of what is in the file.
    pub(crate) fn of_bytes(path: &Path, bytes: &[u8]) -> Result<Self, DocumentError> {
        let json = |error| DocumentError::Json {
            path: path.to_owned(),
            error,
        };
        let Version { format_version } = serde_json::from_slice(bytes).map_err(json)?;
        if !(1..=FORMAT_VERSION).contains(&format_version) {
            return Err(DocumentError::Version {
                path: path.to_owned(),
                found: format_version,
            });
        }
        let document: Self = serde_json::from_slice(bytes).map_err(json)?;
        if document.reports.iter().all(|report| report.fit.is_none()) {
            return Err(DocumentError::NoFits {
                path: path.to_owned(),
            });
        }
        Ok(document)
    }

    /// A report on a file: by its path, next by its name.
    pub fn report_on(&self, source: &Path) -> Option<&Report> {
        let reports = || self.reports.iter();
        let same_name =
            |report: &&Report| Path::new(&report.file).file_name() == source.file_name();
        reports()
            .find(|report| Path::new(&report.file) == source)
            .or_else(|| reports().find(same_name))
    }

    /// The options by which a scan of one wavelength, in micrometres, of a file was fitted: those of
    /// the fit whose wavelength is within 1 % of its own, or which states none either. Of several it
    /// is the one of the same file, next by the file's name, next by the nearest wavelength, and else
    /// the first.
    pub fn options_for(&self, source: &str, wavelength_um: Option<f64>) -> Option<&FitOptions> {
        let source = Path::new(source);
        let key = |report: &Report| {
            let file = Path::new(&report.file);
            let other_name = file.file_name() != source.file_name();
            let distance = distance(report.wavelength_um, wavelength_um)?;
            Some((file != source, other_name, distance))
        };
        let matching = self.reports.iter().filter_map(|report| {
            let options = &report.fit.as_ref()?.options;
            Some((key(report)?, options))
        });
        let nearest = matching.min_by(|(a, _), (b, _)| {
            let names = (a.0, a.1).cmp(&(b.0, b.1));
            names.then(a.2.total_cmp(&b.2))
        });
        nearest.map(|(_, options)| options)
    }
}

/// How far a wavelength is from a wanted one, as a fraction; `None` where it is another.
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
    use crate::report::Depth;
    use crate::scan::synthetic::scan;
    use crate::{Measurements, RefractiveIndex};

    fn report(file: &str, wavelength_um: Option<f64>, max_iterations: u64) -> Report {
        let options = FitOptions {
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            max_iterations,
            ..FitOptions::default()
        };
        let (mut report, _) = Report::of(&of(file, wavelength_um), &options, Depth::Fit);
        report.file = file.to_owned();
        report
    }

    fn of(file: &str, wavelength_um: Option<f64>) -> Measurements {
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
            let options = document.options_for(file, wavelength_um);
            let found = options.map(|options| options.max_iterations);
            assert_eq!(found, expected, "{file} {wavelength_um:?}");
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fit.json");
        let document = Document::new(vec![report("x.csv", None, 5)]);
        fs::write(&path, serde_json::to_string(&document).unwrap()).unwrap();
        assert_eq!(Document::read(&path).unwrap().reports, document.reports);
    }

    #[test]
    fn what_is_no_document_is_named_with_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fit.json");
        for (text, message) in [
            ("", "line 1, column 0"),
            ("{\n\"format_version\": oops", "line 2, column 19"),
            (
                "psi_deg,theta_deg",
                "expected JSON, as fit --json writes it",
            ),
            ("[1]", "expected the document that fit --json writes"),
            (
                "{\"format_version\": 99, \"more\": 1}",
                "format_version 99: expected one from 1 to 1",
            ),
            ("{\"format_version\": 1, \"reports\": []}", "holds no fit"),
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
