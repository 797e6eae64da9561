//! How an evaluator errs at fresh points of a domain.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::domain::{Azimuth, Domain};
use super::requirements::Coordinates;
use crate::evaluator::{Evaluator, Points, Precision};
use crate::family::AnyBrdf;
use crate::geometry::Geometry;
use crate::numeric::Primitive;

/// Points of a probe that decides on a table.
const TABLE_PROBE: usize = 1 << 15;

/// Points of a domain with the exact f_r, in both precisions, each exact at its own points.
///
/// Half of the points lie evenly over the domain; the others where evaluators err most: next to the
/// mirror direction, at a distance of the lobe's width and far less, and at the ends of the ranges.
#[derive(Debug, Clone)]
pub struct Probe {
    coordinates: Coordinates,
    double: [Vec<f64>; 6],
    single: [Vec<f32>; 6],
    exact_double: Vec<f64>,
    exact_single: Vec<f64>,
}

/// Relative errors of f_r.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// The largest.
    pub max: f64,
    /// 99 of 100 are not larger.
    pub p99: f64,
    /// Root mean square.
    pub rms: f64,
}

impl Probe {
    /// `count` points of the domain; another `seed` gives others.
    pub fn new(
        brdf: &AnyBrdf,
        domain: &Domain,
        coordinates: Coordinates,
        count: usize,
        seed: u32,
    ) -> Self {
        let width = brdf.parameters().k1.min(1.0);
        let double = in_coordinates(&angles(domain, width, count, seed), coordinates);
        let single = double
            .each_ref()
            .map(|a| a.iter().map(|&x| f32::narrow(x)).collect());
        let exact_single = exact(brdf, &points(&single, coordinates), count);
        let exact_double = exact(brdf, &points(&double, coordinates), count);
        Self {
            coordinates,
            double,
            single,
            exact_double,
            exact_single,
        }
    }

    /// The points in `f64`.
    pub fn points(&self) -> Points<'_, f64> {
        points(&self.double, self.coordinates)
    }

    /// The points in `f32`.
    pub fn points_f32(&self) -> Points<'_, f32> {
        points(&self.single, self.coordinates)
    }

    /// How many points there are.
    pub fn count(&self) -> usize {
        self.exact_double.len()
    }

    /// The errors of an evaluator, at the points in the precision that it works in.
    pub fn errors(&self, evaluator: &dyn Evaluator) -> Errors {
        // The arrays have one length.
        let relative = match evaluator.precision() {
            Precision::Double => {
                let mut out = vec![0.0; self.count()];
                let _ = evaluator.values(&self.points(), &mut out);
                relative_errors(&out, &self.exact_double)
            }
            Precision::Single => {
                let mut out = vec![0.0_f32; self.count()];
                let _ = evaluator.values_f32(&self.points_f32(), &mut out);
                relative_errors(&out, &self.exact_single)
            }
        };
        Errors::of(relative)
    }
}

/// f_r of each point by itself: the measure of all evaluators.
fn exact<T: Primitive>(brdf: &AnyBrdf, points: &Points<T>, count: usize) -> Vec<f64> {
    let value = |i: usize| single_value(brdf, points, i);
    (0..count).into_par_iter().map(value).collect()
}

/// f_r of one of the points; NaN outside the domain.
#[inline]
pub(super) fn single_value<T: Primitive>(brdf: &AnyBrdf, points: &Points<T>, i: usize) -> f64 {
    let at = |array: &[T]| array[i].widen();
    let geometry = match *points {
        Points::Cosines { psi, theta, phi } => Geometry::from_cosines(at(psi), at(theta), at(phi)),
        Points::Angles { psi, theta, phi } => Geometry::new(at(psi), at(theta), at(phi)),
        Points::Directions { source, view } => {
            let vector = |[x, y, z]: [&[T]; 3]| Vector3::new(at(x), at(y), at(z));
            Geometry::from_directions(&vector(source), &vector(view))
        }
    };
    geometry.map_or(f64::NAN, |geometry| brdf.value(&geometry))
}

fn relative_errors<T: Primitive>(values: &[T], exact: &[f64]) -> Vec<f64> {
    let error = |(value, &exact): (&T, &f64)| {
        let error = (value.widen() - exact).abs();
        if error == 0.0 {
            0.0
        } else if error.is_finite() {
            error / exact.abs()
        } else {
            f64::INFINITY
        }
    };
    values.iter().zip(exact).map(error).collect()
}

impl Errors {
    fn of(mut relative: Vec<f64>) -> Self {
        relative.sort_unstable_by(f64::total_cmp);
        let count = relative.len();
        let at = |fraction: usize| relative.get((count * fraction / 100).min(count.max(1) - 1));
        let squares: f64 = relative.iter().map(|error| error * error).sum();
        Self {
            max: at(100).copied().unwrap_or(0.0),
            p99: at(99).copied().unwrap_or(0.0),
            rms: (squares / count.max(1) as f64).sqrt(),
        }
    }
}

