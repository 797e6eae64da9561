//! Fits of many scans.

use std::ops::ControlFlow;

use brdf_fit::batch::{self, BatchError, BatchFit, BatchObserver, BatchOptions, Scans};
use brdf_fit::{
    Measurement, Model, PARALLEL_FROM, Parameter, ParameterIntervals, intervals_of_many,
    intervals_of_many_on_one_thread,
};
use numpy::{Element, IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{repeated, same_length, scans, values};
use crate::error::value_error;
use crate::pool;

/// The angles of many scans, with what their fits share.
#[pyclass(frozen, module = "brdf_fit._native")]
pub(crate) struct BatchPlan {
    plan: batch::BatchPlan,
    angles: Vec<Measurement>,
    options: BatchOptions,
}

/// What is computed beside the fits.
#[derive(Clone, Copy)]
struct Wanted {
    errors: bool,
    intervals: bool,
}

#[pymethods]
impl BatchPlan {
    #[new]
    fn new(
        py: Python<'_>,
        psi: PyReadonlyArray1<'_, f64>,
        theta: PyReadonlyArray1<'_, f64>,
        phi: PyReadonlyArray1<'_, f64>,
        n: f64,
        model: &str,
    ) -> PyResult<Self> {
        let (psi, theta, phi) = (values(&psi)?, values(&theta)?, values(&phi)?);
        same_length(&[
            ("psi", psi.len()),
            ("theta", theta.len()),
            ("phi", phi.len()),
        ])?;
        let angles: Vec<Measurement> = (psi.iter().zip(theta).zip(phi))
            .map(|((&psi, &theta), &phi)| Measurement {
                wavelength_um: None,
                psi,
                theta,
                phi,
                brdf: 1.0,
                sigma: None,
            })
            .collect();
        let options = BatchOptions {
            model: model.parse::<Model>().map_err(value_error)?,
            n,
            ..BatchOptions::default()
        };
        let plan = pool::run(py, None, |_| batch::BatchPlan::new(&angles, &options))?;
        Ok(Self {
            plan: plan.map_err(value_error)?,
            angles,
            options,
        })
    }

    /// The names of the free parameters.
    #[getter]
    fn free(&self) -> Vec<String> {
        let free = self.options.model.free().iter().copied();
        free.map(name).collect()
    }

    /// The columns of the fits of an array (scans, readings) of float64 or float32. The intervals have no
    /// regard to the weights.
    #[pyo3(signature = (scans, weights, errors, intervals, threads))]
    fn fit_many<'py>(
        &self,
        py: Python<'py>,
        scans: &Bound<'py, PyAny>,
        weights: Option<&Bound<'py, PyAny>>,
        errors: bool,
        intervals: bool,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let wanted = Wanted { errors, intervals };
        let (fit, intervals) = if let Ok(scans) = scans.cast::<PyArray2<f64>>() {
            self.fit_typed::<f64>(py, &scans.readonly(), weights, wanted, threads)
        } else {
            let scans = scans.cast::<PyArray2<f32>>()?;
            self.fit_typed::<f32>(py, &scans.readonly(), weights, wanted, threads)
        }?;
        columns(py, fit, intervals)
    }
}

impl BatchPlan {
    fn fit_typed<T: Element + Copy + Into<f64> + Sync>(
        &self,
        py: Python<'_>,
        array: &PyReadonlyArray2<'_, T>,
        weights: Option<&Bound<'_, PyAny>>,
        wanted: Wanted,
        threads: Option<usize>,
    ) -> PyResult<Fitted> {
        let readings = scans(array)?;
        let weights = weights
            .map(|weights| Ok::<_, PyErr>(weights.cast::<PyArray2<T>>()?.readonly()))
            .transpose()?;
        let weights = match &weights {
            None => None,
            Some(one) if one.as_array().nrows() == 1 => Some(repeated(one, readings.len())?),
            Some(all) => Some(scans(all)?),
        };
        let work = Work {
            of: self,
            readings,
            weights,
            wanted,
        };
        // The intervals of large scans need a pool in any case. That of this package can be forked.
        let needs_pool = wanted.intervals && self.angles.len() >= PARALLEL_FROM;
        let fit = if threads == Some(1) && !needs_pool {
            work.fit_on_this_thread(py)?
        } else {
            pool::run(py, threads, |interrupt| {
                work.fit(false, &mut |_, _| interrupt.flow())
            })?
        };
        fit.map_err(value_error)
    }
}

