//! Fits of many scans.

use std::ops::ControlFlow;

use brdf_fit::batch::{self, BatchError, BatchFit, BatchObserver, BatchOptions, Scans};
use brdf_fit::{Measurement, Model};
use numpy::{Element, IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{repeated, same_length, scans, values};
use crate::error::value_error;
use crate::pool;

/// The angles of many scans, with what their fits share.
#[pyclass(frozen, module = "brdf_fit._native")]
pub(crate) struct BatchPlan(batch::BatchPlan);

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
        pool::run(py, None, |_| batch::BatchPlan::new(&angles, &options))?
            .map(Self)
            .map_err(value_error)
    }

    /// The columns of the fits of an array (scans, readings) of float64 or float32.
    #[pyo3(signature = (scans, weights, errors, threads))]
    fn fit_many<'py>(
        &self,
        py: Python<'py>,
        scans: &Bound<'py, PyAny>,
        weights: Option<&Bound<'py, PyAny>>,
        errors: bool,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let fit = if let Ok(scans) = scans.cast::<PyArray2<f64>>() {
            self.fit_typed::<f64>(py, &scans.readonly(), weights, errors, threads)
        } else {
            let scans = scans.cast::<PyArray2<f32>>()?;
            self.fit_typed::<f32>(py, &scans.readonly(), weights, errors, threads)
        }?;
        columns(py, fit)
    }
}

impl BatchPlan {
    fn fit_typed<T: Element + Copy + Into<f64> + Sync>(
        &self,
        py: Python<'_>,
        array: &PyReadonlyArray2<'_, T>,
        weights: Option<&Bound<'_, PyAny>>,
        errors: bool,
        threads: Option<usize>,
    ) -> PyResult<BatchFit> {
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
            plan: &self.0,
            readings,
            weights,
            errors,
        };
        let fit = if threads == Some(1) {
            work.fit_on_this_thread(py)?
        } else {
            pool::run(py, threads, |interrupt| {
                work.fit(false, &mut |_, _| interrupt.flow())
            })?
        };
        fit.map_err(value_error)
    }
}

/// The fits of one call.
struct Work<'a, T> {
    plan: &'a batch::BatchPlan,
    readings: Scans<'a, T>,
    weights: Option<Scans<'a, T>>,
    errors: bool,
}

impl<T: Copy + Into<f64> + Sync> Work<'_, T> {
    fn fit(
        &self,
        one_thread: bool,
        observer: &mut dyn BatchObserver,
    ) -> Result<BatchFit, BatchError> {
        let mut run = self.plan.run(self.readings);
        if let Some(weights) = self.weights {
            run = run.weights(weights);
        }
        if self.errors {
            run = run.constant_noise_errors();
        }
        if one_thread {
            run = run.on_one_thread();
        }
        run.fit_observed(observer)
    }

    /// The fits without a pool, as the workers of an engine and forked processes need them.
    fn fit_on_this_thread(&self, py: Python<'_>) -> PyResult<Result<BatchFit, BatchError>> {
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
fn columns(py: Python<'_>, fit: BatchFit) -> PyResult<Bound<'_, PyDict>> {
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
    Ok(columns)
}
