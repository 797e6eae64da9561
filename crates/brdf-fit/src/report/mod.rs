//! What a person or a program reads after the fits: the tables, the JSON, the parameters and the
//! curves as CSV.

mod csv;
mod document;
mod folder;
mod html;
mod text;

pub use csv::{
    CURVE_COLUMNS, MODEL_COLUMNS, PARAMETER_COLUMNS, THEORY_COLUMNS, write_curves, write_models,
    write_parameters, write_theory, write_theory_alone,
};

pub(crate) use document::plain;
pub use document::{Document, DocumentError};
pub use folder::{FolderError, PAGE, figures_of, write_folder};
pub use html::html;
pub use text::Section;

use serde::{Deserialize, Serialize};

use crate::fit::{Fit, FitError, FitOptions, fit_scan};
use crate::inference::{
    Assessment, Uncertainty, Warning, assess_observed, sufficient_model, warnings,
};
use crate::model::Model;
use crate::progress::{NoObserver, Observer, Phase, Progress};
use crate::scan::{Convention, Format};
use crate::scan::{Measurement, Measurements, Metadata};
use crate::solver::Termination;

/// The result of one wavelength of one file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The file.
    pub file: String,
    /// What the file says of itself.
    pub metadata: Metadata,
    /// Columns of the file that were not used.
    pub ignored_columns: Vec<String>,
    /// The angular convention in which the file was read.
    #[serde(default)]
    pub convention: Convention,
    /// The format of the file.
    #[serde(default)]
    pub format: Format,
    /// What was converted on the way from the file to the readings, and what was left out.
    #[serde(default)]
    pub conversions: Vec<String>,
    /// Wavelength in micrometres, where the file states one.
    pub wavelength_um: Option<f64>,
    /// The model that was to be fitted.
    #[serde(default)]
    pub model: Model,
    /// How many readings there are.
    pub readings: usize,
    /// The fit, where there is one.
    pub fit: Option<Fit>,
    /// Why there is none.
    pub error: Option<String>,
    /// What to know before trusting it.
    pub warnings: Vec<Warning>,
    /// How far its parameters can be trusted.
    #[serde(default)]
    pub uncertainty: Option<Uncertainty>,
    /// What it is worth.
    #[serde(default)]
    pub assessment: Option<Assessment>,
    /// The readings that a robust fit rejects.
    #[serde(default)]
    pub rejected: Vec<Measurement>,
}

/// How much a report says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Depth {
    /// The fit alone.
    Fit,
    /// The fit, what it is worth, and the ladder of models.
    Assessed,
    /// The neighbours as well.
    Compared,
}

/// The model of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelChoice {
    /// That of the options.
    Given,
    /// The smallest of the ladder that predicts well enough: see
    /// [`Verdict`](crate::inference::Verdict).
    Auto,
}

impl Report {
    /// Fits one wavelength and reports on it. The error is returned beside the report, which holds
    /// its words.
    pub fn of(
        measurements: &Measurements,
        options: &FitOptions,
        depth: Depth,
    ) -> (Self, Option<FitError>) {
        Self::of_choice(measurements, options, ModelChoice::Given, depth)
    }

    /// [`of`](Self::of) a model that is chosen by the scan itself, where it is asked for.
    pub fn of_choice(
        measurements: &Measurements,
        options: &FitOptions,
        choice: ModelChoice,
        depth: Depth,
    ) -> (Self, Option<FitError>) {
        Self::observed(measurements, options, choice, depth, &NoObserver)
    }

    /// [`of_choice`](Self::of_choice), each step of which is told to `observer`, who can end it with
    /// [`FitError::Cancelled`]: the report then holds what was complete.
    pub fn observed(
        measurements: &Measurements,
        options: &FitOptions,
        choice: ModelChoice,
        depth: Depth,
        observer: &dyn Observer,
    ) -> (Self, Option<FitError>) {
        let mut report = Self {
            file: measurements.source.clone(),
            metadata: measurements.metadata.clone(),
            ignored_columns: measurements.ignored_columns.clone(),
            convention: measurements.convention,
            format: measurements.format,
            conversions: measurements.conversions.clone(),
            wavelength_um: measurements.wavelengths().first().copied().flatten(),
            readings: measurements.readings().len(),
            model: options.model,
            warnings: Vec::new(),
            fit: None,
            error: None,
            uncertainty: None,
            assessment: None,
            rejected: Vec::new(),
        };
        let filled = match choice {
            ModelChoice::Given => report.fill(measurements, options, depth, observer),
            ModelChoice::Auto => report.fill_by_choice(measurements, options, depth, observer),
        };
        let error = filled.err();
        report.error = error.as_ref().map(ToString::to_string);
        (report, error)
    }

    fn fill_by_choice(
        &mut self,
        measurements: &Measurements,
        options: &FitOptions,
        depth: Depth,
        observer: &dyn Observer,
    ) -> Result<(), FitError> {
        // What cannot be fitted at all is told by the paper's model.
        self.model = sufficient_model(measurements, options, observer)?;
        self.fill(measurements, &options.of_model(self.model), depth, observer)
    }

    fn fill(
        &mut self,
        measurements: &Measurements,
        options: &FitOptions,
        depth: Depth,
        observer: &dyn Observer,
    ) -> Result<(), FitError> {
        let fitted = fit_scan(measurements, options, observer)?;
        if let Some(robust) = &fitted.fit.robust {
            let readings = measurements.readings();
            let rejected = robust.rejected.iter().map(|r| readings[r.reading]);
            self.rejected = rejected.collect();
        }
        let fit = self.fit.insert(fitted.fit.clone());
        let progress = Progress::begin(observer, Phase::Uncertainty)?;
        let uncertainty = Uncertainty::of_fit(&fitted, &progress)?;
        let fitted_readings = options.fitted_readings(measurements);
        self.warnings = warnings(&fitted_readings, fit, &uncertainty, &progress)?;
        // Where everything is fixed there is nothing to be uncertain of.
        self.uncertainty = Some(uncertainty).filter(|u| !u.estimates.is_empty());
        if depth > Depth::Fit {
            let compare = depth == Depth::Compared;
            self.assessment = Some(assess_observed(measurements, fit, compare, observer)?);
        }
        Ok(())
    }

    /// One word on how the fit ended: `ok`; `global`, where the global check took a lower minimum;
    /// `iteration-limit`; each with ` (stage 1 alone)` where it is; or `failed: ` and why.
    pub fn status(&self) -> String {
        let Some(fit) = &self.fit else {
            return format!("failed: {}", self.error.as_deref().unwrap_or("no fit"));
        };
        let taken = fit
            .global_check
            .as_ref()
            .is_some_and(|check| check.lower_minimum_taken);
        let word = match fit.last_stage().map(|stage| stage.termination) {
            _ if taken => "global",
            Some(Termination::IterationLimit) => "iteration-limit",
            _ => "ok",
        };
        let alone = if fit.stage2.is_none() {
            " (stage 1 alone)"
        } else {
            ""
        };
        format!("{word}{alone}")
    }
}
