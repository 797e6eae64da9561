//! The compared models as a table.

use super::table::{Column, Row, Table};
use crate::format::digits;
use crate::inference::{Assessment, Candidate};
use crate::model::Parameter;

/// How the numbers of [`model_table`] are written.
#[derive(Debug, Clone, Copy)]
pub struct ModelTableFormat {
    /// E in percent.
    pub percent: fn(f64) -> String,
    /// Decimals of AICc.
    pub aicc_decimals: usize,
}

/// A table of the models of an assessment, with a column for each parameter.
pub fn model_table(assessment: &Assessment, format: &ModelTableFormat) -> Table {
    let row = |candidate: &Candidate| {
        let mut cells = vec![candidate.model.to_string()];
        cells.extend(errors(candidate, format));
        cells.extend(Parameter::ALL.map(|parameter| {
            let mut estimates = candidate.estimates.iter();
            let estimate = estimates.find(|estimate| estimate.parameter == parameter);
            estimate.map_or_else(String::new, ToString::to_string)
        }));
        cells.push(violation(candidate).unwrap_or_else(|| "conserved".to_owned()));
        Row::new(cells)
    };
    let mut columns = vec![Column::left("model", 11)];
    columns.extend(["E %", "predicted %", "AICc"].map(|name| Column::right(name, 13)));
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
    let format = ModelTableFormat {
        percent: digits,
        aicc_decimals: 1,
    };
    let fitted = |candidate: &Candidate| {
        let mut cells = vec![candidate.model.to_string()];
        cells.extend(errors(candidate, &format));
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
            Column::right("E %", 13),
            Column::right("predicted %", 13),
            Column::right("AICc", 10),
            Column::left("parameters (95 % interval)", 0),
        ],
        rows,
        notes: Vec::new(),
    }
}

/// E, E of the cross-validation, and AICc.
fn errors(candidate: &Candidate, format: &ModelTableFormat) -> [String; 3] {
    let dash = || "-".to_owned();
    let aicc = |aicc: f64| format!("{aicc:+.*}", format.aicc_decimals);
    [
        (format.percent)(candidate.e_percent),
        candidate
            .predicted_e_percent
            .map_or_else(dash, format.percent),
        candidate.aicc_above_best.map_or_else(dash, aicc),
    ]
}

/// From which incidence the model violates energy conservation, if it does.
fn violation(candidate: &Candidate) -> Option<String> {
    let psi = candidate.violation_deg?;
    Some(format!("rho > 1 from {psi:.0} deg"))
}
