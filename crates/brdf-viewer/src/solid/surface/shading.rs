//! The radiance of each pixel.

use std::f32::consts::PI;

use brdf_core::AnyBrdf;
use brdf_core::evaluator::{Evaluator as _, Points, Single};

use super::pixels::Pixels;
use super::sky::Sky;

/// The shares of the light of a lamp and of a uniform sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// The irradiance of a surface that faces the lamp, in units of that at which a perfect diffuser is
    /// white.
    pub lamp: f32,
    /// The irradiance by the whole sky, in the same unit.
    pub sky: f32,
}

/// The radiance of each pixel that shows the surface, in units of white, at one wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct Radiance {
    pub(super) values: Vec<f32>,
    /// The largest of them.
    pub(super) largest: f32,
}

impl Radiance {
    /// The radiance of each pixel that is wholly covered by the surface, with its index in the picture.
    pub fn covered(&self, pixels: &Pixels) -> impl Iterator<Item = (usize, f32)> {
        let values = pixels.seen.iter().zip(&self.values);
        let covered = values.filter(|(seen, _)| seen.coverage == u8::MAX);
        covered.map(|(seen, value)| (seen.pixel as usize, *value))
    }
}

/// The radiance of a surface with a BRDF and its sky.
pub fn shade(pixels: &Pixels, brdf: &AnyBrdf, sky: &Sky, light: Light) -> Radiance {
    let mut values: Vec<f32> = match light.sky {
        0.0 => vec![0.0; pixels.seen.len()],
        share => {
            let seen = pixels.seen.iter();
            seen.map(|seen| share * sky.at(seen.sky)).collect()
        }
    };
    if light.lamp > 0.0 {
        add_lamp(pixels, *brdf, light.lamp, &mut values);
    }
    let largest = values.iter().copied().fold(0.0, f32::max);
    Radiance { values, largest }
}

fn add_lamp(pixels: &Pixels, brdf: AnyBrdf, lamp: f32, sums: &mut [f32]) {
    let lit = &pixels.lit;
    let points = Points::Directions {
        source: lit.source.each_ref().map(Vec::as_slice),
        view: lit.view.each_ref().map(Vec::as_slice),
    };
    let mut values = vec![0.0_f32; lit.seen.len()];
    // All arrays have one length, so that there is no error.
    let _ = Single::new(brdf).values_f32(&points, &mut values);
    for ((seen, value), cos_psi) in lit.seen.iter().zip(values).zip(&lit.source[2]) {
        let radiance = lamp * PI * value * cos_psi;
        // Next to the limb and to the terminator a value may not be a number.
        if radiance.is_finite() {
            sums[*seen as usize] += radiance;
        }
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::{Family, ModelParameters};

    use super::super::lamp_direction;
    use super::*;

    const LAMP: Light = Light {
        lamp: 1.0,
        sky: 0.0,
    };

    fn brdf(k2: f64, kd: f64, k1: f64) -> AnyBrdf {
        let (n, p) = (1.5, 1.0);
        AnyBrdf::new(Family::Paper, &ModelParameters { k2, kd, k1, n, p }).unwrap()
    }

    fn radiance(pixels: &Pixels, brdf: AnyBrdf, light: Light) -> Vec<f32> {
        let sky = Sky::new(&brdf);
        shade(pixels, &brdf, &sky, light).values
    }

    /// The normal of a pixel of a ball.
    fn normal(side: usize, pixel: u32) -> [f64; 3] {
        let (row, column) = (pixel as usize / side, pixel as usize % side);
        let half = 0.5 * side as f64;
        let x = (column as f64 + 0.5 - half) / half;
        let y = (half - row as f64 - 0.5) / half;
        [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]
    }

    fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        (0..3).map(|i| a[i] * b[i]).sum()
    }

    #[test]
    fn a_lambertian_ball_is_the_cosine_in_every_pixel() {
        for angles in [[0.0, 0.0], [0.6, 0.5], [-2.0, 0.3]] {
            let lamp = lamp_direction(angles);
            let pixels = Pixels::ball(96, lamp);
            let found = radiance(&pixels, brdf(0.0, 1.0, 0.1), LAMP);
            for (seen, found) in pixels.seen.iter().zip(found) {
                if seen.coverage < 255 {
                    continue;
                }
                let cos_psi = dot(normal(96, seen.pixel), lamp).max(0.0);
                assert!((f64::from(found) - cos_psi).abs() < 1e-5, "{angles:?}");
            }
        }
    }

    #[test]
    fn a_perfect_diffuser_is_white_under_the_sky() {
        let sky = Light {
            lamp: 0.0,
            sky: 1.0,
        };
        for pixels in [Pixels::ball(64, [0.0, 0.0, 1.0]), Pixels::plate(64, 1.2)] {
            let found = radiance(&pixels, brdf(0.0, 1.0, 0.1), sky);
            assert!(found.iter().all(|radiance| (radiance - 1.0).abs() < 1e-6));
        }
    }

    #[test]
    fn the_brightest_pixel_of_a_narrow_lobe_has_the_half_vector_as_its_normal() {
        let side = 256;
        for angles in [[0.0, 0.0], [0.7, 0.4], [-0.9, -0.2]] {
            let lamp = lamp_direction(angles);
            let half = [lamp[0], lamp[1], lamp[2] + 1.0];
            let half = half.map(|x| x / dot(half, half).sqrt());
            let pixels = Pixels::ball(side, lamp);
            let found = radiance(&pixels, brdf(0.3, 0.1, 0.02), LAMP);
            let brightest = (0..found.len()).max_by(|a, b| found[*a].total_cmp(&found[*b]));
            let at = normal(side, pixels.seen[brightest.unwrap()].pixel);
            let off = (0..2).map(|i| (at[i] - half[i]).abs()).fold(0.0, f64::max);
            assert!(off < 2.0 / side as f64, "{angles:?}: {at:?} {half:?}");
        }
    }

    #[test]
    fn the_plate_is_brightest_where_it_mirrors_the_lamp() {
        let pixels = Pixels::plate(300, 78_f64.to_radians());
        let found = radiance(&pixels, brdf(0.3, 0.1, 0.05), LAMP);
        let brightest = (0..found.len()).max_by(|a, b| found[*a].total_cmp(&found[*b]));
        let column = pixels.seen[brightest.unwrap()].pixel % 300;
        assert!((149..=150).contains(&column), "{column}");
        assert!(found.iter().all(|radiance| radiance.is_finite()));
    }
}
