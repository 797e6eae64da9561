//! The results of several fits in one table, a row for each.

use super::run::Report;
use super::table::{Column, Row, Table};
use crate::format::two_digits;
use crate::inference::Quality;
use crate::model::Parameter;

/// A table with a row for each report: its wavelength, its parameters with their intervals of 95 %,
/// and its error. Where the reports are of several files, their names come first.
pub fn summary(reports: &[Report]) -> Table {
    let several_files = reports.iter().any(|report| report.file != reports[0].file);
    let free = |parameter: &Parameter| {
        let mut fits = reports.iter().filter_map(|report| report.fit.as_ref());
        fits.any(|fit| fit.fits(*parameter))
    };
    let parameters: Vec<Parameter> = Parameter::ALL.into_iter().filter(free).collect();
    let mut columns = Vec::new();
    if several_files {
        columns.push(Column::left("file", 10));
    }
    columns.push(Column::right("um", 7));
    columns.extend(
        parameters
            .iter()
            .map(|parameter| Column::right(format!("{parameter} (95 %)"), 24)),
    );
    columns.extend([Column::right("rms %", 6), Column::left("quality", 0)]);
    Table {
        caption: "All fits".to_owned(),
        columns,
        rows: reports
            .iter()
            .map(|report| row(report, &parameters, several_files))
            .collect(),
        notes: Vec::new(),
    }
}

fn row(report: &Report, parameters: &[Parameter], several_files: bool) -> Row {
    let mut cells = Vec::new();
    if several_files {
        cells.push(report.file.clone());
    }
    cells.push(
        report
            .wavelength_um
            .map_or_else(|| "-".to_owned(), |um| um.to_string()),
    );
    let Some(fit) = &report.fit else {
        return Row::with_remark(cells, report.status());
    };
    let uncertainty = report.uncertainty.as_ref();
    cells.extend(parameters.iter().map(|&parameter| {
        let estimate = uncertainty.and_then(|uncertainty| uncertainty.estimate(parameter));
        estimate.map_or_else(|| "-".to_owned(), ToString::to_string)
    }));
    let rms = fit.rms_percent();
    cells.extend([two_digits(rms), Quality::of_rms(rms).word().to_owned()]);
    Row::new(cells)
}
