//! The report as plain text, in sections.

use super::details::{
    correlation_line, cross_validation_lines, global_check_line, incidences_section,
    models_section, options_lines, physics_lines, stages_section,
};
use super::layout::{labelled, wrapped};
use super::parameters;
use super::run::Report;
use super::sentences::{
    fit_options, noise_clauses, parameters_notes, refractive_index, verdict_sentence,
};
use crate::fit::{Fit, rms_percent};
use crate::format::{counted, digits, rounded, two_digits};
use crate::inference::{Assessment, Quality, Uncertainty, Warning};
use crate::model::Model;
use crate::scan::{Convention, Side};

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
                    two_digits(rms_percent(relative.least_squares_e_percent)),
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

/// What is not as in a fit with the default options.
fn fit_lines(fit: &Fit) -> String {
    let parts = fit_options(fit);
    if parts.is_empty() {
        return String::new();
    }
    labelled("fit", &parts.join("; "))
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

/// Whether the residuals contradict independent errors of constant size.
fn noise_lines(uncertainty: &Uncertainty) -> String {
    let clauses = noise_clauses(uncertainty);
    let labels = std::iter::once("noise").chain(std::iter::repeat(""));
    labels
        .zip(&clauses)
        .map(|(label, clause)| labelled(label, clause))
        .collect()
}

/// The verdict on the models.
fn verdict_lines(fit: &Fit, assessment: &Assessment) -> String {
    labelled("verdict", &verdict_sentence(fit, assessment))
}

#[cfg(test)]
mod tests {
    use brdf_core::Parameters;

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
