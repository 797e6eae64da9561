//! A lobe as a mesh for other programs.

use std::io::{self, Write};

use super::lobe::Lobe;
use crate::plot::radius::Radius;

/// Writes a lobe as Wavefront OBJ, with z along the normal and x towards the source's side of the plane
/// of incidence. A unit is the outermost circle of the radius. Each vertex has the texture coordinates
/// theta and phi in degrees and, as the third, the value in 1/sr.
///
/// # Errors
///
/// [`io::Error`] from the writer.
pub fn write_obj(
    lobe: &Lobe,
    radius: Radius,
    title: [&str; 2],
    mut writer: impl Write,
) -> io::Result<()> {
    for line in title {
        // A line of a comment ends at the first break.
        let line: String = line.chars().filter(|c| !c.is_control()).collect();
        writeln!(writer, "# {line}")?;
    }
    writeln!(
        writer,
        "# radius 1: {:e} 1/sr; vt: theta and phi in degrees, and the value in 1/sr",
        radius.circles().last().map_or(1.0, |(value, _)| *value)
    )?;
    writeln!(writer, "o lobe")?;
    for [x, y, z] in lobe.points(radius) {
        writeln!(writer, "v {x:.7} {y:.7} {z:.7}")?;
    }
    let angles = lobe.theta.iter();
    let angles = angles.flat_map(|theta| lobe.phi.iter().map(|phi| (*theta, *phi)));
    for ((theta, phi), value) in angles.zip(&lobe.values) {
        let (theta_deg, phi_deg) = (theta.to_degrees(), phi.to_degrees());
        writeln!(writer, "vt {theta_deg:.5} {phi_deg:.5} {value:e}")?;
    }
    for corners in lobe.faces() {
        // Indices count from 1, and corners run anticlockwise as seen from outside.
        let [a, b, c, d] = corners.map(|i| i + 1);
        // The first row is one point.
        if lobe.theta[0] == 0.0 && corners[0] < lobe.phi.len() {
            writeln!(writer, "f {a}/{a} {c}/{c} {d}/{d}")?;
        } else {
            writeln!(writer, "f {a}/{a} {c}/{c} {d}/{d} {b}/{b}")?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use brdf_core::{AnyBrdf, Family, ModelParameters};
    use brdf_fit::plot::{Quantity, Scale};

    use super::super::vector::{cross, difference, dot};
    use super::*;

    fn numbers(text: &str, kind: &str) -> Vec<Vec<f64>> {
        let lines = text.lines().filter_map(|line| line.strip_prefix(kind));
        lines
            .map(|line| {
                let words = line.split_whitespace();
                let words = words.map(|word| word.split('/').next().unwrap_or(word));
                words.map(|word| word.parse().unwrap()).collect()
            })
            .collect()
    }

    #[test]
    fn the_mesh_contains_the_values_and_looks_outwards() {
        let at = ModelParameters {
            k2: 0.3,
            kd: 0.1,
            k1: 0.2,
            n: 1.5,
            p: 1.0,
        };
        let brdf = AnyBrdf::new(Family::Paper, &at).unwrap();
        let lobe = Lobe::new(&brdf, 0.6, Quantity::Brdf);
        let radius = Radius::new((0.01, lobe.largest()), Scale::Linear);
        let mut bytes = Vec::new();
        write_obj(&lobe, radius, ["a\nb", "c"], &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.starts_with("# ab\n# c\n"));
        let (vertices, attributes) = (numbers(&text, "v "), numbers(&text, "vt "));
        assert_eq!(vertices.len(), lobe.values.len());
        for (vertex, attribute) in vertices.iter().zip(&attributes) {
            let radius = dot(point(vertex), point(vertex)).sqrt();
            let expected = attribute[2] / radius_of(&lobe);
            assert!((radius - expected).abs() < 1e-6);
        }
        for face in numbers(&text, "f ") {
            let [a, b, c] = [0, 1, 2].map(|i| point(&vertices[face[i] as usize - 1]));
            let normal = cross(difference(b, a), difference(c, b));
            assert!(dot(normal, b) > 0.0, "{face:?}");
        }
    }

    fn radius_of(lobe: &Lobe) -> f64 {
        Radius::new((0.01, lobe.largest()), Scale::Linear).outermost()
    }

    fn point(numbers: &[f64]) -> [f64; 3] {
        [numbers[0], numbers[1], numbers[2]]
    }
}
