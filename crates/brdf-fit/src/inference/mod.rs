//! What can be inferred from a fit beyond its parameters: their uncertainty, how well the model
//! predicts incidences that it is not fitted to, which model suffices, and what to be warned of.

pub mod assessment;
pub mod cross_validation;
pub mod uncertainty;
pub mod warning;
