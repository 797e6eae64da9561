//! The model and its parameters as the user edits them.

use brdf_core::{AnyBrdf, ModelParameters};
use brdf_fit::{FixedParameters, Model, Parameter};

/// The state of the parameter controls: the model, the parameter values, and the parameters that
/// are fixed in a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EditedParameters {
    /// The model.
    pub model: Model,
    /// The values of its parameters.
    pub values: ModelParameters,
    /// Whether each parameter is fixed in a fit, in the order of [`Parameter::ALL`].
    pub fixed: [bool; 5],
}

impl EditedParameters {
    /// Parameters of a model, none of which is fixed.
    pub fn new(model: Model, values: ModelParameters) -> Self {
        Self {
            model,
            values,
            fixed: [false; 5],
        }
    }

    /// Whether a parameter is fixed in a fit.
    pub fn is_fixed(&self, parameter: Parameter) -> bool {
        self.fixed[parameter as usize]
    }

    /// The fixed parameters with their values. Parameters that the model does not fit are not
    /// included.
    pub fn fixed_parameters(&self) -> FixedParameters {
        let fixed = self.model.free().iter().filter(|p| self.is_fixed(**p));
        fixed.fold(FixedParameters::none(), |fixed, p| {
            fixed.with(*p, p.of(&self.values))
        })
    }

    /// The BRDF; `None` if a parameter is outside its domain.
    pub fn brdf(&self) -> Option<AnyBrdf> {
        AnyBrdf::new(self.model.family(), &self.values).ok()
    }

    /// The parameters of the model: those that it fits, and n if it has a specular part.
    pub fn model_parameters(&self) -> Vec<Parameter> {
        let needs_n = self.model.frees(Parameter::K2);
        Parameter::ALL
            .into_iter()
            .filter(|p| self.model.frees(*p) || (*p == Parameter::N && needs_n))
            .collect()
    }
}
