//! The alternatives of a trade-off of fitting as CSV.

use std::io;

use super::result::{Alternative, FitTradeoff, Measured, Outcome};
use crate::model::Parameter;

/// The header of the CSV of [`write_fit_tradeoffs`]. E is in percent, the excess of E a fraction of the
/// lowest E; shifts are in standard errors of the reference.
pub const FIT_TRADEOFF_COLUMNS: [&str; 25] = [
    "file",
    "wavelength_um",
    "name",
    "method",
    "stages",
    "global_check",
    "max_iterations",
    "readings",
    "incidences",
    "seconds",
    "e_percent",
    "excess_e",
    "k2",
    "kd",
    "k1",
    "n",
    "p",
    "shift_k2",
    "shift_kd",
    "shift_k1",
    "shift_n",
    "shift_p",
    "converged",
    "pareto",
    "status",
];

/// Writes trade-offs as CSV, one line for each alternative. A failed alternative has empty columns and
/// its error as the status.
///
/// # Errors
///
/// The writer fails.
pub fn write_fit_tradeoffs(tradeoffs: &[FitTradeoff], writer: impl io::Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(FIT_TRADEOFF_COLUMNS)?;
    for tradeoff in tradeoffs {
        for alternative in &tradeoff.alternatives {
            csv.write_record(record(tradeoff, alternative))?;
        }
    }
    csv.flush()
}

/// The line of an alternative, in the order of [`FIT_TRADEOFF_COLUMNS`].
fn record(tradeoff: &FitTradeoff, alternative: &Alternative) -> Vec<String> {
    let measured = alternative.measured();
    let mut record = vec![
        tradeoff.source.clone(),
        or_empty(tradeoff.wavelength_um),
        alternative.name.clone(),
        alternative.method.clone(),
        alternative.stages.clone(),
        alternative.global_check.to_string(),
        alternative.max_iterations.to_string(),
        alternative.readings.to_string(),
        alternative.incidences.to_string(),
        or_empty(measured.map(|m| m.seconds)),
        or_empty(measured.map(|m| m.e_percent)),
        or_empty(measured.map(|m| m.excess_e)),
    ];
    let value = |parameter: Parameter| measured.map(|m| parameter.of(&m.parameters));
    record.extend(Parameter::ALL.map(|parameter| or_empty(value(parameter))));
    let shift = |parameter: Parameter| measured.and_then(|m| shift(m, parameter));
    record.extend(Parameter::ALL.map(|parameter| or_empty(shift(parameter))));
    record.push(or_empty(measured.map(|m| m.converged)));
    record.push(or_empty(measured.map(|m| m.pareto)));
    record.push(match &alternative.outcome {
        Outcome::Fitted(measured) => measured.ended_by.clone(),
        Outcome::Failed { error } => format!("failed: {error}"),
    });
    record
}

fn shift(measured: &Measured, parameter: Parameter) -> Option<f64> {
    let mut shifts = measured.shift_in_sigma.iter();
    shifts.find(|of| of.parameter == parameter)?.value
}

fn or_empty<T: ToString>(value: Option<T>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}
