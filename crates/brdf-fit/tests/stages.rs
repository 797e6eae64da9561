//! The two stages of a fit, their options and their reports.

use brdf_core::{ModelParameters, Parameters};
#[cfg(feature = "plot")]
use brdf_fit::plot::{Figure, report_figures};
#[cfg(feature = "plot")]
use brdf_fit::report::{Picture, html};
use brdf_fit::synthetic::scan;
use brdf_fit::{
    Depth, Fit, FitError, FitOptions, Measurement, Measurements, Objective, ObjectiveError,
    RefractiveIndex, Report, Warning, fit,
};

fn truth() -> Parameters {
    Parameters::new(0.3, 0.1, 0.2).unwrap()
}

fn options() -> FitOptions {
    FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    }
}

/// The scan without the incidences that `keep` refuses.
fn scan_with(keep: impl Fn(&Measurement) -> bool) -> Measurements {
    let all = scan(truth(), 1.5);
    let readings = all.readings().iter().copied().filter(keep).collect();
    Measurements::new("test", readings).unwrap()
}

#[test]
fn stage_1_uses_the_incidences_up_to_its_limit_and_stage_2_all() {
    let fit = fit(&scan(truth(), 1.5), &options()).unwrap();
    let up_to_60: usize = fit
        .incidences
        .iter()
        .filter(|i| i.psi_deg <= 60.0)
        .map(|i| i.readings)
        .sum();
    assert_eq!(fit.stage1.unwrap().readings, up_to_60);
    assert_eq!(fit.stage2.unwrap().readings, fit.readings);
    assert!(up_to_60 < fit.readings);
}

#[test]
fn stage_1_without_readings_is_left_out_and_says_why() {
    let fit = fit(&scan_with(|r| r.psi > 1.1), &options()).unwrap();
    assert_eq!(fit.stage1, None);
    assert_eq!(
        fit.stage1_left_out.as_deref(),
        Some("0 readings up to 60 deg")
    );
}

#[test]
fn a_given_start_is_where_the_first_stage_starts() {
    let start = ModelParameters::three(Parameters::new(1.0, 1.0, 1.0).unwrap(), 1.5);
    let fit = fit(
        &scan(truth(), 1.5),
        &FitOptions {
            start: Some(start),
            ..options()
        },
    )
    .unwrap();
    assert_eq!(fit.initial.parameters, start.parameters());
    assert_eq!(fit.initial.weights, None);
}

#[test]
fn a_minimum_that_stage_2_missed_is_taken() {
    let hurried = FitOptions {
        start: Some(ModelParameters::three(
            Parameters::new(1.0, 1.0, 1.0).unwrap(),
            1.5,
        )),
        max_iterations: 1,
        ..options()
    };
    let fit = fit(&scan(truth(), 1.5), &hurried).unwrap();
    let check = fit.global_check.unwrap();
    assert!(check.lower_minimum_taken && check.stage2_e_percent > fit.e_percent);
    assert!((fit.parameters.k1 / 0.2 - 1.0).abs() < 1e-5);
}

#[test]
fn the_size_of_the_readings_does_not_matter() {
    for size in [1e-20, 1e20] {
        let mut readings = scan(truth(), 1.5).readings().to_vec();
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf *= size * (1.0 + 0.1 * (i as f64).sin());
        }
        let scan = Measurements::new("test", readings).unwrap();
        let fit = fit(&scan, &options()).unwrap();
        assert!((fit.parameters.k1 / 0.2 - 1.0).abs() < 0.1);
        assert!((fit.parameters.k2 / (0.3 * size) - 1.0).abs() < 0.1);
        let report = Report::new(&scan, &options(), Depth::Fit).0;
        // A surface of 1e20 is brighter than white, and its reflectance exceeds 1.
        let kinds: Vec<_> = report.warnings.iter().map(Warning::kind).collect();
        let expected = ["too-bright?", "reflectance-above-one"];
        assert_eq!(kinds, if size > 1.0 { &expected[..] } else { &[] });
    }
}

#[test]
fn readings_that_weigh_nothing_are_counted_and_do_not_count() {
    let mut options = options();
    options.weights.g1 = "0=1,5=0".parse().unwrap();
    let found = fit(&scan(truth(), 1.5), &options).unwrap();
    assert_eq!(
        found.readings - found.zero_weight,
        found.incidences[0].readings
    );
    options.weights.g1 = "0=0,1=0".parse().unwrap();
    let scan = scan_with(|r| r.psi > 0.1);
    assert_eq!(
        fit(&scan, &options),
        Err(FitError::Objective(ObjectiveError::AllZero))
    );
}

#[test]
fn several_wavelengths_are_refused() {
    let mut readings = scan(truth(), 1.5).readings().to_vec();
    readings[0].wavelength_um = Some(0.5);
    readings[1].wavelength_um = Some(0.6);
    let several = Measurements::new("test", readings).unwrap();
    assert_eq!(
        fit(&several, &options()),
        Err(FitError::SeveralWavelengths(3))
    );
}

#[test]
fn the_refractive_index_of_the_options_goes_before_that_of_the_file() {
    let mut scan = scan(truth(), 1.5);
    assert_eq!(
        fit(&scan, &FitOptions::default()),
        Err(FitError::NoRefractiveIndex(None))
    );
    scan.refractive_index = Some(RefractiveIndex::Same(1.7));
    assert_eq!(fit(&scan, &FitOptions::default()).unwrap().n, 1.7);
    assert_eq!(fit(&scan, &options()).unwrap().n, 1.5);
}

