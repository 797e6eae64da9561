//! The exceptions of the package. Each has the words of the library's error.

use std::fmt::Display;
use std::io;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

pyo3::create_exception!(
    brdf_fit,
    FitError,
    PyValueError,
    "A scan cannot be fitted: too few readings, no refractive index, options that contradict each other."
);
pyo3::create_exception!(
    brdf_fit,
    ReadError,
    PyValueError,
    "A file is not a scan: the message has the file, the line, the value, and what was expected."
);
pyo3::create_exception!(
    brdf_fit,
    ExportError,
    PyValueError,
    "A fit cannot be written in a format: several wavelengths, or a tolerance that no table reaches."
);

/// The error of an argument.
pub(crate) fn value_error(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// An error of the operating system, as the `OSError` of its kind with the library's words.
pub(crate) fn os_error(kind: io::ErrorKind, message: impl Display) -> PyErr {
    io::Error::new(kind, message.to_string()).into()
}
