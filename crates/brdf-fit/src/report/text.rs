//! The report as plain text, in sections.

use std::fmt::Write as _;

use brdf_core::Parameters;

use super::run::Report;
use super::{incidences, models, parameters, stages};
use crate::fit::Fit;
use crate::fit::robust::REJECTED;
use crate::format::{counted, digits, in_degrees, rounded, shortest, two_digits};
use crate::inference::{
    Assessment, Deviations, ErrorSizes, Knowledge, Noise, Physics, Quality, Uncertainty, Warning,
};
use crate::model::{K1_RANGE, Model, Parameter};
use crate::objective::MOST_FOLDS;
use crate::scan::{Convention, Measurement, Side};

/// A section of the text of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Section {
    /// Its title, which [`Report::text`] does not show.
    pub title: &'static str,
    /// Its lines, each terminated, as in [`Report::text`]; a blank line may come first.
    pub text: String,
}

impl Report {
    /// The report as text: a heading, and the sections that answer what was read, how well the model
    /// describes it, what the parameters are and what they rest on.
    pub fn text(&self) -> String {
        self.explained_text(false, &ToString::to_string)
    }

    /// [`text`](Self::text), with the stages, the incidences, the compared models and whatever else is
    /// known.
    pub fn detailed_text(&self) -> String {
        self.explained_text(true, &ToString::to_string)
    }

    /// [`detailed_text`](Self::detailed_text) or [`text`](Self::text), with other sentences for the
    /// warnings.
    pub(crate) fn explained_text(
        &self,
        detailed: bool,
        explain: &dyn Fn(&Warning) -> String,
    ) -> String {
        let mut sections = self.brief_sections(explain);
        if let Some(fit) = self.fit.as_ref().filter(|_| detailed) {
            sections.extend(not_empty(self.detailed_sections(fit)));
        }
        let sections = sections.into_iter().map(|section| section.text);
        std::iter::once(self.heading()).chain(sections).collect()
    }

    /// The sections of [`detailed_text`](Self::detailed_text) below its heading, in their order,
    /// without empty ones.
    pub fn sections(&self) -> Vec<Section> {
        let mut sections = self.brief_sections(&ToString::to_string);
        if let Some(fit) = &self.fit {
            sections.extend(not_empty(self.detailed_sections(fit)));
        }
        sections
    }

    fn brief_sections(&self, explain: &dyn Fn(&Warning) -> String) -> Vec<Section> {
        let assessment = self.assessment.as_ref();
        let mut sections = vec![("reading", self.reading_lines())];
        if let Some(fit) = &self.fit {
            sections.push(("fit", fit_lines(fit)));
            sections.push(("quality", self.quality_lines(fit)));
        } else {
            let error = self.error.as_deref().unwrap_or("no fit");
            sections.push(("error", labelled("error", error)));
        }
        if let Some(uncertainty) = &self.uncertainty {
            sections.push(("parameters", parameters_section(uncertainty, assessment)));
            let noise = noise_lines(uncertainty) + &self.gain_line();
            sections.push(("noise", noise));
        }
        if let (Some(fit), Some(assessment)) = (&self.fit, assessment) {
            sections.push(("verdict", verdict_lines(fit, assessment)));
        }
        let warnings = self.warnings.iter();
        let warnings = warnings.map(|warning| labelled("warning", &explain(warning)));
        sections.push(("warnings", warnings.collect()));
        not_empty(sections)
    }

    fn detailed_sections(&self, fit: &Fit) -> Vec<(&'static str, String)> {
        let assessment = self.assessment.as_ref();
        let check = global_check_line(fit) + &options_lines(fit, &self.rejected);
        let incidences = incidences_section(fit, self.deviations.as_ref(), assessment);
        let mut sections = vec![
            ("stages", stages_section(fit)),
            ("incidences", incidences),
            ("global check and options", check),
        ];
        if let Some(uncertainty) = &self.uncertainty {
            sections.push(("correlations", correlation_line(uncertainty)));
        }
        if let Some(assessment) = assessment {
            let models = cross_validation_lines(fit, assessment) + &models_section(assessment);
            sections.push(("models", models));
            sections.push(("reflectance", physics_lines(&assessment.physics, fit)));
        }
        sections
    }

