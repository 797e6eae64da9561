//! The fitted parameters with their confidence intervals as a table.

use super::table::{Column, Row, Table};
use crate::format::digits;
use crate::format::rounded;
use crate::inference::Assessment;
use crate::inference::{Estimate, Interval, Knowledge, Uncertainty};
use crate::model::Parameter;

/// Heading of the bootstrap over resampled incidences.
const BOOTSTRAP: &str = "95 % incidence bootstrap";

/// The parameters with standard errors and intervals of 68 % and 95 %.
pub(super) fn detailed(uncertainty: &Uncertainty, assessment: Option<&Assessment>) -> Table {
    let row = |estimate: &Estimate| {
        let bootstrap = bootstrap(assessment, estimate.parameter);
        let bootstrap = bootstrap.unwrap_or_else(|| "-".to_owned());
        detailed_row(estimate, bootstrap)
    };
    Table {
        caption: "Parameters".to_owned(),
        columns: vec![
            Column::left("", 9),
            Column::right("value", 13),
            Column::right("1 sigma", 13),
            Column::right("68 %", 26),
            Column::right("95 %", 26),
            Column::right(BOOTSTRAP, 26),
        ],
        rows: uncertainty.estimates.iter().map(row).collect(),
        notes: Vec::new(),
    }
}

fn detailed_row(estimate: &Estimate, bootstrap: String) -> Row {
    let (name, value) = (estimate.parameter.to_string(), estimate.value);
    match &estimate.knowledge {
        Knowledge::Determined {
            standard_error,
            interval_68,
            interval_95,
        } => {
            let rounded = |x: f64| rounded(x, *standard_error);
            Row::new([
                name,
                rounded(value),
                rounded(*standard_error),
                interval(interval_68, rounded),
                interval(interval_95, rounded),
                bootstrap,
            ])
        }
        Knowledge::OnBound { interval_95 } => {
            let width = |end: Option<f64>| end.map_or(0.0, |end| (end - value).abs());
            let error = 0.3 * width(interval_95.from).max(width(interval_95.to));
            Row::new([
                name,
                digits(value),
                "on its bound".to_owned(),
                String::new(),
                interval(interval_95, |x| rounded(x, error)),
                bootstrap,
            ])
        }
        Knowledge::ConstrainedByEnergy => {
            Row::with_remark([name, digits(value)], "constrained by rho <= 1")
        }
        Knowledge::NotDetermined { reason, .. } => {
            Row::with_remark([name], format!("not determined: {reason}"))
        }
    }
}

/// The ends of an interval; `?` where an end was not found.
fn interval(interval: &Interval, digits: impl Fn(f64) -> String) -> String {
    let end = |end: Option<f64>| end.map_or_else(|| "?".to_owned(), &digits);
    format!("{} ... {}", end(interval.from), end(interval.to))
}

/// The 95 % interval of a parameter over resampled incidences, if the assessment has one.
fn bootstrap(assessment: Option<&Assessment>, parameter: Parameter) -> Option<String> {
    let mut spreads = assessment?.bootstrap.iter();
    let spread = spreads.find(|spread| spread.parameter == parameter)?;
    let digits = |x: f64| rounded(x, spread.standard_deviation);
    Some(format!("{} ... {}", digits(spread.from), digits(spread.to)))
}

/// The parameters with their intervals of 95 %.
pub(super) fn brief(uncertainty: &Uncertainty, assessment: Option<&Assessment>) -> Table {
    let row = |estimate: &Estimate| {
        let (value, remark) = match &estimate.knowledge {
            Knowledge::NotDetermined { reason, .. } => {
                (String::new(), format!("not determined: {reason}"))
            }
            Knowledge::OnBound { .. } => (estimate.to_string(), "on its bound".to_owned()),
            Knowledge::Determined { .. } | Knowledge::ConstrainedByEnergy => {
                (estimate.to_string(), String::new())
            }
        };
        let bootstrap = bootstrap(assessment, estimate.parameter).unwrap_or_default();
        Row::new([estimate.parameter.to_string(), value, bootstrap, remark])
    };
    Table {
        caption: "Parameters".to_owned(),
        columns: vec![
            Column::left("", 9),
            Column::right("value (95 % interval)", 26),
            Column::right(BOOTSTRAP, 26),
            Column::left("", 0),
        ],
        rows: uncertainty.estimates.iter().map(row).collect(),
        notes: Vec::new(),
    }
}
