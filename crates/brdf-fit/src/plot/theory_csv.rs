//! The curves of a BRDF without measurements as CSV. They are computed at the view angles at which
//! the curves of the figures are drawn.

use std::io;

use brdf_core::AnyBrdf;

use super::curves::theory_curves;
use crate::format::in_degrees;
use crate::report::THEORY_COLUMNS;

/// Writes the curves of a BRDF in the plane of incidence, at incidence angles psi in radians.
///
/// The columns are [`THEORY_COLUMNS`]; `name` fills the first, and those of the measurement are empty.
///
/// # Errors
///
/// The writer fails.
pub fn write_theory_alone(
    name: &str,
    brdf: &AnyBrdf,
    incidences: &[f64],
    writer: impl io::Write,
) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(THEORY_COLUMNS)?;
    for curve in theory_curves(brdf, incidences) {
        for at in &curve.theory {
            let mut record = THEORY_COLUMNS.map(|_| String::new());
            name.clone_into(&mut record[0]);
            record[2] = in_degrees(curve.psi).to_string();
            record[3] = at.theta_deg.to_string();
            "0".clone_into(&mut record[4]);
            record[7] = at.value.to_string();
            csv.write_record(record)?;
        }
    }
    csv.flush()
}
