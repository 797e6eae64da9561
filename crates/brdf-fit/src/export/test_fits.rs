//! Fits for the tests of the formats.

use brdf_core::{AnyBrdf, Family, ModelParameters};

use super::material::{Fitted, Material};

/// A fit without a wavelength.
pub(super) fn fitted(family: Family, parameters: ModelParameters) -> Fitted {
    Fitted {
        file: "scan.csv".to_owned(),
        wavelength_um: None,
        brdf: AnyBrdf::new(family, &parameters).unwrap(),
        e_percent: 1.0,
        psi_max_deg: 70.0,
    }
}

/// A fit of the model of the paper with k2, kD, k1 and n.
pub(super) fn of_paper([k2, kd, k1, n]: [f64; 4]) -> Fitted {
    let parameters = ModelParameters {
        k2,
        kd,
        k1,
        n,
        p: 1.0,
    };
    fitted(Family::Paper, parameters)
}

/// A fit of a scan, with parameters that have no short decimal form.
pub(super) fn of_scan(file: &str, wavelength_um: Option<f64>, family: Family) -> Fitted {
    let parameters = ModelParameters {
        k2: 0.1 + 0.2,
        kd: 1.0 / 3.0,
        k1: 0.1,
        n: 1.5,
        p: if family == Family::Power { 1.7 } else { 1.0 },
    };
    Fitted {
        file: file.to_owned(),
        wavelength_um,
        e_percent: 1.25,
        ..fitted(family, parameters)
    }
}

/// Fits of two scans, one of them without a wavelength.
pub(super) fn material() -> Material {
    let fits = vec![
        of_scan("a/x.csv", Some(0.5), Family::Paper),
        of_scan("a/x.csv", Some(0.503), Family::Ggx),
        of_scan("a/x.csv", Some(0.9), Family::Power),
        of_scan("b/y.csv", None, Family::Beckmann),
    ];
    Material { fits }
}
