//! Scans: readings with their angles.

use brdf_fit::{Measurement, Measurements};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::arrays::{same_length, values};
use crate::error::value_error;

/// The readings of one wavelength.
#[pyclass(frozen, module = "brdf_fit._native")]
pub(crate) struct Scan(pub(crate) Measurements);

#[pymethods]
impl Scan {
    /// A scan of psi, theta and phi in radians, and f_r in 1/sr.
    #[new]
    fn new(
        columns: [PyReadonlyArray1<'_, f64>; 4],
        sigma: Option<PyReadonlyArray1<'_, f64>>,
        wavelength_um: Option<f64>,
        source: String,
    ) -> PyResult<Self> {
        let columns = columns.iter().map(values).collect::<PyResult<Vec<_>>>()?;
        let sigma = sigma.as_ref().map(values).transpose()?;
        let mut lengths = vec![
            ("brdf", columns[3].len()),
            ("psi", columns[0].len()),
            ("theta", columns[1].len()),
            ("phi", columns[2].len()),
        ];
        lengths.extend(sigma.map(|sigma| ("sigma", sigma.len())));
        let count = same_length(&lengths)?;
        let reading = |i: usize| {
            let reading = Measurement {
                wavelength_um,
                psi: columns[0][i],
                theta: columns[1][i],
                phi: columns[2][i],
                brdf: columns[3][i],
                sigma: sigma.map(|sigma| sigma[i]),
            };
            let valid = reading.validated();
            valid.map_err(|error| value_error(format!("reading {i}: {error}")))
        };
        let readings = (0..count).map(reading).collect::<PyResult<Vec<_>>>()?;
        Measurements::new(source, readings)
            .map(Self)
            .map_err(value_error)
    }

    /// From the text that `to_json` gives.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        serde_json::from_str(text).map(Self).map_err(value_error)
    }

    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.0).map_err(value_error)
    }

    #[getter]
    fn source(&self) -> &str {
        &self.0.source
    }

    #[getter]
    fn format(&self) -> &'static str {
        self.0.format.name()
    }

    #[getter]
    fn wavelength_um(&self) -> Option<f64> {
        self.0.wavelengths().first().copied().flatten()
    }

    #[getter]
    fn n(&self) -> Option<f64> {
        let stated = self.0.refractive_index.as_ref();
        stated.and_then(|n| n.at(self.wavelength_um()))
    }

    #[getter]
    fn metadata(&self) -> Vec<(String, String)> {
        self.0.metadata.0.clone()
    }

    #[getter]
    fn conversions(&self) -> Vec<String> {
        self.0.conversions.clone()
    }

    #[getter]
    fn ignored_columns(&self) -> Vec<String> {
        self.0.ignored_columns.clone()
    }

    fn __len__(&self) -> usize {
        self.0.readings().len()
    }

    /// psi, theta and phi in radians, f_r and its standard deviations in 1/sr (NaN where none is stated).
    fn columns<'py>(&self, py: Python<'py>) -> [Bound<'py, PyArray1<f64>>; 5] {
        let column = |of: fn(&Measurement) -> f64| {
            let values: Vec<f64> = self.0.readings().iter().map(of).collect();
            values.into_pyarray(py)
        };
        [
            column(|reading| reading.psi),
            column(|reading| reading.theta),
            column(|reading| reading.phi),
            column(|reading| reading.brdf),
            column(|reading| reading.sigma.unwrap_or(f64::NAN)),
        ]
    }
}
