//! The coverage of the intervals over simulated scans, their values on measured scans, and the tests of
//! the noise.

use brdf_core::published::PUBLISHED;
use brdf_core::{Geometry, ThreeParameterBrdf};
use brdf_fit::report::{Depth, Report};
use brdf_fit::synthetic::scan;
use brdf_fit::{FitOptions, Measurements, Parameter, RefractiveIndex};
use brdf_tests::coverage::{Cell, Design, Noise, Study, summarise};
use brdf_tests::{generator, in_workspace, normal, one_wavelength};

/// The simulated scans of each cell. The full study has 300: see `docs/validation.md`.
const SCANS: u64 = 40;

/// Five standard deviations of the share of [`SCANS`] that hold the truth where 95 % do, in percent.
const CHANCE: f64 = 17.0;

/// Samples and designs of the reduced study: a narrow lobe, a broad one and a paint; few incidences and
/// many.
const CELLS: [(&str, Design); 4] = [
    ("001", Design::Four),
    ("002", Design::Five),
    ("Z307", Design::Z307),
    ("003", Design::Three),
];

fn options(n: f64) -> FitOptions {
    FitOptions {
        refractive_index: Some(RefractiveIndex::Same(n)),
        ..FitOptions::default()
    }
}

/// Every cell holds the truth in as many scans as the full study requires, less what chance allows.
fn check(study: Study, noises: &[Noise], least_mean: f64) {
    for &noise in noises {
        let cells = CELLS.map(|(sample, design)| Cell {
            study,
            sample,
            design,
            noise,
        });
        let found: Vec<_> = cells.iter().map(|cell| cell.run(SCANS)).collect();
        for summary in summarise(&found) {
            let (name, parameter) = (noise.name(), summary.parameter);
            let Some(least) = Some(summary.least).filter(|least| least.is_finite()) else {
                continue;
            };
            println!(
                "{}, {name}: {parameter} {:.0} % [{least:.0} %], width {:.1}",
                study.name(),
                summary.mean,
                summary.width
            );
            let (cell_limit, _) = noise.limits();
            assert!(
                least >= cell_limit - CHANCE,
                "{name} {parameter}: {least} %"
            );
            assert!(
                summary.mean >= least_mean,
                "{name} {parameter}: {} %",
                summary.mean
            );
        }
    }
}

#[test]
fn intervals_of_the_paper_s_model_hold_the_truth_for_every_kind_of_noise() {
    check(Study::Three, &Noise::ALL[..10], 88.0);
}

#[test]
fn intervals_are_not_much_wider_than_the_errors() {
    for noise in [Noise::Proportional1, Noise::Floor] {
        for (sample, design) in CELLS {
            let cell = Cell {
                study: Study::Three,
                sample,
                design,
                noise,
            };
            for found in cell.run(SCANS) {
                assert!((0.6..1.6).contains(&found.width), "{cell:?} {found:?}");
            }
        }
    }
}

#[test]
fn intervals_with_a_fitted_index_hold_the_truth() {
    let noises = [Noise::Constant, Noise::Floor, Noise::Gain, Noise::Real];
    check(Study::ThreeN, &noises, 88.0);
}

#[test]
fn intervals_with_a_free_exponent_hold_the_truth() {
    check(Study::PowerN, &[Noise::Floor], 88.0);
}

#[test]
fn intervals_of_relative_fits_and_of_stated_errors_hold_the_truth() {
    let noises = [Noise::Proportional5, Noise::Gain, Noise::Lobe];
    check(Study::Relative, &noises, 88.0);
    check(Study::Stated, &noises, 88.0);
}

#[test]
fn intervals_of_a_robust_fit_hold_the_truth_of_scans_with_outliers() {
    check(Study::Huber, &[Noise::Outliers, Noise::Proportional5], 90.0);
}

#[test]
fn intervals_of_an_azimuthal_scan_hold_the_truth() {
    for noise in [Noise::Constant, Noise::Floor, Noise::Gain] {
        let cell = Cell {
            study: Study::Three,
            sample: "003",
            design: Design::Azimuthal,
            noise,
        };
        for found in cell.run(SCANS) {
            assert!(found.percent >= 90.0 - CHANCE, "{noise:?} {found:?}");
        }
    }
}

