//! Reading a material from a JSON file, and writing it.

use std::borrow::Cow;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

use brdf_core::AnyBrdf;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use super::error::{FORMAT_VERSION, MaterialError};
use super::fitted::{Fitted, Material};
use crate::report::{Document, DocumentError, Report};

/// The JSON of a material, with the version of the format.
#[derive(Serialize, Deserialize)]
struct Versioned<'a> {
    format_version: u32,
    fits: Cow<'a, [Fitted]>,
}

/// The keys that every version of the format has, and a document of fits has not.
#[derive(Deserialize)]
struct Kind {
    format_version: u32,
    #[serde(rename = "fits")]
    _fits: IgnoredAny,
}

impl Material {
    /// Reads the fits of a file: a [`Document`] of reports, or JSON that [`write`](Self::write)
    /// wrote.
    ///
    /// The fits of a document are in order of file and wavelength.
    ///
    /// # Errors
    ///
    /// [`MaterialError`] where the file cannot be read, is damaged, contains no fit, has an unknown
    /// format version or has parameters outside the domain of the model.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, MaterialError> {
        let path = path.as_ref();
        let bytes = fs::read(path).map_err(|error| DocumentError::Io {
            path: path.to_owned(),
            error,
        })?;
        Self::from_bytes(path, &bytes)
    }

    /// Reads the fits from the content of a file; `path` stands for the file in errors.
    ///
    /// # Errors
    ///
    /// Those of [`read`](Self::read).
    pub fn from_bytes(path: impl AsRef<Path>, bytes: &[u8]) -> Result<Self, MaterialError> {
        let path = path.as_ref();
        match serde_json::from_slice(bytes) {
            Ok(Kind { format_version, .. }) => from_model(path, format_version, bytes),
            // A file that is neither is reported as a damaged document.
            Err(_) => from_document(path, &Document::from_bytes(path, bytes)?),
        }
    }

    /// Writes the fits as JSON with a format version.
    ///
    /// # Errors
    ///
    /// Writing fails.
    pub fn write(&self, writer: &mut dyn Write) -> io::Result<()> {
        let versioned = Versioned {
            format_version: FORMAT_VERSION,
            fits: Cow::Borrowed(&self.fits),
        };
        serde_json::to_writer_pretty(&mut *writer, &versioned)?;
        writer.write_all(b"\n")
    }
}

fn from_model(path: &Path, found: u32, bytes: &[u8]) -> Result<Material, MaterialError> {
    let path = path.to_owned();
    if found != FORMAT_VERSION {
        return Err(MaterialError::Version { path, found });
    }
    match serde_json::from_slice::<Versioned>(bytes) {
        Ok(model) if model.fits.is_empty() => Err(MaterialError::NoFits { path }),
        Ok(model) => Ok(Material {
            fits: model.fits.into_owned(),
        }),
        Err(error) => Err(MaterialError::Model { path, error }),
    }
}

fn from_document(path: &Path, document: &Document) -> Result<Material, MaterialError> {
    let fit = |report| from_report(path, report);
    let fits = document.reports.iter().filter_map(fit);
    let mut fits = fits.collect::<Result<Vec<_>, _>>()?;
    let wavelength = |fit: &Fitted| fit.wavelength_um.unwrap_or(0.0);
    fits.sort_by(|a, b| {
        let by_file = a.file.cmp(&b.file);
        by_file.then(wavelength(a).total_cmp(&wavelength(b)))
    });
    Ok(Material { fits })
}

