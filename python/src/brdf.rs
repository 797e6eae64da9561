//! Values and reflectances of BRDFs.

use brdf_core::{AnyBrdf, Geometry, ModelParameters};
use brdf_fit::Model;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::arrays::{same_length, values};
use crate::error::value_error;
use crate::pool::{self, Interrupt};

/// The number of points between two looks for Ctrl+C.
const PIECE: usize = 1 << 16;

/// The BRDF of a model by its name.
pub(crate) fn brdf(model: &str, at: &ModelParameters) -> PyResult<AnyBrdf> {
    let model: Model = model.parse().map_err(value_error)?;
    AnyBrdf::new(model.family(), at).map_err(value_error)
}

/// f_r in 1/sr of one BRDF at points; NaN where an angle is NaN.
#[pyfunction]
pub(crate) fn evaluate<'py>(
    py: Python<'py>,
    angles: [PyReadonlyArray1<'py, f64>; 3],
    parameters: [f64; 5],
    model: &str,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let brdf = brdf(model, &of_array(parameters))?;
    let (angles, count) = checked(&angles)?;
    let values = in_pieces(py, count, |i| value(&brdf, &angles, i))?;
    Ok(values.into_pyarray(py))
}

/// f_r in 1/sr at points, each with its own parameters; NaN where one is NaN.
#[pyfunction]
pub(crate) fn evaluate_each<'py>(
    py: Python<'py>,
    angles: [PyReadonlyArray1<'py, f64>; 3],
    parameters: [PyReadonlyArray1<'py, f64>; 5],
    model: &str,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let family = model.parse::<Model>().map_err(value_error)?.family();
    let (angles, count) = checked(&angles)?;
    let columns = parameters
        .iter()
        .map(values)
        .collect::<PyResult<Vec<_>>>()?;
    for column in &columns {
        same_length(&[("psi", count), ("a parameter", column.len())])?;
    }
    let values = in_pieces(py, count, |i| {
        let mut at = of_array([0, 1, 2, 3, 4].map(|column| columns[column][i]));
        if at.k2 == 0.0 && at.k1.is_nan() {
            // As many fits give it: without a lobe, its width has no effect.
            at.k1 = 1.0;
        }
        if [at.k2, at.kd, at.k1, at.n, at.p].iter().any(|x| x.is_nan()) {
            return Ok(f64::NAN);
        }
        let brdf = AnyBrdf::new(family, &at).map_err(|error| format!("point {i}: {error}"))?;
        value(&brdf, &angles, i)
    })?;
    Ok(values.into_pyarray(py))
}

/// The directional-hemispherical reflectance at incidences psi, to a relative tolerance.
#[pyfunction]
pub(crate) fn hemispherical_reflectance<'py>(
    py: Python<'py>,
    psi: PyReadonlyArray1<'py, f64>,
    parameters: [f64; 5],
    model: &str,
    tolerance: f64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    if !(tolerance > 0.0 && tolerance < 1.0) {
        return Err(value_error(format!(
            "tolerance = {tolerance}: expected a number above 0 and below 1"
        )));
    }
    let brdf = brdf(model, &of_array(parameters))?;
    let psi = values(&psi)?;
    let found = pool::run(py, None, |interrupt: &Interrupt| {
        psi.iter()
            .enumerate()
            .map_while(|(i, &psi)| {
                let of_one = || {
                    let rho = brdf.hemispherical_reflectance(psi, tolerance);
                    rho.map_err(|error| format!("point {i}: {error}"))
                };
                interrupt.flow().is_continue().then(of_one)
            })
            .collect::<Result<Vec<f64>, String>>()
    })?;
    Ok(found.map_err(value_error)?.into_pyarray(py))
}

/// k2, kD, k1, n and p.
pub(crate) fn of_array([k2, kd, k1, n, p]: [f64; 5]) -> ModelParameters {
    ModelParameters { k2, kd, k1, n, p }
}

/// The values of psi, theta and phi, and their number.
fn checked<'a>(
    [psi, theta, phi]: &'a [PyReadonlyArray1<'_, f64>; 3],
) -> PyResult<([&'a [f64]; 3], usize)> {
    let angles = [values(psi)?, values(theta)?, values(phi)?];
    let count = same_length(&[
        ("psi", angles[0].len()),
        ("theta", angles[1].len()),
        ("phi", angles[2].len()),
    ])?;
    Ok((angles, count))
}

fn value(brdf: &AnyBrdf, [psi, theta, phi]: &[&[f64]; 3], i: usize) -> Result<f64, String> {
    let (psi, theta, phi) = (psi[i], theta[i], phi[i]);
    if psi.is_nan() || theta.is_nan() || phi.is_nan() {
        return Ok(f64::NAN);
    }
    let geometry = Geometry::new(psi, theta, phi).map_err(|error| format!("point {i}: {error}"))?;
    Ok(brdf.value(&geometry))
}

/// The values of a function of the index, without the GIL, with looks for Ctrl+C.
fn in_pieces(
    py: Python<'_>,
    count: usize,
    of_index: impl Fn(usize) -> Result<f64, String> + Sync,
) -> PyResult<Vec<f64>> {
    let mut values = Vec::with_capacity(count);
    for start in (0..count).step_by(PIECE) {
        let indices = start..(start + PIECE).min(count);
        let piece: Result<Vec<f64>, String> = py.detach(|| indices.map(&of_index).collect());
        values.extend(piece.map_err(value_error)?);
        py.check_signals()?;
    }
    Ok(values)
}