    /// How the file was read.
    fn reading_lines(&self) -> String {
        let mut text = String::new();
        for conversion in &self.conversions {
            text += &labelled("read", conversion);
        }
        if !self.ignored_columns.is_empty() {
            text += &labelled("not used", &self.ignored_columns.join(", "));
        }
        text
    }

    /// The error of the fit.
    fn quality_lines(&self, fit: &Fit) -> String {
        let quality = Quality::of(fit);
        let mut text = labelled("quality", &format!("{}: {quality}", quality.word()));
        text += &labelled(
            "error",
            &format!(
                "rms {} % of the rms of f_r cos theta (sqrt(E); E = {} % by eq. (5))",
                two_digits(fit.rms_percent()),
                shortest_percent(fit.e_percent)
            ),
        );
        if fit.accepted_rms_percent() < fit.rms_percent() {
            text += &labelled(
                "",
                &format!(
                    "without the rejected readings, which the quality is of: rms {} %",
                    two_digits(fit.accepted_rms_percent())
                ),
            );
        }
        if let Some(deviations) = &self.deviations {
            text += &labelled(
                "",
                &format!(
                    "half of the readings are within {} %, 90 % within {} % of the measured f_r",
                    two_digits(deviations.median_percent),
                    two_digits(deviations.ninety_percent)
                ),
            );
        }
        if let Some(relative) = &fit.relative {
            text += &labelled(
                "",
                &format!(
                    "fitted with weights of relative errors; E is least, rms {} %, at k2 {}, kD {}, k1 {}",
                    two_digits(10.0 * relative.least_squares_e_percent.sqrt()),
                    digits(relative.least_squares.k2),
                    digits(relative.least_squares.kd),
                    digits(relative.least_squares.k1)
                ),
            );
        }
        text
    }

    /// How much better weights of relative errors would determine the parameters.
    fn gain_line(&self) -> String {
        let gains: Vec<String> = self
            .gain_of_relative_weights
            .iter()
            .filter(|(_, gain)| *gain > 1.1)
            .map(|(parameter, gain)| format!("{parameter} {} times", two_digits(*gain)))
            .collect();
        if gains.is_empty() {
            return String::new();
        }
        let gains = parameters::listed(&gains);
        labelled(
            "",
            &format!("weights of relative errors would determine the parameters better: {gains}"),
        )
    }

    fn heading(&self) -> String {
        let title = match self.metadata.get("sample") {
            Some(sample) => format!("{}: {sample}", self.file),
            None => self.file.clone(),
        };
        let mut parts = vec![
            self.wavelength_um
                .map_or_else(|| "wavelength not stated".to_owned(), |w| format!("{w} um")),
        ];
        if let Some(fit) = &self.fit {
            parts.push(refractive_index(fit));
            if fit.model() != Model::Three {
                let description = fit.model().description();
                parts.push(format!("model {}: {description}", fit.model()));
            }
        }
        let readings = counted(self.readings, "reading");
        parts.push(format!("{readings} of f_r in 1/sr"));
        let Convention {
            theta_positive,
            phi_zero,
        } = self.convention;
        parts.push(format!("theta positive {}", side(theta_positive)));
        if phi_zero == Side::Forward {
            parts.push(format!("phi zero {}", side(phi_zero)));
        }
        wrapped("", &title, 2) + &wrapped("  ", &parts.join(", "), 4)
    }
}

fn side(side: Side) -> &'static str {
    match side {
        Side::Source => "on the side of the source",
        Side::Forward => "on the side of the mirror direction",
    }
}

/// The width of the text, in characters.
const WIDTH: usize = 100;

/// The width of a label and the indent of what it labels.
const INDENT: usize = 12;

