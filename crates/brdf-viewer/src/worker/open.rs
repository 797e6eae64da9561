//! Opens files: scans, and fits as JSON together with their scans.

use std::path::{Path, PathBuf};

use brdf_fit::read::{LazyScan, ReadError, ReadOptions};
use brdf_fit::report::{Document, DocumentError, Report};
use brdf_fit::{Convention, Format, Measurements, Side};

use crate::platform::Files;
use crate::platform::current::CurrentFiles;
use crate::state::built_in;
use crate::state::sample::{Opened, Scan};

/// Why a file cannot be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(super) enum OpenError {
    /// The path leads to a folder, a pipe or a device.
    #[error("{}: is not a regular file: expected a scan, or a fit as JSON", .0.display())]
    NotRegular(PathBuf),
    /// The scan cannot be read.
    #[error(transparent)]
    Scan(#[from] ReadError),
    /// The fit cannot be read.
    #[error(transparent)]
    Fit(#[from] DocumentError),
    /// The scan of a fit is missing.
    #[error(
        "{}: is a fit of {scan}, which cannot be found: expected the scan {}",
        fit.display(), CurrentFiles::PLACE_OF_SCANS
    )]
    ScanNotFound {
        /// The path of the fit.
        fit: PathBuf,
        /// The scan as the fit names it.
        scan: String,
    },
    /// The scans that a fit joined are no longer of one sample.
    #[error(
        "{}: is a fit of {scans}, which state different refractive indices now: expected one sample",
        fit.display()
    )]
    NotOneSample {
        /// The path of the fit.
        fit: PathBuf,
        /// The scans as the fit names them.
        scans: String,
    },
}

/// Opens a scan, or the scans of a document of fits together with these.
///
/// # Errors
///
/// The file cannot be read, or a fit names a scan that cannot be found.
pub(super) fn open(path: &Path, convention: Convention) -> Result<Vec<Opened>, OpenError> {
    // Reading a pipe could block this thread, and all following jobs, forever.
    if CurrentFiles::is_special(path) {
        return Err(OpenError::NotRegular(path.to_owned()));
    }
    if is_fit(path) {
        return open_fit(path);
    }
    Ok(vec![Opened {
        source: path.display().to_string(),
        file: Some(path.to_owned()),
        scans: read_scan(path, &read_options(convention))?,
    }])
}

/// Opens a scan from the content of a file.
///
/// # Errors
///
/// The content cannot be read.
pub(super) fn open_bytes(
    name: &str,
    bytes: &[u8],
    convention: Convention,
) -> Result<Opened, OpenError> {
    Ok(Opened {
        source: name.to_owned(),
        file: None,
        scans: read_content(name, bytes, &read_options(convention))?,
    })
}

/// The extensions of all scan formats, of plain text, and of fits.
pub fn extensions() -> Vec<&'static str> {
    let formats = Format::NAMED.into_iter();
    let of_formats = formats.flat_map(|(format, _)| format.extensions().iter().copied());
    of_formats.chain(["txt", "dat", "json"]).collect()
}

fn is_fit(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("json"))
}

/// The options for a convention selected in the menu. The default sides leave the choice to the
/// file format.
fn read_options(convention: Convention) -> ReadOptions {
    let unless_default = |side: Side| (side != Side::default()).then_some(side);
    ReadOptions {
        theta_positive: unless_default(convention.theta_positive),
        phi_zero: unless_default(convention.phi_zero),
        ..ReadOptions::default()
    }
}

/// The options with which the scan of a fit was read.
fn options_of(report: &Report) -> ReadOptions {
    ReadOptions {
        format: Some(report.format),
        theta_positive: Some(report.convention.theta_positive),
        phi_zero: Some(report.convention.phi_zero),
        columns: report.read_settings.columns.clone(),
        declarations: report.read_settings.declarations.clone(),
        ..ReadOptions::default()
    }
}

