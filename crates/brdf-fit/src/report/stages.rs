//! The stages of a fit as a table.

use std::fmt::Write as _;

use brdf_core::{ModelParameters, Parameters};

use super::table::{Column, Row, Table};
use crate::fit::{Fit, Stage};
use crate::format::digits;
use crate::model::Parameter;

/// The initial values or a stage.
struct Step<'a> {
    name: &'static str,
    parameters: Parameters,
    own_percent: f64,
    all_percent: f64,
    /// `None` for the initial values.
    stage: Option<&'a Stage>,
}

fn steps(fit: &Fit) -> Vec<Step<'_>> {
    let mut steps = vec![Step {
        name: "initial",
        parameters: fit.initial.parameters,
        own_percent: fit.initial_e_percent.own,
        all_percent: fit.initial_e_percent.all,
        stage: None,
    }];
    for (name, stage) in [("stage 1", &fit.stage1), ("stage 2", &fit.stage2)] {
        steps.extend(stage.as_ref().map(|stage| Step {
            name,
            parameters: stage.parameters.parameters(),
            own_percent: stage.e_percent.own,
            all_percent: stage.e_percent.all,
            stage: Some(stage),
        }));
    }
    steps
}

/// The stages with their computational effort, and the result where it is not that of the last stage.
pub(super) fn detailed(fit: &Fit) -> Table {
    let row = |name: &str, at: &Parameters, own: f64, all: String| {
        let mut cells = vec![name.to_owned()];
        cells.extend([at.k2, at.kd, at.k1, own].map(digits));
        cells.push(all);
        cells
    };
    let mut rows = Vec::new();
    for step in steps(fit) {
        let all = digits(step.all_percent);
        let mut cells = row(step.name, &step.parameters, step.own_percent, all);
        if let Some(stage) = step.stage {
            cells.extend(effort(fit, stage));
        }
        rows.push(Row::new(cells));
    }
    if fit.last_stage().map(|stage| stage.parameters) != Some(fit.at()) {
        // The error of the result is known over the fitted readings only.
        let all = match fit.options.scope() {
            Some(_) => "-".to_owned(),
            None => digits(fit.e_percent),
        };
        rows.push(Row::new(row("result", &fit.parameters, fit.e_percent, all)));
    }
    let mut columns = vec![Column::left("", 9)];
    columns.extend(["k2", "kD", "k1", "E own %", "E all %"].map(|name| Column::right(name, 13)));
    columns.extend([
        Column::right("readings", 10),
        Column::right("iter.", 7),
        Column::right("eval.", 7),
        Column::right("time us", 9),
        Column::left("termination", 0),
    ]);
    Table {
        caption: "Stages".to_owned(),
        columns,
        rows,
        notes: Vec::new(),
    }
}

fn effort(fit: &Fit, stage: &Stage) -> [String; 5] {
    [
        stage.readings.to_string(),
        stage.iterations.to_string(),
        stage.evaluations.to_string(),
        format!("{:.1}", 1e6 * stage.seconds),
        format!(
            "{}: {}{}",
            stage.method.short_name(),
            stage.termination,
            further_parameters(fit, &stage.parameters)
        ),
    ]
}

/// n and p of a stage, where they are fitted.
fn further_parameters(fit: &Fit, at: &ModelParameters) -> String {
    let mut text = String::new();
    for parameter in [Parameter::N, Parameter::P] {
        if fit.fits(parameter) {
            let _ = write!(text, "; {parameter} = {}", digits(parameter.of(at)));
        }
    }
    text
}

/// The parameters and the error of each stage.
pub(super) fn brief(fit: &Fit) -> Table {
    let rows = steps(fit).into_iter().map(|step| {
        let Parameters { k2, kd, k1 } = step.parameters;
        let mut cells = vec![step.name.to_owned()];
        let numbers = [k2, kd, k1, step.own_percent, step.all_percent];
        cells.extend(numbers.map(|number| format!("{number:.6}")));
        cells.extend(step.stage.map(|stage| stage.readings.to_string()));
        Row::new(cells)
    });
    let numbers = ["k2", "kD", "k1", "E own %", "E all %", "readings"];
    let mut columns = vec![Column::left("", 9)];
    columns.extend(numbers.map(|name| Column::right(name, 13)));
    Table {
        caption: "Stages".to_owned(),
        columns,
        rows: rows.collect(),
        notes: Vec::new(),
    }
}
