//! The times of the library alone, beside those of `benchmarks/overhead.py`:
//! `cargo run --release --example library_times`.

use std::time::Instant;

use brdf_fit::batch::{BatchOptions, BatchPlan, Scans};
use brdf_fit::{Depth, FitOptions, Measurements, RefractiveIndex, Report};

/// The number of scans of the batch.
const SCANS: usize = 100_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../data/measured/z307_on_aluminium.csv"
    );
    let scan = Measurements::read_csv(file)?.by_wavelength().swap_remove(0);
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    let fit = best(300, || {
        let (report, error) = Report::new(&scan, &options, Depth::Fit);
        assert!(error.is_none() && report.fit.is_some());
    });
    println!("fit with its report: {:.0} us", 1e6 * fit);

    let plan = BatchPlan::new(scan.readings(), &BatchOptions::default())?;
    let one: Vec<f64> = scan.readings().iter().map(|reading| reading.brdf).collect();
    let many: Vec<f64> = (0..SCANS)
        .flat_map(|i| one.iter().map(move |f_r| f_r * (1.0 + i as f64)))
        .collect();
    let scans = Scans::new(&many, plan.readings())?;
    let batch = best(10, || {
        let fits = plan.run(scans).on_one_thread().fit();
        assert_eq!(fits.map(|fits| fits.len()), Ok(SCANS));
    });
    println!(
        "fit_many on one thread: {:.2} us a scan",
        1e6 * batch / SCANS as f64
    );
    Ok(())
}

/// The shortest of many runs, in seconds.
fn best(runs: usize, mut work: impl FnMut()) -> f64 {
    let mut shortest = f64::INFINITY;
    for _ in 0..runs {
        let start = Instant::now();
        work();
        shortest = shortest.min(start.elapsed().as_secs_f64());
    }
    shortest
}
