//! A lobe and what is around it in the plane of a picture, the farthest first.

use brdf_fit::plot::Ground;

use super::camera::Camera;
use super::depth::DepthBuffer;
use super::directions::{COLUMNS, ROWS};
use super::lobe::Lobe;
use super::scene::{LobeScene, Spot};
use super::surroundings;
use super::vector::{Vector, cross, difference, dot, scaled, sum, unit};

/// Red, green and blue.
pub(super) type Rgb = [u8; 3];

/// The distance of the ends of the rays from the centre, in radii of the outermost circle.
pub(super) const RAY: f64 = 1.12;

/// The light in which the lobe is drawn: to the left, upwards and towards the camera.
const LIGHT: [f64; 3] = [-0.5, 0.6, 1.0];

/// Every line of this number of a second lobe is drawn.
const GHOST_LINES: usize = 8;

/// How much nearer an outline is than the faces beside it, so that it is not covered by them.
const OUTLINE_LIFT: f64 = 0.004;

/// The colours of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Inks {
    /// The lobe.
    pub lobe: Rgb,
    /// The second lobe.
    pub ghost: Rgb,
    /// Readings, rays and text.
    pub ink: Rgb,
    /// The plane of the surface.
    pub faint: Rgb,
    /// What surrounds a reading.
    pub ground: Rgb,
}

impl Inks {
    /// The colours of a window.
    pub fn for_window(ground: Ground) -> Self {
        let (ink, faint, page) = match ground {
            Ground::Light => (30, 175, 250),
            Ground::Dark => (235, 95, 27),
        };
        Self::with_greys(ground, [ink, faint, page])
    }

    /// The colours of a figure, whose greys are those on white paper.
    pub fn for_figure(ground: Ground) -> Self {
        Self::with_greys(ground, [30, 175, 255])
    }

    fn with_greys(ground: Ground, [ink, faint, page]: [u8; 3]) -> Self {
        let colour = |i| brdf_fit::plot::colour(None, i, 2, ground);
        Self {
            lobe: colour(0),
            ghost: colour(1),
            ink: [ink; 3],
            faint: [faint; 3],
            ground: [page; 3],
        }
    }
}

/// A part of a picture.
#[derive(Debug, Clone, PartialEq)]
pub enum Piece {
    /// A face, by the indices of its upper left, upper right, lower left and lower right corner.
    Face([usize; 4]),
    /// A straight line: its ends, its width and its colour.
    Line([[f64; 2]; 2], f64, Rgb),
    /// A filled circle: its centre, its radius and its colour.
    Disc([f64; 2], f64, Rgb),
    /// A circle: its centre, its radius, the width of its line and its colour.
    Ring([f64; 2], f64, f64, Rgb),
    /// A text around a point.
    Text(String, [f64; 2]),
}

/// A picture.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Projection {
    /// The corners of the faces, with their colours.
    pub vertices: Vec<([f64; 2], Rgb)>,
    /// The parts, each with its depth towards the camera. Each covers those before it.
    pub pieces: Vec<(f64, Piece)>,
}

/// From space to the picture.
pub(super) struct Frame {
    axes: [Vector; 3],
    centre: [f64; 2],
    scale: f64,
}

impl Frame {
    /// A frame in which the hemisphere fills an area with a left, upper, right and lower edge.
    fn new(camera: &Camera, [left, top, right, bottom]: [f64; 4]) -> Self {
        let (width, height) = (right - left, bottom - top);
        let below = RAY * camera.pitch.sin();
        let fitting = (0.5 * width / RAY).min(height / (RAY + below)) * 0.96;
        Self {
            axes: camera.axes(),
            // With another magnification the origin stays.
            centre: [
                0.5 * (left + right),
                0.5 * (top + bottom) + 0.5 * (RAY - below) * fitting,
            ],
            scale: fitting.max(1.0) * camera.zoom,
        }
    }

    /// The coordinates of a point to the right, upwards and towards the camera.
    pub(super) fn seen(&self, point: Vector) -> Vector {
        self.axes.map(|axis| dot(point, axis))
    }

