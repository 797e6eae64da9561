//! The compared models as a table.

use super::table::{Column, Row, Table};
use crate::fit::rms_percent;
use crate::format::two_digits;
use crate::inference::{Assessment, Candidate};
use crate::model::Parameter;

/// A table of the models of an assessment, with a column for each parameter.
pub fn model_table(assessment: &Assessment) -> Table {
    let row = |candidate: &Candidate| {
        let mut cells = vec![candidate.model.to_string()];
        cells.extend(errors(candidate));
        cells.extend(Parameter::ALL.map(|parameter| {
            let mut estimates = candidate.estimates.iter();
            let estimate = estimates.find(|estimate| estimate.parameter == parameter);
            estimate.map_or_else(String::new, ToString::to_string)
        }));
        cells.push(violation(candidate).unwrap_or_else(|| "conserved".to_owned()));
        Row::new(cells)
    };
    let mut columns = vec![Column::left("model", 11)];
    columns.extend(ERRORS.map(|name| Column::right(name, 13)));
    columns.extend(Parameter::ALL.map(|parameter| Column::right(parameter.to_string(), 26)));
    columns.push(Column::left("energy", 0));
    Table {
        caption: "Models (95 % intervals)".to_owned(),
        columns,
        rows: assessment.models.iter().map(row).collect(),
        notes: Vec::new(),
    }
}

/// A table of the models of an assessment, with their parameters in one column.
pub(super) fn compact(assessment: &Assessment) -> Table {
    let fitted = |candidate: &Candidate| {
        let mut cells = vec![candidate.model.to_string()];
        cells.extend(errors(candidate));
        let estimates = candidate.estimates.iter();
        let parameters: Vec<String> = estimates
            .map(|estimate| format!("{} {estimate}", estimate.parameter))
            .collect();
        let energy = violation(candidate).map_or_else(String::new, |text| format!("; {text}"));
        cells.push(parameters.join(", ") + &energy);
        Row::new(cells)
    };
    let mut rows: Vec<Row> = assessment.models.iter().map(fitted).collect();
    rows.extend(assessment.left_out.iter().map(|missing| {
        let reason = format!("not fitted: {}", missing.reason);
        Row::with_remark([missing.model.name()], reason)
    }));
    Table {
        caption: "Models".to_owned(),
        columns: vec![
            Column::left("model", 11),
            Column::right(ERRORS[0], 8),
            Column::right(ERRORS[1], 15),
            Column::right(ERRORS[2], 12),
            Column::left("parameters (95 % interval)", 0),
        ],
        rows,
        notes: Vec::new(),
    }
}

/// The columns of [`errors`].
const ERRORS: [&str; 3] = ["rms %", "predicted rms %", "predicts %"];

/// The rms error of the fit, that of the prediction of each incidence by the others, and the typical
/// relative error of that prediction by fits of relative errors.
fn errors(candidate: &Candidate) -> [String; 3] {
    let dash = || "-".to_owned();
    let rms = |e_percent: f64| two_digits(rms_percent(e_percent));
    let relative = candidate.relative_prediction.as_ref();
    let predicts = relative.filter(|prediction| !prediction.incidences.is_empty());
    [
        rms(candidate.e_percent),
        candidate.predicted_e_percent.map_or_else(dash, rms),
        predicts.map_or_else(dash, |prediction| two_digits(prediction.within_percent())),
    ]
}

/// What the columns of errors are, as sentences.
pub(super) fn legend() -> String {
    "rms: sqrt(E); predicted rms: of each incidence by a fit of E to the others; predicts: the typical \
     relative error of that, by fits of relative errors."
        .to_owned()
}

/// From which incidence the model violates energy conservation, if it does.
fn violation(candidate: &Candidate) -> Option<String> {
    let psi = candidate.violation_deg?;
    Some(format!("rho > 1 from {psi:.0} deg"))
}
