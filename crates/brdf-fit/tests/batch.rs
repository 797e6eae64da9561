//! Fits of many scans find the optimum of `fit`, on scans of every kind that is hard.
//!
//! `BATCH_SCANS=100000 cargo test --release -p brdf-fit --test batch -- --nocapture` tries as many scans
//! as that, and prints the largest differences.

use std::f64::consts::PI;

use brdf_core::{AnyBrdf, Geometry, ModelParameters};
use brdf_fit::batch::{BatchOptions, BatchPlan, Scans, Status};
use brdf_fit::{FitError, FitOptions, Measurement, Measurements, Model, RefractiveIndex, fit};
use rand::rngs::StdRng;
use rand::{RngExt as _, SeedableRng as _};
use rayon::prelude::*;

const N: f64 = 1.5;

/// E of two ways to the same optimum differs by less than this fraction of E, or of the readings' squares.
const RELATIVE: f64 = 1e-9;
const ABSOLUTE: f64 = 1e-13;

fn reading(psi_deg: f64, theta_deg: f64, phi_deg: f64) -> Measurement {
    Measurement {
        wavelength_um: None,
        psi: psi_deg.to_radians(),
        theta: theta_deg.to_radians(),
        phi: phi_deg.to_radians(),
        brdf: 0.0,
        sigma: None,
    }
}

/// Angles in the plane of incidence, turned by an offset, with one of `step` readings.
fn in_plane(offset: f64, step: usize) -> Vec<Measurement> {
    let angles = [0.0, 15.0, 30.0, 45.0, 60.0].into_iter().flat_map(|psi| {
        let views = (-15..=15).map(|i| 5.0 * f64::from(i) + offset);
        views
            .filter(move |theta| (theta - psi).abs() > 4.0)
            .map(move |theta| (psi, theta))
    });
    angles
        .step_by(step)
        .map(|(psi, theta)| reading(psi, theta, 0.0))
        .collect()
}

/// Angles with azimuth.
fn hemisphere() -> Vec<Measurement> {
    let mut angles = Vec::new();
    for psi in [10.0, 40.0, 65.0] {
        for theta in [5.0, 20.0, 40.0, 60.0, 75.0] {
            for phi in [0.0, 30.0, 75.0, 120.0, 160.0, 180.0] {
                angles.push(reading(psi, theta, phi));
            }
        }
    }
    angles
}

