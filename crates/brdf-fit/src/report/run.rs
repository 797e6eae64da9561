//! The report on one wavelength of one file: the fit with everything that is computed from it.

use serde::{Deserialize, Serialize};

use crate::fit::{Fit, FitError, FitOptions, fit_scan};
use crate::inference::{Assessment, Deviations, Estimate, Quality, Uncertainty, Warning};
use crate::inference::{MOST_READINGS, Tests, assess_observed, sufficient_model, warnings};
use crate::model::{Model, Parameter};
use crate::objective::weights::AssumedErrors;
use crate::progress::{Cancelled, NoObserver, Observer, Phase, Progress};
use crate::scan::{Convention, Format, Measurement, Measurements, Metadata, ReadSettings};
use crate::solver::Termination;

/// The result for one wavelength of one file.
///
/// ```
/// use brdf_core::Parameters;
/// use brdf_fit::report::{Depth, Report};
/// use brdf_fit::synthetic::scan;
/// use brdf_fit::{FitOptions, RefractiveIndex};
///
/// let measurements = scan(Parameters::new(0.3, 0.1, 0.2)?, 1.5);
/// let options = FitOptions {
///     refractive_index: Some(RefractiveIndex::Same(1.5)),
///     ..FitOptions::default()
/// };
/// let (report, error) = Report::new(&measurements, &options, Depth::Fit);
/// assert_eq!(error, None);
/// assert_eq!(report.status(), "ok");
/// println!("{}", report.text());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Name of the file.
    pub file: String,
    /// Metadata from the file, such as the name of the sample.
    pub metadata: Metadata,
    /// Columns of the file that are not used.
    pub ignored_columns: Vec<String>,
    /// Angular convention with which the file was read.
    #[serde(default)]
    pub convention: Convention,
    /// Format of the file.
    #[serde(default)]
    pub format: Format,
    /// What was said about the file when it was read.
    #[serde(
        default,
        rename = "reading",
        skip_serializing_if = "ReadSettings::is_empty"
    )]
    pub read_settings: ReadSettings,
    /// Conversions and omissions made while the file was read, one sentence each.
    #[serde(default)]
    pub conversions: Vec<String>,
    /// Wavelength in micrometres, if the file states one.
    pub wavelength_um: Option<f64>,
    /// The model requested or, with [`ModelChoice::Auto`], chosen.
    #[serde(default)]
    pub model: Model,
    /// Number of readings at this wavelength, without those that are left out.
    pub readings: usize,
    /// The indices of the readings at this wavelength that the user has left out, from 0 in the order of
    /// the file: see [`Measurements::without`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<usize>,
    /// The fit; `None` if it failed.
    pub fit: Option<Fit>,
    /// Message of the error that prevented or interrupted the fit or its assessment.
    pub error: Option<String>,
    /// Warnings about the data and the fit.
    pub warnings: Vec<Warning>,
    /// Standard errors and confidence intervals; `None` if no parameter was fitted.
    #[serde(default)]
    pub uncertainty: Option<Uncertainty>,
    /// By which factors the standard errors of the parameters would shrink with the weights of relative
    /// errors, where the errors grow with the reading and the model describes the sample; else empty.
    #[serde(default)]
    pub gain_of_relative_weights: Vec<(Parameter, f64)>,
    /// The relative errors of the fit; `None` below [`Depth::Assessed`].
    #[serde(default)]
    pub deviations: Option<Deviations>,
    /// Cross-validation, physical plausibility and model comparison; `None` below [`Depth::Assessed`].
    #[serde(default)]
    pub assessment: Option<Assessment>,
    /// The readings that a robust fit rejects.
    #[serde(default)]
    pub rejected: Vec<Measurement>,
}

/// How much a report computes beside the fit and its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Depth {
    /// Nothing.
    Fit,
    /// The tests of the noise.
    Tested,
    /// The assessment, with all models of the hierarchy.
    Assessed,
    /// The assessment, with the reference models as well.
    Compared,
}

/// Which model a report fits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelChoice {
    /// The model of the options.
    Given,
    /// The smallest model of the hierarchy that predicts incidences outside the fit about as well as
    /// the best of them: see [`Verdict`](crate::inference::Verdict).
    Auto,
}

impl Report {
    /// Fits one wavelength with the model of the options and reports on it.
    ///
    /// If the fit fails, its error is returned beside the report, which then contains the message and
    /// whatever was complete.
    pub fn new(
        measurements: &Measurements,
        options: &FitOptions,
        depth: Depth,
    ) -> (Self, Option<FitError>) {
        Self::observed(
            measurements,
            options,
            ModelChoice::Given,
            depth,
            &NoObserver,
        )
    }

    /// [`new`](Self::new) with a choice of the model and with progress reports.
    ///
    /// Each iteration is reported to `observer`, which may cancel the computation. The error is then
    /// [`FitError::Cancelled`], and the report contains whatever was complete.
    pub fn observed(
        measurements: &Measurements,
        options: &FitOptions,
        choice: ModelChoice,
        depth: Depth,
        observer: &dyn Observer,
    ) -> (Self, Option<FitError>) {
        Self::observed_in_parts(measurements, options, choice, depth, observer, &|_| {})
    }

