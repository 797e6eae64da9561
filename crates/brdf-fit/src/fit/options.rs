//! The settings of a fit.

use std::borrow::Cow;

use brdf_core::ModelParameters;
use serde::{Deserialize, Serialize};

use super::robust::Loss;
use crate::format::{as_degrees, as_optional_degrees, in_degrees};
use crate::model::{FixedParameters, Model, Parameter, ReducedModel};
use crate::objective::weights::Weights;
use crate::scan::{Measurements, RefractiveIndex};
use crate::solver::Method;

/// Settings of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitOptions {
    /// The model.
    #[serde(default)]
    pub model: Model,
    /// Refractive index; `None` takes what the measurements state. Where the model has n free, the
    /// fit starts there, or from [`DEFAULT_N`] where nobody states one.
    pub refractive_index: Option<RefractiveIndex>,
    /// Weights of the readings in E.
    pub weights: Weights,
    /// Where the first stage starts; `None` takes the paper's initial values.
    pub start: Option<ModelParameters>,
    /// Method of stage 1; `None` leaves the stage out.
    pub stage1: Option<Method>,
    /// Largest incidence angle of stage 1, in radians (in JSON in degrees, `stage1_limit_deg`).
    #[serde(rename = "stage1_limit_deg", with = "as_degrees")]
    pub stage1_limit: f64,
    /// Method of stage 2; `None` fits stage 1 alone: the fit, and all that it is worth, is then of
    /// the readings up to the limit of stage 1. One stage at least is asked for.
    pub stage2: Option<Method>,
    /// Largest number of iterations of each stage.
    pub max_iterations: u64,
    /// Whether the profile search over k1 checks the result of stage 2.
    pub global_check: bool,
    /// A loss other than the square, for data with outliers; `None` is the paper's E.
    #[serde(default)]
    pub robust: Option<Loss>,
    /// Fit under rho(psi) <= 1 up to this incidence, in radians (in JSON in degrees,
    /// `energy_limit_deg`); `None` leaves the fit free.
    #[serde(default, rename = "energy_limit_deg", with = "as_optional_degrees")]
    pub energy_limit: Option<f64>,
    /// The parameters that are fixed at a value instead of being fitted; the model frees them.
    #[serde(
        default,
        rename = "held",
        skip_serializing_if = "FixedParameters::is_empty"
    )]
    pub fixed: FixedParameters,
}

impl FitOptions {
    /// The model with what is fixed of it.
    pub fn reduced_model(&self) -> ReducedModel {
        ReducedModel::new(self.model, self.fixed)
    }

    /// The parameters that are fitted, in their order: the model's free ones that are not fixed.
    pub fn free(&self) -> Vec<Parameter> {
        self.reduced_model().free().to_vec()
    }

    /// The readings that a fit is of: those up to the limit of stage 1 where that is alone.
    pub fn fitted_readings<'a>(&self, measurements: &'a Measurements) -> Cow<'a, Measurements> {
        if self.stage2.is_some() {
            Cow::Borrowed(measurements)
        } else {
            Cow::Owned(measurements.up_to(self.stage1_limit))
        }
    }

    /// What a fit is of, where that is not all readings: `psi <= 60 deg`.
    pub(crate) fn scope(&self) -> Option<String> {
        let limit = in_degrees(self.stage1_limit);
        let alone = self.stage2.is_none();
        alone.then(|| format!("psi <= {limit} deg"))
    }

    /// The same for another model, which holds what it has of the fixed parameters.
    #[must_use]
    pub fn of_model(&self, model: Model) -> Self {
        Self {
            model,
            fixed: self.fixed.within(model),
            ..self.clone()
        }
    }
}

/// Levenberg-Marquardt in both stages: on the scans in `data/measured/` at n = 1.5 it reaches the
/// same optima as Nelder-Mead with 15 evaluations a stage instead of 343 (the column `eval.` of
/// `fit data/measured/*.csv --n 1.5`, with and without `--stage1 nm --stage2 nm`).
impl Default for FitOptions {
    fn default() -> Self {
        Self {
            model: Model::Three,
            refractive_index: None,
            weights: Weights::default(),
            start: None,
            stage1: Some(Method::LevenbergMarquardt),
            stage1_limit: 60_f64.to_radians(),
            stage2: Some(Method::LevenbergMarquardt),
            max_iterations: 10_000,
            global_check: true,
            robust: None,
            energy_limit: None,
            fixed: FixedParameters::none(),
        }
    }
}
