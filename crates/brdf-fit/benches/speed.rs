//! What an evaluation, a fit and the reading of a scan cost, in one run:
//! `cargo bench -p brdf-fit --bench speed`.

use std::fmt::Write as _;
use std::hint::black_box;
use std::io::Cursor;
use std::path::Path;

use brdf_core::published::PUBLISHED;
use brdf_core::{AnyBrdf, Family, Geometry, ModelParameters, Parameters, ThreeParameterBrdf};
use brdf_fit::export::{ExportOptions, Fitted, Material, Target, export};
use brdf_fit::read::merl::{Channel, Table};
use brdf_fit::report::{Depth, Report};
use brdf_fit::{FitOptions, Measurements, Method, RefractiveIndex, fit};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DVector, Dyn, OMatrix, U3, Vector3};

const N: f64 = 1.5;
const ROWS: u32 = 1_000_000;

/// Sets of angles over the domain, so that no branch or cache learns one of them by heart.
fn angles() -> Vec<[f64; 3]> {
    (0..1024)
        .map(|i| {
            let turn = f64::from(i) * 0.618_033_988_75;
            [
                1.5 * turn.fract(),
                1.5 * (turn * 7.3).fract(),
                6.0 * (turn * 3.1).fract(),
            ]
        })
        .collect()
}

fn evaluation(c: &mut Criterion) {
    let parameters = Parameters::new(0.3, 0.1, 0.2).expect("in the domain");
    let brdf = ThreeParameterBrdf::new(parameters, N).expect("in the domain");
    let angles = angles();
    let geometry =
        |[psi, theta, phi]: [f64; 3]| Geometry::new(psi, theta, phi).expect("in the domain");
    let geometries: Vec<Geometry> = angles.iter().map(|&a| geometry(a)).collect();
    let mut group = c.benchmark_group("evaluation (1024 points)");
    group.throughput(Throughput::Elements(angles.len() as u64));
    group.bench_function("value from angles", |b| {
        b.iter(|| {
            black_box(&angles)
                .iter()
                .map(|&a| brdf.value(&geometry(a)))
                .sum::<f64>()
        });
    });
    group.bench_function("sines and cosines of the standard library alone", |b| {
        let sum = |(sin, cos): (f64, f64)| sin + cos;
        b.iter(|| {
            let of = |[psi, theta, phi]: [f64; 3]| {
                let half_difference = (0.5 * (psi - theta)).sin();
                sum(psi.sin_cos())
                    + sum(theta.sin_cos())
                    + sum((0.5 * phi).sin_cos())
                    + half_difference
            };
            black_box(&angles).iter().map(|&a| of(a)).sum::<f64>()
        });
    });
    group.bench_function("value from a geometry", |b| {
        b.iter(|| {
            black_box(&geometries)
                .iter()
                .map(|g| brdf.value(g))
                .sum::<f64>()
        });
    });
    group.bench_function("gradient from a geometry", |b| {
        b.iter(|| {
            black_box(&geometries)
                .iter()
                .map(|g| brdf.gradient(g)[2])
                .sum::<f64>()
        });
    });
    group.finish();
}

/// The 112 readings of Z307 at 0.631 um.
fn sample() -> Measurements {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/measured");
    let scan = Measurements::read_csv(folder.join("z307_on_aluminium.csv")).expect("the sample");
    scan.by_wavelength().remove(0)
}

fn fits(c: &mut Criterion) {
    let scan = sample();
    let options = |stage1, stage2, global_check| FitOptions {
        refractive_index: Some(RefractiveIndex::Same(N)),
        stage1,
        stage2: Some(stage2),
        global_check,
        ..FitOptions::default()
    };
    let lm = Method::LevenbergMarquardt;
    let nm = Method::NelderMead;
    let mut group = c.benchmark_group("fit of 112 readings");
    for (name, options) in [
        ("two stages LM, global check", options(Some(lm), lm, true)),
        ("two stages LM", options(Some(lm), lm, false)),
        ("one stage LM", options(None, lm, false)),
        ("two stages NM, global check", options(Some(nm), nm, true)),
    ] {
        group.bench_function(name, |b| b.iter(|| fit(black_box(&scan), &options)));
    }
    let all = options(Some(lm), lm, true);
    for (name, depth) in [
        (
            "two stages LM, global check, intervals, warnings",
            Depth::Fit,
        ),
        (
            "the same, cross-validation, model hierarchy, physics",
            Depth::Assessed,
        ),
        ("the same, reference models", Depth::Compared),
    ] {
        group.bench_function(name, |b| {
            b.iter(|| Report::new(black_box(&scan), &all, depth));
        });
    }
    let start = fit(&scan, &options(None, lm, false))
        .expect("a fit")
        .initial
        .parameters;
    let plain = Plain::new(&scan, start);
    group.bench_function("one stage, plain levenberg-marquardt crate", |b| {
        b.iter(|| LevenbergMarquardt::new().minimize(black_box(plain.clone())));
    });
    group.finish();
}

