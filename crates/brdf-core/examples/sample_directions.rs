//! Estimates the hemispherical reflectance by importance sampling and compares it with the integral.

use std::error::Error;

use brdf_core::{Parameters, Sampler, ThreeParameterBrdf};

const COUNT: u32 = 100_000;

fn main() -> Result<(), Box<dyn Error>> {
    // Sample 001 of the paper's Table 1 at 0.91 um, with light incident at 60 deg.
    let brdf = ThreeParameterBrdf::new(Parameters::new(1.211, 0.521, 0.071)?, 1.60)?;
    let psi = 60_f64.to_radians();
    let source = [psi.sin(), 0.0, psi.cos()];

    let sampler = Sampler::new(&brdf.into());
    let mut sum = 0.0;
    for i in 0..COUNT {
        // Even points in three dimensions in place of random numbers (Roberts 2018).
        let steps = [0.819_172_513, 0.671_043_607, 0.549_700_478];
        let numbers = steps.map(|step: f64| (f64::from(i) * step).fract());
        if let Some(sample) = sampler.sample(source, numbers)? {
            sum += sample.weight;
        }
    }
    let estimate = sum / f64::from(COUNT);
    let integral = brdf.hemispherical_reflectance(psi, 1e-9)?;
    println!(
        "hemispherical reflectance at 60 deg: {estimate:.5} by sampling, {integral:.5} by integration"
    );
    Ok(())
}
