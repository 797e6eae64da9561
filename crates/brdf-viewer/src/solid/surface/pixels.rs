//! The geometry of each pixel: what does not depend on the BRDF.

use super::sky::Sky;

type Vector = [f32; 3];

/// The tangent of half the angle of view of the camera above the plate.
const HALF_VIEW: f32 = 0.28;

/// The height of the camera above the plate and its distance from the middle, in units of half a side.
const CAMERA: [f32; 2] = [1.34, 5.0];

/// Half the length of the plate, away from the camera and across, in the same unit.
const PLATE: [f32; 2] = [1.6, 0.95];

/// A pixel that shows the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seen {
    /// The index in the picture.
    pub(super) pixel: u32,
    /// The index in the table of the sky.
    pub(super) sky: u16,
    /// How much of the pixel the surface covers, from 0 to 255.
    pub(super) coverage: u8,
}

/// Directions in the frame of the surface, z along its normal, of the pixels that the lamp reaches.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Lit {
    /// The index among the pixels that show the surface.
    pub(super) seen: Vec<u32>,
    pub(super) source: [Vec<f32>; 3],
    pub(super) view: [Vec<f32>; 3],
}

/// The pixels of a picture of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Pixels {
    /// The width and the height.
    pub size: [usize; 2],
    pub(super) seen: Vec<Seen>,
    pub(super) lit: Lit,
}

/// The direction towards the lamp: to the right by an angle in radians, and upwards by another; the
/// camera is at (0, 0).
pub fn lamp_direction([right, up]: [f64; 2]) -> [f64; 3] {
    let ((sin_right, cos_right), (sin_up, cos_up)) = (right.sin_cos(), up.sin_cos());
    [sin_right * cos_up, sin_up, cos_right * cos_up]
}

impl Pixels {
    /// A ball that fills a square of `side` pixels, seen from far away, with a lamp in a direction with x
    /// to the right, y upwards and z towards the viewer.
    pub fn ball(side: usize, lamp: [f64; 3]) -> Self {
        let lamp = lamp.map(|x| x as f32);
        let mut pixels = Self::empty([side, side]);
        let half = 0.5 * side as f32;
        for row in 0..side {
            for column in 0..side {
                let x = (column as f32 + 0.5 - half) / half;
                let y = (half - row as f32 - 0.5) / half;
                let distance = x.hypot(y);
                let coverage = (1.0 - distance) * half + 0.5;
                if coverage <= 0.0 {
                    continue;
                }
                // A pixel that the limb crosses shows what is just inside.
                let inside = (1.0 - 0.5 / half).min(distance) / distance.max(1e-9);
                let [x, y] = [x * inside, y * inside];
                let normal = [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()];
                pixels.push(row * side + column, coverage, normal, lamp, [0.0, 0.0, 1.0]);
            }
        }
        pixels
    }

    /// A horizontal plate, seen at a small angle from above, with a lamp behind it at a zenith angle psi
    /// in radians: the mirror direction is towards the viewer. Twice as wide as high.
    pub fn plate(width: usize, psi: f64) -> Self {
        let height = width / 2;
        let mut pixels = Self::empty([width, height]);
        let (sin, cos) = psi.sin_cos();
        // x to the right, y away from the camera, z along the normal.
        let lamp = [0.0, sin as f32, cos as f32];
        let [camera_height, distance] = CAMERA;
        let eye = [0.0, -distance, camera_height];
        // The middle of the picture is the middle of the plate.
        let forwards = unit([0.0, distance, -camera_height]);
        let upwards = [0.0, -forwards[2], forwards[1]];
        for row in 0..height {
            for column in 0..width {
                let of_width = |at: usize, of: usize| {
                    (2.0 * (at as f32 + 0.5) - of as f32) / width as f32 * HALF_VIEW
                };
                let (x, y) = (of_width(column, width), -of_width(row, height));
                let ray = [
                    x,
                    forwards[1] + y * upwards[1],
                    forwards[2] + y * upwards[2],
                ];
                if ray[2] >= 0.0 {
                    continue;
                }
                let reach = camera_height / -ray[2];
                let point = [reach * ray[0], eye[1] + reach * ray[1]];
                // The size of a pixel on the plate, across and away.
                let pixel = 2.0 * HALF_VIEW / width as f32 * reach;
                let sizes = [pixel, pixel * dot(ray, ray).sqrt() / -ray[2]];
                let margins = [PLATE[1] - point[0].abs(), PLATE[0] - point[1].abs()];
                let coverage = [0, 1].map(|i| (margins[i] / sizes[i] + 0.5).clamp(0.0, 1.0));
                let view = unit(ray.map(|x| -x));
                pixels.push(
                    row * width + column,
                    coverage[0] * coverage[1],
                    [0.0, 0.0, 1.0],
                    lamp,
                    view,
                );
            }
        }
        pixels
    }

    fn empty(size: [usize; 2]) -> Self {
        Self {
            size,
            seen: Vec::new(),
            lit: Lit::default(),
        }
    }

    /// Adds a pixel by the normal and the directions towards the lamp and the viewer, if they cover any
    /// of it.
    fn push(&mut self, pixel: usize, coverage: f32, normal: Vector, lamp: Vector, view: Vector) {
        let coverage = (coverage.min(1.0) * 255.0).round() as u8;
        if coverage == 0 {
            return;
        }
        let (cos_psi, cos_theta) = (dot(normal, lamp), dot(normal, view));
        if cos_psi > 0.0 && cos_theta > 0.0 {
            let seen = self.seen.len() as u32;
            self.lit
                .push(seen, normal, lamp, view, [cos_psi, cos_theta]);
        }
        self.seen.push(Seen {
            pixel: pixel as u32,
            sky: Sky::index(cos_theta),
            coverage,
        });
    }
}

impl Lit {
    /// The frame of the surface has x in the plane of the normal and the lamp.
    fn push(&mut self, seen: u32, normal: Vector, lamp: Vector, view: Vector, cos: [f32; 2]) {
        let [cos_psi, cos_theta] = cos;
        let along = unit_or_across([0, 1, 2].map(|i| lamp[i] - cos_psi * normal[i]), normal);
        let across = cross(normal, along);
        let source = [dot(lamp, along), 0.0, cos_psi];
        let view = [dot(view, along), dot(view, across), cos_theta];
        self.seen.push(seen);
        for i in 0..3 {
            self.source[i].push(source[i]);
            self.view[i].push(view[i]);
        }
    }
}

fn dot(a: Vector, b: Vector) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn unit(a: Vector) -> Vector {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

/// The direction of a vector at right angles to a normal, or any one where it has none.
fn unit_or_across(a: Vector, normal: Vector) -> Vector {
    if dot(a, a) > 1e-12 {
        return unit(a);
    }
    let other = if normal[0].abs() < 0.5 {
        [1.0, 0.0, 0.0]
    } else {
        [0.0, 1.0, 0.0]
    };
    unit(cross(normal, other))
}