/// The fits of one call, and the intervals of each parameter where they are wanted.
type Fitted = (BatchFit, Vec<ParameterIntervals>);

/// What one call computes.
struct Work<'a, T> {
    of: &'a BatchPlan,
    readings: Scans<'a, T>,
    weights: Option<Scans<'a, T>>,
    wanted: Wanted,
}

impl<T: Copy + Into<f64> + Sync> Work<'_, T> {
    fn fit(
        &self,
        one_thread: bool,
        observer: &mut dyn BatchObserver,
    ) -> Result<Fitted, BatchError> {
        let mut run = self.of.plan.run(self.readings);
        if let Some(weights) = self.weights {
            run = run.weights(weights);
        }
        if self.wanted.errors {
            run = run.constant_noise_errors();
        }
        if one_thread {
            run = run.on_one_thread();
        }
        let fit = run.fit_observed(observer)?;
        let intervals = if self.wanted.intervals {
            self.intervals(one_thread, observer)?
        } else {
            Vec::new()
        };
        Ok((fit, intervals))
    }

    fn intervals(
        &self,
        one_thread: bool,
        observer: &mut dyn BatchObserver,
    ) -> Result<Vec<ParameterIntervals>, BatchError> {
        let BatchPlan {
            angles, options, ..
        } = self.of;
        if one_thread {
            intervals_of_many_on_one_thread(angles, options, self.readings, observer)
        } else {
            intervals_of_many(angles, options, self.readings, observer)
        }
    }

    /// The fits without a pool, as the workers of an engine and forked processes need them.
    fn fit_on_this_thread(&self, py: Python<'_>) -> PyResult<Result<Fitted, BatchError>> {
        let mut exception = None;
        let fit = py.detach(|| {
            self.fit(true, &mut |_, _| match pool::check_signals() {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => {
                    exception = Some(error);
                    ControlFlow::Break(())
                }
            })
        });
        exception.map_or(Ok(fit), Err)
    }
}

/// One contiguous array for each column.
fn columns(
    py: Python<'_>,
    fit: BatchFit,
    intervals: Vec<ParameterIntervals>,
) -> PyResult<Bound<'_, PyDict>> {
    let columns = PyDict::new(py);
    let status: Vec<u8> = fit.status.iter().map(|status| *status as u8).collect();
    columns.set_item("k2", fit.k2.into_pyarray(py))?;
    columns.set_item("kd", fit.kd.into_pyarray(py))?;
    columns.set_item("k1", fit.k1.into_pyarray(py))?;
    columns.set_item("n", fit.n.into_pyarray(py))?;
    columns.set_item("p", fit.p.into_pyarray(py))?;
    columns.set_item("e_percent", fit.e_percent.into_pyarray(py))?;
    columns.set_item("readings", fit.readings.into_pyarray(py))?;
    columns.set_item("status", status.into_pyarray(py))?;
    if let Some(errors) = fit.constant_noise {
        columns.set_item("k2_stderr", errors.k2.into_pyarray(py))?;
        columns.set_item("kd_stderr", errors.kd.into_pyarray(py))?;
        columns.set_item("k1_stderr", errors.k1.into_pyarray(py))?;
        columns.set_item("n_stderr", errors.n.into_pyarray(py))?;
        columns.set_item("p_stderr", errors.p.into_pyarray(py))?;
    }
    for all in intervals {
        let name = name(all.parameter);
        let standard_error = all.standard_error.into_pyarray(py);
        columns.set_item(format!("{name}_standard_error"), standard_error)?;
        columns.set_item(format!("{name}_from"), all.from.into_pyarray(py))?;
        columns.set_item(format!("{name}_to"), all.to.into_pyarray(py))?;
    }
    Ok(columns)
}

/// The name of a parameter in Python.
fn name(parameter: Parameter) -> String {
    parameter.to_string().to_lowercase()
}
