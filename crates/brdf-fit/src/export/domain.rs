//! What the tables have in common: where their tolerance holds, and what their comments say.

use std::f64::consts::FRAC_PI_2;
use std::io::{self, Write};

use brdf_core::{AnyBrdf, Geometry};

use super::interpolated::Table;
use super::material::Fitted;

/// Up to this angle from the normal, of incidence and of view, a table keeps to its tolerance.
pub(super) const LIMIT_DEG: f64 = 85.0;

/// f_r; below the horizon that at the horizon, for the sake of interpolation.
pub(super) fn value(brdf: &AnyBrdf, psi: f64, theta: f64, phi: f64) -> f64 {
    let above = theta.min(FRAC_PI_2.next_down());
    Geometry::new(psi, above, phi).map_or(0.0, |geometry| brdf.value(&geometry))
}

/// Angles at equal distances, both ends included.
pub(super) fn spread(from: f64, to: f64, count: u32) -> Vec<f64> {
    let step = (to - from) / f64::from(count - 1);
    (0..count).map(|i| from + f64::from(i) * step).collect()
}

/// Angles from 0 on, close to each other there: the lobe may be narrow.
pub(super) fn from_narrow(to: f64) -> Vec<f64> {
    let ratio = 1.5_f64;
    let mut angles = vec![0.0];
    let mut angle = to;
    while angle > to * 1e-4 {
        angles.push(angle);
        angle /= ratio;
    }
    angles
}

/// A ten-thousandth of a degree is finer than any instrument, and short to write.
pub(super) fn rounded_deg(angle: f64) -> f64 {
    (angle * 1e4).round() / 1e4
}

/// The parameters of a fit, in words.
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

/// What the table is of, and how exact it is.
pub(super) fn write_comments(
    fits: &[Fitted],
    tolerance: f64,
    table: &Table,
    writer: &mut dyn Write,
) -> io::Result<()> {
    for fit in fits {
        let file = fit.file.replace(['\n', '\r'], " ");
        let wavelength = fit
            .wavelength_um
            .map_or_else(String::new, |um| format!(" at {um} um"));
        let e = fit.e_percent;
        writeln!(writer, "# fit of {file}{wavelength}, E = {e} %")?;
        writeln!(writer, "# {}", parameters(fit))?;
    }
    writeln!(writer, "# refractive_index: {}", refractive_index(fits))?;
    writeln!(
        writer,
        "# tolerance: {tolerance} (relative, between the entries)"
    )?;
    writeln!(
        writer,
        "# domain: incidence and view up to {LIMIT_DEG} deg, all azimuths"
    )?;
    let (error, checked) = (table.largest_error, table.checked);
    writeln!(
        writer,
        "# largest_error: {error:.2e} (found at {checked} points between the entries)"
    )
}

/// As our readers take it: one number, or one for each wavelength.
pub(super) fn refractive_index(fits: &[Fitted]) -> String {
    let n = |fit: &Fitted| fit.brdf.model_parameters().n;
    let pair = |fit: &Fitted| fit.wavelength_um.map(|um| format!("{um}={}", n(fit)));
    let pairs: Vec<String> = fits.iter().filter_map(pair).collect();
    match fits {
        [only] => n(only).to_string(),
        _ => pairs.join(","),
    }
}
