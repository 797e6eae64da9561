//! Evaluates a BRDF at a million points with the fastest evaluator within a tolerance.

use std::error::Error;
use std::time::Instant;

use brdf_core::evaluator::Points;
use brdf_core::scene::{Coordinates, Domain, Plan, Scene};
use brdf_core::{Parameters, ThreeParameterBrdf};

const COUNT: usize = 1_000_000;

fn main() -> Result<(), Box<dyn Error>> {
    // Sample 001 of the paper's Table 1 at 0.91 um.
    let brdf = ThreeParameterBrdf::new(Parameters::new(1.211, 0.521, 0.071)?, 1.60)?.into();
    let scene = Scene {
        domain: Domain::all((0.0, 1.2), (0.0, 1.2))?,
        coordinates: Coordinates::Angles,
        tolerance: 1e-4,
        evaluations: COUNT as f64,
    };
    let plan = Plan::new(&brdf, &scene)?;
    println!("evaluator: {}", plan.evaluator.name());

    // One incidence of 0.5 rad and views over a range of angles and azimuths.
    let sequence = |factor: f64, largest: f64| -> Vec<f64> {
        let at = |i: usize| largest * (i as f64 * factor).fract();
        (0..COUNT).map(at).collect()
    };
    let psi = vec![0.5; COUNT];
    let theta = sequence(0.618_034, 1.2);
    let phi = sequence(0.754_878, std::f64::consts::TAU);
    let mut values = vec![0.0; COUNT];
    let start = Instant::now();
    let points = Points::Angles {
        psi: &psi,
        theta: &theta,
        phi: &phi,
    };
    plan.evaluator.values(&points, &mut values)?;
    let nanoseconds = 1e9 * start.elapsed().as_secs_f64() / COUNT as f64;

    let mean = values.iter().sum::<f64>() / COUNT as f64;
    println!("{COUNT} points, {nanoseconds:.1} ns each, mean f_r = {mean:.4} 1/sr");
    Ok(())
}