/// A sentence behind a label, wrapped to the width of the text.
fn labelled(label: &str, sentence: &str) -> String {
    let label = format!("  {label:<width$}", width = INDENT - 2);
    let text = wrapped(&label, sentence, INDENT);
    if sentence.is_empty() {
        String::new()
    } else {
        text
    }
}

/// A line that begins with a label, wrapped at blanks to the width of the text; what follows is
/// indented.
fn wrapped(label: &str, sentence: &str, indent: usize) -> String {
    let mut text = label.to_owned();
    let mut column = label.chars().count();
    for (i, word) in sentence.split(' ').enumerate() {
        let length = word.chars().count();
        if i > 0 && column + 1 + length > WIDTH {
            let _ = write!(text, "\n{:indent$}", "");
            column = indent;
        } else if i > 0 {
            text.push(' ');
            column += 1;
        }
        text += word;
        column += length;
    }
    text.push('\n');
    text
}

fn not_empty(sections: Vec<(&'static str, String)>) -> Vec<Section> {
    sections
        .into_iter()
        .filter(|(_, text)| !text.is_empty())
        .map(|(title, text)| Section { title, text })
        .collect()
}

/// E in percent with three significant digits.
fn shortest_percent(e_percent: f64) -> String {
    rounded(e_percent, 0.05 * e_percent)
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

/// What is not as in a fit with the default options.
fn fit_lines(fit: &Fit) -> String {
    let parts = fit_options(fit);
    if parts.is_empty() {
        return String::new();
    }
    labelled("fit", &parts.join("; "))
}

/// The clauses of [`fit_lines`].
pub(super) fn fit_options(fit: &Fit) -> Vec<String> {
    let mut parts = Vec::new();
    if let Some(scope) = fit.options.scope() {
        parts.push(format!(
            "stage 1 alone, {scope}: {}",
            counted(fit.readings, "reading")
        ));
    }
    if !fit.options.fixed.is_empty() {
        parts.push(format!("fixed: {}", fit.options.fixed));
    }
    let weights = fit.options.weights.to_string();
    if !weights.is_empty() {
        parts.push(format!("readings weighted by {weights}"));
    }
    if let Some(robust) = &fit.robust {
        parts.push(format!(
            "robust ({} loss): {} rejected",
            robust.loss,
            counted(robust.rejected.len(), "reading")
        ));
    }
    if let Some(energy) = &fit.energy {
        let effect = if energy.binding {
            "constrains the fit"
        } else {
            "is met by the unconstrained fit"
        };
        parts.push(format!(
            "rho(psi) <= 1 up to {} deg {effect}",
            energy.limit_deg
        ));
    }
    parts
}

fn stages_section(fit: &Fit) -> String {
    let mut text = format!("\n{}", stages::detailed(fit).text());
    if let Some(reason) = &fit.stage1_left_out {
        let _ = writeln!(text, "  stage 1 skipped: {reason}");
    } else if fit.stage1.is_some() {
        let limit = in_degrees(fit.options.stage1_limit);
        let _ = writeln!(text, "  stage 1: psi <= {limit} deg");
    }
    let _ = writeln!(text, "  initial values: {}", fit.initial);
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

fn incidences_section(
    fit: &Fit,
    deviations: Option<&Deviations>,
    assessment: Option<&Assessment>,
) -> String {
    let mut text = String::new();
    for table in incidences::side_by_side(fit, deviations, assessment) {
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

/// The parameters, the errors that their intervals come from, and what they rest on.
fn parameters_section(uncertainty: &Uncertainty, assessment: Option<&Assessment>) -> String {
    let table = parameters::table(uncertainty, assessment).text();
    let notes = parameters_notes(uncertainty, assessment);
    let labels = std::iter::once("intervals").chain(std::iter::repeat(""));
    let notes = labels
        .zip(&notes)
        .map(|(label, note)| labelled(label, note));
    format!("\n{table}{}", notes.collect::<String>())
}

/// What the intervals come from, and what the parameters rest on, as clauses.
pub(super) fn parameters_notes(
    uncertainty: &Uncertainty,
    assessment: Option<&Assessment>,
) -> Vec<String> {
    let mut notes: Vec<String> = no_interval(uncertainty)
        .map(str::to_owned)
        .into_iter()
        .collect();
    if let (Some(errors), false) = (&uncertainty.errors, uncertainty.covariance.is_empty()) {
        notes.push(sources(errors, uncertainty));
    }
    notes.extend(assessment.map_or_else(Vec::new, |a| parameters::reliance(uncertainty, a)));
    if let Some(n) = uncertainty.estimate(Parameter::N) {
        notes.push(format!(
            "n = {} is an effective index: it stands in for what the model lacks (the binders of \
             paints have 1.4 to 1.7)",
            digits(n.value)
        ));
    }
    notes
}

fn no_interval(uncertainty: &Uncertainty) -> Option<&str> {
    let mut estimates = uncertainty.estimates.iter();
    estimates.find_map(|estimate| match &estimate.knowledge {
        Knowledge::NoInterval { reason } => Some(reason.as_str()),
        _ => None,
    })
}

/// The errors that the intervals come from.
fn sources(errors: &ErrorSizes, uncertainty: &Uncertainty) -> String {
    let mut parts = Vec::new();
    let all = [
        errors.proportional_percent,
        errors.patch_percent,
        errors.incidence_percent.unwrap_or(0.0),
        errors.constant_percent,
        errors.counting_percent,
    ];
    let largest = all.into_iter().fold(0.0, f64::max);
    let mut part = |percent: f64, of: &str| {
        if percent > 0.1 * largest {
            parts.push(format!("{} % {of}", two_digits(percent)));
        }
    };
    part(errors.proportional_percent, "per reading");
    part(errors.patch_percent, "per stretch of 20 deg");
    part(errors.incidence_percent.unwrap_or(0.0), "per incidence");
    part(errors.constant_percent, "of the rms reading, constant");
    part(
        errors.counting_percent,
        "like counting statistics at the rms reading",
    );
    if let Some(factor) = errors.stated_factor {
        let factor = two_digits(factor);
        parts.insert(0, format!("{factor} times the stated standard deviations"));
    }
    let errors_of = if parts.is_empty() {
        "rounding".to_owned()
    } else {
        parts.join(", ")
    };
    let alone = errors.incidence_percent.is_none();
    format!(
        "from errors of {errors_of}, estimated from the residuals ({}){}",
        degrees(uncertainty),
        if alone {
            "; one incidence: an error of its gain is not included"
        } else {
            ""
        }
    )
}

/// The degrees of freedom of the intervals: `t, 10 to 41 degrees of freedom`.
fn degrees(uncertainty: &Uncertainty) -> String {
    let estimates = uncertainty.estimates.iter();
    let all = estimates.filter_map(|estimate| match estimate.knowledge {
        Knowledge::Determined {
            degrees_of_freedom, ..
        } => degrees_of_freedom,
        _ => None,
    });
    let (least, most) = all.fold((f64::INFINITY, 0.0_f64), |(least, most), degrees| {
        (least.min(degrees), most.max(degrees))
    });
    if least > most {
        return "no parameter is determined".to_owned();
    }
    let (least, most) = (format!("{least:.0}"), format!("{most:.0}"));
    if least == most {
        format!("t, {least} degrees of freedom")
    } else {
        format!("t, {least} to {most} degrees of freedom")
    }
}

/// Whether the residuals contradict independent errors of constant size.
fn noise_lines(uncertainty: &Uncertainty) -> String {
    if let Noise::Given { reduced_chi_square } = uncertainty.noise {
        let chi =
            format!("reduced chi^2 of the stated standard deviations: {reduced_chi_square:.2}");
        return labelled("noise", &chi);
    }
    let (Some(tests), Some(errors)) = (&uncertainty.tests, &uncertainty.errors) else {
        return String::new();
    };
    let mut all = Vec::new();
    let share = two_digits;
    if tests.grows() {
        all.push(format!(
            "the errors grow with the reading ({}): {} % of it, not constant",
            significance(tests.growth_p),
            share(errors.proportional_percent)
        ));
    }
    let neighbours = tests.patch_p.filter(|_| tests.neighbours_err_together()).map(|p| {
        format!(
            "neighbouring readings err together, by {} % ({}): the model misses the shape, or the \
             instrument's errors are correlated",
            share(errors.patch_percent),
            significance(p)
        )
    });
    let of_incidence = errors.incidence_percent.unwrap_or(0.0);
    let incidences = tests.incidence_p.filter(|_| tests.incidences_differ()).map(|p| {
        format!(
            "whole incidences lie high or low together, by {} % ({}): gain or alignment of each \
             incidence, or the model",
            share(of_incidence),
            significance(p)
        )
    });
    if of_incidence > errors.patch_percent {
        all.extend(incidences.into_iter().chain(neighbours));
    } else {
        all.extend(neighbours.into_iter().chain(incidences));
    }
    if all.is_empty() {
        all.push(
            "nothing contradicts independent errors of constant size in f_r cos theta (three tests, \
             1 %)"
                .to_owned(),
        );
    }
    let labels = std::iter::once("noise").chain(std::iter::repeat(""));
    labels
        .zip(&all)
        .map(|(label, sentence)| labelled(label, sentence))
        .collect()
}

fn significance(p: f64) -> String {
    if p < 0.001 {
        "p < 0.001".to_owned()
    } else {
        format!("p = {p:.3}")
    }
}

/// The verdict on the models.
fn verdict_lines(fit: &Fit, assessment: &Assessment) -> String {
    labelled("verdict", &verdict_sentence(fit, assessment))
}

/// The verdict, and how well the fitted model predicts where it is another.
pub(super) fn verdict_sentence(fit: &Fit, assessment: &Assessment) -> String {
    let Some(verdict) = &assessment.verdict else {
        return "none: too few incidences to predict one from the others".to_owned();
    };
    let mut models = assessment.models.iter();
    let own = models
        .find(|candidate| candidate.model == fit.model())
        .filter(|candidate| Some(candidate.model) != verdict.model)
        .and_then(|candidate| candidate.relative_prediction.as_ref());
    let own = own.map_or_else(String::new, |own| {
        let within = two_digits(own.within_percent());
        format!("; {} predicts within {within} %", fit.model())
    });
    format!("{verdict}{own}")
}

/// The correlations of the parameters.
fn correlation_line(uncertainty: &Uncertainty) -> String {
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
        return String::new();
    }
    format!("  correlations: {}\n", pairs.join(", "))
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
    let rms = |e_percent: f64| two_digits(10.0 * e_percent.sqrt());
    let _ = match &assessment.cross_validation {
        Some(prediction) => writeln!(
            text,
            "\n  leave-one-incidence-out cross-validation: rms {} % (fit to all incidences: {} %)",
            rms(prediction.e_percent),
            rms(assessment.e_percent)
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

/// The compared models.
fn models_section(assessment: &Assessment) -> String {
    let mut table = models::compact(assessment);
    table.notes.push(models::legend());
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
            assert!(
                report.detailed_text().ends_with(&texts) && report.text().starts_with("synthetic")
            );
            sections.iter().map(|section| section.title).collect()
        };
        scan.source = "synthetic".to_owned();
        let (failed, _) = Report::new(&scan, &options, Depth::Fit);
        assert_eq!(titles(&failed), ["reading", "error"]);
        options.refractive_index = Some(RefractiveIndex::Same(1.5));
        let (report, _) = Report::new(&scan, &options, Depth::Assessed);
        let all = [
            "reading",
            "quality",
            "parameters",
            "noise",
            "verdict",
            "warnings",
            "stages",
            "incidences",
            "global check and options",
            "correlations",
            "models",
            "reflectance",
        ];
        assert_eq!(titles(&report), all);
    }
}
