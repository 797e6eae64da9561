//! The fit from random starting points, on the measured samples of the project.

use brdf_core::ModelParameters;
use brdf_fit::{FitOptions, Measurements, Method, RefractiveIndex, fit};
use brdf_tests::{generator, in_workspace, log_uniform};

const STARTS: usize = 1000;

/// A start has reached the optimum when its E is within this fraction of it.
const TOLERANCE: f64 = 1e-6;

fn samples() -> Vec<Measurements> {
    let files = [
        "black_anodise_on_aluminium.csv",
        "titanium_anodise.csv",
        "z307_on_aluminium.csv",
        "z307_on_aluminium_cycled.csv",
    ];
    let scans = files.into_iter().flat_map(|file| {
        Measurements::read_csv(in_workspace("data/measured").join(file))
            .unwrap()
            .by_wavelength()
    });
    scans.collect()
}

#[test]
fn random_starts_end_at_the_optimum() {
    let samples = samples();
    assert_eq!(samples.len(), 9);
    for scan in samples {
        let mut options = FitOptions {
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            ..FitOptions::default()
        };
        let optimum = fit(&scan, &options).unwrap().e_percent;
        options.stage1 = None;
        for method in [Method::LevenbergMarquardt, Method::NelderMead] {
            options.stage2 = Some(method);
            let mut generator = generator(1);
            let mut reached_by_stage2 = 0;
            for _ in 0..STARTS {
                options.start = Some(ModelParameters {
                    k2: log_uniform(&mut generator, 1e-3, 10.0),
                    kd: log_uniform(&mut generator, 1e-3, 10.0),
                    k1: log_uniform(&mut generator, 1e-3, 10.0),
                    n: 1.5,
                    p: 1.0,
                });
                let fit = fit(&scan, &options).unwrap();
                let reached = |e_percent: f64| e_percent <= optimum * (1.0 + TOLERANCE);
                assert!(
                    reached(fit.e_percent),
                    "{}: {:?}",
                    scan.source,
                    options.start
                );
                reached_by_stage2 += usize::from(reached(fit.stage2.unwrap().e_percent.all));
            }
            println!(
                "{} {:?} {method}: {reached_by_stage2} of {STARTS}",
                scan.source,
                scan.wavelengths()
            );
            assert!(reached_by_stage2 * 100 >= STARTS * 99);
        }
    }
}
