//! What is around a lobe: the plane of the surface with its circles, the rays, and the names of both.

use std::f64::consts::PI;

use super::projection::{Frame, Inks, Piece, RAY};
use super::scene::LobeScene;
use super::vector::{Vector, direction, scaled, sum};
use crate::plot::radius::Radius;

/// The number of straight pieces of a circle.
const CIRCLE: u32 = 96;

/// The number of pieces of a ray, each of which is before or behind what it passes.
const RAY_PIECES: u32 = 40;

/// The angle between two lines of the plane, in units of pi.
const LINES: u32 = 12;

/// Draws the plane of the surface. It is behind everything, because it is never seen from below.
pub(super) fn draw_plane(
    frame: &Frame,
    radius: Radius,
    inks: &Inks,
    pieces: &mut Vec<(f64, Piece)>,
) {
    let mut line = |from: Vector, to: Vector, width: f64| {
        let ends = [from, to].map(|point| frame.place(point).0);
        pieces.push((f64::NEG_INFINITY, Piece::Line(ends, width, inks.faint)));
    };
    let on_plane = |part: f64| direction(0.5 * PI, 2.0 * PI * part);
    for (value, _) in radius.circles() {
        let distance = radius.fraction(value).unwrap_or(0.0);
        for i in 0..CIRCLE {
            let [from, to] =
                [i, i + 1].map(|i| scaled(on_plane(f64::from(i) / f64::from(CIRCLE)), distance));
            line(from, to, 1.0);
        }
    }
    for i in 0..LINES {
        // The plane of incidence is drawn stronger.
        let width = if i % (LINES / 2) == 0 { 2.0 } else { 1.0 };
        line([0.0; 3], on_plane(f64::from(i) / f64::from(LINES)), width);
    }
}

/// Draws the normal, the ray from the source, and dashed the mirror direction.
pub(super) fn draw_rays(frame: &Frame, psi: f64, inks: &Inks, pieces: &mut Vec<(f64, Piece)>) {
    let [normal, source, mirror] = ends(psi);
    for (end, width, is_dashed) in [
        (normal, 1.0, false),
        (source, 2.5, false),
        (mirror, 1.5, true),
    ] {
        for i in 0..RAY_PIECES {
            if is_dashed && i % 2 == 1 {
                continue;
            }
            let at = |i: u32| frame.place(scaled(end, f64::from(i) / f64::from(RAY_PIECES)));
            let [(from, near), (to, far)] = [at(i), at(i + 1)];
            let line = Piece::Line([from, to], width, inks.ink);
            pieces.push((0.5 * (near + far), line));
        }
    }
}

/// The ends of the normal, of the ray from the source and of the mirror direction.
fn ends(psi: f64) -> [Vector; 3] {
    [[0.0, 0.0, 1.0], direction(psi, 0.0), direction(psi, PI)].map(|end| scaled(end, RAY))
}

/// Writes the names of the rays and the values of the circles.
pub(super) fn draw_names(frame: &Frame, scene: &LobeScene, pieces: &mut Vec<(f64, Piece)>) {
    let mut text = |text: String, point: Vector| {
        let (place, _) = frame.place(point);
        pieces.push((f64::INFINITY, Piece::Text(text, place)));
    };
    let psi = scene.lobe.psi;
    let [_, source, mirror] = ends(psi);
    text("source".to_owned(), scaled(source, 1.04));
    // At normal incidence the mirror direction is that of the source.
    if psi > 5_f64.to_radians() {
        text("mirror".to_owned(), scaled(mirror, 1.04));
    }
    let below = [0.0, 0.0, -0.055];
    for (value, label) in scene.radius.circles() {
        let distance = scene.radius.fraction(value).unwrap_or(0.0);
        text(label, sum(scaled(frame.right(), distance), below));
    }
}
