//! Materials for the tests.

use brdf_core::{AnyBrdf, Family, ModelParameters};
use brdf_fit::export::{ExportOptions, Fitted, Language, Material, Target, export};

/// BRDFs of each family that the exported sources must reproduce: usual parameters, and those at which
/// an expression of the formulas takes its limit.
pub(crate) fn brdfs() -> Vec<AnyBrdf> {
    let usual = [(0.3, 0.1, 0.2, 1.5, 1.7), (1.211, 0.521, 0.071, 1.6, 0.4)];
    let limits = [
        (0.01, 0.02, 1.0, 1.0, 1.0),
        (0.5, 0.0, 0.97, 1.006, 1.02),
        (0.2, 0.6, 3.0, 2.5, 3.0),
        (0.0, 0.4, 0.5, 1.4, 0.5),
        (0.1, 0.01, 0.01, 1.3, 1.0),
    ];
    let all = usual.into_iter().chain(limits);
    all.flat_map(|(k2, kd, k1, n, p)| {
        let at = ModelParameters { k2, kd, k1, n, p };
        Family::ALL.map(|family| AnyBrdf::new(family, &at).expect("parameters of the domain"))
    })
    .collect()
}

/// The source code of a BRDF.
pub(crate) fn source(brdf: &AnyBrdf, language: Language, name: &str) -> String {
    let fitted = Fitted {
        file: "data/scan.csv".to_owned(),
        wavelength_um: Some(0.63),
        brdf: *brdf,
        e_percent: 1.25,
        psi_max_deg: 70.0,
    };
    let material = Material { fits: vec![fitted] };
    let options = ExportOptions {
        name: name.to_owned(),
        ..ExportOptions::default()
    };
    let mut bytes = Vec::new();
    export(&material, Target::Source(language), &options, &mut bytes).expect("a source");
    String::from_utf8(bytes).expect("text")
}
