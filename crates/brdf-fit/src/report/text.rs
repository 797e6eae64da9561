//! The tables that a person reads.

use std::fmt::Write as _;

use brdf_core::{ModelParameters, Parameters};

use super::Report;
use crate::fit::robust::REJECTED;
use crate::fit::{Fit, Stage};
use crate::format::{counted, digits, in_degrees, rounded, shortest};
use crate::inference::{Assessment, Interval, Knowledge, Noise, Physics, Uncertainty};
use crate::model::{K1_RANGE, Model, Parameter};
use crate::objective::MOST_FOLDS;
use crate::scan::Convention;
use crate::scan::Measurement;

/// A part of what a person reads of a fit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Section {
    /// What it is of.
    pub title: &'static str,
    /// Its lines, each ended, as they stand in [`Report::text`]; a blank line may come first.
    pub text: String,
}

impl Report {
    /// The table that a person reads: a heading and the [sections](Self::sections).
    pub fn text(&self) -> String {
        let sections = self.sections().into_iter().map(|section| section.text);
        std::iter::once(self.heading()).chain(sections).collect()
    }

    /// The parts of [`text`](Self::text) below its heading, in their order; what there is nothing to
    /// say of is left out.
    pub fn sections(&self) -> Vec<Section> {
        let mut sections = self
            .fit
            .as_ref()
            .map_or_else(Vec::new, |fit| self.of_fit(fit));
        if self.fit.is_none() {
            let error = self.error.as_deref().unwrap_or("no fit");
            sections.push(("error", format!("  error: {error}\n")));
        }
        sections.push(("warnings", self.warning_lines()));
        let sections = sections.into_iter();
        sections
            .filter(|(_, text)| !text.is_empty())
            .map(|(title, text)| Section { title, text })
            .collect()
    }

    fn of_fit(&self, fit: &Fit) -> Vec<(&'static str, String)> {
        let assessment = self.assessment.as_ref();
        let check = global_check_line(fit) + &options_lines(fit, &self.rejected);
        let mut sections = vec![
            ("stages", stage_table(fit)),
            ("incidences", incidence_table(fit, assessment)),
            ("global check and options", check),
        ];
        if let Some(uncertainty) = &self.uncertainty {
            sections.push(("parameters", parameter_table(uncertainty, assessment)));
        }
        if let Some(assessment) = assessment {
            let models = prediction_line(fit, assessment) + &model_table(assessment);
            sections.push(("models", models));
            sections.push(("reflectance", physics_lines(&assessment.physics, fit)));
        }
        sections
    }

    fn warning_lines(&self) -> String {
        let mut text = String::new();
        for warning in &self.warnings {
            let _ = writeln!(text, "  warning: {warning}");
        }
        for conversion in &self.conversions {
            let _ = writeln!(text, "  read: {conversion}");
        }
        if !self.ignored_columns.is_empty() {
            let columns = self.ignored_columns.join(", ");
            let _ = writeln!(text, "  columns not used: {columns}");
        }
        text
    }

    fn heading(&self) -> String {
        let mut text = self.file.clone();
        if let Some(sample) = self.metadata.get("sample") {
            let _ = write!(text, ": {sample}");
        }
        text.push('\n');
        let wavelength = self
            .wavelength_um
            .map_or_else(|| "wavelength not stated".to_owned(), |w| format!("{w} um"));
        let _ = write!(text, "  {wavelength}, ");
        if let Some(fit) = &self.fit {
            let fitted = if fit.fits(Parameter::N) {
                " (fitted)"
            } else {
                ""
            };
            let _ = write!(text, "n = {}{fitted}, ", shortest(fit.n));
            if fit.model() != Model::Three {
                let _ = write!(
                    text,
                    "model {}: {}, ",
                    fit.model(),
                    fit.model().description()
                );
            }
        }
        text += &counted(self.readings, "reading");
        if self.convention != Convention::default() {
            let _ = write!(text, ", read with {}", self.convention);
        }
        text.push('\n');
        text
    }
}