    /// [`observed`](Self::observed), which also calls `on_fit` with the report as soon as the fit, its
    /// intervals and its warnings are complete: the rest of the analysis takes much longer.
    pub fn observed_in_parts(
        measurements: &Measurements,
        options: &FitOptions,
        choice: ModelChoice,
        depth: Depth,
        observer: &dyn Observer,
        on_fit: &dyn Fn(&Self),
    ) -> (Self, Option<FitError>) {
        let mut report = Self {
            file: measurements.source.clone(),
            metadata: measurements.metadata.clone(),
            ignored_columns: measurements.ignored_columns.clone(),
            convention: measurements.convention,
            format: measurements.format,
            read_settings: measurements.read_settings.clone(),
            conversions: measurements.conversions.clone(),
            wavelength_um: measurements.wavelengths().first().copied().flatten(),
            readings: measurements.readings().len(),
            left_out: Vec::new(),
            model: options.model,
            warnings: Vec::new(),
            fit: None,
            error: None,
            uncertainty: None,
            gain_of_relative_weights: Vec::new(),
            deviations: None,
            assessment: None,
            rejected: Vec::new(),
        };
        let filled = match choice {
            ModelChoice::Given => report.fill(measurements, options, depth, observer, on_fit),
            ModelChoice::Auto => report.fill_chosen(measurements, options, depth, observer, on_fit),
        };
        let error = filled.err();
        report.error = error.as_ref().map(ToString::to_string);
        (report, error)
    }

    fn fill_chosen(
        &mut self,
        measurements: &Measurements,
        options: &FitOptions,
        depth: Depth,
        observer: &dyn Observer,
        on_fit: &dyn Fn(&Self),
    ) -> Result<(), FitError> {
        // If no model can be fitted, this is the paper's, whose fit reports why.
        self.model = sufficient_model(measurements, options, observer)?;
        self.fill(
            measurements,
            &options.with_model(self.model),
            depth,
            observer,
            on_fit,
        )
    }

    fn fill(
        &mut self,
        measurements: &Measurements,
        options: &FitOptions,
        depth: Depth,
        observer: &dyn Observer,
        on_fit: &dyn Fn(&Self),
    ) -> Result<(), FitError> {
        let fitted = fit_scan(measurements, options, observer)?;
        if let Some(robust) = &fitted.fit.robust {
            let readings = measurements.readings();
            let rejected = robust.rejected.iter().map(|r| readings[r.reading]);
            self.rejected = rejected.collect();
        }
        let fit = fitted.fit.clone();
        self.fit = Some(fit.clone());
        let progress = Progress::begin(observer, Phase::Uncertainty)?;
        let tests = if depth > Depth::Fit {
            Tests::Made
        } else {
            Tests::Omitted
        };
        let uncertainty = Uncertainty::of_fit(measurements, &fitted, tests, &progress)?;
        let fitted_readings = options.fitted_readings(measurements);
        self.warnings = warnings(&fitted_readings, fitted, &uncertainty, &progress)?;
        self.uncertainty = Some(uncertainty).filter(|u| !u.estimates.is_empty());
        on_fit(self);
        if depth >= Depth::Assessed {
            self.deviations = Deviations::of(&fitted_readings, &fit);
            if let Some(uncertainty) = &self.uncertainty {
                self.gain_of_relative_weights =
                    gain_of_relative_weights(measurements, &fit, uncertainty, &progress)?;
            }
            let compare = depth == Depth::Compared;
            self.assessment = Some(assess_observed(measurements, &fit, compare, observer)?);
        }
        Ok(())
    }

    /// How the fit ended, in one word: `ok`; `global` if the global check replaced the result by a
    /// lower minimum; `iteration-limit`; each followed by ` (stage 1 alone)` if stage 2 was not
    /// requested. If there is no fit: `failed: ` and the error.
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

/// [`Report::gain_of_relative_weights`].
fn gain_of_relative_weights(
    measurements: &Measurements,
    fit: &Fit,
    uncertainty: &Uncertainty,
    progress: &Progress<'_>,
) -> Result<Vec<(Parameter, f64)>, Cancelled> {
    let grows = uncertainty.tests.is_some_and(|tests| tests.grows());
    let applies = fit.options.weights.errors == AssumedErrors::Constant
        && fit.robust.is_none()
        && Quality::of(fit) == Quality::Good;
    if !(grows && applies) {
        return Ok(Vec::new());
    }
    let mut options = fit.options.clone();
    options.weights.errors = AssumedErrors::Relative;
    // The standard errors of a large scan are inferred from a part of its readings: so is this fit.
    let large = measurements.readings().len() > MOST_READINGS && !measurements.is_table();
    let few = large.then(|| measurements.thinned(MOST_READINGS));
    let mut fitted = match fit_scan(few.as_ref().unwrap_or(measurements), &options, progress) {
        Ok(fitted) => fitted,
        Err(FitError::Cancelled) => return Err(Cancelled),
        Err(_) => return Ok(Vec::new()),
    };
    // The errors are nevertheless those of a fit of all readings.
    (fitted.fit.readings, fitted.fit.zero_weight) = (fit.readings, fit.zero_weight);
    let relative = Uncertainty::of_fit(measurements, &fitted, Tests::Omitted, progress)?;
    let gain = |estimate: &Estimate| {
        let other = relative.estimate(estimate.parameter)?.standard_error()?;
        Some((estimate.parameter, estimate.standard_error()? / other))
    };
    Ok(uncertainty.estimates.iter().filter_map(gain).collect())
}