#[test]
fn the_json_reads_back() {
    let fit = fit(&scan(truth(), 1.5), &options()).unwrap();
    let json = serde_json::to_string(&fit).unwrap();
    assert!(json.contains("\"stage1_limit_deg\":60.0"));
    let back: Fit = serde_json::from_str(&json).unwrap();
    assert!(back == fit, "the numbers differ");
}

fn alone() -> FitOptions {
    FitOptions {
        stage2: None,
        ..options()
    }
}

fn rippled() -> Measurements {
    let mut readings = scan(truth(), 1.5).readings().to_vec();
    for (i, reading) in readings.iter_mut().enumerate() {
        reading.brdf *= 1.0 + 0.05 * (2.4 * i as f64).sin();
    }
    Measurements::new("test", readings).unwrap()
}

/// All of it is that of a scan that ends at the limit.
#[test]
fn stage_1_alone_is_the_fit_of_a_scan_that_ends_at_its_limit() {
    let (whole, options) = (rippled(), alone());
    let shorter = whole.up_to(options.stage1_limit);
    let (report, error) = Report::new(&whole, &options, Depth::Assessed);
    assert_eq!(error, None);
    let (expected, _) = Report::new(&shorter, &self::options(), Depth::Assessed);
    let fit = report.fit.as_ref().unwrap();
    let short_fit = expected.fit.as_ref().unwrap();
    let same = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
    assert_eq!((fit.readings, fit.stage2), (shorter.readings().len(), None));
    assert_eq!(fit.incidences.len(), short_fit.incidences.len());
    same(fit.e_percent, short_fit.e_percent);
    same(fit.parameters.k1, short_fit.parameters.k1);
    let check = fit.global_check.as_ref().unwrap();
    assert!(!check.lower_minimum_taken);
    same(check.stage2_e_percent, fit.e_percent);
    let errors = |report: &Report| {
        let covariance = &report.uncertainty.as_ref().unwrap().covariance;
        [covariance[0][0], covariance[2][2]]
    };
    same(errors(&report)[0], errors(&expected)[0]);
    same(errors(&report)[1], errors(&expected)[1]);
    let assessed = [&report, &expected].map(|r| r.assessment.as_ref().unwrap());
    assert_eq!(assessed[0].readings, assessed[1].readings);
    for (a, b) in assessed[0].models.iter().zip(&assessed[1].models) {
        same(a.e_percent, b.e_percent);
        same(
            a.predicted_e_percent.unwrap(),
            b.predicted_e_percent.unwrap(),
        );
    }
    assert_eq!(report.warnings.len(), expected.warnings.len());
    // The stage reports E over all readings as well.
    let stage = fit.stage1.unwrap();
    let family = options.model.family();
    let all = Objective::new(&whole, family, 1.5, &options.weights).unwrap();
    same(stage.e_percent.all, 100.0 * all.error(&stage.parameters));
    assert!(stage.e_percent.all != stage.e_percent.own);
}

/// Needs the figures of the report.
#[cfg(feature = "plot")]
#[test]
fn the_report_names_the_scope_of_stage_1_alone() {
    let (report, _) = Report::new(&rippled(), &alone(), Depth::Fit);
    assert_eq!(report.status(), "ok (stage 1 alone)");
    let (text, readings) = (report.text(), report.fit.as_ref().unwrap().readings);
    let line = format!("stage 1 alone, psi <= 60 deg: {readings} readings");
    assert!(text.contains(&line) && !text.contains("stage 2"), "{text}");
    let figures = report_figures(&rippled(), &report).unwrap();
    let said = |f: &Figure| f.caption.contains("fitted to psi <= 60 deg alone");
    assert!(figures.iter().all(said));
    let pictures: Vec<Picture> = figures.iter().map(Picture::from).collect();
    let page = html(&[(&report, &pictures)]);
    assert!(page.contains("stage 1 alone, psi &lt;= 60 deg"));
}

#[test]
fn stages_that_cannot_be_are_errors_of_usage() {
    let none = FitOptions {
        stage1: None,
        ..alone()
    };
    assert_eq!(fit(&rippled(), &none), Err(FitError::NoStage));
    let steep = scan_with(|r| r.psi > 1.1);
    let error = fit(&steep, &alone()).unwrap_err();
    assert!(error.is_usage() && FitError::NoStage.is_usage());
    assert!(
        error.to_string().contains("0 readings up to 60 deg"),
        "{error}"
    );
}

#[test]
fn options_from_elsewhere_are_checked() {
    let with = |n: f64, limit_deg: f64| FitOptions {
        refractive_index: Some(RefractiveIndex::Same(n)),
        energy_limit: Some(limit_deg.to_radians()),
        ..options()
    };
    for (options, message) in [
        (with(0.5, 80.0), "refractive index n = 0.5"),
        (with(f64::NAN, 80.0), "refractive index n = NaN"),
        (with(1.5, 95.0), "up to 95 deg"),
        (with(1.5, -5.0), "up to -5 deg"),
    ] {
        let error = fit(&rippled(), &options).unwrap_err();
        assert!(
            error.is_usage() && error.to_string().contains(message),
            "{error}"
        );
    }
}

/// Written before stage 2 could be left out.
#[test]
fn the_json_of_two_stages_is_what_it_was() {
    let fit = fit(&rippled(), &options()).unwrap();
    let json = serde_json::to_value(&fit).unwrap();
    assert_eq!(json["options"]["stage2"], "levenberg-marquardt");
    assert!(json["stage2"]["iterations"].is_u64());
    let alone = serde_json::to_value(brdf_fit::fit(&rippled(), &alone()).unwrap()).unwrap();
    assert!(alone["stage2"].is_null() && alone["options"]["stage2"].is_null());
    let back: Fit = serde_json::from_value(alone).unwrap();
    assert_eq!((back.stage2, back.options.stage2), (None, None));
}
