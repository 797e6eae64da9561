//! The settings of the next fit.

use brdf_fit::Loss;
use brdf_fit::report::Depth;
use brdf_fit::{AssumedErrors, Weights};
use brdf_fit::{FitOptions, Method, RefractiveIndex};
use serde::{Deserialize, Serialize};

use super::parameters::EditedParameters;

/// The stages of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stages {
    /// Stage 1 only: the incidences up to a limit.
    First,
    /// Stage 2 only: all readings together.
    Second,
    /// Both stages, as in the paper.
    Both,
}

/// A set of scans.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// The current wavelength of the active sample.
    Wavelength,
    /// All wavelengths of the active sample.
    Sample,
    /// All wavelengths of all samples.
    All,
}

/// The weights of the readings in E.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReadingWeights {
    /// Equal weights, as in the paper.
    #[default]
    None,
    /// 1/sigma^2.
    Sigma,
    /// 1/m^2 with f_r cos theta of the model, m: relative errors.
    Relative,
    /// The solid angle that a reading represents.
    SolidAngle,
}

/// The initial values of the fit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// The initial values of the paper.
    #[default]
    Paper,
    /// The current values of the parameters.
    #[serde(rename = "sliders")]
    Current,
}

/// The settings of the next fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FitSettings {
    /// Method of stage 1.
    pub stage1: Method,
    /// Method of stage 2.
    pub stage2: Method,
    /// Largest incidence angle of stage 1, in degrees, from 0 to 90.
    #[serde(rename = "limit_deg")]
    pub stage1_limit_deg: f64,
    /// Weights of the readings.
    pub weights: ReadingWeights,
    /// Robust loss; `None` is least squares.
    #[serde(rename = "robust")]
    pub loss: Option<Loss>,
    /// Whether rho(psi) <= 1 is enforced.
    #[serde(rename = "energy")]
    pub constrain_energy: bool,
    /// Largest incidence angle of this constraint, in degrees, from 0 to below 90.
    pub energy_limit_deg: f64,
    /// Initial values.
    pub start: Start,
    /// Whether the GGX and Beckmann models are fitted as well.
    #[serde(rename = "compare")]
    pub compare_models: bool,
    /// Whether scans are fitted when they are opened.
    pub on_opening: bool,
}

impl Default for FitSettings {
    fn default() -> Self {
        Self {
            stage1: Method::LevenbergMarquardt,
            stage2: Method::LevenbergMarquardt,
            stage1_limit_deg: 60.0,
            weights: ReadingWeights::None,
            loss: None,
            constrain_energy: false,
            energy_limit_deg: brdf_fit::ENERGY_LIMIT_DEG,
            start: Start::Paper,
            compare_models: false,
            on_opening: true,
        }
    }
}

impl FitSettings {
    /// Whether all angles are within their ranges, which is not guaranteed for settings read from a
    /// file.
    pub fn is_valid(&self) -> bool {
        (0.0..=90.0).contains(&self.stage1_limit_deg)
            && (0.0..90.0).contains(&self.energy_limit_deg)
    }

    /// The weights of the objective.
    pub fn objective_weights(&self) -> Weights {
        Weights {
            errors: match self.weights {
                ReadingWeights::Sigma => AssumedErrors::Stated,
                ReadingWeights::Relative => AssumedErrors::Relative,
                ReadingWeights::None | ReadingWeights::SolidAngle => AssumedErrors::Constant,
            },
            by_solid_angle: self.weights == ReadingWeights::SolidAngle,
            ..Weights::default()
        }
    }

    /// The options of a fit, equal to those of the command line.
    pub fn options(&self, parameters: &EditedParameters, stages: Stages) -> FitOptions {
        FitOptions {
            model: parameters.model,
            refractive_index: Some(RefractiveIndex::Same(parameters.values.n)),
            weights: self.objective_weights(),
            fixed: parameters.fixed_parameters(),
            start: (self.start == Start::Current).then_some(parameters.values),
            stage1: (stages != Stages::Second).then_some(self.stage1),
            stage1_limit: self.stage1_limit_deg.to_radians(),
            stage2: (stages != Stages::First).then_some(self.stage2),
            robust: self.loss,
            energy_limit: self
                .constrain_energy
                .then_some(self.energy_limit_deg.to_radians()),
            ..FitOptions::default()
        }
    }

    /// The depth of the analysis after the fit.
    pub fn depth(&self) -> Depth {
        if self.compare_models {
            Depth::Compared
        } else {
            Depth::Assessed
        }
    }
}
