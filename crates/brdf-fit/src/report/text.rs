//! The report as plain text, in sections.

use std::fmt::Write as _;

use brdf_core::Parameters;

use super::run::Report;
use super::{incidences, models, parameters, stages};
use crate::fit::Fit;
use crate::fit::robust::REJECTED;
use crate::format::{counted, digits, in_degrees, shortest};
use crate::inference::{Assessment, Physics};
use crate::inference::{Noise, Uncertainty};
use crate::model::{K1_RANGE, Model, Parameter};
use crate::objective::MOST_FOLDS;
use crate::scan::{Convention, Measurement};

/// A section of the text of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Section {
    /// Its title, which [`Report::text`] does not show.
    pub title: &'static str,
    /// Its lines, each terminated, as in [`Report::text`]; a blank line may come first.
    pub text: String,
}

impl Report {
    /// The report as text: a heading and the [sections](Self::sections).
    pub fn text(&self) -> String {
        let sections = self.sections().into_iter().map(|section| section.text);
        std::iter::once(self.heading()).chain(sections).collect()
    }

    /// The sections of [`text`](Self::text) below its heading, in their order, without empty ones.
    pub fn sections(&self) -> Vec<Section> {
        let mut sections = if let Some(fit) = &self.fit {
            self.fit_sections(fit)
        } else {
            let error = self.error.as_deref().unwrap_or("no fit");
            vec![("error", format!("  error: {error}\n"))]
        };
        sections.push(("warnings", self.warning_lines()));
        let sections = sections.into_iter();
        sections
            .filter(|(_, text)| !text.is_empty())
            .map(|(title, text)| Section { title, text })
            .collect()
    }

