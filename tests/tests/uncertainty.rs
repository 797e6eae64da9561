//! The coverage of the confidence intervals over simulated scans, and their ratio to the bootstrap
//! over incidences on measured scans.

use brdf_core::published::PUBLISHED;
use brdf_core::{Geometry, Parameters, ThreeParameterBrdf};
use brdf_fit::Knowledge;
use brdf_fit::Loss;
use brdf_fit::Parameter;
use brdf_fit::Weights;
use brdf_fit::report::{Depth, Report};
use brdf_fit::synthetic::scan;
use brdf_fit::{FitOptions, Measurement, Measurements, RefractiveIndex};
use brdf_tests::{expected_optima, generator, in_workspace, normal, one_wavelength};

const SCANS: u64 = 2000;
const PARAMETERS: [Parameter; 3] = [Parameter::K2, Parameter::Kd, Parameter::K1];

fn options(n: f64) -> FitOptions {
    FitOptions {
        refractive_index: Some(RefractiveIndex::Same(n)),
        ..FitOptions::default()
    }
}

fn truth_of(truth: &Parameters, parameter: Parameter) -> f64 {
    match parameter {
        Parameter::K2 => truth.k2,
        Parameter::Kd => truth.kd,
        _ => truth.k1,
    }
}

/// How often the 68 and 95 % intervals of k2, kD and k1 contain the truth, in percent, over scans
/// whose readings `disturb` changes by a normal deviate.
fn coverage(
    truth: Parameters,
    n: f64,
    options: &FitOptions,
    disturb: impl Fn(&mut Measurement, f64),
) -> [[f64; 2]; 3] {
    let clean = scan(truth, n);
    let mut generator = generator(2002);
    let mut covered = [[0_u32; 2]; 3];
    for _ in 0..SCANS {
        let mut readings = clean.readings().to_vec();
        for reading in &mut readings {
            disturb(reading, normal(&mut generator));
        }
        let noisy = Measurements::new("simulated", readings).unwrap();
        let (report, error) = Report::new(&noisy, options, Depth::Fit);
        assert_eq!(error, None);
        let uncertainty = report.uncertainty.unwrap();
        for (covered, parameter) in covered.iter_mut().zip(PARAMETERS) {
            let estimate = uncertainty.estimate(parameter).unwrap();
            let value = truth_of(&truth, parameter);
            if let Knowledge::Determined { interval_68, .. } = estimate.knowledge {
                covered[0] += u32::from(interval_68.contains(value));
            }
            covered[1] += u32::from(estimate.interval_95().contains(value));
        }
    }
    covered.map(|pair| pair.map(|count| 100.0 * f64::from(count) / SCANS as f64))
}

fn check(name: &str, coverage: [[f64; 2]; 3]) {
    for (parameter, [at_68, at_95]) in PARAMETERS.iter().zip(coverage) {
        println!("{name}: {parameter} 68 %: {at_68:.1} %, 95 %: {at_95:.1} %");
        assert!(
            (93.0..=97.0).contains(&at_95),
            "{name} {parameter}: {at_95} %"
        );
        assert!(
            (65.0..=71.5).contains(&at_68),
            "{name} {parameter}: {at_68} %"
        );
    }
}

/// Errors of f cos theta with the same variance for all readings, as the intervals assume.
#[test]
fn intervals_from_the_residuals_cover_the_truth() {
    let row = PUBLISHED[4];
    let size = 0.003;
    let noise = |reading: &mut Measurement, z: f64| reading.brdf += size * z / reading.theta.cos();
    check(
        "residuals",
        coverage(row.parameters, row.n, &options(row.n), noise),
    );
}

/// Errors of 5 % of each reading, stated in the scan and used as weights.
#[test]
fn intervals_from_stated_errors_cover_the_truth() {
    let row = PUBLISHED[4];
    let options = FitOptions {
        weights: Weights {
            by_sigma: true,
            ..Weights::default()
        },
        ..options(row.n)
    };
    let noise = |reading: &mut Measurement, z: f64| {
        let sigma = 0.05 * reading.brdf;
        reading.sigma = Some(sigma);
        reading.brdf += sigma * z;
    };
    check("stated", coverage(row.parameters, row.n, &options, noise));
}

/// The band of a theory curve is the standard deviation of that curve over simulated scans.
#[test]
fn the_band_is_the_spread_of_the_curve() {
    let row = PUBLISHED[4];
    let clean = scan(row.parameters, row.n);
    let mut generator = generator(7);
    let at = Geometry::in_plane(0.6, -0.7).unwrap();
    let (mut values, mut bands) = (Vec::new(), Vec::new());
    for _ in 0..400 {
        let mut readings = clean.readings().to_vec();
        for reading in &mut readings {
            reading.brdf += 0.003 * normal(&mut generator) / reading.theta.cos();
        }
        let noisy = Measurements::new("simulated", readings).unwrap();
        let (report, _) = Report::new(&noisy, &options(row.n), Depth::Fit);
        let fit = report.fit.unwrap();
        let brdf = ThreeParameterBrdf::new(fit.parameters, fit.n).unwrap();
        values.push(brdf.value(&at));
        let any = brdf_core::AnyBrdf::new(fit.model().family(), &fit.at()).unwrap();
        bands.push(report.uncertainty.unwrap().band(&any, &at));
    }
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let centre = mean(&values);
    let squares: Vec<f64> = values.iter().map(|v| (v - centre).powi(2)).collect();
    let ratio = mean(&bands) / mean(&squares).sqrt();
    println!("band over spread: {ratio:.3}");
    assert!((0.9..1.1).contains(&ratio), "{ratio}");
}

/// On real samples the model has systematic errors, so that the parameters depend on which incidences
/// were measured: the bootstrap shows a larger spread than the residuals do.
#[test]
fn the_bootstrap_over_incidences_contains_the_fit() {
    let table = expected_optima(&in_workspace("tests/data/measured_optima.csv"));
    for row in table {
        let path = in_workspace("data/measured").join(&row.file);
        let sample = one_wavelength(&path, row.wavelength_um);
        let (report, _) = Report::new(&sample, &options(row.n), Depth::Assessed);
        let uncertainty = report.uncertainty.unwrap();
        let assessment = report.assessment.unwrap();
        for spread in &assessment.bootstrap {
            let estimate = uncertainty.estimate(spread.parameter).unwrap();
            let Knowledge::Determined { standard_error, .. } = estimate.knowledge else {
                continue;
            };
            let ratio = spread.standard_deviation / standard_error;
            println!(
                "{} {} um: {} {ratio:.1}",
                row.file, row.wavelength_um, spread.parameter
            );
            assert!(spread.from <= estimate.value && estimate.value <= spread.to);
            assert!(ratio > 0.5 && ratio < 100.0, "{ratio}");
        }
    }
}

/// The weights of a robust loss depend on the residuals; the intervals account for that.
#[test]
fn intervals_of_robust_fits_cover_the_truth() {
    let row = PUBLISHED[4];
    let noise = |reading: &mut Measurement, z: f64| reading.brdf += 0.003 * z / reading.theta.cos();
    for loss in [Loss::Huber, Loss::Tukey] {
        let options = FitOptions {
            robust: Some(loss),
            global_check: false,
            ..options(row.n)
        };
        let covered = coverage(row.parameters, row.n, &options, noise);
        check(&loss.to_string(), covered);
    }
}
