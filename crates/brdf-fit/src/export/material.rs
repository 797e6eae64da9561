//! What is exported: the fits of one surface as BRDFs.

use std::borrow::Cow;
use std::cmp::Ordering;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use brdf_core::{AnyBrdf, ParameterError};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use crate::report::{Document, DocumentError, Report, without_position};
use crate::scan::WAVELENGTH_TOLERANCE;

/// The version of the JSON of a [`Material`].
const FORMAT_VERSION: u32 = 1;

/// The fits of one surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// One for each wavelength, in ascending order; at least one.
    pub fits: Vec<Fitted>,
}

/// A fitted BRDF, and where it comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fitted {
    /// The file of the scan.
    pub file: String,
    /// Wavelength in micrometres, where the scan states one.
    pub wavelength_um: Option<f64>,
    /// The BRDF: its family and its parameters.
    pub brdf: AnyBrdf,
    /// E over the fitted readings, in percent.
    pub e_percent: f64,
    /// The largest incidence angle of the readings, in degrees.
    pub psi_max_deg: f64,
}

/// Why a coating is not to be had from a file, or not in a form.
#[derive(Debug, thiserror::Error)]
pub enum MaterialError {
    /// The file is no document of fits.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// It looks like a model, and is damaged.
    #[error(
        "{}, line {}, column {}: {}: expected the model that export --to json writes",
        path.display(), error.line(), error.column(), without_position(.error)
    )]
    Model {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        error: serde_json::Error,
    },
    /// It is a model of a later version of the program.
    #[error(
        "{}: format_version {found} of a model: expected {FORMAT_VERSION} (was it written by a later \
         version?)",
        path.display()
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
    /// It is a model without a fit.
    #[error("{}: holds no fit: expected a model of at least one", path.display())]
    NoFits {
        /// The file.
        path: PathBuf,
    },
    /// Parameters that no program of ours writes.
    #[error("{}, the fit of {file}: {error}", path.display())]
    Parameter {
        /// The file.
        path: PathBuf,
        /// The file of the scan.
        file: String,
        /// Which.
        error: ParameterError,
    },
    /// There is no fit of the wanted wavelength, or of the wanted file.
    #[error("no fit of {wanted}: expected one of {}", .found.join(", "))]
    NoSuch {
        /// What was asked for.
        wanted: String,
        /// What there is.
        found: Vec<String>,
    },
    /// There is no fit for one of the colours red, green and blue.
    #[error("no fit within {reach_um} um of {colour} ({primary_um} um): expected --wavelength UM, for grey, or --rgb RED,GREEN,BLUE, of {}", .found.join(", "))]
    NoColour {
        /// Which.
        colour: &'static str,
        /// Where it is looked for, in micrometres.
        primary_um: f64,
        /// How far from there, in micrometres.
        reach_um: f64,
        /// What there is.
        found: Vec<String>,
    },
    /// There is room for one fit.
    #[error("there are several fits: expected one of {} to be chosen with --{option}", .found.join(", "))]
    Several {
        /// The option that chooses.
        option: &'static str,
        /// What there is to choose from.
        found: Vec<String>,
    },
}

/// The JSON of a coating, with its version.
#[derive(Serialize, Deserialize)]
struct Versioned<'a> {
    format_version: u32,
    fits: Cow<'a, [Fitted]>,
}

/// What every version has, and a document has not.
#[derive(Deserialize)]
struct Kind {
    format_version: u32,
    #[serde(rename = "fits")]
    _fits: IgnoredAny,
}

