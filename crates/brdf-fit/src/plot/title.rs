//! The two lines above a figure.

use std::path::Path;

use crate::fit::Fit;
use crate::model::{Model, Parameter};
use crate::scan::Measurements;

/// A longer name of a sample is cut: it would not fit above the figure.
const LONGEST: usize = 105;

/// What a figure is of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Title {
    /// The sample.
    pub(super) sample: String,
    /// Wavelength, model and parameters.
    pub(super) details: String,
    /// The theory in the words of a caption.
    pub(super) theory: String,
    /// Of several samples a line each, below the figure.
    pub(super) samples: Vec<String>,
}

impl Title {
    pub(super) fn of(measurements: &Measurements, fit: &Fit) -> Self {
        let model = fit.model();
        Self {
            sample: shortened(&sample(measurements)),
            details: format!(
                "{}model {model}: {}, E = {} %",
                wavelength(fit.wavelength_um),
                parameters(fit),
                short(fit.e_percent)
            ),
            theory: format!("model {model}, {}{}", model.description(), particulars(fit)),
            samples: Vec::new(),
        }
    }
}

fn sample(measurements: &Measurements) -> String {
    if let Some(sample) = measurements.metadata.get("sample") {
        return sample.to_owned();
    }
    let stem = Path::new(&measurements.source).file_stem();
    stem.map_or_else(
        || measurements.source.clone(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}

pub(super) fn shortened(name: &str) -> String {
    if name.chars().count() <= LONGEST {
        return name.to_owned();
    }
    let kept: String = name.chars().take(LONGEST - 3).collect();
    kept.trim_end().to_owned() + "..."
}

fn wavelength(wavelength_um: Option<f64>) -> String {
    wavelength_um.map_or_else(String::new, |w| format!("{w} um, "))
}

/// The parameters that the model has, and n where it says anything.
fn parameters(fit: &Fit) -> String {
    let (model, at) = (fit.model(), fit.at());
    let shown = Parameter::ALL
        .into_iter()
        .filter(|&parameter| model.frees(parameter) || shown_fixed(model, parameter));
    let words = shown.map(|parameter| {
        let fixed = fit.options.fixed.get(parameter).map_or("", |_| " (held)");
        format!("{parameter} = {}{fixed}", short(parameter.of(&at)))
    });
    words.collect::<Vec<_>>().join(", ")
}

/// What is held and what was fitted, in the words of a caption.
fn particulars(fit: &Fit) -> String {
    let fixed = &fit.options.fixed;
    let fixed = (!fixed.is_empty()).then(|| format!(", {fixed} held"));
    let scope = fit.options.scope();
    let scope = scope.map(|scope| format!(", fitted to {scope} alone"));
    fixed.into_iter().chain(scope).collect()
}

fn shown_fixed(model: Model, parameter: Parameter) -> bool {
    parameter == Parameter::N && model != Model::Lambert
}

/// Four significant digits.
pub(super) fn short(value: f64) -> String {
    let scientific = format!("{value:.3e}");
    let rounded: f64 = scientific.parse().unwrap_or(value);
    if rounded == 0.0 || (1e-4..1e5).contains(&rounded.abs()) {
        rounded.to_string()
    } else {
        scientific
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        assert_eq!(short(0.022_859_8), "0.02286");
        assert_eq!(short(0.0), "0");
        assert_eq!(short(1e-6), "1.000e-6");
        assert_eq!(short(30.0), "30");
        assert_eq!(short(f64::NAN), "NaN");
    }

    #[test]
    fn long_names_are_cut_between_letters() {
        let name = "\u{3b1}".repeat(300);
        assert_eq!(shortened(&name).chars().count(), LONGEST);
        assert_eq!(shortened("short"), "short");
    }

    #[test]
    fn a_scan_without_a_name_has_that_of_its_file() {
        let scan = Measurements {
            source: "folder/paint_7.csv".to_owned(),
            ..Measurements::default()
        };
        assert_eq!(sample(&scan), "paint_7");
    }
}
