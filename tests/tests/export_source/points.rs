//! Points at which exported sources are evaluated, and the accuracy that is required there.

use std::f64::consts::FRAC_1_PI;

use brdf_core::{AnyBrdf, Geometry, Sampler};
use brdf_tests::generator;
use nalgebra::Vector3;
use rand::RngExt;

/// The largest angle of the points.
const LARGEST_DEG: f64 = 85.0;

/// Angles, directions, and numbers to draw a direction with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    /// psi, theta and phi.
    pub(crate) angles: [f64; 3],
    /// Towards the source.
    pub(crate) source: [f64; 3],
    /// Towards the viewer: anywhere, or next to the mirror direction.
    pub(crate) view: [f64; 3],
    /// Of [0, 1).
    pub(crate) numbers: [f64; 3],
}

impl Point {
    /// All numbers.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        let Self {
            angles,
            source,
            view,
            numbers,
        } = *self;
        [angles, source, view, numbers].into_iter().flatten()
    }

    /// The nearest point whose numbers `f32` has.
    pub(crate) fn single(self) -> Self {
        let single = |numbers: [f64; 3]| narrow(numbers).map(f64::from);
        Self {
            angles: single(self.angles),
            source: single(self.source),
            view: single(self.view),
            numbers: single(self.numbers),
        }
    }
}

/// The nearest numbers of single precision.
#[expect(clippy::cast_possible_truncation, reason = "the nearest is meant")]
pub(crate) fn narrow(numbers: [f64; 3]) -> [f32; 3] {
    numbers.map(|x| x as f32)
}

/// Points up to 85 deg, half of their views next to the mirror direction, as near as a lobe of the
/// width k1 asks for.
pub(crate) fn points(k1: f64, count: u64) -> Vec<Point> {
    let mut generator = generator(count);
    let largest = LARGEST_DEG.to_radians();
    let mut point = |near: bool| {
        let mut uniform = |from: f64, to: f64| generator.random_range(from..to);
        let (psi, phi) = (uniform(0.0, largest), uniform(-6.0, 6.0));
        let (theta, phi) = if near {
            let offset = k1.min(1.0) * uniform(-2.0, 2.0);
            ((-psi + offset).clamp(-largest, largest), 0.1 * offset)
        } else {
            (uniform(-largest, largest), phi)
        };
        let turn = uniform(-3.0, 3.0);
        Point {
            angles: [psi, theta, phi],
            source: direction(psi, turn),
            view: direction(theta, turn + phi),
            numbers: [0, 1, 2].map(|_| uniform(0.0, 1.0)),
        }
    };
    (0..count).map(|i| point(i % 2 == 0)).collect()
}

fn direction(zenith: f64, azimuth: f64) -> [f64; 3] {
    let (sin, cos) = azimuth.sin_cos();
    [zenith.sin() * cos, zenith.sin() * sin, zenith.cos()]
}

/// The results of a source at a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    /// f_r of the angles.
    pub(crate) of_angles: f64,
    /// f_r of the directions.
    pub(crate) of_directions: f64,
    /// The density of the view.
    pub(crate) pdf: f64,
    /// The direction that is drawn.
    pub(crate) drawn: [f64; 3],
    /// Its density.
    pub(crate) density: f64,
    /// f_r cos theta over its density.
    pub(crate) weight: f64,
}

impl Found {
    /// From as many numbers, in the same order.
    pub(crate) fn from_numbers(numbers: [f64; 8]) -> Self {
        let [of_angles, of_directions, pdf, x, y, z, density, weight] = numbers;
        Self {
            of_angles,
            of_directions,
            pdf,
            drawn: [x, y, z],
            density,
            weight,
        }
    }
}

/// Relative errors against the model, and the distance of a drawn direction.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Errors {
    /// f_r of angles.
    pub(crate) of_angles: f64,
    /// f_r of directions.
    pub(crate) of_directions: f64,
    /// The density of a view.
    pub(crate) pdf: f64,
    /// The distance of the drawn direction from that of the model's sampler.
    pub(crate) drawn: f64,
    /// Density and weight of that direction.
    pub(crate) of_drawn: f64,
}