/// The geometries that are tried, with names.
fn geometries() -> [(&'static str, Vec<Measurement>); 5] {
    [
        ("in plane", in_plane(0.0, 1)),
        ("in plane, no reading at the mirror angle", in_plane(0.7, 1)),
        ("with azimuth", hemisphere()),
        ("few readings", in_plane(0.0, 11)),
        (
            "very few readings, none at the mirror angle",
            in_plane(0.7, 25),
        ),
    ]
}

struct Random(StdRng);

impl Random {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    fn logarithmic(&mut self, low: f64, high: f64) -> f64 {
        self.within(low.ln(), high.ln()).exp()
    }

    /// About normal, with unit variance.
    fn noise(&mut self) -> f64 {
        (0..12).map(|_| self.0.random::<f64>()).sum::<f64>() - 6.0
    }
}

fn theory(at: ModelParameters, model: Model, angles: &[Measurement]) -> Vec<f64> {
    let brdf = AnyBrdf::new(model.family(), &at).unwrap();
    let value = |reading: &Measurement| {
        brdf.value(&Geometry::new(reading.psi, reading.theta, reading.phi).unwrap())
    };
    angles.iter().map(value).collect()
}

const KINDS: u64 = 10;

/// A scan of one of the kinds: ordinary, no diffuse part, no lobe, noise about zero, large noise, tiny
/// lobe, very wide lobe, two lobes, no noise, dark lobe.
fn scan(kind: u64, seed: u64, model: Model, angles: &[Measurement]) -> Vec<f64> {
    let mut random = Random(StdRng::seed_from_u64(seed * KINDS + kind));
    let mut at = ModelParameters {
        k2: random.logarithmic(0.01, 1.0),
        kd: random.logarithmic(0.01, 0.5),
        k1: random.logarithmic(0.02, 3.0),
        n: if model.frees(brdf_fit::Parameter::N) {
            random.within(1.2, 2.5)
        } else {
            N
        },
        p: 1.0,
    };
    let mut noise = (0.02, 0.001);
    match kind {
        1 => at.kd = 0.0,
        2 => at.k2 = 0.0,
        4 => noise.0 = 1.0,
        5 => at.k1 = random.logarithmic(1e-6, 1e-2),
        6 => at.k1 = random.logarithmic(10.0, 1e3),
        8 => noise = (0.0, 0.0),
        _ => {}
    }
    let mut readings = theory(at, model, angles);
    if kind == 7 {
        let other = ModelParameters {
            k1: at.k1 * random.logarithmic(0.02, 0.3),
            k2: at.k2 * random.logarithmic(0.02, 0.5),
            ..at
        };
        for (reading, more) in readings.iter_mut().zip(theory(other, model, angles)) {
            *reading += more;
        }
    }
    if kind == 9 {
        let hole = theory(ModelParameters { kd: 0.0, ..at }, model, angles);
        for (reading, hole) in readings.iter_mut().zip(hole) {
            *reading = at.kd / PI - 0.5 * hole;
        }
    }
    let largest = readings.iter().fold(0.0_f64, |max, r| max.max(r.abs()));
    for reading in &mut readings {
        if kind == 3 {
            *reading = 0.0;
            noise.1 = 0.1;
        }
        *reading += (*reading * noise.0 + largest.max(1e-3) * noise.1) * random.noise();
    }
    readings
}

fn measurements(angles: &[Measurement], readings: &[f64]) -> Measurements {
    let pairs = angles
        .iter()
        .zip(readings)
        .filter(|(_, reading)| !reading.is_nan());
    let readings = pairs.map(|(at, brdf)| Measurement { brdf: *brdf, ..*at });
    Measurements::new("scan", readings.collect()).unwrap()
}

/// The number of scans of each kind and geometry.
fn scans_of_each(in_all: u64) -> u64 {
    let wanted = std::env::var("BATCH_SCANS").ok();
    let wanted: u64 = wanted.map_or(in_all, |count| count.parse().unwrap());
    (wanted / (5 * KINDS)).max(1)
}

/// How far E of the two ways is apart.
#[derive(Debug, Clone, Copy, Default)]
struct Apart {
    /// The largest excess of E of the plan above that of `fit`, as a fraction of E.
    above: f64,
    /// The same of `fit` above the plan.
    below: f64,
    missed: usize,
    missed_by_fit: usize,
}

/// The first scans of each kind.
fn first(each: u64) -> Vec<(u64, u64)> {
    let of_seed = |seed| (0..KINDS).map(move |kind| (kind, seed));
    (0..each).flat_map(of_seed).collect()
}

/// The scans of some kinds and seeds, of which each reading is missing with a probability of `gaps`.
fn compare(
    name: &str,
    angles: &[Measurement],
    model: Model,
    seeds: &[(u64, u64)],
    gaps: f64,
) -> Apart {
    let options = BatchOptions {
        model,
        n: N,
        ..BatchOptions::default()
    };
    let plan = BatchPlan::new(angles, &options).unwrap();
    let scans: Vec<Vec<f64>> = seeds
        .par_iter()
        .map(|(kind, seed)| {
            let mut readings = scan(*kind, *seed, model, angles);
            let mut random = Random(StdRng::seed_from_u64(seed * KINDS + kind));
            for reading in &mut readings {
                if gaps > 0.0 && random.within(0.0, 1.0) < gaps {
                    *reading = f64::NAN;
                }
            }
            readings
        })
        .collect();
    let flat: Vec<f64> = scans.iter().flatten().copied().collect();
    let fits = plan
        .fit_many(Scans::new(&flat, angles.len()).unwrap())
        .unwrap();
    let fit_options = FitOptions {
        model,
        refractive_index: Some(RefractiveIndex::Same(N)),
        ..FitOptions::default()
    };
    let single: Vec<Result<(f64, ModelParameters), FitError>> = scans
        .par_iter()
        .map(|scan| {
            let fit = fit(&measurements(angles, scan), &fit_options)?;
            Ok((fit.e_percent / 100.0, fit.at()))
        })
        .collect();
    let mut apart = Apart::default();
    for (i, single) in single.into_iter().enumerate() {
        let many = fits.e_percent[i] / 100.0;
        let (single, at) = match single {
            Ok(single) => single,
            Err(error) => panic!("{name}, {:?}: {error}", seeds[i]),
        };
        // The limit of a narrow Beckmann lobe of which no reading sees the peak is beyond the range of
        // numbers.
        if at.k2.max(fits.k2[i]) > 1e30 {
            continue;
        }
        let difference = (many - single) / single.max(1e-30);
        if many > single * (1.0 + RELATIVE) + ABSOLUTE {
            apart.missed += 1;
            println!(
                "{name}, {model}, {:?}: {many:e} above {single:e} of {at:?}: k1 {} n {} {:?}",
                seeds[i], fits.k1[i], fits.n[i], fits.status[i]
            );
        } else if (many - single).abs() > ABSOLUTE {
            apart.above = apart.above.max(difference);
        }
        if single > many * (1.0 + RELATIVE) + ABSOLUTE {
            apart.missed_by_fit += 1;
            println!(
                "{name}, {model}, {:?}: fit {single:e} of {at:?} above {many:e}: k2 {} kD {} k1 {} n {}",
                seeds[i], fits.k2[i], fits.kd[i], fits.k1[i], fits.n[i]
            );
        } else if (many - single).abs() > ABSOLUTE {
            apart.below = apart.below.max(-difference);
        }
    }
    println!(
        "{name}, {model}, gaps {gaps}, {} scans: {apart:?}",
        seeds.len()
    );
    apart
}

/// A part of each scan that is missing, for a geometry and a model. All are tried before a missed optimum
/// fails the test.
fn none_is_missed(
    models: &[Model],
    geometries: &[(&'static str, Vec<Measurement>)],
    gaps: &[f64],
    in_all: u64,
) {
    let mut missed = Vec::new();
    for model in models {
        for (name, angles) in geometries {
            if angles.len() <= model.free().len() + 1 {
                continue;
            }
            for gaps in gaps {
                let apart = compare(name, angles, *model, &first(scans_of_each(in_all)), *gaps);
                if (apart.missed, apart.missed_by_fit) != (0, 0) {
                    missed.push(format!("{name}, {model}, gaps {gaps}: {apart:?}"));
                }
            }
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

#[test]
fn three_parameters_are_those_of_the_fit() {
    none_is_missed(&[Model::Three], &geometries(), &[0.0], 2000);
}

#[test]
fn smaller_and_reference_models_are_those_of_the_fit() {
    let models = [Model::Lambert, Model::Specular, Model::Ggx, Model::Beckmann];
    none_is_missed(&models, &geometries(), &[0.0], 500);
}

#[test]
fn models_with_a_free_index_are_those_of_the_fit() {
    let models = [Model::ThreeN, Model::SmithN, Model::GgxN, Model::BeckmannN];
    none_is_missed(&models, &geometries(), &[0.0], 250);
}

#[test]
fn gaps_are_readings_that_are_not_there() {
    let models = [Model::Three, Model::Specular, Model::Ggx, Model::Beckmann];
    let geometries = &geometries()[..3];
    none_is_missed(&models, geometries, &[0.1, 0.6], 100);
    for (_, angles) in geometries {
        let plan = BatchPlan::new(angles, &BatchOptions::default()).unwrap();
        let mut readings = scan(0, 1, Model::Three, angles);
        readings
            .iter_mut()
            .step_by(3)
            .for_each(|reading| *reading = f64::NAN);
        let taken = readings.iter().filter(|reading| !reading.is_nan()).count();
        let fits = plan.fit_many(Scans::new(&readings, angles.len()).unwrap());
        assert_eq!(fits.unwrap().readings[0] as usize, taken);
    }
}

#[test]
fn the_digits_do_not_depend_on_threads_blocks_or_strides() {
    let angles = in_plane(0.0, 1);
    let plan = BatchPlan::new(&angles, &BatchOptions::default()).unwrap();
    let scans: Vec<Vec<f64>> = (0..1000)
        .map(|i| scan(i % KINDS, i, Model::Three, &angles))
        .collect();
    let flat: Vec<f64> = scans.iter().flatten().copied().collect();
    let m = angles.len();
    let all = plan
        .run(Scans::new(&flat, m).unwrap())
        .constant_noise_errors()
        .fit()
        .unwrap();
    let bits = |column: &[f64]| column.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
    for (from, to) in [(0, 1), (3, 200), (999, 1000), (63, 129), (500, 500)] {
        let some = Scans::new(&flat[from * m..to * m], m).unwrap();
        let some = plan
            .run(some)
            .constant_noise_errors()
            .on_one_thread()
            .fit()
            .unwrap();
        assert_eq!(bits(&some.k1), bits(&all.k1[from..to]));
        assert_eq!(bits(&some.e_percent), bits(&all.e_percent[from..to]));
        let errors = [&some, &all].map(|fit| bits(&fit.constant_noise.as_ref().unwrap().k1));
        assert_eq!(errors[0], errors[1][from..to]);
    }
    let mut transposed = vec![0.0; flat.len()];
    for (i, scan) in scans.iter().enumerate() {
        for (j, reading) in scan.iter().enumerate() {
            transposed[j * scans.len() + i] = *reading;
        }
    }
    let strided = Scans::strided(&transposed, [scans.len(), m], [1, scans.len()]).unwrap();
    assert_eq!(bits(&plan.fit_many(strided).unwrap().k1), bits(&all.k1));
}

#[test]
fn scans_that_cannot_be_fitted_say_why() {
    let angles = in_plane(0.0, 1);
    let m = angles.len();
    let plan = BatchPlan::new(&angles, &BatchOptions::default()).unwrap();
    let good = scan(0, 1, Model::Three, &angles);
    let few: Vec<f64> = (0..m)
        .map(|i| if i < 3 { good[i] } else { f64::NAN })
        .collect();
    let infinite: Vec<f64> = good
        .iter()
        .map(|r| if *r == good[5] { f64::INFINITY } else { *r })
        .collect();
    let huge: Vec<f64> = good.iter().map(|r| r * 1e200).collect();
    let constant = vec![0.2; m];
    let rows = [
        vec![0.0; m],
        few,
        infinite,
        huge,
        good.clone(),
        constant,
        vec![f64::NAN; m],
    ];
    let flat: Vec<f64> = rows.concat();
    let fits = plan.fit_many(Scans::new(&flat, m).unwrap()).unwrap();
    let expected = [
        Status::AllZero,
        Status::TooFewReadings,
        Status::OutOfRange,
        Status::OutOfRange,
        Status::Fitted,
        Status::NoLobe,
        Status::TooFewReadings,
    ];
    for (status, expected) in fits.status.iter().zip(expected) {
        assert_eq!(*status, expected, "{:?}", fits.status);
    }
    assert!(fits.k2[0].is_nan() && fits.k2[4] > 0.0);
    assert!((fits.kd[5] - 0.2 * PI).abs() < 1e-12 && fits.k1[5].is_nan());
    // The scan beside those is the same alone.
    let alone = plan.fit_many(Scans::new(&good, m).unwrap()).unwrap();
    assert_eq!(alone.k1[0].to_bits(), fits.k1[4].to_bits());
}

#[test]
fn weights_of_scans_are_those_of_repeated_readings() {
    let angles = in_plane(0.0, 1);
    let m = angles.len();
    let plan = BatchPlan::new(&angles, &BatchOptions::default()).unwrap();
    let scan = scan(0, 3, Model::Three, &angles);
    let times = |i: usize| [1, 2, 0, 3][i % 4];
    let weights: Vec<f64> = (0..m).map(|i| f64::from(times(i))).collect();
    let run = plan
        .run(Scans::new(&scan, m).unwrap())
        .weights(Scans::new(&weights, m).unwrap());
    let fits = run.fit().unwrap();
    let repeated = angles
        .iter()
        .zip(&scan)
        .enumerate()
        .flat_map(|(i, (at, brdf))| {
            let reading = Measurement { brdf: *brdf, ..*at };
            (0..times(i)).map(move |_| reading)
        });
    let measurements = Measurements::new("scan", repeated.collect()).unwrap();
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(N)),
        ..FitOptions::default()
    };
    let single = fit(&measurements, &options).unwrap();
    assert!((fits.e_percent[0] / single.e_percent - 1.0).abs() < 1e-9);
    assert!((fits.k1[0] / single.parameters.k1 - 1.0).abs() < 1e-6);
}

/// Optima that one of the two searches, or both, once missed: two minima within a step of the grid, a faint lobe
/// between two widths, flat valleys along n, a lobe that is the better the narrower it is, and Beckmann's lobes
/// whose second reading is 1e-5 of the first.
#[test]
fn optima_that_are_hard_to_find_are_found() {
    let [in_plane, turned, azimuth, few, very_few] = geometries();
    let cases = [
        (
            &in_plane,
            Model::Three,
            0.1,
            vec![(3, 1277), (4, 1567), (3, 1212)],
        ),
        (&in_plane, Model::Three, 0.0, vec![(2, 641)]),
        (
            &turned,
            Model::Three,
            0.1,
            vec![(2, 961), (3, 1190), (2, 1850)],
        ),
        (&azimuth, Model::Three, 0.1, vec![(2, 54), (3, 106)]),
        (&in_plane, Model::Specular, 0.6, vec![(3, 762), (3, 876)]),
        (
            &in_plane,
            Model::Ggx,
            0.0,
            vec![(2, 458), (3, 901), (2, 1643)],
        ),
        (&azimuth, Model::Ggx, 0.0, vec![(2, 241), (1, 819)]),
        (
            &in_plane,
            Model::Beckmann,
            0.0,
            vec![(5, 681), (8, 763), (3, 1317)],
        ),
        (&in_plane, Model::Beckmann, 0.1, vec![(5, 655), (2, 802)]),
        (
            &in_plane,
            Model::Beckmann,
            0.6,
            vec![(3, 587), (3, 1001), (5, 1907)],
        ),
        (&azimuth, Model::Beckmann, 0.0, vec![(5, 498), (3, 1071)]),
        (&azimuth, Model::Beckmann, 0.6, vec![(3, 883)]),
        (&in_plane, Model::ThreeN, 0.0, vec![(3, 355)]),
        (&turned, Model::ThreeN, 0.0, vec![(4, 1367)]),
        (
            &very_few,
            Model::ThreeN,
            0.0,
            vec![(1, 327), (7, 1079), (7, 260)],
        ),
        (
            &in_plane,
            Model::SmithN,
            0.0,
            vec![(6, 1009), (7, 1423), (2, 1856)],
        ),
        (
            &azimuth,
            Model::SmithN,
            0.0,
            vec![(2, 1287), (9, 1368), (6, 1834)],
        ),
        (
            &very_few,
            Model::SmithN,
            0.0,
            vec![(5, 1351), (6, 1061), (1, 1945)],
        ),
        (&in_plane, Model::GgxN, 0.0, vec![(4, 1873)]),
        (&few, Model::GgxN, 0.0, vec![(4, 962), (3, 1246)]),
        (&very_few, Model::GgxN, 0.0, vec![(0, 272)]),
        (
            &azimuth,
            Model::BeckmannN,
            0.0,
            vec![(4, 12), (5, 93), (5, 767), (5, 1224), (5, 1553), (5, 1926)],
        ),
        (&few, Model::BeckmannN, 0.0, vec![(2, 94)]),
    ];
    for ((name, angles), model, gaps, seeds) in cases {
        let apart = compare(name, angles, model, &seeds, gaps);
        assert_eq!(
            (apart.missed, apart.missed_by_fit),
            (0, 0),
            "{name}, {model}"
        );
    }
}

/// No width of the grid shows its lobe, of k2 = 6e-8.
#[test]
fn a_faint_lobe_between_two_widths_of_the_grid_is_found() {
    let angles = hemisphere();
    let options = BatchOptions {
        n: N,
        ..BatchOptions::default()
    };
    let plan = BatchPlan::new(&angles, &options).unwrap();
    let readings = scan(2, 1929, Model::Three, &angles);
    let scans = Scans::new(&readings, angles.len()).unwrap();
    let batch = plan.fit_many(scans).unwrap();
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(N)),
        ..FitOptions::default()
    };
    let single = fit(&measurements(&angles, &readings), &options).unwrap();
    assert!(batch.e_percent[0] <= single.e_percent * (1.0 + RELATIVE));
    assert!(batch.k2[0] > 0.0);
}

#[test]
fn the_first_stage_is_that_of_fit() {
    let angles = in_plane(0.7, 1);
    let limit = 30_f64.to_radians();
    let options = BatchOptions {
        n: N,
        stage1_limit: Some(limit),
        ..BatchOptions::default()
    };
    let plan = BatchPlan::new(&angles, &options).unwrap();
    let readings = scan(0, 3, Model::Three, &angles);
    let scans = Scans::new(&readings, angles.len()).unwrap();
    let batch = plan.fit_many(scans).unwrap();
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(N)),
        stage1_limit: limit,
        stage2: None,
        ..FitOptions::default()
    };
    let single = fit(&measurements(&angles, &readings), &options).unwrap();
    assert!(single.readings < angles.len());
    assert_eq!(batch.readings[0] as usize, single.readings);
    assert!((batch.e_percent[0] / single.e_percent - 1.0).abs() < RELATIVE);
    assert!((batch.k1[0] / single.parameters.k1 - 1.0).abs() < 1e-5);
    let none = BatchOptions {
        stage1_limit: Some(-0.1),
        ..BatchOptions::default()
    };
    let error = BatchPlan::new(&angles, &none).unwrap_err();
    assert!(
        error.to_string().contains("no incidence angle is up to"),
        "{error}"
    );
}
