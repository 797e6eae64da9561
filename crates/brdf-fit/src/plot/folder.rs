//! A folder with the figures of all fits and a page that contains them.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use brdf_core::{AnyBrdf, Geometry};
use rayon::prelude::*;

use super::error::PlotError;
use super::figure::Figure;
use super::figures::{FIGURES, figures};
use super::write::{ENDINGS, create_folder, stem, write_figures};
use crate::output::{WriteError, write_file};
use crate::read::{LazyScan, ReadError};
use crate::report::{Picture, Report, html};
use crate::scan::Measurements;

/// File name of the page.
pub const PAGE: &str = "report.html";

/// Why [`write_folder`] failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// The readings of a table could not be read again.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A figure could not be drawn or written.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// The page could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl<'a> From<&'a Figure> for Picture<'a> {
    fn from(figure: &'a Figure) -> Self {
        Self {
            svg: &figure.svg,
            caption: &figure.caption,
        }
    }
}

/// Writes the figures of each fit, as SVG and PNG named after its file and wavelength, and a page
/// `report.html` with all figures and tables. Returns the written files.
///
/// # Errors
///
/// The readings of a table cannot be read again, a figure cannot be drawn, or a file cannot be
/// written. Files written before the error remain.
pub fn write_folder(
    reports: &[(&LazyScan, &Report)],
    folder: &Path,
) -> Result<Vec<PathBuf>, FolderError> {
    // Other outputs of a command may be in this folder, whatever becomes of the figures.
    create_folder(folder)?;
    let prefixes = prefixes(
        reports
            .iter()
            .map(|(_, report)| (report.file.as_str(), report.wavelength_um)),
    );
    let drawn: Vec<(Vec<Figure>, Vec<PathBuf>)> = reports
        .par_iter()
        .zip(&prefixes)
        .map(|((scan, report), prefix)| {
            let figures = report_figures(&*scan.plotted()?, report)?;
            let files = write_figures(&figures, folder, prefix)?;
            Ok((figures, files))
        })
        .collect::<Result<_, FolderError>>()?;
    let pictures: Vec<Vec<Picture<'_>>> = drawn
        .iter()
        .map(|(figures, _)| figures.iter().map(Picture::from).collect())
        .collect();
    let pages: Vec<(&Report, &[Picture<'_>])> = reports
        .iter()
        .zip(&pictures)
        .map(|((_, report), pictures)| (*report, pictures.as_slice()))
        .collect();
    let page = folder.join(PAGE);
    write_file(&page, |writer| writer.write_all(html(&pages).as_bytes()))?;
    let mut files: Vec<PathBuf> = drawn.into_iter().flat_map(|(_, files)| files).collect();
    files.push(page);
    Ok(files)
}

/// The figures of a fit; empty if the fit failed.
///
/// # Errors
///
/// A figure cannot be drawn.
pub fn report_figures(
    measurements: &Measurements,
    report: &Report,
) -> Result<Vec<Figure>, PlotError> {
    let Some(fit) = &report.fit else {
        return Ok(Vec::new());
    };
    let brdf = AnyBrdf::new(fit.model().family(), &fit.at()).ok();
    match (&report.uncertainty, brdf) {
        (Some(uncertainty), Some(brdf)) if !uncertainty.covariance.is_empty() => {
            let band = |geometry: &Geometry| uncertainty.band(&brdf, geometry);
            figures(measurements, fit, Some(&band))
        }
        _ => figures(measurements, fit, None),
    }
}

/// The names of all files, except [`PAGE`], that [`write_folder`] may write for these scans.
pub fn figure_files<'a>(scans: impl IntoIterator<Item = &'a LazyScan>) -> Vec<String> {
    let scans: Vec<_> = scans
        .into_iter()
        .map(|scan| (scan.source(), scan.wavelength_um()))
        .collect();
    let scans = scans
        .iter()
        .map(|(file, wavelength)| (&**file, *wavelength));
    let stems = prefixes(scans)
        .into_iter()
        .flat_map(|prefix| FIGURES.map(|name| stem(&prefix, name)));
    stems
        .flat_map(|stem| ENDINGS.map(|ending| format!("{stem}.{ending}")))
        .collect()
}

/// The first part of the file names of each fit, from its file and wavelength.
fn prefixes<'a>(fits: impl Iterator<Item = (&'a str, Option<f64>)>) -> Vec<String> {
    let mut taken = HashSet::new();
    fits.map(|(file, wavelength_um)| unique(&prefix(file, wavelength_um), &mut taken))
        .collect()
}

fn prefix(file: &str, wavelength_um: Option<f64>) -> String {
    let stem = Path::new(file).file_stem();
    let stem = stem.map_or_else(
        || "scan".to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    );
    match wavelength_um {
        Some(wavelength) => format!("{stem}-{wavelength}um"),
        None => stem,
    }
}

/// The name, with a number appended if it is taken.
fn unique(name: &str, taken: &mut HashSet<String>) -> String {
    let mut candidate = name.to_owned();
    let mut number = 2;
    while !taken.insert(candidate.clone()) {
        candidate = format!("{name}-{number}");
        number += 1;
    }
    candidate
}