impl Material {
    /// Reads the fits of a file: the document of a run, or what [`write`](Self::write) wrote.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, MaterialError> {
        let path = path.as_ref();
        let bytes = fs::read(path).map_err(|error| DocumentError::Io {
            path: path.to_owned(),
            error,
        })?;
        match serde_json::from_slice(&bytes) {
            Ok(Kind { format_version, .. }) => Self::of_model(path, format_version, &bytes),
            // Where it is neither, the words of the error are those about a document.
            Err(_) => Self::of_document(path, &Document::from_bytes(path, &bytes)?),
        }
    }

    /// The fits of what [`write`](Self::write) wrote.
    fn of_model(path: &Path, found: u32, bytes: &[u8]) -> Result<Self, MaterialError> {
        let path = path.to_owned();
        if found != FORMAT_VERSION {
            return Err(MaterialError::Version { path, found });
        }
        match serde_json::from_slice::<Versioned>(bytes) {
            Ok(model) if model.fits.is_empty() => Err(MaterialError::NoFits { path }),
            Ok(model) => Ok(Self {
                fits: model.fits.into_owned(),
            }),
            Err(error) => Err(MaterialError::Model { path, error }),
        }
    }

    /// The fits of a document.
    fn of_document(path: &Path, document: &Document) -> Result<Self, MaterialError> {
        let fit = |report| Fitted::of_report(path, report);
        let fits = document.reports.iter().filter_map(fit);
        let mut fits = fits.collect::<Result<Vec<_>, _>>()?;
        fits.sort_by(|a, b| a.file.cmp(&b.file).then(by_wavelength(a, b)));
        Ok(Self { fits })
    }

    /// Writes the model as JSON with a format version: family and parameters of each fit.
    pub fn write(&self, writer: &mut dyn Write) -> io::Result<()> {
        let versioned = Versioned {
            format_version: FORMAT_VERSION,
            fits: Cow::Borrowed(&self.fits),
        };
        serde_json::to_writer_pretty(&mut *writer, &versioned)?;
        writer.write_all(b"\n")
    }

    /// The fits of one file, the only one where none is named, given by its path or its name.
    ///
    /// Errors: there is none, or files of several folders have the name.
    pub fn of_file(self, name: Option<&str>) -> Result<Self, MaterialError> {
        let files = distinct(self.fits.iter().map(|fit| fit.file.clone()));
        let Some(name) = name else {
            return match files.len() {
                1 => Ok(self),
                _ => Err(MaterialError::Several {
                    option: "file",
                    found: files,
                }),
            };
        };
        let is_named = |fit: &Fitted| {
            fit.file == name
                || Path::new(&fit.file)
                    .file_name()
                    .is_some_and(|file| file == name)
        };
        let fits: Vec<Fitted> = self.fits.into_iter().filter(is_named).collect();
        let named = distinct(fits.iter().map(|fit| fit.file.clone()));
        match named.len() {
            0 => Err(MaterialError::NoSuch {
                wanted: name.to_owned(),
                found: files,
            }),
            1 => Ok(Self { fits }),
            _ => Err(MaterialError::Several {
                option: "file",
                found: named,
            }),
        }
    }

    /// The fit nearest to a wavelength in micrometres.
    ///
    /// Errors: none is within 1 %.
    pub fn of_wavelength(self, wavelength_um: f64) -> Result<Self, MaterialError> {
        let fit = self.at_wavelength(wavelength_um)?.clone();
        Ok(Self { fits: vec![fit] })
    }

    pub(super) fn at_wavelength(&self, wavelength_um: f64) -> Result<&Fitted, MaterialError> {
        self.within(wavelength_um, WAVELENGTH_TOLERANCE * wavelength_um)
            .ok_or_else(|| MaterialError::NoSuch {
                wanted: format!("{wavelength_um} um"),
                found: self.wavelengths(),
            })
    }

    /// The fit nearest to a wavelength, none farther than the reach, both in micrometres.
    pub(super) fn within(&self, wavelength_um: f64, reach_um: f64) -> Option<&Fitted> {
        let distance = |fit: &Fitted| fit.wavelength_um.map(|w| (w - wavelength_um).abs());
        let near = self
            .fits
            .iter()
            .filter_map(|fit| Some((fit, distance(fit)?)));
        near.filter(|(_, distance)| *distance <= reach_um)
            .min_by(|(_, a), (_, b)| a.total_cmp(b))
            .map(|(fit, _)| fit)
    }

    /// The only fit.
    ///
    /// Errors: there are several.
    pub fn only(&self) -> Result<&Fitted, MaterialError> {
        match self.fits.as_slice() {
            [fit] => Ok(fit),
            _ => Err(MaterialError::Several {
                option: "wavelength",
                found: self.wavelengths(),
            }),
        }
    }

    pub(super) fn wavelengths(&self) -> Vec<String> {
        distinct(self.fits.iter().map(|fit| match fit.wavelength_um {
            Some(wavelength) => format!("{wavelength} um"),
            None => "one without a wavelength".to_owned(),
        }))
    }
}

impl Fitted {
    fn of_report(path: &Path, report: &Report) -> Option<Result<Self, MaterialError>> {
        let fit = report.fit.as_ref()?;
        let brdf = AnyBrdf::new(fit.model().family(), &fit.at());
        let incidences = fit.incidences.iter();
        let fitted = brdf.map(|brdf| Self {
            file: report.file.clone(),
            wavelength_um: report.wavelength_um,
            brdf,
            e_percent: fit.e_percent,
            psi_max_deg: incidences.map(|i| i.psi_deg).fold(0.0, f64::max),
        });
        Some(fitted.map_err(|error| MaterialError::Parameter {
            path: path.to_owned(),
            file: report.file.clone(),
            error,
        }))
    }
}

fn by_wavelength(a: &Fitted, b: &Fitted) -> Ordering {
    let value = |fit: &Fitted| fit.wavelength_um.unwrap_or(0.0);
    value(a).total_cmp(&value(b))
}

