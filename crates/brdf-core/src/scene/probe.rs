//! The errors of an evaluator at points of a domain.

use std::f64::consts::{PI, TAU};

use super::domain::{Azimuth, Domain};
use super::requirements::Coordinates;
use crate::evaluator::{Evaluator, Points, Precision};
use crate::family::AnyBrdf;
use crate::geometry::Geometry;
use crate::numeric::Primitive;
use crate::parallel;

/// Points of a domain in `f64` and in `f32`, with f_r at each of them as the reference.
///
/// The reference is [`AnyBrdf::value`], evaluated at the points of each precision separately. Half of
/// the points are spread evenly over the domain. The others are where evaluators have the largest
/// errors: a quarter next to the mirror direction, at distances from 1e-4 to 10 widths of the lobe,
/// and a quarter at the ends of the ranges.
#[derive(Debug, Clone)]
pub struct Probe {
    coordinates: Coordinates,
    double: [Vec<f64>; 6],
    single: [Vec<f32>; 6],
    exact_double: Vec<f64>,
    exact_single: Vec<f64>,
}

/// Relative errors of f_r over a set of points, dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Errors {
    /// The largest error.
    pub max: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// The root mean square.
    pub rms: f64,
}

impl Probe {
    /// `count` points of the domain, which are determined by `seed`.
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

    /// The points as arrays of `f64`.
    pub fn points(&self) -> Points<'_, f64> {
        points(&self.double, self.coordinates)
    }

    /// The points as arrays of `f32`.
    pub fn points_f32(&self) -> Points<'_, f32> {
        points(&self.single, self.coordinates)
    }

    /// The number of points.
    pub fn count(&self) -> usize {
        self.exact_double.len()
    }

    /// The errors of an evaluator at the points in its own precision.
    pub fn errors(&self, evaluator: &dyn Evaluator) -> Errors {
        // All arrays have the same length, so that there is no error.
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

/// f_r at each point by itself, the reference for all evaluators.
fn exact<T: Primitive>(brdf: &AnyBrdf, points: &Points<T>, count: usize) -> Vec<f64> {
    parallel::map(count, |i| single_value(brdf, points, i))
}

/// f_r at one of the points; NaN outside the domain.
#[inline]
pub(super) fn single_value<T: Primitive>(brdf: &AnyBrdf, points: &Points<T>, i: usize) -> f64 {
    let at = |array: &[T]| array[i].widen();
    let geometry = match *points {
        Points::Cosines { psi, theta, phi } => Geometry::from_cosines(at(psi), at(theta), at(phi)),
        Points::Angles { psi, theta, phi } => Geometry::new(at(psi), at(theta), at(phi)),
        Points::Directions { source, view } => {
            let [source, view] = [source, view].map(|components| components.map(at));
            Geometry::from_directions(source, view)
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

/// psi, theta >= 0 and phi of a point, in radians.
type Angles = [f64; 3];

/// Points of the domain from an additive sequence in four dimensions (Roberts 2018), which is even
/// for any number of points.
fn angles(domain: &Domain, width: f64, count: usize, seed: u32) -> Vec<Angles> {
    // Powers of 1/x, where x is the positive root of x^5 = x + 1.
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

/// The azimuth in plane, which is forward more often than backward because the peak is there.
fn in_plane(w: f64) -> f64 {
    if w < 0.7 { PI } else { 0.0 }
}

/// A point at 1e-4 to 10 widths of the lobe from the mirror direction.
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

/// A point at the ends of some of the ranges, or in the direction back into the source.
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

/// The arrays of the coordinates. Unused arrays are empty.
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
