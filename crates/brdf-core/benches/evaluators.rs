//! The time of an evaluation by each of the evaluators. Compare times within one run:
//! `cargo bench -p brdf-core --bench evaluators`.

#![expect(
    clippy::cast_possible_truncation,
    reason = "rounds to the nearest `f32`"
)]

use std::hint::black_box;

use brdf_core::evaluator::{Double, Evaluator, FittedFresnel, Points, Single};
use brdf_core::{AnyBrdf, Family, Geometry, ModelParameters, Parameters};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rayon::prelude::*;

/// The number of points whose arrays stay in the nearest caches.
const POINTS: usize = 1024;

/// Arrays of angles over the domain without a pattern that a branch predictor could learn.
fn angles(count: usize) -> [Vec<f64>; 3] {
    let sequence = |factor: f64, scale: f64| {
        (0..count)
            .map(|i| scale * (i as f64 * 0.618_033_988_75 * factor).fract())
            .collect()
    };
    [sequence(1.0, 1.5), sequence(7.3, 1.5), sequence(3.1, 6.0)]
}

fn brdf(family: Family) -> AnyBrdf {
    let three = Parameters::new(0.3, 0.1, 0.2).expect("in the domain");
    let at = ModelParameters {
        p: 1.7,
        ..ModelParameters::three(three, 1.5)
    };
    AnyBrdf::new(family, &at).expect("in the domain")
}

fn in_cache(c: &mut Criterion) {
    let brdf = brdf(Family::Paper);
    let AnyBrdf::Paper(paper) = brdf else {
        unreachable!("the requested family")
    };
    let [psi, theta, phi] = angles(POINTS);
    let cosines = [&psi, &theta, &phi].map(|a| a.iter().map(|x| x.cos()).collect::<Vec<_>>());
    let [cos_psi, cos_theta, cos_phi] = &cosines;
    let mut out = vec![0.0; POINTS];
    let mut group = c.benchmark_group("evaluators, 1024 points");
    group.throughput(Throughput::Elements(POINTS as u64));

    group.bench_function("value() from angles, one by one", |b| {
        b.iter(|| {
            for i in 0..POINTS {
                let geometry = Geometry::new(psi[i], theta[i], phi[i]).expect("in the domain");
                out[i] = black_box(&paper).value(&geometry);
            }
        });
    });
    group.bench_function("value() from cosines, one by one", |b| {
        b.iter(|| {
            for i in 0..POINTS {
                let geometry = Geometry::from_cosines(cos_psi[i], cos_theta[i], cos_phi[i]);
                out[i] = black_box(&paper).value(&geometry.expect("in the domain"));
            }
        });
    });
    let from_cosines = Points::Cosines {
        psi: cos_psi,
        theta: cos_theta,
        phi: cos_phi,
    };
    let from_angles = Points::Angles {
        psi: &psi,
        theta: &theta,
        phi: &phi,
    };
    let double = Double::new(brdf);
    for (name, points) in [("cosines", from_cosines), ("angles", from_angles)] {
        group.bench_function(format!("f64 batch from {name}"), |b| {
            b.iter(|| double.values(black_box(&points), &mut out));
        });
    }
    let narrow = |a: &Vec<f64>| a.iter().map(|&x| x as f32).collect::<Vec<f32>>();
    let [psi32, theta32, phi32] = [&psi, &theta, &phi].map(narrow);
    let [cos_psi32, cos_theta32, cos_phi32] = [cos_psi, cos_theta, cos_phi].map(narrow);
    let mut out32 = vec![0.0_f32; POINTS];
    let from_cosines = Points::Cosines {
        psi: &cos_psi32,
        theta: &cos_theta32,
        phi: &cos_phi32,
    };
    let from_angles = Points::Angles {
        psi: &psi32,
        theta: &theta32,
        phi: &phi32,
    };
    let single = Single::new(brdf);
    let fitted = FittedFresnel::new(brdf, 0.0, 1e-3).expect("a polynomial");
    for (name, points) in [("cosines", from_cosines), ("angles", from_angles)] {
        group.bench_function(format!("f32 batch from {name}"), |b| {
            b.iter(|| single.values_f32(black_box(&points), &mut out32));
        });
        group.bench_function(
            format!("f32 batch, fitted Fresnel factor, from {name}"),
            |b| {
                b.iter(|| fitted.values_f32(black_box(&points), &mut out32));
            },
        );
    }
    group.finish();
}

