//! The figure of a lobe, as SVG or PNG.

use std::f64::consts::TAU;

use brdf_fit::plot::{DRAWING_AREA, Figure, Ground, Shape, drawing};

use super::camera::Camera;
use super::projection::{Inks, Piece, Projection, Rgb, project};
use super::scene::LobeScene;

/// How much a face is enlarged beyond its outline, in units of the figure: without it the ground would
/// shine through between two faces.
const OVERLAP: f64 = 0.5;

/// The figure of a lobe with two lines of title.
pub fn lobe_figure(scene: &LobeScene, camera: &Camera, title: [&str; 2], ground: Ground) -> Figure {
    let inks = Inks::for_figure(ground);
    let projection = project(scene, camera, DRAWING_AREA, &inks);
    let pieces = projection.pieces.iter();
    let shapes: Vec<Shape> = pieces
        .map(|(_, piece)| shape(piece, &projection, inks.ink))
        .collect();
    drawing("lobe", title, ground, &shapes)
}

fn shape(piece: &Piece, projection: &Projection, ink: Rgb) -> Shape {
    match piece {
        Piece::Face(corners) => face(corners.map(|i| projection.vertices[i])),
        Piece::Line(ends, width, colour) => Shape::Line(ends.to_vec(), *width, *colour),
        Piece::Disc(at, radius, colour) => Shape::Disc(*at, *radius, *colour),
        Piece::Ring([x, y], radius, width, colour) => {
            let corner = |i: u32| {
                let (sin, cos) = (TAU * f64::from(i) / 24.0).sin_cos();
                [x + radius * cos, y + radius * sin]
            };
            Shape::Line((0..=24).map(corner).collect(), *width, *colour)
        }
        Piece::Text(text, at) => Shape::Text(text.clone(), *at, ink),
    }
}

/// A face in the mean colour of its corners.
fn face([a, b, c, d]: [([f64; 2], Rgb); 4]) -> Shape {
    let corners = [a, b, d, c];
    let mean = |i: usize| corners.iter().map(|(at, _)| at[i]).sum::<f64>() / 4.0;
    let middle = [mean(0), mean(1)];
    let enlarged = corners.map(|([x, y], _)| {
        let (dx, dy) = (x - middle[0], y - middle[1]);
        let factor = OVERLAP / dx.hypot(dy).max(1e-9);
        [x + factor * dx, y + factor * dy]
    });
    let colour = |i: usize| {
        let sum: u32 = corners.iter().map(|(_, colour)| u32::from(colour[i])).sum();
        (sum / 4) as u8
    };
    Shape::Area(enlarged.to_vec(), [colour(0), colour(1), colour(2)])
}