/// Each once, in the order of the first.
fn distinct(all: impl Iterator<Item = String>) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for one in all {
        if !found.contains(&one) {
            found.push(one);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use brdf_core::{Family, ModelParameters, Parameters};
    use serde_json::{Value, json};
    use tempfile::TempDir;

    use super::*;
    use crate::report::Depth;
    use crate::scan::synthetic::scan;
    use crate::{FitOptions, Measurements, RefractiveIndex};

    /// A file of a test.
    struct Folder(TempDir);

    impl Folder {
        fn new() -> Self {
            Self(tempfile::tempdir().unwrap())
        }

        fn file(&self) -> PathBuf {
            self.0.path().join("fit.json")
        }

        fn read(&self, content: &[u8]) -> Result<Material, MaterialError> {
            fs::write(self.file(), content).unwrap();
            Material::read(self.file())
        }

        /// What is said of a file, after its path.
        fn refused(&self, content: &[u8]) -> String {
            let said = self.read(content).unwrap_err().to_string();
            let path = self.file().display().to_string();
            said.strip_prefix(&path).unwrap().to_owned()
        }
    }

    fn fitted(file: &str, wavelength_um: Option<f64>, family: Family) -> Fitted {
        let at = ModelParameters {
            k2: 0.1 + 0.2,
            kd: 1.0 / 3.0,
            k1: 0.1,
            n: 1.5,
            p: if family == Family::Power { 1.7 } else { 1.0 },
        };
        Fitted {
            file: file.to_owned(),
            wavelength_um,
            brdf: AnyBrdf::new(family, &at).unwrap(),
            e_percent: 1.25,
            psi_max_deg: 70.0,
        }
    }

    fn coating() -> Material {
        let fits = vec![
            fitted("a/x.csv", Some(0.5), Family::Paper),
            fitted("a/x.csv", Some(0.503), Family::Ggx),
            fitted("a/x.csv", Some(0.9), Family::Power),
            fitted("b/y.csv", None, Family::Beckmann),
        ];
        Material { fits }
    }

    fn written(coating: &Material) -> Vec<u8> {
        let mut bytes = Vec::new();
        coating.write(&mut bytes).unwrap();
        bytes
    }

    /// The JSON of a coating with something changed.
    fn changed(change: impl Fn(&mut Value)) -> Vec<u8> {
        let mut value = serde_json::from_slice(&written(&coating())).unwrap();
        change(&mut value);
        serde_json::to_vec(&value).unwrap()
    }

    fn report(file: &str, wavelength_um: f64, n: f64) -> Report {
        let mut readings = scan(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5)
            .readings()
            .to_vec();
        for reading in &mut readings {
            reading.wavelength_um = Some(wavelength_um);
        }
        let options = FitOptions {
            refractive_index: Some(RefractiveIndex::Same(n)),
            ..FitOptions::default()
        };
        let scan = Measurements::new(file, readings).unwrap();
        Report::new(&scan, &options, Depth::Fit).0
    }

    #[test]
    fn what_is_written_is_read_again() {
        let read = Folder::new().read(&written(&coating())).unwrap();
        assert_eq!(read, coating());
    }

    #[test]
    fn the_fits_of_a_document_are_in_order_of_file_and_wavelength() {
        // An index outside the domain: a report without a fit.
        let reports = vec![
            report("y.csv", 0.9, 1.5),
            report("y.csv", 0.5, 1.5),
            report("x.csv", 0.7, 1.5),
            report("x.csv", 0.6, 0.0),
        ];
        assert!(reports[3].fit.is_none());
        let document = Document::new(reports);
        let bytes = serde_json::to_vec(&document).unwrap();
        let coating = Folder::new().read(&bytes).unwrap();
        let of = |fit: &Fitted| (fit.file.clone(), fit.wavelength_um);
        let found: Vec<_> = coating.fits.iter().map(of).collect();
        let expected = [("x.csv", 0.7), ("y.csv", 0.5), ("y.csv", 0.9)];
        assert_eq!(
            found,
            expected.map(|(file, um)| (file.to_owned(), Some(um)))
        );
        for fit in &coating.fits {
            let at = fit.brdf.model_parameters();
            assert_eq!((fit.brdf.family(), at.n, at.p), (Family::Paper, 1.5, 1.0));
            assert!((at.k1 - 0.2).abs() < 1e-9 && fit.e_percent < 1e-6);
            assert_eq!(fit.psi_max_deg.round(), 70.0);
        }
    }

    #[test]
    fn parameters_outside_the_domain_are_named_with_file_and_scan() {
        let document = Document::new(vec![report("x.csv", 0.5, 1.5)]);
        let refused = |key: &str, wrong: &Value| {
            let mut value = serde_json::to_value(&document).unwrap();
            let fit = &mut value["reports"][0]["fit"];
            *fit.pointer_mut(key).unwrap() = wrong.clone();
            Folder::new().refused(&serde_json::to_vec(&value).unwrap())
        };
        let said = refused("/parameters/k1", &json!(-1.0));
        assert!(said.contains("k1 = -1: expected a number in"), "{said}");
        let said = refused("/n", &json!(0.5));
        assert!(
            said.starts_with(", the fit of x.csv: refractive index"),
            "{said}"
        );
    }

    #[test]
    fn a_model_of_a_later_version_is_said_to_be_one() {
        let later = changed(|value| {
            value["format_version"] = json!(2);
            value["fits"][0]["brdf"] = json!({ "family": "of tomorrow" });
        });
        assert_eq!(
            Folder::new().refused(&later),
            ": format_version 2 of a model: expected 1 (was it written by a later version?)"
        );
    }

    #[test]
    fn a_damaged_model_is_named_with_its_place() {
        let folder = Folder::new();
        let said = folder.refused(&changed(|value| value["fits"] = json!([])));
        assert_eq!(said, ": holds no fit: expected a model of at least one");
        for (change, message) in [
            (("k1", json!(-1.0)), "k1"),
            (("family", json!("phong")), "unknown variant `phong`"),
            (("k2", json!("much")), "invalid type: string \"much\""),
        ] {
            let (key, new) = change;
            let bytes = changed(|value| value["fits"][1]["brdf"][key] = new.clone());
            let said = folder.refused(&bytes);
            assert!(said.starts_with(", line 1, column "), "{said}");
            assert!(said.contains(message), "{said}");
            assert!(
                said.ends_with("expected the model that export --to json writes"),
                "{said}"
            );
        }
        let fitless = changed(|value| value["fits"] = json!("none"));
        assert!(
            folder
                .refused(&fitless)
                .contains("invalid type: string \"none\"")
        );
    }

    #[test]
    fn what_is_neither_model_nor_document_is_told_as_a_document() {
        let (folder, whole) = (Folder::new(), written(&coating()));
        for content in [
            b"".as_slice(),
            b"psi_deg,theta_deg",
            &whole[..whole.len() / 2],
        ] {
            let said = folder.refused(content);
            assert!(
                said.ends_with("expected JSON with a document of fits"),
                "{said}"
            );
        }
        let said = folder.refused(b"{\"format_version\": 1}");
        assert!(said.contains("missing field `reports`"), "{said}");
        let missing = Material::read(folder.0.path().join("none")).unwrap_err();
        assert!(
            missing.to_string().contains("none: cannot be read"),
            "{missing}"
        );
    }

    #[test]
    fn the_fits_of_a_file_are_found_by_its_path_or_its_name() {
        for name in ["a/x.csv", "x.csv"] {
            let found = coating().of_file(Some(name)).unwrap();
            assert_eq!(found.fits, coating().fits[..3]);
        }
        let error = coating().of_file(Some("z.csv")).unwrap_err().to_string();
        assert_eq!(error, "no fit of z.csv: expected one of a/x.csv, b/y.csv");
        let error = coating().of_file(None).unwrap_err().to_string();
        let expected =
            "there are several fits: expected one of a/x.csv, b/y.csv to be chosen with --file";
        assert_eq!(error, expected);
        let mut two = coating();
        two.fits.push(fitted("b/x.csv", Some(0.5), Family::Paper));
        let error = two.of_file(Some("x.csv")).unwrap_err().to_string();
        let expected =
            "there are several fits: expected one of a/x.csv, b/x.csv to be chosen with --file";
        assert_eq!(error, expected);
        let alone = coating().of_file(Some("y.csv")).unwrap();
        assert_eq!(alone.clone().of_file(None).unwrap(), alone);
    }

    #[test]
    fn the_nearest_wavelength_within_one_percent_is_taken() {
        for (wanted, expected) in [(0.5, 0.5), (0.502, 0.503), (0.899, 0.9), (0.498, 0.5)] {
            let found = coating().of_wavelength(wanted).unwrap();
            assert_eq!(found.only().unwrap().wavelength_um, Some(expected));
        }
        for wanted in [0.494, 0.91, f64::NAN] {
            let error = coating().of_wavelength(wanted).unwrap_err().to_string();
            let expected = format!(
                "no fit of {wanted} um: expected one of 0.5 um, 0.503 um, 0.9 um, one without a \
                 wavelength"
            );
            assert_eq!(error, expected);
        }
    }

    #[test]
    fn of_several_fits_none_is_the_only_one() {
        let error = coating().only().unwrap_err().to_string();
        assert_eq!(
            error,
            "there are several fits: expected one of 0.5 um, 0.503 um, 0.9 um, one without a wavelength to \
             be chosen with --wavelength"
        );
    }
}