/// All families, in `f32` and `f64`, from cosines.
fn families(c: &mut Criterion) {
    let [psi, theta, phi] = angles(POINTS).map(|a| a.iter().map(|x| x.cos()).collect::<Vec<_>>());
    let points = Points::Cosines {
        psi: &psi,
        theta: &theta,
        phi: &phi,
    };
    let narrow = |a: &[f64]| a.iter().map(|&x| x as f32).collect::<Vec<f32>>();
    let [psi32, theta32, phi32] = [narrow(&psi), narrow(&theta), narrow(&phi)];
    let points32 = Points::Cosines {
        psi: &psi32,
        theta: &theta32,
        phi: &phi32,
    };
    let mut group = c.benchmark_group("families, 1024 points from cosines");
    group.throughput(Throughput::Elements(POINTS as u64));
    for family in Family::ALL {
        let (mut out, mut out32) = (vec![0.0; POINTS], vec![0.0_f32; POINTS]);
        let (double, single) = (Double::new(brdf(family)), Single::new(brdf(family)));
        group.bench_function(format!("{family:?} f64"), |b| {
            b.iter(|| double.values(black_box(&points), &mut out));
        });
        group.bench_function(format!("{family:?} f32"), |b| {
            b.iter(|| single.values_f32(black_box(&points32), &mut out32));
        });
    }
    group.finish();
}

/// The number of points from which on several threads are faster than one.
fn break_even(c: &mut Criterion) {
    let [psi, theta, phi] =
        angles(1 << 16).map(|a| a.iter().map(|x| x.cos() as f32).collect::<Vec<_>>());
    let mut out = vec![0.0_f32; 1 << 16];
    let single = Single::new(brdf(Family::Paper));
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let one_thread = one_thread.expect("a pool");
    let mut group = c.benchmark_group("f32 batch from cosines");
    for count in [1 << 14, 1 << 15, 1 << 16] {
        let points = Points::Cosines {
            psi: &psi[..count],
            theta: &theta[..count],
            phi: &phi[..count],
        };
        let out = &mut out[..count];
        group.throughput(Throughput::Elements(count as u64));
        group.bench_function(format!("{count} points, one thread"), |b| {
            one_thread.install(|| b.iter(|| single.values_f32(black_box(&points), out)));
        });
        group.bench_function(format!("{count} points, all threads"), |b| {
            b.iter(|| single.values_f32(black_box(&points), out));
        });
    }
    group.finish();
}

/// Compares `f32` with the memory, a triad over the same arrays: three are read and one is written.
fn in_memory(c: &mut Criterion) {
    const MANY: usize = 16 << 20;
    // Arrays at the same offset in a page share cache sets. These have different offsets.
    const APART: usize = 272;
    let arrays =
        angles(MANY + 3 * APART).map(|a| a.iter().map(|x| x.cos() as f32).collect::<Vec<_>>());
    let part = |i: usize| &arrays[i][i * APART..i * APART + MANY];
    let (psi, theta, phi) = (part(0), part(1), part(2));
    let mut out = vec![0.0_f32; MANY + 3 * APART];
    let out = &mut out[3 * APART..];
    let points = Points::Cosines { psi, theta, phi };
    let single = Single::new(brdf(Family::Paper));
    let fitted = FittedFresnel::new(brdf(Family::Paper), 0.0, 1e-3).expect("a polynomial");
    let mut group = c.benchmark_group("16 Mi points, all threads");
    group.sample_size(20);
    group.throughput(Throughput::Elements(MANY as u64));
    group.bench_function("triad", |b| {
        b.iter(|| triad([psi, theta, phi], out));
    });
    group.bench_function("f32 batch from cosines", |b| {
        b.iter(|| single.values_f32(black_box(&points), out));
    });
    group.bench_function("f32 batch, fitted Fresnel factor, from cosines", |b| {
        b.iter(|| fitted.values_f32(black_box(&points), out));
    });
    group.finish();
}

/// Computes out = a + b c on all threads.
fn triad([a, b, c]: [&[f32]; 3], out: &mut [f32]) {
    const CHUNK: usize = 1 << 20;
    out.par_chunks_mut(CHUNK)
        .enumerate()
        .for_each(|(chunk, out)| {
            let range = chunk * CHUNK..chunk * CHUNK + out.len();
            let (a, b, c) = (&a[range.clone()], &b[range.clone()], &c[range]);
            for (((out, a), b), c) in out.iter_mut().zip(a).zip(b).zip(c) {
                *out = a + b * c;
            }
        });
}

/// Compares a grid of views for each incidence with as many points of a batch.
fn grid(c: &mut Criterion) {
    let [psi, theta, phi] = angles(POINTS);
    let psi = &psi[..16];
    let double = Double::new(brdf(Family::Paper));
    let mut out = vec![0.0; psi.len() * POINTS];
    let mut group = c.benchmark_group("grid, 16 incidences, 1024 views");
    group.throughput(Throughput::Elements(out.len() as u64));
    group.bench_function("f64 grid", |b| {
        b.iter(|| double.grid(black_box(psi), &theta, &phi, &mut out));
    });
    let repeated: Vec<f64> = psi.iter().flat_map(|&psi| vec![psi; POINTS]).collect();
    let (theta, phi) = (theta.repeat(psi.len()), phi.repeat(psi.len()));
    let points = Points::Angles {
        psi: &repeated,
        theta: &theta,
        phi: &phi,
    };
    group.bench_function("f64 batch from angles", |b| {
        b.iter(|| double.values(black_box(&points), &mut out));
    });
    group.finish();
}

criterion_group!(benches, in_cache, families, break_even, in_memory, grid);
criterion_main!(benches);
