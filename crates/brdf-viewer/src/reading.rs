//! Opening files: scans, and fits as JSON with the scans that they are of.

use std::path::{Path, PathBuf};

use brdf_fit::Measurements;
use brdf_fit::read::{LazyScan, ReadError, ReadOptions};
use brdf_fit::report::{Document, Report};
use brdf_fit::scan::{Convention, Side};

use crate::job::Opened;
use crate::state::built_in;
use crate::state::sample::Scan;

/// What is in a file: a scan, or a sample for each of the scans that a document of fits is of.
///
/// Errors: what is wrong with it, in words.
pub fn read(path: &Path, convention: Convention) -> Result<Vec<Opened>, String> {
    // A pipe would be waited for without end, with everything that is opened after it.
    if path.exists() && !path.is_file() {
        return Err(format!(
            "{}: is no regular file: expected a scan, or a fit as JSON",
            path.display()
        ));
    }
    if is_fit(path) {
        return read_fit(path);
    }
    Ok(vec![Opened {
        source: path.display().to_string(),
        file: Some(path.to_owned()),
        scans: read_scan(path, &chosen(convention))?,
    }])
}

/// What is in a file that is already here.
///
/// Errors: what is wrong with it, in words.
pub fn read_bytes(name: &str, bytes: &[u8], convention: Convention) -> Result<Opened, String> {
    Ok(Opened {
        source: name.to_owned(),
        file: None,
        scans: read_content(name, bytes, &chosen(convention))?,
    })
}

fn is_fit(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("json"))
}

/// What the menu says of the sides: that they are the model's leaves them to the format of the file.
fn chosen(convention: Convention) -> ReadOptions {
    let other = |side: Side| (side != Side::default()).then_some(side);
    ReadOptions {
        theta_positive: other(convention.theta_positive),
        phi_zero: other(convention.phi_zero),
        ..ReadOptions::default()
    }
}

/// How the scan of a fit was read.
fn as_before(report: &Report) -> ReadOptions {
    ReadOptions {
        format: Some(report.format),
        theta_positive: Some(report.convention.theta_positive),
        phi_zero: Some(report.convention.phi_zero),
        ..ReadOptions::default()
    }
}

/// The scans of a file; of a table, which has no incidences, as a goniometer would have taken them.
fn read_scan(path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, String> {
    let words = |error: ReadError| error.to_string();
    let scans = LazyScan::open(path, options).map_err(words)?;
    let plotted = scans.iter().map(LazyScan::plotted);
    plotted
        .map(|scan| Ok(Scan::new(scan.map_err(words)?.into_owned())))
        .collect()
}

fn read_content(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Vec<Scan>, String> {
    Measurements::from_bytes(name, bytes, options)
        .map(scans)
        .map_err(|error| error.to_string())
}

fn scans(measurements: Measurements) -> Vec<Scan> {
    let all = measurements.by_wavelength().into_iter();
    all.map(Scan::new).collect()
}

/// The scans that a document of fits is of, with these fits.
fn read_fit(path: &Path) -> Result<Vec<Opened>, String> {
    let document = Document::read(path).map_err(|error| error.to_string())?;
    let mut files: Vec<(&str, ReadOptions)> = Vec::new();
    for report in &document.reports {
        let file = (report.file.as_str(), as_before(report));
        if !files.contains(&file) {
            files.push(file);
        }
    }
    let of_file = |(file, options): (&str, ReadOptions)| {
        let (place, mut scans) = read_scan_of(path, file, &options)?;
        for scan in &mut scans {
            take_fit(scan, &document, file);
        }
        Ok(Opened {
            source: path.display().to_string(),
            file: place,
            scans,
        })
    };
    files.into_iter().map(of_file).collect()
}

/// The fit of a scan of a file, where the document has it.
fn take_fit(scan: &mut Scan, document: &Document, file: &str) {
    let wavelength = scan.wavelength_um();
    let mut reports = document.reports.iter();
    let found = reports.find(|report| report.file == file && report.wavelength_um == wavelength);
    if let Some(report) = found {
        scan.take(report.clone());
        scan.settled = scan.knobs;
    }
}

/// The scan that a fit names, and its file: as it is named, beside the fit, or among the built-in
/// ones.
fn read_scan_of(
    fit: &Path,
    file: &str,
    options: &ReadOptions,
) -> Result<(Option<PathBuf>, Vec<Scan>), String> {
    let beside = fit.parent().map(|folder| folder.join(file));
    let same_folder = fit
        .parent()
        .and_then(|folder| Some(folder.join(Path::new(file).file_name()?)));
    for path in [Some(PathBuf::from(file)), beside, same_folder]
        .into_iter()
        .flatten()
    {
        if path.is_file() {
            let scans = read_scan(&path, options)?;
            return Ok((Some(path), scans));
        }
    }
    match built_in::text_of(file) {
        Some(text) => Ok((None, read_content(file, text.as_bytes(), options)?)),
        None => Err(format!(
            "{}: is a fit of {file}, which cannot be found: expected the scan where the fit names \
             it, or beside the fit",
            fit.display()
        )),
    }
}
