//! From radiances to the colours of a screen.

use std::sync::LazyLock;

use egui::{Color32, ColorImage};

use super::pixels::{Pixels, Seen};
use super::shading::Radiance;
use super::sky::Sky;

/// The number of entries of the table from linear values to those of a screen.
const ENTRIES: usize = 4096;

/// The zenith angle of the reflectance that an automatic exposure shows as half of white.
const REFERENCE_ZENITH_DEG: f64 = 30.0;

/// The largest exposure in stops, to both sides.
pub const MOST_STOPS: f64 = 16.0;

/// The sRGB value of each linear one: a power for each pixel would take most of the time.
static SCREEN: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let entry = |i: usize| egui::ecolor::gamma_u8_from_linear_f32(i as f32 / (ENTRIES - 1) as f32);
    (0..ENTRIES).map(entry).collect()
});

/// The exposure in half stops at which the largest hemispherical reflectance of surfaces is about half of
/// white. Those above half of white are not darkened, unless they reflect more than all light, as the fit of
/// a scan with another scale may.
pub fn automatic_stops<'a>(skies: impl Iterator<Item = &'a Sky>) -> f64 {
    let zenith = REFERENCE_ZENITH_DEG.to_radians();
    let largest = skies.map(|sky| f64::from(sky.reflectance(zenith)));
    let largest = largest.fold(0.0, f64::max).max(1e-4);
    let half_stops = if largest > 1.0 {
        (2.0 * largest.recip().log2()).floor()
    } else {
        (2.0 * (0.5 / largest).log2()).round().max(0.0)
    };
    (0.5 * half_stops).clamp(-MOST_STOPS, MOST_STOPS)
}

/// The exposure in half stops at which the brightest place of pictures is just not white.
pub fn stops_for_highlights<'a>(radiances: impl Iterator<Item = &'a Radiance>) -> f64 {
    let largest = radiances.map(|radiance| radiance.largest);
    let largest = largest.fold(1e-4, f32::max);
    let stops = -f64::from(largest).log2();
    ((2.0 * stops).floor() / 2.0).clamp(-MOST_STOPS, MOST_STOPS)
}

/// The picture at an exposure in stops, each of which doubles the light, on a transparent ground: in
/// colour from the radiances of red, green and blue, in grey from one. What is brighter than white is
/// white.
pub fn develop(pixels: &Pixels, channels: &[&Radiance], stops: f64) -> ColorImage {
    let largest = (ENTRIES - 1) as f32;
    let factor = stops.exp2() as f32 * largest;
    let screen: &[u8] = &SCREEN;
    let shown = |value: f32| screen[(value * factor + 0.5).clamp(0.0, largest) as usize];
    let mut image = ColorImage::filled(pixels.size, Color32::TRANSPARENT);
    let mut set = |seen: &Seen, [red, green, blue]: [u8; 3]| {
        image.pixels[seen.pixel as usize] = if seen.coverage == u8::MAX {
            Color32::from_rgb(red, green, blue)
        } else {
            Color32::from_rgba_unmultiplied(red, green, blue, seen.coverage)
        };
    };
    if let [red, green, blue] = channels {
        let values = red.values.iter().zip(&green.values).zip(&blue.values);
        for (seen, ((red, green), blue)) in pixels.seen.iter().zip(values) {
            set(seen, [shown(*red), shown(*green), shown(*blue)]);
        }
    } else if let Some(grey) = channels.first() {
        for (seen, grey) in pixels.seen.iter().zip(&grey.values) {
            set(seen, [shown(*grey); 3]);
        }
    }
    image
}

#[cfg(test)]
mod tests {
    use brdf_core::{AnyBrdf, Family, ModelParameters};

    use super::super::{Light, shade};
    use super::*;

    fn picture(brdfs: &[AnyBrdf], stops: f64) -> ColorImage {
        let pixels = Pixels::ball(64, [0.3, 0.2, 0.933]);
        let light = Light {
            lamp: 0.8,
            sky: 0.2,
        };
        let radiances: Vec<Radiance> = brdfs
            .iter()
            .map(|brdf| shade(&pixels, brdf, &Sky::new(brdf), light))
            .collect();
        develop(&pixels, &radiances.iter().collect::<Vec<_>>(), stops)
    }

    fn brdf(kd: f64) -> AnyBrdf {
        let at = ModelParameters {
            k2: 0.05,
            kd,
            k1: 0.2,
            n: 1.5,
            p: 1.0,
        };
        AnyBrdf::new(Family::Ggx, &at).unwrap()
    }

    #[test]
    fn three_equal_fits_are_grey_and_like_one() {
        let three = picture(&[brdf(0.3); 3], 1.0);
        let colours = three.pixels.iter();
        assert!(colours.clone().all(|c| c.r() == c.g() && c.g() == c.b()));
        assert!(colours.clone().any(|c| c.r() > 100));
        assert_eq!(three, picture(&[brdf(0.3)], 1.0));
    }

    #[test]
    fn the_channels_are_red_green_and_blue() {
        let image = picture(&[brdf(0.9), brdf(0.4), brdf(0.1)], 0.0);
        let middle = image.pixels[32 * 64 + 40];
        assert!(
            middle.r() > middle.g() && middle.g() > middle.b(),
            "{middle:?}"
        );
    }

    #[test]
    fn the_brightest_place_is_just_not_white() {
        let pixels = Pixels::plate(64, 1.3);
        let sky = Sky::new(&brdf(0.1));
        let light = Light {
            lamp: 1.0,
            sky: 0.0,
        };
        let radiance = shade(&pixels, &brdf(0.1), &sky, light);
        let stops = stops_for_highlights(std::iter::once(&radiance));
        let shown = f64::from(radiance.largest) * stops.exp2();
        assert!((0.7..=1.0).contains(&shown), "{shown}");
    }

    #[test]
    fn a_stop_doubles_the_light() {
        let [dark, bright] = [0.0, 1.0].map(|stops| picture(&[brdf(0.1)], stops));
        let linear = |c: Color32| egui::ecolor::linear_f32_from_gamma_u8(c.r());
        let at = 30 * 64 + 36;
        let ratio = linear(bright.pixels[at]) / linear(dark.pixels[at]);
        assert!((ratio - 2.0).abs() < 0.05, "{ratio}");
    }

    #[test]
    fn the_automatic_exposure_brightens_dark_paint_only() {
        let stops = |kd: f64| automatic_stops(std::iter::once(&Sky::new(&brdf(kd))));
        assert_eq!(stops(0.9), 0.0);
        assert_eq!(stops(3.8), -2.0);
        assert!((2.0..4.0).contains(&stops(0.03)), "{}", stops(0.03));
    }
}
