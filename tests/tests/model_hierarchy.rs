//! The models of the hierarchy and the reference models on measured samples, against the errors that
//! an independent program found with n free.

use std::path::Path;

use brdf_fit::Model;
use brdf_fit::{FitOptions, RefractiveIndex, fit};
use brdf_tests::{in_workspace, one_wavelength, shared_data};

/// File, wavelength in micrometres, model, and E in percent of the independent program to two decimals.
type Expected = (&'static str, f64, Model, f64);

const PROJECT: [Expected; 8] = [
    ("z307_on_aluminium.csv", 0.63079, Model::Three, 2.84),
    ("z307_on_aluminium.csv", 0.63079, Model::ThreeN, 0.09),
    (
        "black_anodise_on_aluminium.csv",
        0.63079,
        Model::Three,
        2.61,
    ),
    (
        "black_anodise_on_aluminium.csv",
        0.63079,
        Model::ThreeN,
        0.71,
    ),
    (
        "black_anodise_on_aluminium.csv",
        0.63079,
        Model::SmithN,
        0.18,
    ),
    ("titanium_anodise.csv", 0.38565, Model::Three, 2.39),
    ("titanium_anodise.csv", 0.38565, Model::ThreeN, 0.71),
    ("titanium_anodise.csv", 0.38565, Model::PowerN, 0.13),
];

const SHARED: [Expected; 6] = [
    (
        "rt300s/anoblack_ec1_on_aluminium.csv",
        0.65,
        Model::Three,
        2.09,
    ),
    (
        "rt300s/anoblack_ec1_on_aluminium.csv",
        0.65,
        Model::ThreeN,
        1.81,
    ),
    ("rt300s/magic_black.csv", 0.65, Model::Three, 5.33),
    ("rt300s/magic_black.csv", 0.65, Model::ThreeN, 0.32),
    ("mwir/steel_sandblasted.csv", 4.0, Model::Three, 7.30),
    ("mwir/steel_sandblasted.csv", 4.0, Model::ThreeN, 0.65),
];

fn e_percent(folder: &Path, file: &str, wavelength_um: f64, model: Model) -> f64 {
    let options = FitOptions {
        model,
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    let scan = one_wavelength(&folder.join(file), wavelength_um);
    fit(&scan, &options).unwrap().e_percent
}

fn check(folder: &Path, table: &[Expected]) {
    for &(file, wavelength_um, model, expected) in table {
        let found = e_percent(folder, file, wavelength_um, model);
        assert!(
            (found - expected).abs() <= 0.02,
            "{file} {model}: {found} {expected}"
        );
    }
}

#[test]
fn the_projects_samples_have_the_known_errors() {
    check(&in_workspace("data/measured"), &PROJECT);
}

#[test]
fn the_shared_samples_have_the_known_errors() {
    let Some(folder) = shared_data() else { return };
    check(&folder, &SHARED);
}

#[test]
fn at_the_given_index_the_papers_model_is_better_for_paint_and_ggx_for_anodise() {
    let e = |file, model| e_percent(&in_workspace("data/measured"), file, 0.63079, model);
    let paint = "z307_on_aluminium.csv";
    assert!(e(paint, Model::Three) < e(paint, Model::Ggx));
    assert!(e(paint, Model::Three) < e(paint, Model::Beckmann));
    let anodise = "black_anodise_on_aluminium.csv";
    assert!(e(anodise, Model::Ggx) < e(anodise, Model::Three));
    assert!(e(anodise, Model::GgxN) < e(anodise, Model::ThreeN));
}
