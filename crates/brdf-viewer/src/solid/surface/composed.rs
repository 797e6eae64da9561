//! A picture of several surfaces beside each other, for a file.

use brdf_core::AnyBrdf;
use brdf_fit::plot::Ground;
use egui::{Color32, ColorImage};

use super::{Light, Pixels, Radiance, Sky, develop, lamp_direction, shade};
/// Surfaces with what lights and exposes them.
#[derive(Debug, Clone, PartialEq)]
pub struct Composition {
    /// The BRDFs of the colours of each surface.
    pub surfaces: Vec<Vec<AnyBrdf>>,
    /// The direction of the lamp on the ball: to the right and upwards, in radians.
    pub lamp: [f64; 2],
    /// The zenith angle of the lamp on the plate, in radians.
    pub plate_psi: f64,
    /// The light.
    pub light: Light,
    /// The exposures of the balls and of the plates in stops.
    pub stops: [f64; 2],
    /// The ground of the picture.
    pub ground: Ground,
}

impl Composition {
    /// The picture, with `side` pixels along each surface: the ball above the plate.
    pub fn picture(&self, side: usize) -> ColorImage {
        let lamp = lamp_direction(self.lamp);
        let parts = [
            Pixels::ball(side, lamp),
            Pixels::plate(side, self.plate_psi),
        ];
        let page = match self.ground {
            Ground::Light => Color32::WHITE,
            Ground::Dark => Color32::from_gray(27),
        };
        let size = [side * self.surfaces.len(), side + side / 2];
        let mut image = ColorImage::filled(size, page);
        for (column, brdfs) in self.surfaces.iter().enumerate() {
            let skies: Vec<Sky> = brdfs.iter().map(Sky::new).collect();
            for ((pixels, top), stops) in parts.iter().zip([0, side]).zip(self.stops) {
                let channels: Vec<Radiance> = brdfs
                    .iter()
                    .zip(&skies)
                    .map(|(brdf, sky)| shade(pixels, brdf, sky, self.light))
                    .collect();
                let part = develop(pixels, &channels.iter().collect::<Vec<_>>(), stops);
                draw(&part, [column * side, top], &mut image);
            }
        }
        image
    }
}

/// Draws a picture with a transparent ground over another one.
fn draw(part: &ColorImage, [left, top]: [usize; 2], image: &mut ColorImage) {
    let width = image.size[0];
    for (row, pixels) in part.pixels.chunks(part.size[0]).enumerate() {
        let from = (top + row) * width + left;
        for (below, pixel) in image.pixels[from..from + pixels.len()]
            .iter_mut()
            .zip(pixels)
        {
            *below = below.blend(*pixel);
        }
    }
}
