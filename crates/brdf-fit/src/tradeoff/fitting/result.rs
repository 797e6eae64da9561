//! The results of a trade-off of fitting.

use brdf_core::ModelParameters;
use serde::Serialize;

use super::error::TrialError;
use crate::model::Parameter;

/// A comparison of the ways to fit one wavelength of a scan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitTradeoff {
    /// The source of the readings: the path of a file, or the caller's name for them.
    pub source: String,
    /// The name of the sample, where the file states it.
    pub sample: Option<String>,
    /// Wavelength in micrometres, where the scan states one.
    pub wavelength_um: Option<f64>,
    /// The fit with which the alternatives are compared.
    pub reference: Reference,
    /// The alternatives, the first of which is the reference itself.
    pub alternatives: Vec<Alternative>,
}

/// The result of the reference: Levenberg-Marquardt in both stages, and the global check.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reference {
    /// The fitted parameters.
    pub parameters: ModelParameters,
    /// The standard error of each fitted parameter.
    pub standard_errors: Vec<OfParameter>,
    /// E over all readings, in percent.
    pub e_percent: f64,
    /// The number of readings.
    pub readings: usize,
    /// The number of incidences.
    pub incidences: usize,
    /// Whether the global check replaced the minimum of the stages by a lower one.
    pub lower_minimum_taken: bool,
}

/// A number for one fitted parameter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OfParameter {
    /// The parameter.
    pub parameter: Parameter,
    /// The number; `None` where the parameter has no standard error, as on its bound, or where E is
    /// that of rounding.
    pub value: Option<f64>,
}

/// One way to fit the scan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Alternative {
    /// A short description.
    pub name: String,
    /// `levenberg-marquardt`, `nelder-mead`, both in their order with a comma, or `profile`.
    pub method: String,
    /// `both`, `all incidences only` or `stage 1 only`.
    pub stages: String,
    /// Whether the global check follows the stages.
    pub global_check: bool,
    /// Largest number of iterations of each stage.
    pub max_iterations: u64,
    /// The number of readings that are fitted.
    pub readings: usize,
    /// The number of their incidences.
    pub incidences: usize,
    /// The result.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// The result of one way to fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Outcome {
    /// The fit succeeded.
    Fitted(Box<Measured>),
    /// The fit failed.
    Failed {
        /// Why; in JSON the message.
        error: TrialError,
    },
}

/// The time and the accuracy of a fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measured {
    /// Time of the fit on one thread, the median of several runs, in seconds.
    pub seconds: f64,
    /// The number of runs.
    pub runs: usize,
    /// E of the parameters over all readings of the scan, in percent.
    pub e_percent: f64,
    /// E / (lowest E of all alternatives) - 1; zero below 1e-9, which is the rounding of E.
    pub excess_e: f64,
    /// The fitted parameters.
    pub parameters: ModelParameters,
    /// The shift of each fitted parameter from the reference, in standard errors of the reference.
    pub shift_in_sigma: Vec<OfParameter>,
    /// Whether the last stage ended at a minimum over its readings, and not at its iteration limit.
    pub converged: bool,
    /// Why the fit ended.
    pub ended_by: String,
    /// Whether the fit is on the Pareto front of time and excess E.
    pub pareto: bool,
}

impl Alternative {
    /// The measurement of a fit that succeeded.
    pub fn measured(&self) -> Option<&Measured> {
        match &self.outcome {
            Outcome::Fitted(measured) => Some(measured),
            Outcome::Failed { .. } => None,
        }
    }

    pub(super) fn measured_mut(&mut self) -> Option<&mut Measured> {
        match &mut self.outcome {
            Outcome::Fitted(measured) => Some(measured),
            Outcome::Failed { .. } => None,
        }
    }
}