    /// The place of a point in the picture, and its depth.
    pub(super) fn place(&self, point: Vector) -> ([f64; 2], f64) {
        let [x, y, depth] = self.seen(point);
        (self.placed([x, y, depth]), depth)
    }

    fn placed(&self, [x, y, _]: Vector) -> [f64; 2] {
        let [centre_x, centre_y] = self.centre;
        [centre_x + self.scale * x, centre_y - self.scale * y]
    }

    /// The direction to the right in the plane of the surface.
    pub(super) fn right(&self) -> Vector {
        self.axes[0]
    }
}

/// The picture of a lobe within an area with a left, upper, right and lower edge.
pub fn project(scene: &LobeScene, camera: &Camera, area: [f64; 4], inks: &Inks) -> Projection {
    let frame = Frame::new(camera, area);
    let mut projection = Projection::default();
    let pieces = &mut projection.pieces;
    surroundings::draw_plane(&frame, scene.radius, inks, pieces);
    let behind = pieces.len();
    let seen: Vec<Vector> = scene
        .lobe
        .points(scene.radius)
        .into_iter()
        .map(|point| frame.seen(point))
        .collect();
    let shades = shades(&seen);
    projection.vertices = seen
        .iter()
        .zip(&shades)
        .map(|(point, shade)| (frame.placed(*point), shaded(inks.lobe, *shade)))
        .collect();
    draw_faces(&scene.lobe, &seen, pieces);
    draw_outline(&frame, &seen, &projection.vertices, pieces);
    // Without readings and a second lobe nothing asks for the depth.
    let is_alone = scene.readings.is_empty() && scene.ghost.is_none();
    let depth = (!is_alone).then(|| DepthBuffer::new(&seen, scene.lobe.faces()));
    if let (Some(ghost), Some(depth)) = (&scene.ghost, &depth) {
        draw_ghost(&frame, ghost, scene, depth, inks, pieces);
    }
    surroundings::draw_rays(&frame, scene.lobe.psi, inks, pieces);
    sort(&mut pieces[behind..]);
    if let Some(depth) = &depth {
        draw_readings(&frame, scene, depth, inks, pieces);
    }
    surroundings::draw_names(&frame, scene, pieces);
    projection
}

/// Sorts pieces from the farthest to the nearest. Their depths are sorted first, since pieces are large.
fn sort(pieces: &mut [(f64, Piece)]) {
    let depths = pieces.iter().map(|(depth, _)| *depth);
    let mut order: Vec<(f64, usize)> = depths.zip(0..).collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let take = |i: usize, pieces: &mut [(f64, Piece)]| {
        std::mem::replace(&mut pieces[i].1, Piece::Face([0; 4]))
    };
    let sorted: Vec<(f64, Piece)> = order
        .into_iter()
        .map(|(depth, i)| (depth, take(i, pieces)))
        .collect();
    for (piece, sorted) in pieces.iter_mut().zip(sorted) {
        *piece = sorted;
    }
}

fn draw_faces(lobe: &Lobe, seen: &[Vector], pieces: &mut Vec<(f64, Piece)>) {
    for corners in lobe.faces() {
        let depth = corners.iter().map(|i| seen[*i][2]).sum::<f64>() / 4.0;
        pieces.push((depth, Piece::Face(corners)));
    }
}

/// The brightness of each point of a lobe, from 0 to 1, by the normal of the lobe there.
fn shades(seen: &[Vector]) -> Vec<f64> {
    let light = unit(LIGHT);
    let at = |row: usize, column: usize| seen[row * COLUMNS + column];
    let shade = |i: usize| {
        let (row, column) = (i / COLUMNS, i % COLUMNS);
        let (above, below) = (row.saturating_sub(1), (row + 1).min(ROWS - 1));
        // The first and the last column are the same.
        let last = COLUMNS - 1;
        let before = if column == 0 { last - 1 } else { column - 1 };
        let after = if column == last { 1 } else { column + 1 };
        let along = difference(at(below, column), at(above, column));
        // The first row is one point, whose neighbours are in the second row.
        let across = difference(at(row.max(1), after), at(row.max(1), before));
        0.4 + 0.6 * dot(unit(cross(unit(along), unit(across))), light).abs()
    };
    (0..seen.len()).map(shade).collect()
}

