//! The fitted parameters with their intervals as a table.

use super::table::{Column, Row, Table};
use crate::format::{digits, fixed, rounded};
use crate::inference::{Assessment, Estimate, Interval, Knowledge, Uncertainty, Without};
use crate::inference::{most_influential, rests_on};

/// The parameters with their intervals of 95 % and standard errors, and without the incidence that
/// they depend on most.
pub(super) fn table(uncertainty: &Uncertainty, assessment: Option<&Assessment>) -> Table {
    let without = without(uncertainty, assessment);
    let row = |estimate: &Estimate| row(estimate, without);
    let mut columns = vec![
        Column::left("", 10),
        Column::right("value", 11),
        Column::right("95 %", 24),
        Column::right("standard error", 15),
    ];
    columns.extend(without.map(|without| {
        let heading = format!("without {} deg", without.psi_deg);
        Column::right(heading, 16)
    }));
    Table {
        caption: "Parameters".to_owned(),
        columns,
        rows: uncertainty.estimates.iter().map(row).collect(),
        notes: Vec::new(),
    }
}

/// The incidence whose removal moves a parameter by most standard errors.
fn without<'a>(
    uncertainty: &Uncertainty,
    assessment: Option<&'a Assessment>,
) -> Option<&'a Without> {
    most_influential(uncertainty, &assessment?.sensitivity)
}

fn row(estimate: &Estimate, without: Option<&Without>) -> Row {
    let (name, value) = (estimate.parameter.to_string(), estimate.value);
    let other = without.map(|without| estimate.parameter.of(&without.parameters));
    match &estimate.knowledge {
        Knowledge::Determined {
            standard_error,
            interval_95,
            ..
        } => {
            let rounded = |x: f64| rounded(x, *standard_error);
            let mut cells = vec![
                name,
                rounded(value),
                interval(interval_95, rounded),
                rounded(*standard_error),
            ];
            cells.extend(other.map(rounded));
            Row::new(cells)
        }
        Knowledge::OnBound { interval_95 } => {
            let upper = interval_95.to.filter(|to| *to > value);
            let below = upper.map_or_else(String::new, |to| {
                format!("below {}", rounded(to, 0.3 * (to - value)))
            });
            let mut cells = vec![name, digits(value), below, "on its bound".to_owned()];
            cells.extend(other.map(digits));
            Row::new(cells)
        }
        Knowledge::ConstrainedByEnergy => {
            Row::with_remark([name, digits(value)], "constrained by rho <= 1")
        }
        Knowledge::NoInterval { .. } => Row::with_remark([name, fixed(value, 3)], "no interval"),
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

/// The parameters that rest on one incidence, as sentences.
pub(super) fn reliance(uncertainty: &Uncertainty, assessment: &Assessment) -> Vec<String> {
    let all = rests_on(uncertainty, &assessment.sensitivity);
    let mut angles: Vec<f64> = all.iter().map(|reliance| reliance.psi_deg).collect();
    angles.dedup();
    angles
        .into_iter()
        .map(|psi_deg| {
            let own = all.iter().filter(|reliance| reliance.psi_deg == psi_deg);
            let names: Vec<String> = own.map(|reliance| reliance.parameter.to_string()).collect();
            let (verb, them, have) = match names.len() {
                1 => ("rests", "it", "its interval"),
                _ => ("rest", "they", "their intervals"),
            };
            let lies = if names.len() == 1 { "lies" } else { "lie" };
            format!(
                "{} {verb} on {psi_deg} deg: without it {them} {lies} outside {have}",
                listed(&names)
            )
        })
        .collect()
}

/// `k2`, `k2 and k1`, `k2, kD and k1`.
pub(super) fn listed(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}