impl Errors {
    /// The largest at some points.
    pub(crate) fn largest(brdf: &AnyBrdf, points: &[Point], found: &[Found]) -> Self {
        assert_eq!(points.len(), found.len());
        let sampler = Sampler::new(brdf);
        let errors = points.iter().zip(found);
        let errors = errors.map(|(point, found)| Self::at(brdf, &sampler, point, found));
        errors.fold(Self::default(), |worst, errors| Self {
            of_angles: worst.of_angles.max(errors.of_angles),
            of_directions: worst.of_directions.max(errors.of_directions),
            pdf: worst.pdf.max(errors.pdf),
            drawn: worst.drawn.max(errors.drawn),
            of_drawn: worst.of_drawn.max(errors.of_drawn),
        })
    }

    fn at(brdf: &AnyBrdf, sampler: &Sampler, point: &Point, found: &Found) -> Self {
        let [psi, theta, phi] = point.angles;
        let angles = Geometry::new(psi, theta, phi).expect("angles");
        let (source, view) = (point.source.into(), point.view.into());
        let directions = Geometry::from_directions(source, view).expect("directions");
        let [drawn, of_drawn] = drawn_errors(brdf, sampler, point, found);
        Self {
            of_angles: relative(found.of_angles, brdf.value(&angles)),
            of_directions: relative(found.of_directions, brdf.value(&directions)),
            pdf: density_error(found.pdf, sampler, &source, &view),
            drawn,
            of_drawn,
        }
    }
}

/// The distance of a drawn direction from that of the sampler, and the error of its density and its
/// weight. Below the surface both are 0; next to the horizon they are not looked at.
fn drawn_errors(brdf: &AnyBrdf, sampler: &Sampler, point: &Point, found: &Found) -> [f64; 2] {
    let source: Vector3<f64> = point.source.into();
    let drawn: Vector3<f64> = found.drawn.into();
    let Some(sample) = sampler.sample(source, point.numbers).expect("a source") else {
        let is_below = drawn.z <= 0.0 && (found.density, found.weight) == (0.0, 0.0);
        assert!(is_below || drawn.z.abs() < 1e-6, "{point:?} {found:?}");
        return [0.0; 2];
    };
    let distance = (drawn - Vector3::from(sample.direction)).norm();
    if drawn.z < LARGEST_DEG.to_radians().cos() {
        return [distance, 0.0];
    }
    let geometry = Geometry::from_directions(source, drawn).expect("directions");
    let intensity = brdf.value(&geometry) * geometry.cos_theta();
    let weight = relative(found.weight, intensity / found.density);
    let density = density_error(found.density, sampler, &source, &drawn);
    [distance, weight.max(density)]
}

/// The error of a density, relative to the density plus 3 % of that of the cosine lobe: where the weight
/// w_s of the specular lobe is nearly 1, 1 - w_s has fewer digits. Directions are drawn with the same
/// w_s, so that estimates are not affected.
fn density_error(
    density: f64,
    sampler: &Sampler,
    source: &Vector3<f64>,
    view: &Vector3<f64>,
) -> f64 {
    let exact = sampler.pdf(source, view).expect("directions");
    let some = 0.03 * view.z * FRAC_1_PI;
    relative(density + some, exact + some)
}

/// The relative error; infinite for what is not a number.
pub(crate) fn relative(value: f64, exact: f64) -> f64 {
    let difference = (value - exact).abs();
    let error = if difference == 0.0 {
        0.0
    } else {
        difference / exact.abs()
    };
    if error.is_nan() { f64::INFINITY } else { error }
}

/// The largest error in double precision: directions are brought to length 1 in the model, which
/// rounds them once more, and next to the mirror direction of a narrow lobe that is a change.
pub(crate) fn check_double(errors: &Errors, k1: f64) {
    let rounding = 16.0 * f64::EPSILON / (k1.min(1.0) * LARGEST_DEG.to_radians().cos());
    assert!(errors.of_angles <= 1e-12, "{errors:?}");
    assert!(errors.of_directions <= 1e-12 + rounding, "{errors:?}");
    assert!(errors.pdf <= 1e-12 + rounding, "{errors:?}");
    assert!(
        errors.drawn <= 1e-9 && errors.of_drawn <= 1e-9,
        "{errors:?}"
    );
}

/// The largest error in single precision, up to 85 deg and for k1 from 0.01 on, of what the batch of
/// the model promises there.
pub(crate) const SINGLE: f64 = 1e-5;

/// Checks all errors against the same limit.
pub(crate) fn check_single(errors: &Errors, limit: f64) {
    let Errors {
        of_angles,
        of_directions,
        pdf,
        drawn,
        of_drawn,
    } = *errors;
    for error in [of_angles, of_directions, pdf, drawn, of_drawn] {
        assert!(error <= limit, "{errors:?}");
    }
}
