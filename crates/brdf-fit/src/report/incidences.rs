//! The error of each incidence as a table.

use super::table::{Column, Row, Table};
use crate::fit::{Fit, rms_percent};
use crate::format::two_digits;
use crate::inference::Assessment;
use crate::inference::{CrossValidation, Deviations};
use crate::objective::IncidenceError;

/// Incidences side by side in the text layout.
const PER_TABLE: usize = 9;

fn prediction(assessment: Option<&Assessment>) -> Option<&CrossValidation> {
    assessment?.cross_validation.as_ref()
}

/// A number in percent, `-` where it is not defined.
fn or_dash(percent: Option<f64>, format: impl Fn(f64) -> String) -> String {
    percent.map_or_else(|| "-".to_owned(), format)
}

/// The rms error of an E in percent.
fn rms(e_percent: f64) -> String {
    two_digits(rms_percent(e_percent))
}

/// The median relative error of an incidence.
fn median(deviations: Option<&Deviations>, psi_deg: f64) -> String {
    let mut all = deviations
        .iter()
        .flat_map(|deviations| &deviations.incidences);
    let own = all.find(|(angle, _)| (angle - psi_deg).abs() < 1e-9);
    own.map_or_else(|| "-".to_owned(), |(_, percent)| two_digits(*percent))
}

/// Tables with one column for each incidence, which number at most nine a table.
pub(super) fn side_by_side(
    fit: &Fit,
    deviations: Option<&Deviations>,
    assessment: Option<&Assessment>,
) -> Vec<Table> {
    let prediction = prediction(assessment);
    let chunk = |(i, incidences): (usize, &[IncidenceError])| {
        let mut columns = vec![Column::left("psi deg", 9)];
        columns.extend(
            incidences
                .iter()
                .map(|incidence| Column::right(incidence.psi_deg.to_string(), 13)),
        );
        let row = |name: &str, cells: &mut dyn Iterator<Item = String>| {
            Row::new(std::iter::once(name.to_owned()).chain(cells))
        };
        let mut readings = incidences.iter().map(|i| i.readings.to_string());
        let mut errors = incidences.iter().map(|i| or_dash(i.e_percent, rms));
        let mut rows = vec![row("readings", &mut readings), row("rms %", &mut errors)];
        let mut medians = incidences.iter().map(|i| median(deviations, i.psi_deg));
        rows.push(row("median %", &mut medians));
        if let Some(prediction) = prediction {
            let predicted = (i * PER_TABLE..).map(|i| prediction.incidences.get(i)?.e_percent);
            let mut predicted = predicted.take(incidences.len()).map(|e| or_dash(e, rms));
            rows.push(row("predicted", &mut predicted));
        }
        Table {
            caption: "Incidences".to_owned(),
            columns,
            rows,
            notes: Vec::new(),
        }
    };
    let chunks = fit.incidences.chunks(PER_TABLE).enumerate();
    chunks.map(chunk).collect()
}

/// A table with one row for each incidence, and one for all.
pub(super) fn one_below_another(
    fit: &Fit,
    deviations: Option<&Deviations>,
    assessment: Option<&Assessment>,
) -> Table {
    let prediction = prediction(assessment);
    let percent = |e: Option<f64>| or_dash(e, rms);
    let row = |name: String, readings: usize, e, median: String, predicted| {
        Row::new([
            name,
            readings.to_string(),
            percent(e),
            median,
            percent(predicted),
        ])
    };
    let incidences = fit.incidences.iter().enumerate();
    let mut rows: Vec<Row> = incidences
        .map(|(i, incidence)| {
            let predicted = prediction.and_then(|p| p.incidences.get(i)?.e_percent);
            let name = incidence.psi_deg.to_string();
            let median = median(deviations, incidence.psi_deg);
            row(
                name,
                incidence.readings,
                incidence.e_percent,
                median,
                predicted,
            )
        })
        .collect();
    rows.push(row(
        "all".to_owned(),
        fit.readings,
        Some(fit.e_percent),
        deviations.map_or_else(|| "-".to_owned(), |all| two_digits(all.median_percent)),
        prediction.map(|p| p.e_percent),
    ));
    Table {
        caption: "Incidences".to_owned(),
        columns: vec![
            Column::left("psi deg", 9),
            Column::right("readings", 13),
            Column::right("rms %", 13),
            Column::right("median %", 13),
            Column::right("predicted rms %", 17),
        ],
        rows,
        notes: Vec::new(),
    }
}
