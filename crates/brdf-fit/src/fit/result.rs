//! The result of a fit, with each stage.

use brdf_core::{ModelParameters, Parameters};
use serde::{Deserialize, Serialize};

use super::energy::EnergyConstraint;
use super::grid_search::ProfilePoint;
use super::options::FitOptions;
use super::relative::RelativeFit;
use super::robust::RobustFit;
use super::start::InitialValues;
use crate::model::{Model, Parameter};
use crate::objective::IncidenceError;
use crate::solver::{Method, Termination};

/// The version of the JSON form of [`Fit`].
pub const FORMAT_VERSION: u32 = 1;

/// The fit of one wavelength of a scan, with each stage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// The [`FORMAT_VERSION`] of the program that wrote the fit.
    pub format_version: u32,
    /// Wavelength in micrometres, if the scan states one.
    pub wavelength_um: Option<f64>,
    /// The refractive index: stated, or fitted if it is free.
    pub n: f64,
    /// The exponent of the facet distribution; 1 if the model has none.
    #[serde(default = "one")]
    pub p: f64,
    /// The settings of the fit.
    pub options: FitOptions,
    /// The number of fitted readings: all, or those of stage 1 if it is alone.
    pub readings: usize,
    /// The number of these readings with zero weight, which do not influence the fit.
    #[serde(rename = "weightless")]
    pub zero_weight: usize,
    /// The fitted parameters: those of the last stage, or of a lower minimum that the global check
    /// found.
    pub parameters: Parameters,
    /// E over the fitted readings in percent.
    pub e_percent: f64,
    /// E of each incidence.
    pub incidences: Vec<IncidenceError>,
    /// The initial values.
    pub initial: InitialValues,
    /// E of the initial values in percent.
    pub initial_e_percent: OwnAndAll,
    /// Stage 1; `None` if it is omitted.
    pub stage1: Option<Stage>,
    /// The reason why a requested stage 1 is omitted.
    pub stage1_left_out: Option<String>,
    /// Stage 2; `None` if stage 1 is alone.
    pub stage2: Option<Stage>,
    /// The check against the global optimum; `None` if it is omitted.
    pub global_check: Option<GlobalCheck>,
    /// The fit of constant errors that a fit of relative errors starts from, if requested.
    #[serde(default)]
    pub relative: Option<RelativeFit>,
    /// The result of the robust loss, if requested.
    #[serde(default)]
    pub robust: Option<RobustFit>,
    /// The result of the energy constraint, if requested.
    #[serde(default)]
    pub energy: Option<EnergyConstraint>,
    /// The time of the whole fit in seconds.
    pub seconds: f64,
}

/// E in percent, over the readings of a stage and over all readings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OwnAndAll {
    /// Over the readings of the stage.
    pub own: f64,
    /// Over all readings.
    pub all: f64,
}

/// The result of one stage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// The method.
    pub method: Method,
    /// The parameters at the end of the stage.
    pub parameters: ModelParameters,
    /// E at the end of the stage.
    pub e_percent: OwnAndAll,
    /// The number of readings of the stage.
    pub readings: usize,
    /// The number of iterations.
    pub iterations: u64,
    /// The number of evaluations of E, with or without derivatives.
    pub evaluations: u64,
    /// The time of the stage in seconds.
    pub seconds: f64,
    /// The reason of the termination.
    #[serde(rename = "ending")]
    pub termination: Termination,
}

/// The result of the check against the global optimum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GlobalCheck {
    /// Whether the last stage missed a lower minimum, which then replaced its result.
    pub lower_minimum_taken: bool,
    /// E of the last stage over the fitted readings, in percent.
    pub stage2_e_percent: f64,
    /// The profile over k1: the lowest E at each width; a single point if k1 is not free.
    pub profile: Vec<ProfilePoint>,
    /// The profile over n, if n is free; otherwise empty.
    #[serde(default)]
    pub profile_n: Vec<ProfilePoint>,
    /// The time of the check in seconds.
    pub seconds: f64,
}

/// The rms error over the rms reading, sqrt(E), in percent, from E in percent.
pub fn rms_percent(e_percent: f64) -> f64 {
    10.0 * e_percent.max(0.0).sqrt()
}

impl Fit {
    /// All parameters of the model.
    pub fn at(&self) -> ModelParameters {
        ModelParameters {
            p: self.p,
            ..ModelParameters::three(self.parameters, self.n)
        }
    }

    /// The model.
    pub fn model(&self) -> Model {
        self.options.model
    }

    /// The rms error over the rms reading, both of f_r cos theta, in percent: sqrt(E).
    pub fn rms_percent(&self) -> f64 {
        rms_percent(self.e_percent)
    }

    /// [`rms_percent`](Self::rms_percent) over the readings that a robust loss does not reject.
    pub fn accepted_rms_percent(&self) -> f64 {
        let accepted = self
            .robust
            .as_ref()
            .and_then(|robust| robust.accepted_e_percent);
        rms_percent(accepted.unwrap_or(self.e_percent))
    }

    /// The last stage.
    pub fn last_stage(&self) -> Option<&Stage> {
        self.stage2.as_ref().or(self.stage1.as_ref())
    }

    /// Whether a parameter is fitted: free in the model, and not fixed.
    pub fn fits(&self, parameter: Parameter) -> bool {
        self.options.reduced_model().frees(parameter)
    }

    /// The number of readings that influence the fit, less the number of fitted parameters.
    pub fn degrees_of_freedom(&self) -> usize {
        (self.readings - self.zero_weight).saturating_sub(self.options.free().len())
    }
}

fn one() -> f64 {
    1.0
}
