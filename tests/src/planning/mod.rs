//! How many readings a scan needs: chosen by a plan, by a grid over the angles, by a grid in each incidence,
//! and at random.
//!
//! The error of a choice is the root mean square of ln(theory/measured) over *all* readings above zero of the scan,
//! the theory being the fit of `three+n` with relative weights to the chosen ones. It is given as a multiple of the
//! error of the fit to all of them.

mod scans;
mod strategies;
mod table;

pub use scans::{Sample, measured, simulated};
pub use strategies::{Choices, Strategy};
pub use table::{Needed, curves_csv, predictions, ratios, rises, table};

use brdf_fit::Measurements;
use brdf_fit::planning::{PlanOptions, Setting, predict};

/// [`planning::error_of`](brdf_fit::planning::error_of), infinite where the chosen readings cannot be fitted.
pub fn error_of(scan: &Measurements, chosen: &[usize]) -> f64 {
    brdf_fit::planning::error_of(scan, chosen).unwrap_or(f64::INFINITY)
}

/// The error that is predicted for the fit to some readings, over all readings above zero of the scan.
pub fn predicted_error(scan: &Measurements, chosen: &[usize], options: &PlanOptions) -> f64 {
    let readings = chosen.iter().map(|&i| scan.readings()[i]).collect();
    let some = Measurements::new("chosen", readings).expect("readings of a scan");
    let above = scan.readings().iter().filter(|reading| reading.brdf > 0.0);
    let over: Vec<Setting> = above.map(Setting::from).collect();
    predict(&some, &over, options)
        .expect("one wavelength")
        .error
}
