//! Importance sampling.

use brdf_core::sampling;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::brdf::{brdf, of_array};
use crate::error::value_error;

/// Draws view directions with a density that resembles f_r cos theta.
#[pyclass(frozen, module = "brdf_fit._native")]
pub(crate) struct Sampler(sampling::Sampler);

/// The components of directions, their densities in 1/sr, and their weights.
type Samples<'py> = [Bound<'py, PyArray1<f64>>; 3];

#[pymethods]
impl Sampler {
    #[new]
    fn new(py: Python<'_>, parameters: [f64; 5], model: &str) -> PyResult<Self> {
        let brdf = brdf(model, &of_array(parameters))?;
        Ok(Self(py.detach(|| sampling::Sampler::new(&brdf))))
    }

    /// Draws a view for each row of sources (points, 3) and of random numbers (points, 3).
    fn sample<'py>(
        &self,
        py: Python<'py>,
        source: PyReadonlyArray2<'py, f64>,
        u: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Samples<'py>> {
        let (source, u) = (rows(&source)?, rows(&u)?);
        let drawn = py.detach(|| {
            let (mut views, mut pdf, mut weight) = (Vec::new(), Vec::new(), Vec::new());
            for (i, (&source, &u)) in source.iter().zip(u).enumerate() {
                if let Some(u) = u.iter().find(|u| !(0.0..=1.0).contains(*u)) {
                    return Err(format!("point {i}: u = {u}: expected numbers in [0, 1)"));
                }
                match self.0.sample(source, u) {
                    Err(error) => return Err(format!("point {i}: {error}")),
                    Ok(Some(sample)) => {
                        views.extend(sample.direction);
                        pdf.push(sample.pdf);
                        weight.push(sample.weight);
                    }
                    Ok(None) => {
                        views.extend([f64::NAN; 3]);
                        pdf.push(f64::NAN);
                        weight.push(0.0);
                    }
                }
            }
            Ok([views, pdf, weight])
        });
        Ok(drawn.map_err(value_error)?.map(|all| all.into_pyarray(py)))
    }

    /// The density in 1/sr of each row of views (points, 3) for a row of sources (points, 3).
    fn pdf<'py>(
        &self,
        py: Python<'py>,
        source: PyReadonlyArray2<'py, f64>,
        view: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (source, view) = (rows(&source)?, rows(&view)?);
        let pdf: Result<Vec<f64>, String> = py.detach(|| {
            let pairs = source.iter().zip(view).enumerate();
            let one = |(i, (&source, &view))| {
                let pdf = self.0.pdf(source, view);
                pdf.map_err(|error| format!("point {i}: {error}"))
            };
            pairs.map(one).collect()
        });
        Ok(pdf.map_err(value_error)?.into_pyarray(py))
    }

    /// The weight of the specular lobe at 17 incidences.
    fn specular_weights<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let values: &[f64] = &self.0.specular_weights();
        PyArray1::from_slice(py, values)
    }
}

/// The rows of a C-contiguous array (points, 3).
fn rows<'a>(array: &'a PyReadonlyArray2<'_, f64>) -> PyResult<&'a [[f64; 3]]> {
    if !array.is_c_contiguous() || array.shape()[1] != 3 {
        return Err(value_error("expected a contiguous array (points, 3)"));
    }
    let values = array.as_slice().map_err(value_error)?;
    Ok(values.as_chunks().0)
}