/// The largest relative error of an evaluator over a domain, at points of its own.
pub(crate) fn worst_error(brdf: &AnyBrdf, evaluator: &dyn Evaluator, domain: &Domain) -> f64 {
    let probe = Probe::new(brdf, domain, Coordinates::Cosines, TABLE_PROBE, 7);
    probe.errors(evaluator).max
}

/// psi, theta >= 0 and phi of a point of a domain.
type Angles = [f64; 3];

/// Points of the domain: an additive sequence in four dimensions (Roberts 2018), which fills it
/// evenly for any number of points.
fn angles(domain: &Domain, width: f64, count: usize, seed: u32) -> Vec<Angles> {
    // Powers of the inverse of the root of x^5 = x + 1.
    const STEPS: [f64; 4] = [
        0.856_674_883_854_502_9,
        0.733_891_856_627_125_6,
        0.628_706_721_037_808_6,
        0.538_597_256_991_023_5,
    ];
    let start = 0.5 + f64::from(seed) * 0.754_877_666_246_692_8;
    (0..count)
        .map(|i| {
            let u = STEPS.map(|step| (start + (i as f64 + 1.0) * step).fract());
            match i % 4 {
                0 | 1 => evenly(domain, u),
                2 => near_mirror(domain, width, u),
                _ => at_ends(domain, u),
            }
        })
        .collect()
}

fn within((from, to): (f64, f64), u: f64) -> f64 {
    from + (to - from) * u
}

fn evenly(domain: &Domain, [u, v, w, _]: [f64; 4]) -> Angles {
    let phi = match domain.azimuth {
        Azimuth::Full => TAU * w,
        Azimuth::InPlane => in_plane(w),
    };
    [within(domain.incidence, u), within(domain.view, v), phi]
}

/// Forward more often than back: that is where the peak is.
fn in_plane(w: f64) -> f64 {
    if w < 0.7 { PI } else { 0.0 }
}

/// Beside the mirror direction by 1e-4 to 10 widths of the lobe.
fn near_mirror(domain: &Domain, width: f64, [u, v, w, x]: [f64; 4]) -> Angles {
    let psi = within(domain.incidence, u);
    let offset = width * 10_f64.powf(5.0 * v - 4.0);
    let (across, along) = (TAU * w).sin_cos();
    let theta = (psi + offset * along).clamp(domain.view.0, domain.view.1);
    let phi = match domain.azimuth {
        Azimuth::Full => PI + offset * across * if x < 0.5 { 1.0 } else { 0.1 },
        Azimuth::InPlane => PI,
    };
    [psi, theta, phi]
}

/// At the ends of some of the ranges, or back into the source.
fn at_ends(domain: &Domain, [u, v, w, x]: [f64; 4]) -> Angles {
    let end = |range: (f64, f64), u: f64| match u {
        u if u < 0.25 => range.0,
        u if u < 0.6 => range.1,
        u => within(range, (u - 0.6) / 0.4),
    };
    let psi = end(domain.incidence, u);
    if x < 0.2 {
        let theta = psi.clamp(domain.view.0, domain.view.1);
        return [psi, theta, 0.0];
    }
    let phi = match domain.azimuth {
        Azimuth::Full => end((0.0, PI), w),
        Azimuth::InPlane => in_plane(w),
    };
    [psi, end(domain.view, v), phi]
}

/// The arrays of the coordinates; those that are not used are empty.
fn in_coordinates(angles: &[Angles], coordinates: Coordinates) -> [Vec<f64>; 6] {
    let array = |f: fn(&Angles) -> f64| angles.iter().map(f).collect::<Vec<f64>>();
    let none = Vec::new;
    match coordinates {
        Coordinates::Cosines => [
            array(|[psi, ..]| psi.cos()),
            array(|[_, theta, _]| theta.cos()),
            array(|[.., phi]| phi.cos()),
            none(),
            none(),
            none(),
        ],
        Coordinates::Angles => [
            array(|[psi, ..]| *psi),
            array(|[_, theta, _]| *theta),
            array(|[.., phi]| *phi),
            none(),
            none(),
            none(),
        ],
        Coordinates::Directions => [
            array(|[psi, ..]| psi.sin()),
            array(|_| 0.0),
            array(|[psi, ..]| psi.cos()),
            array(|[_, theta, phi]| theta.sin() * phi.cos()),
            array(|[_, theta, phi]| theta.sin() * phi.sin()),
            array(|[_, theta, _]| theta.cos()),
        ],
    }
}

fn points<T>(arrays: &[Vec<T>; 6], coordinates: Coordinates) -> Points<'_, T> {
    let [a, b, c, d, e, f] = arrays.each_ref().map(Vec::as_slice);
    match coordinates {
        Coordinates::Cosines => Points::Cosines {
            psi: a,
            theta: b,
            phi: c,
        },
        Coordinates::Angles => Points::Angles {
            psi: a,
            theta: b,
            phi: c,
        },
        Coordinates::Directions => Points::Directions {
            source: [a, b, c],
            view: [d, e, f],
        },
    }
}