/// What one would write with the `levenberg-marquardt` crate alone: residuals and Jacobian from
/// `value` and `gradient` at geometries computed before, no bounds, no stages, no check.
#[derive(Clone)]
struct Plain {
    geometries: Vec<Geometry>,
    /// cos theta and f_r cos theta.
    measured: Vec<(f64, f64)>,
    at: Vector3<f64>,
}

impl Plain {
    fn new(scan: &Measurements, start: Parameters) -> Self {
        let readings = scan.readings();
        Self {
            geometries: readings
                .iter()
                .map(|r| r.geometry().expect("a reading"))
                .collect(),
            measured: readings
                .iter()
                .map(|r| (r.theta.cos(), r.brdf * r.theta.cos()))
                .collect(),
            at: Vector3::new(start.k2, start.kd, start.k1),
        }
    }

    fn brdf(&self) -> Option<ThreeParameterBrdf> {
        let parameters = Parameters::new(self.at[0], self.at[1], self.at[2]).ok()?;
        ThreeParameterBrdf::new(parameters, N).ok()
    }
}

impl LeastSquaresProblem<f64, Dyn, U3> for Plain {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, U3>;
    type ParameterStorage = Owned<f64, U3>;

    fn set_params(&mut self, at: &Vector3<f64>) {
        self.at = *at;
    }

    fn params(&self) -> Vector3<f64> {
        self.at
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let brdf = self.brdf()?;
        let points = self.geometries.iter().zip(&self.measured);
        let residuals =
            points.map(|(g, (cos_theta, measured))| brdf.value(g) * cos_theta - measured);
        Some(DVector::from_iterator(self.measured.len(), residuals))
    }

    fn jacobian(&self) -> Option<OMatrix<f64, Dyn, U3>> {
        let brdf = self.brdf()?;
        let mut jacobian = OMatrix::<f64, Dyn, U3>::zeros(self.measured.len());
        for (i, (geometry, (cos_theta, _))) in
            self.geometries.iter().zip(&self.measured).enumerate()
        {
            for (j, derivative) in brdf.gradient(geometry).into_iter().enumerate() {
                jacobian[(i, j)] = derivative * cos_theta;
            }
        }
        Some(jacobian)
    }
}

fn reading(c: &mut Criterion) {
    let mut text = "wavelength_um,psi_deg,theta_deg,brdf_per_sr\n".to_owned();
    for i in 0..ROWS {
        let (psi, theta) = (i % 80, f64::from(i % 1700) / 10.0 - 85.0);
        let brdf = 0.01 + f64::from(i % 9973) * 1e-6;
        let _ = writeln!(text, "0.63079,{psi},{theta:.1},{brdf:.6}");
    }
    let mut group = c.benchmark_group("reading");
    group.sample_size(10);
    group.throughput(Throughput::Elements(u64::from(ROWS)));
    group.bench_function("a million rows", |b| {
        b.iter(|| Measurements::from_reader(black_box(text.as_bytes())));
    });
    group.finish();
}

/// A MERL table of the first row of Table 1: its channels read, and fitted one after the other.
fn table(c: &mut Criterion) {
    let bytes = merl_table();
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(N)),
        ..FitOptions::default()
    };
    let open = || Table::new(Cursor::new(&bytes), "table").expect("a table");
    let channel = |channel| open().channel(channel).expect("readings");
    let mut group = c.benchmark_group("MERL table");
    group.sample_size(10);
    group.bench_function("three channels read", |b| {
        b.iter(|| Channel::ALL.map(|one| channel(one).readings().len()));
    });
    for (depth, name) in [
        (
            Depth::Fit,
            "three channels read and fitted, with intervals and warnings",
        ),
        (
            Depth::Assessed,
            "the same with cross-validation, the model hierarchy and physics",
        ),
    ] {
        group.bench_function(name, |b| {
            b.iter(|| Channel::ALL.map(|one| Report::new(&channel(one), &options, depth)));
        });
    }
    group.finish();
}

fn merl_table() -> Vec<u8> {
    let row = PUBLISHED[0];
    let parameters = ModelParameters::three(row.parameters, row.n);
    let fitted = Fitted {
        file: "table".to_owned(),
        wavelength_um: None,
        brdf: AnyBrdf::new(Family::Paper, &parameters).expect("a BRDF"),
        e_percent: 0.0,
        psi_max_deg: 90.0,
    };
    let mut bytes = Vec::new();
    let coating = Material { fits: vec![fitted] };
    export(
        &coating,
        Target::Merl,
        &ExportOptions::default(),
        &mut bytes,
    )
    .expect("a table");
    bytes
}

criterion_group!(benches, evaluation, fits, reading, table);
criterion_main!(benches);
