//! What a report tells on request: the stages, the incidences, the checks, the compared models and the
//! reflectance.

use std::fmt::Write as _;

use brdf_core::Parameters;

use super::{incidences, models, stages};
use crate::fit::robust::REJECTED;
use crate::fit::{Fit, rms_percent};
use crate::format::{counted, digits, exact, fixed, in_degrees, shortest, two_digits};
use crate::inference::{Assessment, Deviations, Physics, Uncertainty};
use crate::model::{K1_RANGE, Parameter};
use crate::objective::MOST_FOLDS;
use crate::scan::Measurement;

pub(super) fn stages_section(fit: &Fit) -> String {
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

pub(super) fn incidences_section(
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

pub(super) fn global_check_line(fit: &Fit) -> String {
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
pub(super) fn options_lines(fit: &Fit, rejected: &[Measurement]) -> String {
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
                "    psi {} deg, theta {} deg, phi {} deg: {} 1/sr, residual {} standard deviations",
                in_degrees(reading.psi),
                in_degrees(reading.theta),
                in_degrees(reading.phi),
                exact(reading.brdf),
                fixed(rejected.deviations, 1)
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

/// The correlations of the parameters.
pub(super) fn correlation_line(uncertainty: &Uncertainty) -> String {
    let correlations = uncertainty.correlations();
    let mut pairs = Vec::new();
    for (i, first) in uncertainty.covered.iter().enumerate() {
        for (j, second) in uncertainty.covered.iter().enumerate().skip(i + 1) {
            let value = correlations.get(i).and_then(|row| row.get(j));
            // Variances may be larger than any number.
            if let Some(value) = value.filter(|value| value.is_finite()) {
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
pub(super) fn cross_validation_lines(fit: &Fit, assessment: &Assessment) -> String {
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
    let rms = |e_percent: f64| two_digits(rms_percent(e_percent));
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
pub(super) fn models_section(assessment: &Assessment) -> String {
    let mut table = models::compact(assessment);
    table.notes.push(models::legend());
    format!("\n{}", table.text())
}

pub(super) fn physics_lines(physics: &Physics, fit: &Fit) -> String {
    let values: Vec<String> = physics
        .reflectance
        .iter()
        .map(|point| format!("{} at {}", fixed(point.rho, 3), point.psi_deg))
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
