//! What is said about the options, the intervals, the errors and the models, as clauses.

use super::parameters;
use crate::fit::Fit;
use crate::format::{counted, digits, shortest, two_digits};
use crate::inference::{Assessment, ErrorSizes, Knowledge, Noise, Uncertainty};
use crate::model::Parameter;

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
pub(super) fn noise_clauses(uncertainty: &Uncertainty) -> Vec<String> {
    if let Noise::Given { reduced_chi_square } = uncertainty.noise {
        let chi =
            format!("reduced chi^2 of the stated standard deviations: {reduced_chi_square:.2}");
        return vec![chi];
    }
    let (Some(tests), Some(errors)) = (&uncertainty.tests, &uncertainty.errors) else {
        return Vec::new();
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
    all
}

fn significance(p: f64) -> String {
    if p < 0.001 {
        "p < 0.001".to_owned()
    } else {
        format!("p = {p:.3}")
    }
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
