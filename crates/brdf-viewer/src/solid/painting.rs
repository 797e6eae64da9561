//! A picture as triangles and texts of egui.

use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{Color32, Pos2, pos2, vec2};

use super::projection::{Piece, Projection};

/// Half the width of the soft edge of a line, in points.
const SOFT: f32 = 0.5;

/// The corners of a disc.
const CORNERS: u32 = 16;

/// The triangles of a picture, the farthest first.
pub fn mesh(projection: &Projection) -> Mesh {
    let mut mesh = Mesh::default();
    mesh.vertices
        .extend(projection.vertices.iter().map(|(at, colour)| Vertex {
            pos: position(*at),
            uv: WHITE_UV,
            color: rgb(*colour),
        }));
    for (_, piece) in &projection.pieces {
        match piece {
            Piece::Face(corners) => {
                let [a, b, c, d] = corners.map(|i| i as u32);
                mesh.indices.extend([a, b, c, b, d, c]);
            }
            Piece::Line(ends, width, colour) => {
                line(&mut mesh, ends.map(position), *width as f32, rgb(*colour));
            }
            Piece::Disc(at, radius, colour) => {
                let radii = [*radius as f32 - SOFT, *radius as f32 + SOFT];
                disc(&mut mesh, position(*at), radii, rgb(*colour));
            }
            Piece::Ring(at, radius, width, colour) => {
                ring(
                    &mut mesh,
                    position(*at),
                    *radius as f32,
                    *width as f32,
                    rgb(*colour),
                );
            }
            Piece::Text(..) => {}
        }
    }
    mesh
}

/// The texts of a picture, each with its middle.
pub fn texts(projection: &Projection) -> impl Iterator<Item = (&str, Pos2)> {
    let pieces = projection.pieces.iter();
    pieces.filter_map(|(_, piece)| match piece {
        Piece::Text(text, at) => Some((text.as_str(), position(*at))),
        _ => None,
    })
}

fn position([x, y]: [f64; 2]) -> Pos2 {
    pos2(x as f32, y as f32)
}

fn rgb([red, green, blue]: [u8; 3]) -> Color32 {
    Color32::from_rgb(red, green, blue)
}

/// A line whose sides are soft, which is smooth on every screen.
fn line(mesh: &mut Mesh, [from, to]: [Pos2; 2], width: f32, colour: Color32) {
    let along = (to - from).normalized();
    let across = vec2(-along.y, along.x);
    let (core, edge) = ((0.5 * width - SOFT).max(0.0), 0.5 * width + SOFT);
    let first = mesh.vertices.len() as u32;
    for end in [from, to] {
        mesh.colored_vertex(end - across * edge, Color32::TRANSPARENT);
        mesh.colored_vertex(end - across * core, colour);
        mesh.colored_vertex(end + across * core, colour);
        mesh.colored_vertex(end + across * edge, Color32::TRANSPARENT);
    }
    for i in first..first + 3 {
        mesh.add_triangle(i, i + 1, i + 4);
        mesh.add_triangle(i + 1, i + 5, i + 4);
    }
}

/// A filled circle whose edge is soft between two radii.
fn disc(mesh: &mut Mesh, centre: Pos2, [inner, outer]: [f32; 2], colour: Color32) {
    let first = mesh.vertices.len() as u32;
    mesh.colored_vertex(centre, colour);
    for corner in circle(centre, inner) {
        mesh.colored_vertex(corner, colour);
    }
    for corner in circle(centre, outer) {
        mesh.colored_vertex(corner, Color32::TRANSPARENT);
    }
    for i in 0..CORNERS {
        let [a, b] = [i, (i + 1) % CORNERS].map(|i| first + 1 + i);
        mesh.add_triangle(first, a, b);
        mesh.add_triangle(a, b, a + CORNERS);
        mesh.add_triangle(b, b + CORNERS, a + CORNERS);
    }
}

fn ring(mesh: &mut Mesh, centre: Pos2, radius: f32, width: f32, colour: Color32) {
    let corners: Vec<Pos2> = circle(centre, radius).collect();
    for (i, corner) in corners.iter().enumerate() {
        let next = corners[(i + 1) % corners.len()];
        line(mesh, [*corner, next], width, colour);
    }
}

fn circle(centre: Pos2, radius: f32) -> impl Iterator<Item = Pos2> {
    (0..CORNERS).map(move |i| {
        let (sin, cos) = (std::f32::consts::TAU * i as f32 / CORNERS as f32).sin_cos();
        centre + radius * vec2(cos, sin)
    })
}
