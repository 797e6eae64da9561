//! The alternatives as CSV.

use std::io;

use super::{Alternative, FitTrade, Measured, Outcome};
use crate::model::Parameter;

/// The header of the CSV. E is in percent, its excess a fraction of the lowest; the shifts are in
/// standard errors of the reference.
pub const FIT_TRADE_COLUMNS: [&str; 25] = [
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

/// Writes one line an alternative; what was not fitted has empty columns and its error as status.
pub fn write_fit_trades(trades: &[FitTrade], writer: impl io::Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(FIT_TRADE_COLUMNS)?;
    for trade in trades {
        for alternative in &trade.alternatives {
            csv.write_record(record(trade, alternative))?;
        }
    }
    csv.flush()
}

/// The line of an alternative, in the order of [`FIT_TRADE_COLUMNS`].
fn record(trade: &FitTrade, alternative: &Alternative) -> Vec<String> {
    let measured = alternative.measured();
    let mut record = vec![
        trade.source.clone(),
        or_empty(trade.wavelength_um),
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
