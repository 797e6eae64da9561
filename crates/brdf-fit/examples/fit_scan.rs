//! Fits a scan and prints the parameters with their intervals and the warnings.
//!
//! `cargo run --example fit_scan -- data/measured/z307_on_aluminium.csv 1.5`; without arguments, a
//! computed scan is fitted.

use brdf_core::Parameters;
use brdf_fit::{Depth, FitOptions, Measurements, RefractiveIndex, Report, synthetic};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let scans = match arguments.next() {
        Some(path) => Measurements::read_csv(path)?.by_wavelength(),
        None => vec![synthetic::scan(Parameters::new(0.3, 0.1, 0.2)?, 1.5)],
    };
    let n = arguments.next().map_or(Ok(1.5), |n| n.parse())?;
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(n)),
        ..FitOptions::default()
    };
    for scan in &scans {
        let (report, error) = Report::new(scan, &options, Depth::Fit);
        if let Some(error) = error {
            return Err(error.into());
        }
        let Some(fit) = &report.fit else { continue };
        println!("{} readings, E = {:.3} %", fit.readings, fit.e_percent);
        for estimate in report.uncertainty.iter().flat_map(|u| &u.estimates) {
            println!("  {}: {estimate}", estimate.parameter);
        }
        for warning in &report.warnings {
            println!("  warning: {warning}");
        }
    }
    Ok(())
}
