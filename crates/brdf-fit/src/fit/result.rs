//! A fit with every step on the way.

use brdf_core::{ModelParameters, Parameters};
use serde::{Deserialize, Serialize};

use super::energy::EnergyConstraint;
use super::global_check::GlobalCheck;
use super::options::FitOptions;
use super::robust::RobustFit;
use super::start::InitialValues;
use crate::model::{Model, Parameter};
use crate::objective::IncidenceError;
use crate::solver::{Method, Termination};

/// Version of the JSON that [`Fit`] is written as.
pub const FORMAT_VERSION: u32 = 1;

/// A fit of one wavelength of a scan, with every step on the way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// [`FORMAT_VERSION`] of the program that wrote it.
    pub format_version: u32,
    /// Wavelength in micrometres, where the scan states one.
    pub wavelength_um: Option<f64>,
    /// Refractive index of the coating: as given, or as fitted where the model has it free.
    pub n: f64,
    /// Exponent of the facet distribution; 1 where the model has none.
    #[serde(default = "one")]
    pub p: f64,
    /// The settings of the fit.
    pub options: FitOptions,
    /// How many readings were fitted: all, or those of stage 1 where it is alone.
    pub readings: usize,
    /// How many of them have a weight of zero, and so no say.
    #[serde(rename = "weightless")]
    pub zero_weight: usize,
    /// The fitted parameters: those of the last stage, or of the lower minimum that the check found.
    pub parameters: Parameters,
    /// E over the fitted readings, in percent.
    pub e_percent: f64,
    /// E of each incidence by itself.
    pub incidences: Vec<IncidenceError>,
    /// The initial values.
    pub initial: InitialValues,
    /// E of the initial values over the readings of the first stage, and over all, in percent.
    pub initial_e_percent: OwnAndAll,
    /// Stage 1; `None` where it was left out.
    pub stage1: Option<Stage>,
    /// Why stage 1 was left out although it was asked for.
    pub stage1_left_out: Option<String>,
    /// Stage 2; `None` where stage 1 is alone.
    pub stage2: Option<Stage>,
    /// The check against the global optimum; `None` where it was left out.
    pub global_check: Option<GlobalCheck>,
    /// What another loss than the square did, where one was asked for.
    #[serde(default)]
    pub robust: Option<RobustFit>,
    /// What keeping energy did, where it was asked for.
    #[serde(default)]
    pub energy: Option<EnergyConstraint>,
    /// Time of the whole fit in seconds.
    pub seconds: f64,
}

/// E in percent over the readings of a stage, and over all readings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OwnAndAll {
    /// Over the readings of the stage.
    pub own: f64,
    /// Over all readings.
    pub all: f64,
}

/// What one stage did.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Its method.
    pub method: Method,
    /// Where it ended.
    pub parameters: ModelParameters,
    /// E there.
    pub e_percent: OwnAndAll,
    /// How many readings it used.
    pub readings: usize,
    /// Its iterations.
    pub iterations: u64,
    /// How often it evaluated E, alone or with derivatives.
    pub evaluations: u64,
    /// Its time in seconds.
    pub seconds: f64,
    /// Why it stopped.
    #[serde(rename = "ending")]
    pub termination: Termination,
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

    /// The last of its stages.
    pub fn last_stage(&self) -> Option<&Stage> {
        self.stage2.as_ref().or(self.stage1.as_ref())
    }

    /// Whether a parameter was fitted: free in the model, and not fixed.
    pub fn fits(&self, parameter: Parameter) -> bool {
        self.options.reduced_model().frees(parameter)
    }

    /// Readings that have a say, less the fitted parameters.
    pub fn degrees_of_freedom(&self) -> usize {
        (self.readings - self.zero_weight).saturating_sub(self.options.free().len())
    }
}

fn one() -> f64 {
    1.0
}
