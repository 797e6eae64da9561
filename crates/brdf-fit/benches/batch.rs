//! What the fit of a scan costs where many share their angles, against one fit after the other, in one run:
//! `cargo bench -p brdf-fit --bench batch`, or `... -- three+n` for one model, `-- intervals`, or `-- fit`.
//!
//! The scans have the 112 angles of a measured paint, parameters drawn at random, noise of 2 % of each
//! reading and of 0.1 % of the largest one. Times are the shortest of five runs, so that other work on the
//! machine does not count.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use brdf_core::{AnyBrdf, Geometry, ModelParameters};
use brdf_fit::batch::{BatchFit, BatchOptions, BatchPlan, Scans};
use brdf_fit::{
    FitOptions, Measurement, Measurements, Model, RefractiveIndex, fit,
    intervals_of_many_on_one_thread,
};
use rand::rngs::StdRng;
use rand::{RngExt as _, SeedableRng as _};

const N: f64 = 1.5;
const SCANS: usize = 20_000;
const RUNS: usize = 5;

fn angles() -> Vec<Measurement> {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/measured/z307_on_aluminium.csv");
    let all = Measurements::read_csv(&path).expect("a measured scan");
    all.by_wavelength()[0].readings().to_vec()
}

fn readings(angles: &[Measurement], scans: usize) -> Vec<f64> {
    let mut random = StdRng::seed_from_u64(1);
    let mut within = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let mut all = Vec::with_capacity(scans * angles.len());
    for _ in 0..scans {
        let mut logarithmic = |low: f64, high: f64| within(low.ln(), high.ln()).exp();
        let (k2, kd, k1) = (
            logarithmic(0.01, 1.0),
            logarithmic(0.01, 0.5),
            logarithmic(0.02, 2.0),
        );
        let at = ModelParameters {
            k2,
            kd,
            k1,
            n: N,
            p: 1.0,
        };
        let brdf = AnyBrdf::new(Model::Three.family(), &at).expect("in the domain");
        let value = |reading: &Measurement| {
            let geometry = Geometry::new(reading.psi, reading.theta, reading.phi);
            brdf.value(&geometry.expect("in the domain"))
        };
        let values: Vec<f64> = angles.iter().map(value).collect();
        let largest = values.iter().copied().fold(0.0, f64::max);
        for value in values {
            let noise: f64 = (0..12).map(|_| within(0.0, 1.0)).sum::<f64>() - 6.0;
            all.push(value + (0.02 * value + 0.001 * largest) * noise);
        }
    }
    all
}

/// The shortest time of some work in microseconds a scan.
fn microseconds<T>(scans: usize, mut work: impl FnMut() -> T) -> (f64, T) {
    let mut best = f64::INFINITY;
    let mut last = None;
    for _ in 0..RUNS {
        let start = Instant::now();
        last = Some(std::hint::black_box(work()));
        best = best.min(start.elapsed().as_secs_f64());
    }
    (1e6 * best / scans as f64, last.expect("there was a run"))
}

fn main() {
    let angles = angles();
    let m = angles.len();
    let all = readings(&angles, SCANS);
    let scans = Scans::new(&all, m).expect("whole scans");
    let mut gaps = all.clone();
    gaps.iter_mut()
        .step_by(7)
        .for_each(|reading| *reading = f64::NAN);
    let options = |model| BatchOptions {
        model,
        n: N,
        ..BatchOptions::default()
    };
    let only = std::env::args().skip(1).find(|word| !word.starts_with('-'));
    let is_wanted = |part: &str| only.as_deref().is_none_or(|only| only == part);
    println!("{m} readings a scan, one thread unless said; us a scan");
    for model in [
        Model::Lambert,
        Model::Specular,
        Model::Three,
        Model::Ggx,
        Model::Beckmann,
    ] {
        if !is_wanted(model.name()) {
            continue;
        }
        let start = Instant::now();
        let plan = BatchPlan::new(&angles, &options(model)).expect("a plan");
        let made = 1e3 * start.elapsed().as_secs_f64();
        let (plain, _) = microseconds(SCANS, || plan.run(scans).on_one_thread().fit());
        println!("{model:12} {plain:8.2}   plan {made:.1} ms");
        if model != Model::Three {
            continue;
        }
        let (errors, _) = microseconds(SCANS, || {
            plan.run(scans)
                .constant_noise_errors()
                .on_one_thread()
                .fit()
        });
        let (threads, _) = microseconds(SCANS, || plan.fit_many(scans));
        let with_gaps = Scans::new(&gaps, m).expect("whole scans");
        let (gaps, _) = microseconds(SCANS, || plan.run(with_gaps).on_one_thread().fit());
        println!("  with errors {errors:.2}, with gaps {gaps:.2}, on all threads {threads:.2}");
    }
    for (model, part) in [
        (Model::ThreeN, 10),
        (Model::SmithN, 20),
        (Model::PowerN, 200),
    ] {
        if !is_wanted(model.name()) {
            continue;
        }
        let plan = BatchPlan::new(&angles, &options(model)).expect("a plan");
        let few = Scans::new(&all[..SCANS / part * m], m).expect("whole scans");
        let (time, _) = microseconds(SCANS / part, || plan.run(few).on_one_thread().fit());
        println!("{model:12} {time:8.2}");
    }
    if is_wanted("intervals") {
        intervals(&angles, &all);
    }
    for model in [Model::Three, Model::ThreeN] {
        if is_wanted("fit") {
            one_by_one(&angles, &all, model);
        }
    }
}

/// The intervals of the first scans, whose errors are estimated from the residuals of each.
fn intervals(angles: &[Measurement], all: &[f64]) {
    const SCANS: usize = 500;
    let few = Scans::new(&all[..SCANS * angles.len()], angles.len()).expect("whole scans");
    let options = BatchOptions::default();
    let (time, _) = microseconds(SCANS, || {
        let mut observer = |_, _| ControlFlow::Continue(());
        intervals_of_many_on_one_thread(angles, &options, few, &mut observer)
    });
    println!("intervals    {time:8.2}");
}

/// The library's fit of the first scans, and how far E of the plan is from it.
fn one_by_one(angles: &[Measurement], all: &[f64], model: Model) {
    const FITS: usize = 200;
    let m = angles.len();
    let options = FitOptions {
        model,
        refractive_index: Some(RefractiveIndex::Same(N)),
        ..FitOptions::default()
    };
    let scan = |readings: &[f64]| {
        let pairs = angles.iter().zip(readings);
        let readings = pairs.map(|(at, brdf)| Measurement { brdf: *brdf, ..*at });
        Measurements::new("scan", readings.collect()).expect("readings")
    };
    let scans: Vec<Measurements> = all.chunks(m).take(FITS).map(scan).collect();
    let fit_all = || -> Vec<f64> {
        let e = |scan| fit(scan, &options).expect("a fit").e_percent;
        scans.iter().map(e).collect()
    };
    let (time, single) = microseconds(FITS, fit_all);
    let batch = BatchOptions {
        model,
        n: N,
        ..BatchOptions::default()
    };
    let plan = BatchPlan::new(angles, &batch).expect("a plan");
    let few = Scans::new(&all[..FITS * m], m).expect("whole scans");
    let many: BatchFit = plan.fit_many(few).expect("fits");
    let apart = single
        .iter()
        .zip(&many.e_percent)
        .map(|(a, b)| (a / b - 1.0).abs());
    println!(
        "fit, {model:12} {time:8.2}   largest relative difference of E {:.1e}",
        apart.fold(0.0, f64::max)
    );
}