fn shaded(colour: Rgb, shade: f64) -> Rgb {
    colour.map(|component| (f64::from(component) * shade) as u8)
}

/// Draws the edges between faces that are seen from outside and from inside, and the rim: without them
/// the outline would have steps, because the edges of triangles are not smooth on a screen.
fn draw_outline(
    frame: &Frame,
    seen: &[Vector],
    vertices: &[([f64; 2], Rgb)],
    pieces: &mut Vec<(f64, Piece)>,
) {
    let side = |row: usize, column: usize| {
        let i = row * COLUMNS + column;
        let down = difference(seen[i + COLUMNS + 1], seen[i]);
        let across = difference(seen[i + 1], seen[i + COLUMNS]);
        down[0] * across[1] - down[1] * across[0] > 0.0
    };
    let sides: Vec<bool> = (0..ROWS - 1)
        .flat_map(|row| (0..COLUMNS - 1).map(move |column| side(row, column)))
        .collect();
    let is_front = |row: usize, column: usize| sides[row * (COLUMNS - 1) + column];
    let mut edge = |a: usize, b: usize| {
        let middle = scaled(sum(seen[a], seen[b]), 0.5);
        let ends = [a, b].map(|i| frame.placed(seen[i]));
        let colour = shaded(vertices[a].1, 0.85);
        pieces.push((middle[2] + OUTLINE_LIFT, Piece::Line(ends, 1.2, colour)));
    };
    for row in 0..ROWS {
        for column in 0..COLUMNS - 1 {
            let i = row * COLUMNS + column;
            let is_rim = row == ROWS - 1;
            if is_rim || row > 0 && is_front(row - 1, column) != is_front(row, column) {
                edge(i, i + 1);
            }
            let before = (column + COLUMNS - 2) % (COLUMNS - 1);
            if !is_rim && is_front(row, before) != is_front(row, column) {
                edge(i, i + COLUMNS);
            }
        }
    }
}

/// Draws a second lobe as some of the lines of its grid. The lines of its front that are inside the first
/// lobe shine through it.
fn draw_ghost(
    frame: &Frame,
    ghost: &Lobe,
    scene: &LobeScene,
    lobe: &DepthBuffer,
    inks: &Inks,
    pieces: &mut Vec<(f64, Piece)>,
) {
    let points = ghost.points(scene.radius).into_iter();
    let seen: Vec<Vector> = points.map(|point| frame.seen(point)).collect();
    let own = DepthBuffer::new(&seen, ghost.faces());
    let through = [0, 1, 2].map(|i| inks.lobe[i].midpoint(inks.ghost[i]));
    let mut line = |a: usize, b: usize| {
        let middle = scaled(sum(seen[a], seen[b]), 0.5);
        let ends = [a, b].map(|i| frame.placed(seen[i]));
        let (depth, colour) = if lobe.hides(middle) && !own.hides(middle) {
            // Nearer than the lobe, which reaches up to 1.
            (2.0, through)
        } else {
            (middle[2], inks.ghost)
        };
        pieces.push((depth, Piece::Line(ends, 1.0, colour)));
    };
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let i = row * COLUMNS + column;
            if row % GHOST_LINES == 0 && column + 1 < COLUMNS {
                line(i, i + 1);
            }
            if column % GHOST_LINES == 0 && row + 1 < ROWS {
                line(i, i + COLUMNS);
            }
        }
    }
}

fn draw_readings(
    frame: &Frame,
    scene: &LobeScene,
    depth: &DepthBuffer,
    inks: &Inks,
    pieces: &mut Vec<(f64, Piece)>,
) {
    for spot in &scene.readings {
        let Some(distance) = scene.radius.fraction(spot.value) else {
            continue;
        };
        let at = frame.seen(scaled(spot.direction, distance));
        let mark = mark(frame.placed(at), spot, depth.hides(at), inks);
        pieces.extend(mark.into_iter().map(|piece| (f64::INFINITY, piece)));
    }
}

