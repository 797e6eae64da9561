//! The results of several fits in one table, a row for each.

use super::run::Report;
use super::table::{Column, Row, Table};
use crate::format::{digits, two_digits};
use crate::inference::Quality;
use crate::model::Parameter;

/// The most parameters whose intervals fit into the width of the text.
const MOST_INTERVALS: usize = 3;

/// A table with a row for each report: its wavelength, its parameters, with their intervals of 95 % if
/// they are three at most, and its error. Where the reports are of several files, the names of these
/// come last.
pub fn summary(reports: &[Report]) -> Table {
    let several_files = reports.iter().any(|report| report.file != reports[0].file);
    let free = |parameter: &Parameter| {
        let mut fits = reports.iter().filter_map(|report| report.fit.as_ref());
        fits.any(|fit| fit.fits(*parameter))
    };
    let parameters: Vec<Parameter> = Parameter::ALL.into_iter().filter(free).collect();
    let mut columns = vec![Column::left("um", 8)];
    columns.extend(parameters.iter().map(|parameter| {
        if parameters.len() <= MOST_INTERVALS {
            Column::right(format!("{parameter} (95 %)"), 27)
        } else {
            Column::right(parameter.to_string(), 12)
        }
    }));
    columns.extend([Column::right("rms %", 6), Column::left("", 0)]);
    if several_files {
        columns.push(Column::left("file", 0));
    }
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

fn row(report: &Report, parameters: &[Parameter], with_file: bool) -> Row {
    let wavelength = report.wavelength_um;
    let mut cells = vec![wavelength.map_or_else(|| "-".to_owned(), |um| um.to_string())];
    let Some(fit) = &report.fit else {
        return Row::with_remark(cells, report.status());
    };
    let at = fit.at();
    let uncertainty = report.uncertainty.as_ref();
    cells.extend(parameters.iter().map(|&parameter| {
        let estimate = uncertainty.and_then(|uncertainty| uncertainty.estimate(parameter));
        match estimate {
            Some(estimate) if parameters.len() <= MOST_INTERVALS => estimate.to_string(),
            _ => digits(parameter.of(&at)),
        }
    }));
    let rms = fit.rms_percent();
    cells.extend([two_digits(rms), Quality::of(fit).word().to_owned()]);
    cells.extend(with_file.then(|| report.file.clone()));
    Row::new(cells)
}
