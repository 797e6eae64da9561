//! The scans that plans are measured on: those that were measured, and simulated ones whose truth is another model.

use std::path::Path;

use brdf_core::{AnyBrdf, Family, ModelParameters};
use brdf_fit::{Measurement, Measurements};
use rand_distr::{Distribution as _, StandardNormal};

use crate::{expected_optima, generator};

/// A scan of one wavelength with its name.
pub struct Sample {
    /// The file and the wavelength, or the truth.
    pub name: String,
    /// The scan.
    pub scan: Measurements,
}

/// The scans of a folder that are listed in its table of optima, each wavelength by itself.
pub fn measured(folder: &Path) -> Vec<Sample> {
    let optima = expected_optima(&folder.join("expected_optima.csv"));
    let mut files: Vec<String> = optima.into_iter().map(|optimum| optimum.file).collect();
    files.dedup();
    let mut samples = Vec::new();
    for file in files {
        let scan = Measurements::read_csv(folder.join(&file)).expect("a readable sample");
        for scan in scan.by_wavelength() {
            let um = scan.wavelengths().first().copied().flatten().unwrap_or(0.0);
            let name = format!("{} {um}", file.trim_end_matches(".csv"));
            samples.push(Sample { name, scan });
        }
    }
    samples
}

/// Scans whose truth is GGX, Beckmann, the ellipsoid with an exponent, or GGX with a peak towards the source: with
/// the noise of a goniometer, in the plane of incidence (psi 10 to 70 deg by 20) and with azimuths.
pub fn simulated() -> Vec<Sample> {
    let mut samples = Vec::new();
    for (name, family, p, retro) in [
        ("GGX", Family::Ggx, 1.0, 0.0),
        ("Beckmann", Family::Beckmann, 1.0, 0.0),
        ("exponent 2", Family::Power, 2.0, 0.0),
        ("exponent 0.6", Family::Power, 0.6, 0.0),
        ("GGX with retroreflection", Family::Ggx, 1.0, 0.3),
    ] {
        for (width, k1) in [("narrow", 0.12), ("broad", 0.4)] {
            let at = ModelParameters {
                k2: 0.05 / k1,
                kd: 0.05,
                k1,
                n: 1.5,
                p,
            };
            let brdf = AnyBrdf::new(family, &at).expect("parameters in the domain");
            for (design, azimuths) in [
                ("in-plane", [0.0].as_slice()),
                ("azimuth", &[0.0, 45.0, 90.0, 135.0]),
            ] {
                let scan = simulate(&brdf, retro, azimuths, samples.len() as u64);
                let name = format!("{name}, {width}, {design}");
                samples.push(Sample { name, scan });
            }
        }
    }
    samples
}

/// A scan with 1 % of each incidence, 1 % of each reading, and a peak of 8 deg towards the source.
fn simulate(brdf: &AnyBrdf, retro: f64, azimuths_deg: &[f64], seed: u64) -> Measurements {
    let mut random = generator(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let mut readings = Vec::new();
    for psi_deg in [10.0, 30.0, 50.0, 70.0_f64] {
        let gain = 1.0 + 0.01 * normal();
        for phi_deg in azimuths_deg {
            for step in 0..33 {
                let theta_deg = -80.0 + 5.0 * f64::from(step);
                let mut reading = Measurement {
                    wavelength_um: None,
                    psi: psi_deg.to_radians(),
                    theta: theta_deg.to_radians(),
                    phi: f64::to_radians(*phi_deg),
                    brdf: 0.0,
                    sigma: None,
                };
                let from_source = from_source_deg(&reading);
                if from_source < 4.0 {
                    continue;
                }
                let geometry = reading.geometry().expect("angles in the domain");
                let peak = 1.0 + retro * (-0.5 * (from_source / 8.0).powi(2)).exp() * 4.0;
                let noise = gain * (1.0 + 0.01 * normal());
                reading.brdf = brdf.value(&geometry) * peak * noise;
                readings.push(reading);
            }
        }
    }
    Measurements::new("simulated", readings).expect("valid readings")
}

fn from_source_deg(reading: &Measurement) -> f64 {
    brdf_fit::planning::Setting::from(reading)
        .from_source()
        .to_degrees()
}
