//! A folder with the pictures of all fits and the page that holds them.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use brdf_core::{AnyBrdf, Geometry};
use rayon::prelude::*;

use super::{Report, html};
use crate::output::{WriteError, write_file};
use crate::plot::{Figure, PlotError, figures, write_figures};
use crate::read::{LazyScan, ReadError};
use crate::scan::Measurements;

/// The name of the page.
pub const PAGE: &str = "report.html";

/// Why the folder could not be written whole.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// The readings of a table could not be read once more.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A picture could not be drawn or written.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// The page could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Draws the pictures of each fit, as SVG and PNG named after its file and wavelength, and writes
/// `report.html` with all of them and the tables. Returns the files that were written.
pub fn write_folder(
    reports: &[(&LazyScan, &Report)],
    folder: &Path,
) -> Result<Vec<PathBuf>, FolderError> {
    let mut taken = HashSet::new();
    let prefixes: Vec<String> = reports
        .iter()
        .map(|(_, report)| unique(&prefix(report), &mut taken))
        .collect();
    let drawn: Vec<(Vec<Figure>, Vec<PathBuf>)> = reports
        .par_iter()
        .zip(&prefixes)
        .map(|((scan, report), prefix)| {
            let figures = figures_of(&*scan.plotted()?, report)?;
            let files = write_figures(&figures, folder, prefix)?;
            Ok((figures, files))
        })
        .collect::<Result<_, FolderError>>()?;
    let pages: Vec<(&Report, &[Figure])> = reports
        .iter()
        .zip(&drawn)
        .map(|((_, report), (figures, _))| (*report, figures.as_slice()))
        .collect();
    let page = folder.join(PAGE);
    write_file(&page, |writer| writer.write_all(html(&pages).as_bytes()))?;
    let mut files: Vec<PathBuf> = drawn.into_iter().flat_map(|(_, files)| files).collect();
    files.push(page);
    Ok(files)
}

/// The pictures of a fit; none where there is none.
pub fn figures_of(measurements: &Measurements, report: &Report) -> Result<Vec<Figure>, PlotError> {
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

/// File and wavelength, as a name of a file.
fn prefix(report: &Report) -> String {
    let stem = Path::new(&report.file).file_stem();
    let stem = stem.map_or_else(
        || "scan".to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    );
    match report.wavelength_um {
        Some(wavelength) => format!("{stem}-{wavelength}um"),
        None => stem,
    }
}

/// The name, or with a number where it is taken.
fn unique(name: &str, taken: &mut HashSet<String>) -> String {
    let mut candidate = name.to_owned();
    let mut number = 2;
    while !taken.insert(candidate.clone()) {
        candidate = format!("{name}-{number}");
        number += 1;
    }
    candidate
}