fn stage_table(fit: &Fit) -> String {
    let mut text = format!(
        "\n  {:<9}{:>13}{:>13}{:>13}{:>13}{:>13}{:>10}{:>7}{:>7}{:>9}  ended by\n",
        "", "k2", "kD", "k1", "E own %", "E all %", "readings", "iter.", "eval.", "time us"
    );
    let mut line = |name: &str, p: &Parameters, own: f64, all: &str, rest: &str| {
        let row = format!(
            "  {name:<9}{:>13}{:>13}{:>13}{:>13}{:>13}{rest}",
            digits(p.k2),
            digits(p.kd),
            digits(p.k1),
            digits(own),
            all
        );
        let _ = writeln!(text, "{}", row.trim_end());
    };
    let work = |stage: &Stage| {
        format!(
            "{:>10}{:>7}{:>7}{:>9.1}  {}: {}{}",
            stage.readings,
            stage.iterations,
            stage.evaluations,
            1e6 * stage.seconds,
            stage.method.short_name(),
            stage.termination,
            further_parameters(fit, &stage.parameters)
        )
    };
    line(
        "initial",
        &fit.initial.parameters,
        fit.initial_e_percent.own,
        &digits(fit.initial_e_percent.all),
        "",
    );
    for (name, stage) in [("stage 1", &fit.stage1), ("stage 2", &fit.stage2)] {
        let Some(stage) = stage else { continue };
        let (at, e) = (stage.parameters.parameters(), stage.e_percent);
        line(name, &at, e.own, &digits(e.all), &work(stage));
    }
    let scope = fit.options.scope();
    if fit.last_stage().map(|stage| stage.parameters) != Some(fit.at()) {
        // Of other readings than the fitted ones it is not told.
        let all = scope
            .as_ref()
            .map_or_else(|| digits(fit.e_percent), |_| "-".to_owned());
        line("result", &fit.parameters, fit.e_percent, &all, "");
    }
    if let Some(reason) = &fit.stage1_left_out {
        let _ = writeln!(text, "  stage 1 left out: {reason}");
    } else if let Some(scope) = scope {
        let _ = writeln!(
            text,
            "  stage 1 alone: all that follows is of {scope}, {}",
            counted(fit.readings, "reading")
        );
    } else if fit.stage1.is_some() {
        let limit = in_degrees(fit.options.stage1_limit);
        let _ = writeln!(text, "  stage 1: psi <= {limit} deg");
    }
    let _ = writeln!(text, "  initial values: {}", fit.initial);
    let weights = fit.options.weights.to_string();
    if !weights.is_empty() {
        let _ = writeln!(text, "  readings weighted by {weights}");
    }
    let fixed = &fit.options.fixed;
    if !fixed.is_empty() {
        let _ = writeln!(text, "  fixed: {fixed}");
    }
    let Parameters { k2, kd, k1 } = fit.parameters;
    for (parameter, on_bound, name) in [
        (Parameter::K2, k2 == 0.0, "k2 = 0"),
        (Parameter::Kd, kd == 0.0, "kD = 0"),
        (
            Parameter::K1,
            k2 > 0.0 && k1 == K1_RANGE.0,
            "k1 = 1e-6, the smallest that is searched",
        ),
        (
            Parameter::K1,
            k2 > 0.0 && k1 == K1_RANGE.1,
            "k1 = 1e3, the largest that is searched",
        ),
    ] {
        if on_bound && fixed.get(parameter).is_none() {
            let _ = writeln!(text, "  on its bound: {name}");
        }
    }
    text
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

fn incidence_table(fit: &Fit, assessment: Option<&Assessment>) -> String {
    const A_ROW: usize = 9;
    let mut text = String::new();
    for (i, chunk) in fit.incidences.chunks(A_ROW).enumerate() {
        let row_start = i * A_ROW;
        let row = |name: &str, cell: &dyn Fn(usize) -> String| {
            let mut row = format!("  {name:<9}");
            for i in 0..chunk.len() {
                let _ = write!(row, "{:>13}", cell(i));
            }
            row.push('\n');
            row
        };
        text.push('\n');
        text += &row("psi deg", &|i| chunk[i].psi_deg.to_string());
        text += &row("readings", &|i| chunk[i].readings.to_string());
        text += &row("E %", &|i| {
            chunk[i].e_percent.map_or_else(|| "-".to_owned(), digits)
        });
        if let Some(prediction) = assessment.and_then(|a| a.cross_validation.as_ref()) {
            let predicted = prediction.incidences.get(row_start..).unwrap_or_default();
            text += &row("predicted", &|i| {
                let e = predicted.get(i).and_then(|incidence| incidence.e_percent);
                e.map_or_else(|| "-".to_owned(), digits)
            });
        }
    }
    text.push('\n');
    text
}

fn global_check_line(fit: &Fit) -> String {
    match &fit.global_check {
        None => "  global check: left out\n".to_owned(),
        Some(check) if check.lower_minimum_taken => format!(
            "  global check: a lower minimum exists and was taken (E {} % instead of {} %)\n",
            digits(fit.e_percent),
            digits(check.stage2_e_percent)
        ),
        Some(_) if fit.options.fixed.get(Parameter::K1).is_some() => {
            "  global check: no lower minimum at the width that is fixed\n".to_owned()
        }
        Some(check) => format!(
            "  global check: no lower minimum for k1 from {:.0e} to {:.0e} ({} widths)\n",
            check
                .profile
                .first()
                .map_or(0.0, |point| point.parameters.k1),
            check
                .profile
                .last()
                .map_or(0.0, |point| point.parameters.k1),
            check.profile.len()
        ),
    }
}

/// What other options than the paper's did.
fn options_lines(fit: &Fit, rejected: &[Measurement]) -> String {
    let mut text = String::new();
    if let Some(robust) = &fit.robust {
        let _ = writeln!(
            text,
            "  robust fit ({} loss): {} with less than half their weight; least squares has E = {} %",
            robust.loss,
            counted(robust.reduced, "reading"),
            digits(robust.least_squares_e_percent)
        );
        let _ = writeln!(
            text,
            "  {} rejected, more than {REJECTED} standard deviations off",
            counted(robust.rejected.len(), "reading")
        );
        for (reading, rejected) in rejected.iter().zip(&robust.rejected) {
            let _ = writeln!(
                text,
                "    psi {} deg, theta {} deg, phi {} deg: {} 1/sr, {:+.1} standard deviations off",
                in_degrees(reading.psi),
                in_degrees(reading.theta),
                in_degrees(reading.phi),
                reading.brdf,
                rejected.deviations
            );
        }
    }
    if let Some(energy) = &fit.energy {
        let limit = energy.limit_deg;
        let _ = if energy.binding {
            writeln!(
                text,
                "  energy: fitted under rho(psi) <= 1 up to {limit} deg, which raises E from {} % to {} %",
                digits(energy.free_e_percent),
                digits(fit.e_percent)
            )
        } else {
            writeln!(
                text,
                "  energy: rho(psi) <= 1 up to {limit} deg holds without any change"
            )
        };
    }
    text
}

fn parameter_table(uncertainty: &Uncertainty, assessment: Option<&Assessment>) -> String {
    let mut text = format!(
        "\n  {:<9}{:>13}{:>13}{:>26}{:>26}{:>26}\n",
        "", "value", "1 sigma", "68 %", "95 %", "95 % over incidences"
    );
    let bootstrap = |parameter: Parameter| {
        let spread = assessment?
            .bootstrap
            .iter()
            .find(|s| s.parameter == parameter)?;
        let digits = |x: f64| rounded(x, spread.standard_deviation);
        Some(format!("{} ... {}", digits(spread.from), digits(spread.to)))
    };
    for estimate in &uncertainty.estimates {
        let name = estimate.parameter.to_string();
        let over = bootstrap(estimate.parameter).unwrap_or_else(|| "-".to_owned());
        let _ = match &estimate.knowledge {
            Knowledge::Determined {
                standard_error,
                interval_68,
                interval_95,
            } => {
                let digits = |x: f64| rounded(x, *standard_error);
                let interval = |i: &Interval| interval_text(i, &digits);
                writeln!(
                    text,
                    "  {name:<9}{:>13}{:>13}{:>26}{:>26}{over:>26}",
                    digits(estimate.value),
                    digits(*standard_error),
                    interval(interval_68),
                    interval(interval_95),
                )
            }
            Knowledge::OnBound { interval_95 } => {
                let value = estimate.value;
                let width = |end: Option<f64>| end.map_or(0.0, |end| (end - value).abs());
                let error = 0.3 * width(interval_95.from).max(width(interval_95.to));
                let interval = interval_text(interval_95, &|x| rounded(x, error));
                writeln!(
                    text,
                    "  {name:<9}{:>13}{:>13}{:>26}{interval:>26}{over:>26}",
                    digits(value),
                    "on its bound",
                    ""
                )
            }
            Knowledge::ConstrainedByEnergy => {
                writeln!(
                    text,
                    "  {name:<9}{:>13}  held by rho <= 1",
                    digits(estimate.value)
                )
            }
            Knowledge::NotDetermined { reason, .. } => {
                writeln!(text, "  {name:<9}not determined: {reason}")
            }
        };
    }
    if !uncertainty.covered.is_empty() {
        text += &noise_line(uncertainty);
    }
    text
}

fn interval_text(interval: &Interval, digits: &dyn Fn(f64) -> String) -> String {
    let end = |end: Option<f64>| end.map_or_else(|| "?".to_owned(), digits);
    format!("{} ... {}", end(interval.from), end(interval.to))
}

fn noise_line(uncertainty: &Uncertainty) -> String {
    let degrees = counted(uncertainty.degrees_of_freedom, "degree");
    let noise = match uncertainty.noise {
        Noise::Residuals => format!("errors from the residuals, {degrees} of freedom"),
        Noise::Given { reduced_chi_square } => format!(
            "errors as the scan states them; reduced chi^2 {reduced_chi_square:.2}, {degrees} of freedom"
        ),
    };
    let correlations = uncertainty.correlations();
    let mut pairs = Vec::new();
    for (i, first) in uncertainty.covered.iter().enumerate() {
        for (j, second) in uncertainty.covered.iter().enumerate().skip(i + 1) {
            if let Some(value) = correlations.get(i).and_then(|row| row.get(j)) {
                pairs.push(format!("{first}-{second} {value:+.2}"));
            }
        }
    }
    if pairs.is_empty() {
        return format!("  {noise}\n");
    }
    format!("  {noise}; correlations {}\n", pairs.join(", "))
}

fn prediction_line(fit: &Fit, assessment: &Assessment) -> String {
    let mut text = String::new();
    if assessment.readings < fit.readings {
        let _ = writeln!(
            text,
            "\n  assessed with {} of the {} readings, evenly over each incidence",
            assessment.readings, fit.readings
        );
    }
    if fit.energy.is_some_and(|energy| energy.binding) {
        text += "\n  prediction and models are of fits without the condition rho <= 1\n";
    }
    if fit
        .robust
        .as_ref()
        .is_some_and(|robust| !robust.rejected.is_empty())
    {
        text +=
            "\n  prediction and models are of least squares fits without the rejected readings\n";
    }
    let incidences = fit.incidences.len();
    if incidences > MOST_FOLDS {
        let _ = writeln!(
            text,
            "\n  the {incidences} incidences are left out several at a time, in {MOST_FOLDS} folds"
        );
    }
    let _ = match &assessment.cross_validation {
        Some(prediction) => writeln!(
            text,
            "\n  prediction of each incidence from the others: E = {} % (the fit: {} %)",
            digits(prediction.e_percent),
            digits(assessment.e_percent)
        ),
        None if fit.incidences.len() < 2 => {
            writeln!(text, "\n  prediction: a single incidence predicts nothing")
        }
        None => writeln!(
            text,
            "\n  prediction: without any one incidence too few readings are left for a fit"
        ),
    };
    text
}

/// The ladder of models with its verdict.
fn model_table(assessment: &Assessment) -> String {
    let mut text = format!(
        "\n  {:<11}{:>13}{:>13}{:>10}  parameters (95 % interval)\n",
        "model", "E %", "predicted %", "AICc"
    );
    for rung in &assessment.models {
        let predicted = rung
            .predicted_e_percent
            .map_or_else(|| "-".to_owned(), digits);
        let parameters: Vec<String> = rung
            .estimates
            .iter()
            .map(|estimate| format!("{} {estimate}", estimate.parameter))
            .collect();
        let aicc = rung
            .aicc_above_best
            .map_or_else(|| "-".to_owned(), |aicc| format!("{aicc:+.1}"));
        let energy = rung
            .violation_deg
            .map_or_else(String::new, |psi| format!("; rho > 1 from {psi:.0} deg"));
        let _ = writeln!(
            text,
            "  {:<11}{:>13}{predicted:>13}{aicc:>10}  {}{energy}",
            rung.model.name(),
            digits(rung.e_percent),
            parameters.join(", ")
        );
    }
    for missing in &assessment.left_out {
        let (name, reason) = (missing.model.name(), &missing.reason);
        let _ = writeln!(text, "  {name:<11}not fitted: {reason}");
    }
    text += "  (predicted: E of each incidence predicted from the others; AICc: above the best, for independent normal errors)\n";
    if let Some(verdict) = &assessment.verdict {
        let _ = writeln!(text, "  verdict: {verdict}");
    }
    text
}

fn physics_lines(physics: &Physics, fit: &Fit) -> String {
    let values: Vec<String> = physics
        .reflectance
        .iter()
        .map(|point| format!("{:.3} at {}", point.rho, point.psi_deg))
        .collect();
    let mut text = format!("  reflectance rho(psi): {} deg", values.join(", "));
    text += &physics.violation_deg.map_or_else(
        || "; below 1 up to 89 deg\n".to_owned(),
        |psi| format!("; above 1 from {psi:.1} deg on\n"),
    );
    if fit.parameters.k2 > 0.0 {
        let _ = writeln!(
            text,
            "  facet reflectance at normal incidence: k2 implies {:.4}, n = {} means {:.4}",
            physics.implied_facet_reflectance,
            shortest(fit.n),
            physics.fresnel_reflectance
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Depth;
    use crate::scan::synthetic::scan;
    use crate::{FitOptions, RefractiveIndex};

    #[test]
    fn the_sections_are_the_text_below_its_heading() {
        let mut scan = scan(Parameters::new(0.156, 0.584, 1.338).unwrap(), 1.5);
        scan.ignored_columns = vec!["temperature".to_owned()];
        let mut options = FitOptions::default();
        let titles = |report: &Report| -> Vec<&str> {
            let sections = report.sections();
            let texts: String = sections.iter().map(|s| s.text.as_str()).collect();
            assert!(report.text().ends_with(&texts) && report.text().starts_with("synthetic"));
            sections.iter().map(|section| section.title).collect()
        };
        scan.source = "synthetic".to_owned();
        let (failed, _) = Report::of(&scan, &options, Depth::Fit);
        assert_eq!(titles(&failed), ["error", "warnings"]);
        options.refractive_index = Some(RefractiveIndex::Same(1.5));
        let (report, _) = Report::of(&scan, &options, Depth::Assessed);
        let all = [
            "stages",
            "incidences",
            "global check and options",
            "parameters",
            "models",
            "reflectance",
            "warnings",
        ];
        assert_eq!(titles(&report), all);
    }
}