    fn fit_sections(&self, fit: &Fit) -> Vec<(&'static str, String)> {
        let assessment = self.assessment.as_ref();
        let check = global_check_line(fit) + &options_lines(fit, &self.rejected);
        let mut sections = vec![
            ("stages", stages_section(fit)),
            ("incidences", incidences_section(fit, assessment)),
            ("global check and options", check),
        ];
        if let Some(uncertainty) = &self.uncertainty {
            sections.push(("parameters", parameters_section(uncertainty, assessment)));
        }
        if let Some(assessment) = assessment {
            let models = cross_validation_lines(fit, assessment) + &models_section(assessment);
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
            let _ = writeln!(text, "  unused columns: {columns}");
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
            let _ = write!(text, "{}, ", refractive_index(fit));
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

/// `n = 1.5`, or `n = 1.11776 (fitted)`.
pub(super) fn refractive_index(fit: &Fit) -> String {
    let fitted = if fit.fits(Parameter::N) {
        " (fitted)"
    } else {
        ""
    };
    format!("n = {}{fitted}", shortest(fit.n))
}

fn stages_section(fit: &Fit) -> String {
    let mut text = format!("\n{}", stages::detailed(fit).text());
    if let Some(reason) = &fit.stage1_left_out {
        let _ = writeln!(text, "  stage 1 skipped: {reason}");
    } else if let Some(scope) = fit.options.scope() {
        let _ = writeln!(
            text,
            "  stage 1 alone: all results below are for {scope}, {}",
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
    text + &bound_lines(fit)
}

/// A line for each fitted parameter that is on a bound.
fn bound_lines(fit: &Fit) -> String {
    let mut text = String::new();
    let Parameters { k2, kd, k1 } = fit.parameters;
    for (parameter, on_bound, name) in [
        (Parameter::K2, k2 == 0.0, "k2 = 0"),
        (Parameter::Kd, kd == 0.0, "kD = 0"),
        (
            Parameter::K1,
            k2 > 0.0 && k1 == K1_RANGE.0,
            "k1 = 1e-6, the smallest value of the search",
        ),
        (
            Parameter::K1,
            k2 > 0.0 && k1 == K1_RANGE.1,
            "k1 = 1e3, the largest value of the search",
        ),
    ] {
        if on_bound && fit.options.fixed.get(parameter).is_none() {
            let _ = writeln!(text, "  on its bound: {name}");
        }
    }
    text
}

fn incidences_section(fit: &Fit, assessment: Option<&Assessment>) -> String {
    let mut text = String::new();
    for table in incidences::side_by_side(fit, assessment) {
        text.push('\n');
        text += &table.text();
    }
    text.push('\n');
    text
}

fn global_check_line(fit: &Fit) -> String {
    match &fit.global_check {
        None => "  global check: skipped\n".to_owned(),
        Some(check) if check.lower_minimum_taken => format!(
            "  global check: found and adopted a lower minimum (E {} % instead of {} %)\n",
            digits(fit.e_percent),
            digits(check.stage2_e_percent)
        ),
        Some(_) if fit.options.fixed.get(Parameter::K1).is_some() => {
            "  global check: no lower minimum at the fixed k1\n".to_owned()
        }
        Some(check) => format!(
            "  global check: no lower minimum for k1 from {:.0e} to {:.0e} ({} values)\n",
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

/// The effects of a robust loss and of the energy constraint.
fn options_lines(fit: &Fit, rejected: &[Measurement]) -> String {
    let mut text = String::new();
    if let Some(robust) = &fit.robust {
        let _ = writeln!(
            text,
            "  robust fit ({} loss): {} at less than half their weight; least squares gives E = {} %",
            robust.loss,
            counted(robust.reduced, "reading"),
            digits(robust.least_squares_e_percent)
        );
        let _ = writeln!(
            text,
            "  {} rejected, with a residual above {REJECTED} standard deviations",
            counted(robust.rejected.len(), "reading")
        );
        for (reading, rejected) in rejected.iter().zip(&robust.rejected) {
            let _ = writeln!(
                text,
                "    psi {} deg, theta {} deg, phi {} deg: {} 1/sr, residual {:+.1} standard deviations",
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
                "  energy: constrained by rho(psi) <= 1 up to {limit} deg, which raises E from {} % to {} %",
                digits(energy.free_e_percent),
                digits(fit.e_percent)
            )
        } else {
            writeln!(
                text,
                "  energy: rho(psi) <= 1 up to {limit} deg is met by the unconstrained fit"
            )
        };
    }
    text
}

fn parameters_section(uncertainty: &Uncertainty, assessment: Option<&Assessment>) -> String {
    let table = parameters::detailed(uncertainty, assessment).text();
    let noise = if uncertainty.covered.is_empty() {
        String::new()
    } else {
        noise_line(uncertainty)
    };
    format!("\n{table}{noise}")
}

/// Where the standard errors come from, and the correlations of the parameters.
fn noise_line(uncertainty: &Uncertainty) -> String {
    let degrees = counted(uncertainty.degrees_of_freedom, "degree");
    let noise = match uncertainty.noise {
        Noise::Residuals => {
            format!("standard errors from the residuals, {degrees} of freedom")
        }
        Noise::Given { reduced_chi_square } => format!(
            "standard errors from the standard deviations of the readings; reduced chi^2 \
             {reduced_chi_square:.2}, {degrees} of freedom"
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

/// The scope of the assessment, and the error of the cross-validation.
fn cross_validation_lines(fit: &Fit, assessment: &Assessment) -> String {
    let mut text = String::new();
    let rejected = fit.robust.as_ref().map_or(0, |r| r.rejected.len());
    if assessment.readings < fit.readings {
        let thinned = assessment.readings + rejected < fit.readings;
        let _ = writeln!(
            text,
            "\n  the assessment uses {} of the {} readings{}",
            assessment.readings,
            fit.readings,
            if thinned {
                ", evenly distributed over each incidence"
            } else {
                ""
            }
        );
    }
    if fit.energy.is_some_and(|energy| energy.binding) {
        text += "\n  cross-validation and models are fitted without the constraint rho <= 1\n";
    }
    if rejected > 0 {
        text += "\n  cross-validation and models are least-squares fits without the rejected readings\n";
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
            "\n  leave-one-incidence-out cross-validation: E = {} % (fit to all incidences: {} %)",
            digits(prediction.e_percent),
            digits(assessment.e_percent)
        ),
        None if incidences < 2 => writeln!(
            text,
            "\n  no cross-validation: there is only a single incidence"
        ),
        None => writeln!(
            text,
            "\n  no cross-validation: without any one incidence too few readings remain for a fit"
        ),
    };
    text
}

/// The compared models with the verdict.
fn models_section(assessment: &Assessment) -> String {
    let mut table = models::compact(assessment);
    table.notes.push(
        "(predicted: E of each incidence, predicted by a fit to the other incidences; AICc: \
         difference from the best model, for independent normal errors)"
            .to_owned(),
    );
    let verdict = assessment.verdict.as_ref();
    table
        .notes
        .extend(verdict.map(|verdict| format!("verdict: {verdict}")));
    format!("\n{}", table.text())
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
            "  facet reflectance at normal incidence: k2 implies {:.4}, n = {} implies {:.4}",
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
    use crate::fit::FitOptions;
    use crate::report::run::Depth;
    use crate::scan::RefractiveIndex;
    use crate::scan::synthetic::scan;

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
        let (failed, _) = Report::new(&scan, &options, Depth::Fit);
        assert_eq!(titles(&failed), ["error", "warnings"]);
        options.refractive_index = Some(RefractiveIndex::Same(1.5));
        let (report, _) = Report::new(&scan, &options, Depth::Assessed);
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
