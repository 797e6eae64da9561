//! Evaluation of many points by the fastest way within a tolerance.

use brdf_core::evaluator::{Evaluator, LengthError, Points};
use brdf_core::scene::{self, Coordinates, Domain, Scene};
use numpy::{Element, IntoPyArray, PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays::same_length;
use crate::brdf::{brdf, of_array};
use crate::error::value_error;
use crate::pool;

/// The evaluator that is chosen for a BRDF, a domain and a tolerance on the present machine.
#[pyclass(frozen, module = "brdf_fit._native")]
pub(crate) struct Plan {
    evaluator: Box<dyn Evaluator>,
    coordinates: Coordinates,
    errors: Option<f64>,
}

#[pymethods]
impl Plan {
    #[new]
    fn new(
        py: Python<'_>,
        parameters: [f64; 5],
        model: &str,
        tolerance: f64,
        psi_max: f64,
        theta_max: f64,
        evaluations: f64,
        cosines: bool,
    ) -> PyResult<Self> {
        let brdf = brdf(model, &of_array(parameters))?;
        let coordinates = if cosines {
            Coordinates::Cosines
        } else {
            Coordinates::Angles
        };
        let scene = Scene {
            domain: Domain::all((0.0, psi_max), (0.0, theta_max)).map_err(value_error)?,
            coordinates,
            tolerance,
            evaluations,
        };
        let plan = pool::run(py, None, |_| scene::Plan::new(&brdf, &scene))?;
        let plan = plan.map_err(value_error)?;
        let chosen = plan.chosen().and_then(|chosen| chosen.errors.as_ref());
        Ok(Self {
            errors: chosen.map(|errors| errors.max),
            evaluator: plan.evaluator,
            coordinates,
        })
    }

    /// The name of the evaluator.
    #[getter]
    fn name(&self) -> &'static str {
        self.evaluator.name()
    }

    /// The largest relative error that was measured in the domain.
    #[getter]
    fn max_error(&self) -> Option<f64> {
        self.errors
    }

    /// f_r in 1/sr at points of float64 or float32, all of one type.
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        points: [Bound<'py, PyAny>; 3],
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if points[0].cast::<PyArray1<f64>>().is_ok() {
            self.typed::<f64>(py, &points, threads, |points, out| {
                self.evaluator.values(points, out)
            })
        } else {
            self.typed::<f32>(py, &points, threads, |points, out| {
                self.evaluator.values_f32(points, out)
            })
        }
    }
}

impl Plan {
    fn typed<'py, T: Element + Copy + Default + Send + Sync>(
        &self,
        py: Python<'py>,
        points: &[Bound<'py, PyAny>; 3],
        threads: Option<usize>,
        work: impl Fn(&Points<'_, T>, &mut [T]) -> Result<(), LengthError> + Sync,
    ) -> PyResult<Bound<'py, PyAny>> {
        let array = |i: usize| Ok::<_, PyErr>(points[i].cast::<PyArray1<T>>()?.readonly());
        let arrays = [array(0)?, array(1)?, array(2)?];
        let slice = |i: usize| arrays[i].as_slice().map_err(value_error);
        let (psi, theta, phi) = (slice(0)?, slice(1)?, slice(2)?);
        let count = same_length(&[
            ("psi", psi.len()),
            ("theta", theta.len()),
            ("phi", phi.len()),
        ])?;
        let points = match self.coordinates {
            Coordinates::Cosines => Points::Cosines { psi, theta, phi },
            _ => Points::Angles { psi, theta, phi },
        };
        let values = pool::run(py, threads, |_| {
            let mut out = vec![T::default(); count];
            work(&points, &mut out).map(|()| out)
        })?;
        Ok(values.map_err(value_error)?.into_pyarray(py).into_any())
    }
}
