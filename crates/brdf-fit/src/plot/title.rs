//! What a figure shows, in the two lines above it, the lines below it and its caption.

use std::path::Path;

use super::canvas::{Canvas, render};
use super::palette::Ground;
use super::style::{LINE_SPACING, SIZE, TEXT, TITLE};
use super::svg::Anchor;
use super::text::{four_digits, shortened};
use crate::fit::Fit;
use crate::model::{Model, Parameter};
use crate::scan::Measurements;

/// The most letters of the name of a sample: more do not fit above the figure.
pub(super) const LONGEST_SAMPLE: usize = 105;

/// The left edge of the text above and below the figure.
pub(super) const LEFT: f64 = 20.0;

/// What a figure shows.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Title {
    /// The sample.
    pub(super) sample: String,
    /// Wavelength, model and parameters.
    pub(super) details: String,
    /// The theory as part of a caption.
    pub(super) theory: String,
    /// Where there are several samples, a line for each.
    pub(super) samples: Vec<String>,
    /// The background of the figure.
    pub(super) ground: Ground,
}

impl Title {
    /// The title of the figures of a fit.
    pub(super) fn of(measurements: &Measurements, fit: &Fit) -> Self {
        let model = fit.model();
        Self {
            sample: shortened(&sample(measurements), LONGEST_SAMPLE),
            details: format!(
                "{}model {model}: {}, E = {} %",
                wavelength(fit.wavelength_um),
                parameters(fit),
                four_digits(fit.e_percent)
            ),
            theory: format!("model {model}, {}{}", model.description(), conditions(fit)),
            samples: Vec::new(),
            ground: Ground::Light,
        }
    }

    /// The SVG of a figure with this title.
    pub(super) fn render(&self, draw: impl FnOnce(&mut Canvas)) -> String {
        let lines = u32::try_from(self.samples.len()).unwrap_or(0);
        // Half a line more keeps the last line off the edge.
        let footer = if lines > 0 { 20 * lines + 10 } else { 0 };
        render(footer, self.ground, |canvas| {
            self.draw(canvas);
            draw(canvas);
        })
    }

    /// Writes the lines above and below the figure.
    pub(super) fn draw(&self, canvas: &mut Canvas) {
        canvas.text(&self.sample, (LEFT, 22.0), TITLE, Anchor::Start);
        canvas.text(&self.details, (LEFT, 45.0), TEXT, Anchor::Start);
        for (i, sample) in self.samples.iter().enumerate() {
            let y = f64::from(SIZE.1) + LINE_SPACING * (i as f64 + 0.5);
            canvas.text(sample, (LEFT, y), TEXT, Anchor::Start);
        }
    }
}

/// The name of the sample, or else of its file.
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

fn wavelength(wavelength_um: Option<f64>) -> String {
    wavelength_um.map_or_else(String::new, |w| format!("{w} um, "))
}

/// The parameters that the model fits, and n where the model depends on it.
fn parameters(fit: &Fit) -> String {
    let (model, at) = (fit.model(), fit.at());
    let shown = Parameter::ALL.into_iter().filter(|&parameter| {
        model.frees(parameter) || parameter == Parameter::N && model != Model::Lambert
    });
    let texts = shown.map(|parameter| {
        let fixed = fit.options.fixed.get(parameter).map_or("", |_| " (fixed)");
        format!("{parameter} = {}{fixed}", four_digits(parameter.of(&at)))
    });
    texts.collect::<Vec<_>>().join(", ")
}

/// The fixed parameters and the readings that were fitted, as part of a caption.
fn conditions(fit: &Fit) -> String {
    let fixed = &fit.options.fixed;
    let fixed = (!fixed.is_empty()).then(|| format!(", {fixed} fixed"));
    let scope = fit.options.scope();
    let scope = scope.map(|scope| format!(", fitted to {scope} alone"));
    fixed.into_iter().chain(scope).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scan_without_a_name_is_named_after_its_file() {
        let scan = Measurements {
            source: "folder/paint_7.csv".to_owned(),
            ..Measurements::default()
        };
        assert_eq!(sample(&scan), "paint_7");
    }
}
