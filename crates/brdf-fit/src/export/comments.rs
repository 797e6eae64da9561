//! The comment lines at the head of the tables: which fits they contain, and how accurate they are.

use std::io::{self, Write};

use super::domain::MAX_ZENITH_DEG;
use super::interpolated::Table;
use super::material::Fitted;

/// The file of the scan and its wavelength, on one line.
pub(super) fn origin(fit: &Fitted) -> String {
    let file = fit.file.replace(['\n', '\r'], " ");
    format!("{file}{}", fit.wavelength_suffix())
}

/// The family and the parameters of a fit.
pub(super) fn parameters(fit: &Fitted) -> String {
    let at = fit.brdf.model_parameters();
    format!(
        "family {}: k2 {}, kD {}, k1 {}, n {}, p {}",
        fit.brdf.family(),
        at.k2,
        at.kd,
        at.k1,
        at.n,
        at.p
    )
}

/// Writes the fits of an interpolated table, its tolerance, its domain and the largest error found.
///
/// # Errors
///
/// Writing fails.
pub(super) fn write(
    fits: &[Fitted],
    tolerance: f64,
    table: &Table,
    writer: &mut dyn Write,
) -> io::Result<()> {
    for fit in fits {
        writeln!(writer, "# fit of {}, E = {} %", origin(fit), fit.e_percent)?;
        writeln!(writer, "# {}", parameters(fit))?;
    }
    writeln!(writer, "# refractive_index: {}", refractive_index(fits))?;
    writeln!(
        writer,
        "# tolerance: {tolerance} (relative, between the entries)"
    )?;
    writeln!(
        writer,
        "# domain: incidence and view up to {MAX_ZENITH_DEG} deg, all azimuths"
    )?;
    let (error, checked) = (table.largest_error, table.checked);
    writeln!(
        writer,
        "# largest_error: {error:.2e} (found at {checked} points between the entries)"
    )
}

/// The refractive indices in the form that [`read`](crate::read) takes: one number, or one for each
/// wavelength.
fn refractive_index(fits: &[Fitted]) -> String {
    let n = |fit: &Fitted| fit.brdf.model_parameters().n;
    let pair = |fit: &Fitted| fit.wavelength_um.map(|um| format!("{um}={}", n(fit)));
    let pairs: Vec<String> = fits.iter().filter_map(pair).collect();
    match fits {
        [only] => n(only).to_string(),
        _ => pairs.join(","),
    }
}
