//! Reading files.

use std::path::PathBuf;

use brdf_fit::{Measurements, ReadError as LibraryError, ReadOptions};
use pyo3::prelude::*;

use crate::error::{ReadError, os_error, value_error};
use crate::pool;
use crate::scan::Scan;

/// The scans of a file of any format, one for each wavelength in ascending order.
#[pyfunction]
pub(crate) fn read(
    py: Python<'_>,
    path: PathBuf,
    format: Option<&str>,
    theta_positive: Option<&str>,
    phi_zero: Option<&str>,
    sample: Option<usize>,
    columns: Vec<(String, String)>,
    declarations: Vec<(String, String)>,
) -> PyResult<Vec<Scan>> {
    let options = ReadOptions {
        format: format.map(str::parse).transpose().map_err(value_error)?,
        theta_positive: theta_positive
            .map(str::parse)
            .transpose()
            .map_err(value_error)?,
        phi_zero: phi_zero.map(str::parse).transpose().map_err(value_error)?,
        sample,
        columns,
        declarations,
    };
    let read = pool::run(py, None, |_| {
        Measurements::read(path, &options).map(Measurements::by_wavelength)
    })?;
    match read {
        Ok(scans) => Ok(scans.into_iter().map(Scan).collect()),
        Err(LibraryError::Io { path, error }) => {
            let message = format!("{}: cannot be read: {error}", path.display());
            Err(os_error(error.kind(), message))
        }
        Err(error) => Err(ReadError::new_err(error.to_string())),
    }
}
