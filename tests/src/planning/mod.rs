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

use brdf_core::AnyBrdf;
use brdf_fit::planning::{PlanOptions, Setting, predict};
use brdf_fit::{AssumedErrors, FitOptions, Measurements, Model, RefractiveIndex, Weights, fit};

/// The fit of `three+n` with relative weights.
pub fn options() -> FitOptions {
    FitOptions {
        model: Model::ThreeN,
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        weights: Weights {
            errors: AssumedErrors::Relative,
            ..Weights::default()
        },
        ..FitOptions::default()
    }
}

/// The root mean square of ln(theory/measured) over all readings above zero of a scan, of the fit to some of them;
/// infinite where these cannot be fitted.
pub fn error_of(scan: &Measurements, chosen: &[usize]) -> f64 {
    let readings = chosen.iter().map(|&i| scan.readings()[i]).collect();
    let fitted = Measurements::new("chosen", readings)
        .ok()
        .and_then(|chosen| fit(&chosen, &options()).ok());
    fitted.map_or(f64::INFINITY, |fitted| {
        let brdf = AnyBrdf::new(fitted.model().family(), &fitted.at()).expect("fitted parameters");
        error_over(scan, &brdf)
    })
}

/// The root mean square of ln(theory/measured) over all readings above zero.
pub fn error_over(scan: &Measurements, brdf: &AnyBrdf) -> f64 {
    let readings = scan.readings().iter().filter(|reading| reading.brdf > 0.0);
    let squares = readings.map(|reading| {
        let geometry = reading.geometry().expect("angles of a scan");
        (brdf.value(&geometry).max(1e-300) / reading.brdf)
            .ln()
            .powi(2)
    });
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| {
        (sum + square, count + 1.0)
    });
    (sum / count).sqrt()
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
