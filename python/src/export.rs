//! Writing fits in the formats of other programs.

use brdf_fit::Document;
use brdf_fit::export::{self as library, ExportOptions, Material, Target, export_companion};
use pyo3::prelude::*;

use crate::error::{ExportError, value_error};
use crate::fit::Report;
use crate::pool;

/// The content of the file of an export, that of its companion where the format has one, and a note on
/// the error of a table.
type Exported = (Vec<u8>, Option<(String, Vec<u8>)>, Option<String>);

/// Fits of one scan in a format.
#[pyfunction]
pub(crate) fn export(
    py: Python<'_>,
    fits: Vec<PyRef<'_, Report>>,
    format: &str,
    name: String,
    tolerance: Option<f64>,
    grid: &str,
    rgb_um: Option<[f64; 3]>,
) -> PyResult<Exported> {
    let target: Target = format.parse().map_err(value_error)?;
    if let Some(tolerance) = tolerance.filter(|t| !(*t > 0.0 && *t < 1.0)) {
        return Err(value_error(format!(
            "tolerance = {tolerance}: expected a number above 0 and below 1"
        )));
    }
    let options = ExportOptions {
        name,
        tolerance,
        grid: grid.parse().map_err(value_error)?,
        rgb: rgb_um,
    };
    let document = Document::new(fits.iter().map(|fit| fit.0.clone()).collect());
    let json = serde_json::to_vec(&document).map_err(value_error)?;
    let words = |error: &dyn std::error::Error| ExportError::new_err(error.to_string());
    let material = Material::from_bytes("the fits", &json)
        .map_err(|error| words(&error))?
        .for_file(None)
        .map_err(|error| words(&error))?;
    let written = pool::run(py, None, |_| {
        let (mut file, mut companion) = (Vec::new(), Vec::new());
        let note = library::export(&material, target, &options, &mut file)?;
        export_companion(target, &options, &mut companion)?;
        Ok::<_, library::ExportError>((file, companion, note))
    })?;
    let (file, companion, note) = written.map_err(|error| words(&error))?;
    let companion = target
        .companion_extension()
        .map(|extension| (extension.to_owned(), companion));
    Ok((file, companion, note.map(|note| note.to_string())))
}