/// A weight of zero has an upper limit, which holds it.
#[test]
fn the_upper_limit_of_a_diffuse_weight_on_its_bound_holds_the_truth() {
    let mut generator = generator(14);
    let truth = brdf_core::Parameters::new(0.3, 0.0, 0.2).unwrap();
    let clean = scan(truth, 1.5);
    let (mut on_bound, mut held) = (0, 0);
    for _ in 0..200 {
        let mut readings = clean.readings().to_vec();
        for reading in &mut readings {
            reading.brdf += 0.002 * normal(&mut generator) / reading.theta.cos();
        }
        let noisy = Measurements::new("simulated", readings).unwrap();
        let (report, _) = Report::new(&noisy, &options(1.5), Depth::Fit);
        let uncertainty = report.uncertainty.unwrap();
        let estimate = uncertainty.estimate(Parameter::Kd).unwrap();
        on_bound += u32::from(estimate.value == 0.0);
        let interval = estimate.interval_95();
        held += u32::from(interval.to.is_some() && interval.contains(0.0));
    }
    println!("kD = 0: on its bound in {on_bound} of 200, held in {held}");
    assert!(on_bound > 50 && held >= 180, "{on_bound} {held}");
}

/// The limits of an independent implementation, to 1 %.
#[test]
fn the_intervals_of_measured_scans_are_those_of_an_independent_computation() {
    for (file, um, limits) in [
        (
            "z307_on_aluminium.csv",
            0.630_79,
            [0.0155, 0.0338, 0.0120, 0.0240, 0.116, 0.313],
        ),
        (
            "z307_on_aluminium.csv",
            0.852_23,
            [0.0249, 0.0593, 0.0077, 0.0231, 0.092, 0.238],
        ),
        (
            "z307_on_aluminium_cycled.csv",
            1.059,
            [0.0353, 0.0699, 0.0101, 0.0261, 0.105, 0.189],
        ),
        (
            "black_anodise_on_aluminium.csv",
            0.630_79,
            [0.0180, 0.0252, 0.0381, 0.0524, 0.427, 1.002],
        ),
        (
            "titanium_anodise.csv",
            0.385_65,
            [0.3578, 0.6222, 0.0558, 0.1727, 0.084, 0.160],
        ),
    ] {
        let scan = one_wavelength(&in_workspace("data/measured").join(file), um);
        let (report, _) = Report::new(&scan, &options(1.5), Depth::Fit);
        let uncertainty = report.uncertainty.unwrap();
        let parameters = [Parameter::K2, Parameter::Kd, Parameter::K1];
        for (parameter, limits) in parameters.iter().zip(limits.chunks(2)) {
            let interval = uncertainty.estimate(*parameter).unwrap().interval_95();
            for (found, expected) in [interval.from, interval.to].iter().zip(limits) {
                let found = found.unwrap();
                // The expected limits are rounded to their last digit.
                let tolerance = 0.01 * expected
                    + 0.00005_f64.max(0.0005 * f64::from(u8::from(*expected > 0.08)));
                assert!(
                    (found - expected).abs() <= tolerance,
                    "{file} {um} {parameter}: {found} {expected}"
                );
            }
        }
    }
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
    // The estimate of constant errors includes errors in proportion to the reading, and is larger.
    assert!((0.9..1.4).contains(&ratio), "{ratio}");
}

/// The share of scans in which each test rejects at 1 %: growth with the reading, incidences, patches.
fn rejections(noise: Noise) -> [f64; 3] {
    let cell = Cell {
        study: Study::Three,
        sample: "003",
        design: Design::Four,
        noise,
    };
    cell.rejections(200)
}

/// Size and power of the tests: each rejects true noise in about 1 % of scans, and what it is made for
/// in nearly all.
#[test]
fn the_tests_of_the_noise_have_their_size_and_power() {
    for (noise, expected) in [
        (Noise::Constant, [0, 0, 0]),
        (Noise::Proportional5, [100, 0, 0]),
        (Noise::Gain, [100, 100, 100]),
        (Noise::Lobe, [100, 0, 100]),
    ] {
        let found = rejections(noise);
        println!("{}: {found:?}", noise.name());
        for (found, expected) in found.iter().zip(expected) {
            if expected == 0 {
                assert!(*found <= 5.0, "{}: {found} %", noise.name());
            } else {
                assert!(*found >= 85.0, "{}: {found} %", noise.name());
            }
        }
    }
}
