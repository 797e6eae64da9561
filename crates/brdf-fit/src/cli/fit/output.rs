//! Writes and prints the results of `brdf fit`.

use std::io;
use std::path::PathBuf;

use super::arguments::Arguments;
use crate::cli::explain;
use crate::cli::failure::Failure;
use crate::cli::stream;
use crate::output;
use crate::plot::write_folder;
use crate::read::LazyScan;
use crate::report::{Document, Report, summary, write_curves, write_models, write_parameters};

/// Writes the files and prints. A failure of one output does not prevent the others: all failures
/// are returned.
pub(super) fn deliver(
    arguments: &Arguments,
    scans: &[&LazyScan],
    reports: Vec<Report>,
) -> Vec<Failure> {
    let scans = scans.iter().copied();
    let mut failures = Vec::new();
    // A run in which no fit succeeded replaces no earlier result.
    let any_fit = reports.iter().any(|report| report.fit.is_some());
    let replaces = |path: &&PathBuf| any_fit || stream::is_stream(path) || !path.exists();
    let kept = |path: &&PathBuf| !replaces(path);
    let outputs = [&arguments.plot, &arguments.curves, &arguments.json];
    for path in outputs.into_iter().flatten().filter(kept) {
        let name = path.display();
        output::print_error(&format!(
            "{name}: no fit succeeded, the earlier result is kept"
        ));
    }
    if let Some(folder) = arguments.plot.as_ref().filter(replaces) {
        let reports: Vec<(&LazyScan, &Report)> = scans.clone().zip(&reports).collect();
        let written = write_folder(&reports, folder);
        failures.extend(written.err().map(Failure::from));
    }
    if let Some(path) = arguments.curves.as_ref().filter(replaces) {
        let fits = scans.zip(&reports);
        let fits = fits.filter_map(|(scan, report)| Some((scan, report.fit.as_ref()?)));
        let written = stream::write(path, |writer| write_curves(fits, writer));
        failures.extend(written.err().map(Failure::from));
    }
    let document = Document::new(reports);
    if let Some(path) = arguments.json.as_ref().filter(replaces) {
        let written = stream::write_json(path, &document);
        failures.extend(written.err().map(Failure::from));
    }
    if arguments.on_standard_output().is_none() {
        let printed = print(arguments, &document.reports);
        failures.extend(printed.err().map(Failure::Print));
    }
    failures
}

/// Prints the tables, or the parameters as CSV.
fn print(arguments: &Arguments, reports: &[Report]) -> io::Result<()> {
    let mut buffer = Vec::new();
    if !arguments.params_only {
        let texts: Vec<String> = reports
            .iter()
            .map(|report| report.explained_text(arguments.verbose, &explain::warning))
            .collect();
        buffer.extend(texts.join("\n").bytes());
        if reports.len() > 1 {
            buffer.extend(format!("\n{}", summary(reports).text()).bytes());
        }
    } else if arguments.compare || arguments.model.is_some() {
        write_models(reports, &mut buffer)?;
    } else {
        write_parameters(reports, &mut buffer)?;
    }
    output::print_text(&String::from_utf8_lossy(&buffer))
}