/// The fit of a report; `None` where the report has none.
fn from_report(path: &Path, report: &Report) -> Option<Result<Fitted, MaterialError>> {
    let fit = report.fit.as_ref()?;
    let brdf = AnyBrdf::new(fit.model().family(), &fit.at());
    let incidences = fit.incidences.iter();
    let fitted = brdf.map(|brdf| Fitted {
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

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use brdf_core::{Family, Parameters};
    use serde_json::{Value, json};
    use tempfile::TempDir;

    use super::*;
    use crate::export::test_fits::material;
    use crate::fit::FitOptions;
    use crate::report::Depth;
    use crate::scan::synthetic::scan;
    use crate::scan::{Measurements, RefractiveIndex};

    /// A folder with one file.
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

        /// The message of the error of a file, after its path.
        fn refused(&self, content: &[u8]) -> String {
            let message = self.read(content).unwrap_err().to_string();
            let path = self.file().display().to_string();
            message.strip_prefix(&path).unwrap().to_owned()
        }
    }

    fn written(material: &Material) -> Vec<u8> {
        let mut bytes = Vec::new();
        material.write(&mut bytes).unwrap();
        bytes
    }

    /// The JSON of a material with a change.
    fn changed(change: impl Fn(&mut Value)) -> Vec<u8> {
        let mut value = serde_json::from_slice(&written(&material())).unwrap();
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
        let read = Folder::new().read(&written(&material())).unwrap();
        assert_eq!(read, material());
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
        let material = Folder::new().read(&bytes).unwrap();
        let of = |fit: &Fitted| (fit.file.clone(), fit.wavelength_um);
        let found: Vec<_> = material.fits.iter().map(of).collect();
        let expected = [("x.csv", 0.7), ("y.csv", 0.5), ("y.csv", 0.9)];
        assert_eq!(
            found,
            expected.map(|(file, um)| (file.to_owned(), Some(um)))
        );
        for fit in &material.fits {
            let at = fit.brdf.model_parameters();
            assert_eq!((fit.brdf.family(), at.n, at.p), (Family::Paper, 1.5, 1.0));
            assert!((at.k1 - 0.2).abs() < 1e-9 && fit.e_percent < 1e-6);
            assert_eq!(fit.psi_max_deg.round(), 70.0);
        }
    }

    #[test]
    fn parameters_outside_the_domain_are_reported_with_file_and_scan() {
        let document = Document::new(vec![report("x.csv", 0.5, 1.5)]);
        let refused = |key: &str, wrong: &Value| {
            let mut value = serde_json::to_value(&document).unwrap();
            let fit = &mut value["reports"][0]["fit"];
            *fit.pointer_mut(key).unwrap() = wrong.clone();
            Folder::new().refused(&serde_json::to_vec(&value).unwrap())
        };
        let message = refused("/parameters/k1", &json!(-1.0));
        assert!(
            message.contains("k1 = -1: expected a number in"),
            "{message}"
        );
        let message = refused("/n", &json!(0.5));
        assert!(
            message.starts_with(", the fit of x.csv: refractive index"),
            "{message}"
        );
    }

    #[test]
    fn a_model_of_a_later_version_is_reported_as_such() {
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
    fn a_damaged_model_is_reported_with_line_and_column() {
        let folder = Folder::new();
        let message = folder.refused(&changed(|value| value["fits"] = json!([])));
        assert_eq!(
            message,
            ": contains no fit: expected a model of at least one"
        );
        for (change, expected) in [
            (("k1", json!(-1.0)), "k1"),
            (("family", json!("phong")), "unknown variant `phong`"),
            (("k2", json!("much")), "invalid type: string \"much\""),
        ] {
            let (key, new) = change;
            let bytes = changed(|value| value["fits"][1]["brdf"][key] = new.clone());
            let message = folder.refused(&bytes);
            assert!(message.starts_with(", line 1, column "), "{message}");
            assert!(message.contains(expected), "{message}");
            assert!(
                message.ends_with(": expected an exported model"),
                "{message}"
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
    fn what_is_neither_a_model_nor_a_document_is_reported_as_a_document() {
        let (folder, whole) = (Folder::new(), written(&material()));
        for content in [
            b"".as_slice(),
            b"psi_deg,theta_deg",
            &whole[..whole.len() / 2],
            b"{\"format_version\": 1}",
        ] {
            let message = folder.read(content).unwrap_err().to_string();
            let of_document = Document::read(folder.file()).unwrap_err();
            assert!(
                matches!(of_document, DocumentError::Json { .. }),
                "{of_document}"
            );
            assert_eq!(message, of_document.to_string());
        }
        let message = folder.refused(b"{\"format_version\": 1}");
        assert!(message.contains("missing field `reports`"), "{message}");
        let missing = Material::read(folder.0.path().join("none")).unwrap_err();
        assert!(
            missing.to_string().contains("none: cannot be read"),
            "{missing}"
        );
    }
}
