//! One scan in every form that can be written by hand gives one fit: the forms hold all digits of their
//! numbers, so that only the rounding of unit conversions remains.

use std::fmt::Write as _;

use brdf_core::{Geometry, ModelParameters, Parameters, ThreeParameterBrdf};
use brdf_fit::{FitOptions, Measurements, ReadOptions, RefractiveIndex, fit};
use std::f64::consts::PI;

const PSI_DEG: [f64; 4] = [10.0, 30.0, 50.0, 65.0];

/// The scan: psi, theta and f_r of a paint with noise, theta positive on the source's side.
fn scan() -> Vec<(f64, f64, f64)> {
    let parameters = Parameters::new(0.12, 0.30, 0.25).unwrap();
    let brdf = ThreeParameterBrdf::new(parameters, 1.5).unwrap();
    let mut all = Vec::new();
    for psi in PSI_DEG {
        for step in -16..=16_i32 {
            let theta = f64::from(step) * 5.0;
            let at = Geometry::new(psi.to_radians(), theta.to_radians(), 0.0).unwrap();
            let noise = 1.0 + 0.02 * (f64::from(step) * 1.7 + psi).sin();
            all.push((psi, theta, brdf.value(&at) * noise));
        }
    }
    all
}

/// The zenith angle and the azimuth of a view, from its signed angle: azimuth 0 is `towards`.
fn zenith_and_azimuth(theta: f64, towards_source: bool) -> (f64, f64) {
    let is_at_zero = (theta >= 0.0) == towards_source;
    (theta.abs(), if is_at_zero { 0.0 } else { 180.0 })
}

fn rows(header: &str, row: impl Fn(f64, f64, f64) -> String) -> String {
    let rows = scan().into_iter().map(|(psi, theta, f)| row(psi, theta, f));
    std::iter::once(header.to_owned())
        .chain(rows)
        .map(|line| line + "\n")
        .collect()
}

/// The forms: a name, the text, and the declarations and sides that it needs.
fn forms() -> Vec<(&'static str, String)> {
    let mut all = vec![
        (
            "degrees",
            rows("psi_deg,theta_deg,brdf_per_sr", |p, t, f| {
                format!("{p},{t},{f}")
            }),
        ),
        (
            "radians",
            rows("psi_rad\ttheta_rad\tbrdf", |p, t, f| {
                format!("{}\t{}\t{f}", p.to_radians(), t.to_radians())
            }),
        ),
        (
            "azimuths",
            rows("theta_i,theta_r,phi,f_r", |p, t, f| {
                let (theta, phi) = zenith_and_azimuth(t, true);
                format!("{p},{theta},{phi},{f}")
            }),
        ),
        (
            "both azimuths, spaces",
            rows("theta_i phi_i theta_o phi_o brdf", |p, t, f| {
                let (theta, phi) = zenith_and_azimuth(t, true);
                format!("{p} 40 {theta} {} {f}", phi + 40.0)
            }),
        ),
        (
            "decimal commas",
            rows("psi_deg;theta_deg;brdf_per_sr", |p, t, f| {
                format!("{p};{t};{f}")
                    .replace('.', ",")
                    .replace('-', "\u{2212}")
            }),
        ),
        (
            "percent",
            rows("AOI (deg),view angle (deg),R%", |p, t, f| {
                format!("{p},{t},{}", 100.0 * PI * f)
            }),
        ),
        (
            "cosine-corrected",
            rows(
                "# quantity: brdf_cos\npsi_deg,theta_deg,value",
                |p, t, f| format!("{p},{t},{}", f * t.to_radians().cos()),
            )
            .replace("value\n", "brdf_cos\n"),
        ),
        (
            "logarithms",
            rows("psi_deg,theta_deg,log10_brdf", |p, t, f| {
                format!("{p},{t},{}", f.log10())
            }),
        ),
        (
            "a column for a wavelength",
            rows("psi_deg,theta_deg,550nm", |p, t, f| format!("{p},{t},{f}")),
        ),
        (
            "signal and reference",
            rows("psi_deg,theta_deg,signal,reference", |p, t, f| {
                format!("{p},{t},{},{}", 7.0 * PI * f, 7.0)
            }),
        ),
        (
            "Black Lab",
            rows(
                "BRF Values\nPaint\nsrc_z src_a view_z view_a 550nm",
                |p, t, f| {
                    let (theta, phi) = zenith_and_azimuth(t, true);
                    format!("{p} 0 {theta} {phi} {}", PI * f)
                },
            ),
        ),
        (
            "ASTM",
            rows(
                "ANGLE_UNIT deg\nVARS theta_i,theta_s,phi_s,BRDF",
                |p, t, f| {
                    let (theta, phi) = zenith_and_azimuth(t, false);
                    format!("{p},{theta},{phi},{f}")
                },
            ),
        ),
    ];
    all.push(("goniometer", pivot()));
    all
}

/// Incidences in columns, views in rows.
fn pivot() -> String {
    let mut text = "theta_deg".to_owned();
    for psi in PSI_DEG {
        let _ = write!(text, ",{psi}");
    }
    let all = scan();
    let count = all.len() / PSI_DEG.len();
    for row in 0..count {
        let _ = write!(text, "\n{}", all[row].1);
        for column in 0..PSI_DEG.len() {
            let _ = write!(text, ",{}", all[column * count + row].2);
        }
    }
    text + "\n"
}

fn fitted(name: &str, text: &str) -> ModelParameters {
    let read = Measurements::from_bytes("scan.txt", text.as_bytes(), &ReadOptions::default());
    let scan = read.unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(scan.readings().len(), 132, "{name}");
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    fit(&scan, &options).unwrap().at()
}

#[test]
fn every_form_of_a_scan_gives_the_same_fit() {
    let forms = forms();
    let expected = fitted(forms[0].0, &forms[0].1);
    for (name, text) in &forms[1..] {
        let found = fitted(name, text);
        for (found, expected) in [
            (found.k2, expected.k2),
            (found.kd, expected.kd),
            (found.k1, expected.k1),
        ] {
            let error = (found / expected - 1.0).abs();
            assert!(error < 1e-10, "{name}: {found} instead of {expected}");
        }
    }
}
