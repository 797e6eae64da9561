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

/// The settings of a fit.
///
/// # Examples
///
/// ```
/// use brdf_fit::{FitOptions, Method, RefractiveIndex};
///
/// let options = FitOptions {
///     refractive_index: Some(RefractiveIndex::Same(1.5)),
///     stage1: Some(Method::NelderMead),
///     ..FitOptions::default()
/// };
/// assert_eq!(options.stage1_limit.to_degrees().round(), 60.0);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitOptions {
    /// The model.
    #[serde(default)]
    pub model: Model,
    /// The refractive index; `None` takes the one that the measurements state. If n is free, the fit
    /// starts there, or at [`DEFAULT_N`](crate::model::DEFAULT_N) if none is stated.
    pub refractive_index: Option<RefractiveIndex>,
    /// Weights of the readings in E.
    pub weights: Weights,
    /// The start of the first stage; `None` takes the initial values of the paper.
    pub start: Option<ModelParameters>,
    /// The method of stage 1; `None` omits the stage.
    pub stage1: Option<Method>,
    /// The largest incidence angle of stage 1 in radians (in JSON in degrees, `stage1_limit_deg`).
    #[serde(rename = "stage1_limit_deg", with = "as_degrees")]
    pub stage1_limit: f64,
    /// The method of stage 2; `None` fits stage 1 alone: the fit and its diagnostics are then of the
    /// readings up to the limit of stage 1. At least one stage is needed.
    pub stage2: Option<Method>,
    /// The largest number of iterations of each stage.
    pub max_iterations: u64,
    /// Whether the grid search checks the result of the last stage against the global optimum.
    pub global_check: bool,
    /// A robust loss for data with outliers; `None` is least squares, the E of the paper.
    #[serde(default)]
    pub robust: Option<Loss>,
    /// The incidence angle up to which the fit is constrained by rho(psi) <= 1, in radians (in JSON in
    /// degrees, `energy_limit_deg`); `None` fits without this constraint.
    #[serde(default, rename = "energy_limit_deg", with = "as_optional_degrees")]
    pub energy_limit: Option<f64>,
    /// The free parameters of the model that are fixed at a value instead of being fitted.
    #[serde(
        default,
        rename = "held",
        skip_serializing_if = "FixedParameters::is_empty"
    )]
    pub fixed: FixedParameters,
}

impl FitOptions {
    /// The model with its fixed parameters.
    pub fn reduced_model(&self) -> ReducedModel {
        ReducedModel::new(self.model, self.fixed)
    }

    /// The parameters that are fitted, in the order of [`Parameter::ALL`].
    pub fn free(&self) -> Vec<Parameter> {
        self.reduced_model().free().to_vec()
    }

    /// The readings that are fitted: all, or those up to the limit of stage 1 if it is alone.
    pub fn fitted_readings<'a>(&self, measurements: &'a Measurements) -> Cow<'a, Measurements> {
        if self.stage2.is_some() {
            Cow::Borrowed(measurements)
        } else {
            Cow::Owned(measurements.up_to(self.stage1_limit))
        }
    }

    /// The scope of the fit if it is not of all readings: `psi <= 60 deg`.
    pub(crate) fn scope(&self) -> Option<String> {
        let limit = in_degrees(self.stage1_limit);
        let alone = self.stage2.is_none();
        alone.then(|| format!("psi <= {limit} deg"))
    }

    /// The same options for another model, with the fixed parameters that it would otherwise fit.
    #[must_use]
    pub fn with_model(&self, model: Model) -> Self {
        Self {
            model,
            fixed: self.fixed.within(model),
            ..self.clone()
        }
    }
}

/// The paper's model, least squares, Levenberg-Marquardt in both stages with a limit of 60 deg, and
/// the global check. On the measured scans of the project at n = 1.5, Levenberg-Marquardt reaches the
/// optima of Nelder-Mead with 15 evaluations of E in each stage instead of 343.
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
