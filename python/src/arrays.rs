//! Arrays of NumPy as the library takes them.

use brdf_fit::batch::Scans;
use numpy::{Element, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::error::value_error;

/// The scans of an array (scans, readings), in C or Fortran order, without a copy.
///
/// A slice of an array in Fortran order has the order of its memory, so that the strides differ.
pub(crate) fn scans<'a, T: Element>(array: &'a PyReadonlyArray2<'_, T>) -> PyResult<Scans<'a, T>> {
    let shape = [array.shape()[0], array.shape()[1]];
    let strides = if array.is_c_contiguous() {
        [shape[1], 1]
    } else if array.is_fortran_contiguous() {
        [1, shape[0]]
    } else {
        return Err(value_error("the array of scans is not contiguous"));
    };
    Scans::strided(slice(array.as_slice())?, shape, strides).map_err(value_error)
}

/// One row of an array (1, readings) for each of many scans.
pub(crate) fn repeated<'a, T: Element>(
    array: &'a PyReadonlyArray2<'_, T>,
    scans: usize,
) -> PyResult<Scans<'a, T>> {
    let shape = [scans, array.shape()[1]];
    Scans::strided(slice(array.as_slice())?, shape, [0, 1]).map_err(value_error)
}

/// The values of a contiguous array of one axis.
pub(crate) fn values<'a>(array: &'a PyReadonlyArray1<'_, f64>) -> PyResult<&'a [f64]> {
    slice(array.as_slice())
}

fn slice<T, E: std::fmt::Display>(slice: Result<&[T], E>) -> PyResult<&[T]> {
    slice.map_err(value_error)
}

/// Checks that arrays have the same length.
pub(crate) fn same_length(arrays: &[(&str, usize)]) -> PyResult<usize> {
    let Some((first, expected)) = arrays.first() else {
        return Ok(0);
    };
    match arrays.iter().find(|(_, length)| length != expected) {
        Some((name, found)) => Err(value_error(format!(
            "{name} has {found} values: expected {expected}, as {first} has"
        ))),
        None => Ok(*expected),
    }
}