/// The scans of a file. A table is sampled at the directions of a goniometer, because it has no
/// incidences of its own.
fn read_scan(path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, OpenError> {
    let scans = CurrentFiles::scans(path, options)?.into_iter();
    let scan = |lazy: LazyScan| {
        let mut scan = Scan::new(lazy.plotted()?.into_owned());
        scan.table = Some(lazy).filter(LazyScan::is_in_file);
        Ok(scan)
    };
    scans.map(scan).collect()
}

fn read_content(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Vec<Scan>, OpenError> {
    let measurements = Measurements::from_bytes(name, bytes, options)?;
    let scans = measurements.by_wavelength().into_iter();
    Ok(scans.map(Scan::new).collect())
}

/// Opens the scans of a document of fits, with their fits.
fn open_fit(path: &Path) -> Result<Vec<Opened>, OpenError> {
    let document = CurrentFiles::document(path)?;
    let mut files: Vec<(&str, &[String], ReadOptions)> = Vec::new();
    for report in &document.reports {
        let joined = report.read_settings.joined.as_slice();
        let file = (report.file.as_str(), joined, options_of(report));
        if !files.contains(&file) {
            files.push(file);
        }
    }
    let open_file = |(name, joined, options): (&str, &[String], ReadOptions)| {
        let (file, mut scans) = match joined {
            [] => read_scan_of_fit(path, name, &options)?,
            files => (None, read_joined_scans_of_fit(path, name, files, &options)?),
        };
        for scan in &mut scans {
            adopt_fit(scan, &document, name);
        }
        Ok(Opened {
            source: path.display().to_string(),
            file,
            scans,
        })
    };
    files.into_iter().map(open_file).collect()
}

/// Adopts the fit of a scan of a file, if the document contains one.
fn adopt_fit(scan: &mut Scan, document: &Document, file: &str) {
    let wavelength = scan.wavelength_um();
    let mut reports = document.reports.iter();
    let found = reports.find(|report| report.file == file && report.wavelength_um == wavelength);
    if let Some(report) = found {
        scan.leave_out(report.left_out.iter().copied().collect());
        scan.adopt_fit(report.clone());
        scan.committed = scan.parameters;
    }
}

/// The scans that a fit joined as one sample, one for each wavelength.
fn read_joined_scans_of_fit(
    fit: &Path,
    name: &str,
    files: &[String],
    options: &ReadOptions,
) -> Result<Vec<Scan>, OpenError> {
    let mut parts = Vec::new();
    for file in files {
        let (_, scans) = read_scan_of_fit(fit, file, options)?;
        parts.extend(scans.iter().map(|scan| scan.measurements.as_ref().clone()));
    }
    let joined = Measurements::joined(parts).ok_or_else(|| OpenError::NotOneSample {
        fit: fit.to_owned(),
        scans: name.to_owned(),
    })?;
    Ok(joined.by_wavelength().into_iter().map(Scan::new).collect())
}

/// The scan that a fit names, and its file: at the given path, relative to the folder of the fit, in
/// that folder, or built in.
fn read_scan_of_fit(
    fit: &Path,
    scan: &str,
    options: &ReadOptions,
) -> Result<(Option<PathBuf>, Vec<Scan>), OpenError> {
    let relative = fit.parent().map(|folder| folder.join(scan));
    let same_folder = fit
        .parent()
        .and_then(|folder| Some(folder.join(Path::new(scan).file_name()?)));
    for path in [Some(PathBuf::from(scan)), relative, same_folder]
        .into_iter()
        .flatten()
    {
        if CurrentFiles::is_file(&path) {
            let scans = read_scan(&path, options)?;
            return Ok((Some(path), scans));
        }
    }
    match built_in::text_of(scan) {
        Some(text) => Ok((None, read_content(scan, text.as_bytes(), options)?)),
        None => Err(OpenError::ScanNotFound {
            fit: fit.to_owned(),
            scan: scan.to_owned(),
        }),
    }
}
