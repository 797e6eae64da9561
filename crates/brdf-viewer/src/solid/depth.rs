//! The depth of a lobe in a picture, by which readings behind it are told apart.

use super::vector::Vector;

/// The number of cells along each side.
const SIDE: usize = 160;

/// The picture reaches from minus this distance to this one along both axes.
const REACH: f64 = 1.25;

/// How far a reading may lie behind the lobe without being hidden: that of a reading that agrees with the
/// theory, seen through a coarse grid.
const TOLERANCE: f64 = 0.02;

/// The nearest depth at each place of a picture.
pub(super) struct DepthBuffer {
    nearest: Vec<f32>,
}

impl DepthBuffer {
    /// The depth of faces, whose corners are given along the axes of the picture and towards the camera.
    pub(super) fn new(points: &[Vector], faces: impl Iterator<Item = [usize; 4]>) -> Self {
        let mut buffer = Self {
            nearest: vec![f32::NEG_INFINITY; SIDE * SIDE],
        };
        for [a, b, c, d] in faces {
            let [a, b, c, d] = [a, b, c, d].map(|i| points[i]);
            buffer.draw([a, b, c]);
            buffer.draw([b, d, c]);
        }
        buffer
    }

    /// Whether a point lies behind a face.
    pub(super) fn hides(&self, [x, y, depth]: Vector) -> bool {
        let cell = |coordinate: f64| to_cells(coordinate).floor();
        let (column, row) = (cell(x), cell(y));
        let inside = 0.0..SIDE as f64;
        if !inside.contains(&column) || !inside.contains(&row) {
            return false;
        }
        f64::from(self.nearest[row as usize * SIDE + column as usize]) > depth + TOLERANCE
    }

    fn draw(&mut self, corners: [Vector; 3]) {
        let [a, b, c] = corners.map(|[x, y, depth]| [to_cells(x), to_cells(y), depth]);
        let area = edge(a, b, c);
        if area == 0.0 {
            return;
        }
        let cells = |axis: usize| {
            let ends = [a, b, c].map(|corner| corner[axis]);
            let low = ends.into_iter().fold(f64::INFINITY, f64::min);
            let high = ends.into_iter().fold(f64::NEG_INFINITY, f64::max);
            low.floor().max(0.0) as usize..(high.ceil().max(0.0) as usize).min(SIDE)
        };
        for row in cells(1) {
            for column in cells(0) {
                let at = [column as f64 + 0.5, row as f64 + 0.5, 0.0];
                let weights = [edge(b, c, at), edge(c, a, at), edge(a, b, at)].map(|e| e / area);
                if weights.iter().all(|weight| *weight >= -1e-9) {
                    let depth = weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2];
                    let cell = &mut self.nearest[row * SIDE + column];
                    *cell = cell.max(depth as f32);
                }
            }
        }
    }
}

fn to_cells(coordinate: f64) -> f64 {
    (coordinate + REACH) * SIDE as f64 / (2.0 * REACH)
}

/// Twice the area of a triangle in the picture, positive if its corners run anticlockwise.
fn edge(a: Vector, b: Vector, c: Vector) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_hides_what_is_behind_it() {
        let points = [
            [-0.5, -0.5, 0.2],
            [0.5, -0.5, 0.2],
            [-0.5, 0.5, 0.2],
            [0.5, 0.5, 0.2],
        ];
        let buffer = DepthBuffer::new(&points, std::iter::once([0, 1, 2, 3]));
        assert!(buffer.hides([0.1, 0.2, 0.0]) && buffer.hides([-0.3, -0.4, 0.0]));
        assert!(!buffer.hides([0.1, 0.2, 0.3]) && !buffer.hides([0.1, 0.2, 0.19]));
        assert!(!buffer.hides([0.8, 0.0, 0.0]) && !buffer.hides([9.0, 9.0, 0.0]));
    }
}
