//! What is exported: the fits of one surface as BRDFs.

use std::borrow::Cow;
use std::cmp::Ordering;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

use brdf_core::{AnyBrdf, ParameterError};
use serde::{Deserialize, Serialize};

use crate::refractive_index::WAVELENGTH_TOLERANCE;
use crate::report::{Document, DocumentError, Report};

/// The version of the JSON of a [`Coating`].
const FORMAT_VERSION: u32 = 1;

/// The fits of one surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Coating {
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
pub enum CoatingError {
    /// The file is no document of fits.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// Parameters that no program of ours writes.
    #[error("{file}: {error}")]
    Parameter {
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

impl Coating {
    /// Reads the fits of a file: the document of a run, or what [`write`](Self::write) wrote.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, CoatingError> {
        let path = path.as_ref();
        let written = fs::read(path).ok();
        let written = written.and_then(|bytes| serde_json::from_slice::<Versioned>(&bytes).ok());
        match written {
            Some(Versioned {
                format_version: FORMAT_VERSION,
                fits,
            }) if !fits.is_empty() => Ok(Self {
                fits: fits.into_owned(),
            }),
            // Where it is neither, the words of the error are those about a document.
            _ => Self::of_document(&Document::read(path)?),
        }
    }

    /// The fits of a document.
    pub fn of_document(document: &Document) -> Result<Self, CoatingError> {
        let fits = document.reports.iter().filter_map(Fitted::of_report);
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
    pub fn of_file(self, name: Option<&str>) -> Result<Self, CoatingError> {
        let files = distinct(self.fits.iter().map(|fit| fit.file.clone()));
        let Some(name) = name else {
            return match files.len() {
                1 => Ok(self),
                _ => Err(CoatingError::Several {
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
        if fits.is_empty() {
            let wanted = name.to_owned();
            return Err(CoatingError::NoSuch {
                wanted,
                found: files,
            });
        }
        Ok(Self { fits })
    }

    /// The fit nearest to a wavelength in micrometres.
    ///
    /// Errors: none is within 1 %.
    pub fn of_wavelength(self, wavelength_um: f64) -> Result<Self, CoatingError> {
        let fit = self.at_wavelength(wavelength_um)?.clone();
        Ok(Self { fits: vec![fit] })
    }

    pub(super) fn at_wavelength(&self, wavelength_um: f64) -> Result<&Fitted, CoatingError> {
        self.within(wavelength_um, WAVELENGTH_TOLERANCE * wavelength_um)
            .ok_or_else(|| CoatingError::NoSuch {
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
    pub fn only(&self) -> Result<&Fitted, CoatingError> {
        match self.fits.as_slice() {
            [fit] => Ok(fit),
            _ => Err(CoatingError::Several {
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
    fn of_report(report: &Report) -> Option<Result<Self, CoatingError>> {
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
        Some(fitted.map_err(|error| CoatingError::Parameter {
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
