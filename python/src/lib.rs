//! The compiled part of the Python package `brdf_fit`.
//!
//! It converts arguments and results; all numbers come from `brdf-fit` and `brdf-core`. Broadcasting,
//! degrees and the classes of results are in the Python files beside it.

mod arrays;
mod batch;
mod brdf;
mod error;
mod export;
mod fit;
mod plan;
mod pool;
mod read;
mod sampler;
mod scan;

use pyo3::prelude::*;

/// The compiled part of `brdf_fit`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::batch::BatchPlan;
    #[pymodule_export]
    use super::brdf::{evaluate, evaluate_each, hemispherical_reflectance};
    #[pymodule_export]
    use super::error::{ExportError, FitError, ReadError};
    #[pymodule_export]
    use super::export::export;
    #[pymodule_export]
    use super::fit::{Report, fit};
    #[pymodule_export]
    use super::plan::Plan;
    #[pymodule_export]
    use super::read::read;
    #[pymodule_export]
    use super::sampler::Sampler;
    #[pymodule_export]
    use super::scan::Scan;
}