/// The mark of a reading: a disc, a ring where it is hidden, a cross where it is left out of the fit.
fn mark([x, y]: [f64; 2], spot: &Spot, is_hidden: bool, inks: &Inks) -> Vec<Piece> {
    if spot.left_out {
        let bar =
            |dx: f64, dy: f64| Piece::Line([[x - dx, y - dy], [x + dx, y + dy]], 1.2, inks.ink);
        vec![bar(3.0, 3.0), bar(3.0, -3.0)]
    } else if is_hidden {
        vec![
            Piece::Disc([x, y], 2.8, inks.ground),
            Piece::Ring([x, y], 3.0, 1.4, inks.ink),
        ]
    } else {
        vec![
            Piece::Disc([x, y], 4.0, inks.ground),
            Piece::Disc([x, y], 3.0, inks.ink),
        ]
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::{AnyBrdf, Family, ModelParameters};
    use brdf_fit::plot::{Quantity, Scale};

    use super::super::vector::direction;
    use super::*;

    const AREA: [f64; 4] = [0.0, 0.0, 600.0, 400.0];

    fn scene(scale: Scale) -> LobeScene {
        let at = ModelParameters {
            k2: 0.3,
            kd: 0.1,
            k1: 0.2,
            n: 1.5,
            p: 1.0,
        };
        let brdf = AnyBrdf::new(Family::Paper, &at).unwrap();
        let ghost = AnyBrdf::new(Family::Ggx, &at).unwrap();
        let spot = |theta: f64, value: f64| Spot {
            direction: direction(theta, 0.0),
            value,
            left_out: false,
        };
        // On the side away from the default camera, above the lobe, and one without a radius.
        let away = Spot {
            direction: direction(1.2, 1.8),
            ..spot(0.0, 1e-3)
        };
        let readings = vec![spot(-0.5, 0.5), spot(-0.2, -0.1), away];
        LobeScene::new(
            (&brdf, Some(&ghost)),
            0.5,
            (Quantity::BrdfCosine, scale),
            readings,
        )
    }

    #[test]
    fn a_picture_is_drawn_from_back_to_front_without_undefined_numbers() {
        for scale in [Scale::Linear, Scale::Logarithmic] {
            for turn in 0..12 {
                let camera =
                    Camera::default().turned(0.55 * f64::from(turn), 0.1 * f64::from(turn));
                let inks = Inks::for_window(Ground::Light);
                let picture = project(&scene(scale), &camera, AREA, &inks);
                let depths = picture.pieces.iter().map(|(depth, _)| *depth);
                assert!(depths.clone().all(|depth| !depth.is_nan()));
                assert!(depths.is_sorted(), "{turn}");
                let places = picture.vertices.iter().map(|(place, _)| place);
                for [x, y] in places {
                    assert!(
                        (0.0..600.0).contains(x) && (0.0..400.0).contains(y),
                        "{x} {y}"
                    );
                }
                let faces = picture.pieces.iter().filter_map(|(_, piece)| match piece {
                    Piece::Face(corners) => Some(corners),
                    _ => None,
                });
                assert_eq!(faces.clone().count(), (ROWS - 1) * (COLUMNS - 1));
                assert!(faces.flatten().all(|i| *i < picture.vertices.len()));
            }
        }
    }

    #[test]
    fn hidden_readings_are_rings_and_those_without_a_radius_are_counted() {
        let inks = Inks::for_window(Ground::Light);
        let scene = scene(Scale::Linear);
        let picture = project(&scene, &Camera::default(), AREA, &inks);
        let count = |is: fn(&Piece) -> bool| {
            let pieces = picture.pieces.iter();
            pieces.filter(|(_, piece)| is(piece)).count()
        };
        // Discs have a border of the colour of the ground, rings a middle.
        assert_eq!(count(|piece| matches!(piece, Piece::Disc(..))), 3);
        assert_eq!(count(|piece| matches!(piece, Piece::Ring(..))), 1);
        assert_eq!(scene.not_shown(), 1);
    }
}
