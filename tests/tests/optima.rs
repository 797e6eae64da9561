//! Every measured sample against the optimum that an independent program found for it.

use std::path::Path;

use brdf_fit::report::{Depth, Report};
use brdf_fit::{FitOptions, Method, RefractiveIndex, fit};
use brdf_tests::{ExpectedOptimum, expected_optima, in_workspace, one_wavelength, shared_data};

/// A fit has reached the optimum when its E is within this fraction of it.
const TOLERANCE: f64 = 1e-6;

/// The one sample whose optimum stands at the other program's limit of k1: ours may be lower.
const AT_A_LIMIT: &str = "satellite/solar_array.csv";

#[test]
fn every_combination_of_methods_reaches_every_optimum_of_the_projects_samples() {
    let table = expected_optima(&in_workspace("tests/data/measured_optima.csv"));
    assert_eq!(table.len(), 9);
    reaches_every_optimum(&in_workspace("data/measured"), table);
}

#[test]
fn every_combination_of_methods_reaches_every_optimum_of_the_shared_samples() {
    let Some(folder) = shared_data() else { return };
    let table = expected_optima(&folder.join("expected_optima.csv"));
    assert_eq!(table.len(), 59);
    reaches_every_optimum(&folder, table);
}

fn reaches_every_optimum(folder: &Path, table: Vec<ExpectedOptimum>) {
    for row in table {
        let scan = one_wavelength(&folder.join(&row.file), row.wavelength_um);
        for stage1 in [Method::NelderMead, Method::LevenbergMarquardt] {
            for stage2 in [Method::NelderMead, Method::LevenbergMarquardt] {
                let options = FitOptions {
                    refractive_index: Some(RefractiveIndex::Same(row.n)),
                    stage1: Some(stage1),
                    stage2: Some(stage2),
                    ..FitOptions::default()
                };
                let fit = fit(&scan, &options).unwrap();
                // Where the limit leaves out no reading, stage 1 is over all of them.
                let first = fit.stage1.unwrap().e_percent.own;
                let second = fit.stage2.unwrap().e_percent.own;
                for (found, optimum) in [(first, row.up_to_60.0), (second, row.all.0)] {
                    let excess = found / optimum - 1.0;
                    let name = format!("{} {} {stage1} {stage2}", row.file, row.wavelength_um);
                    assert!(excess <= TOLERANCE, "{name}: {excess:e} above the optimum");
                    assert!(
                        excess >= -TOLERANCE || row.file == AT_A_LIMIT,
                        "{name}: {excess:e}, another E"
                    );
                }
            }
        }
    }
}

#[test]
fn a_sample_that_the_model_cannot_describe_is_said_to_be_one() {
    let Some(folder) = shared_data() else { return };
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    for row in expected_optima(&folder.join("expected_optima.csv")) {
        let scan = one_wavelength(&folder.join(&row.file), row.wavelength_um);
        let (report, _) = Report::new(&scan, &options, Depth::Fit);
        let says_so = report
            .text()
            .contains("the model does not describe this sample");
        assert_eq!(
            says_so,
            row.all.0 > 10.0,
            "{} {}",
            row.file,
            row.wavelength_um
        );
    }
}
