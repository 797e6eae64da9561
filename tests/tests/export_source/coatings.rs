//! Coatings to export, and directions to evaluate them at.

use brdf_core::{AnyBrdf, Family, Geometry, ModelParameters};
use brdf_fit::export::{Coating, ExportOptions, Fitted, Language, Target, export};
use brdf_tests::generator;
use nalgebra::Vector3;
use rand::RngExt;

/// Numbers that the exported sources must get right for each family: usual ones, and those at which
/// a form of the formulas has its limit.
pub(crate) fn brdfs() -> Vec<AnyBrdf> {
    let usual = [(0.3, 0.1, 0.2, 1.5, 1.7), (1.211, 0.521, 0.071, 1.6, 0.4)];
    let limits = [
        (0.01, 0.02, 1.0, 1.0, 1.0),
        (0.5, 0.0, 0.97, 1.006, 1.02),
        (0.2, 0.6, 3.0, 2.5, 3.0),
        (0.0, 0.4, 0.5, 1.4, 0.5),
        (0.1, 0.01, 0.01, 1.3, 1.0),
    ];
    let all = usual.into_iter().chain(limits);
    all.flat_map(|(k2, kd, k1, n, p)| {
        let at = ModelParameters { k2, kd, k1, n, p };
        Family::ALL.map(|family| AnyBrdf::new(family, &at).expect("parameters of the domain"))
    })
    .collect()
}

/// The source code of a BRDF.
pub(crate) fn source(brdf: &AnyBrdf, language: Language, name: &str) -> String {
    let fitted = Fitted {
        file: "data/scan.csv".to_owned(),
        wavelength_um: Some(0.63),
        brdf: *brdf,
        e_percent: 1.25,
        psi_max_deg: 70.0,
    };
    let coating = Coating { fits: vec![fitted] };
    let options = ExportOptions {
        name: name.to_owned(),
        tolerance: 1e-3,
    };
    let mut bytes = Vec::new();
    export(&coating, Target::Source(language), &options, &mut bytes).expect("a source");
    String::from_utf8(bytes).expect("text")
}

/// A source, a view and three numbers of [0, 1), as `f32` has them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    /// psi, theta and phi.
    pub(crate) angles: [f32; 3],
    /// Towards the source.
    pub(crate) source: [f32; 3],
    /// Towards the viewer: anywhere, or next to the mirror direction.
    pub(crate) view: [f32; 3],
    /// For sampling.
    pub(crate) numbers: [f32; 3],
}

/// Points up to 85 deg, half of their views next to the mirror direction, as near as a lobe of the
/// width k1 asks for.
pub(crate) fn points(k1: f64, count: u64) -> Vec<Point> {
    let mut generator = generator(count);
    let largest = 85_f64.to_radians();
    let mut point = |near: bool| {
        let mut uniform = |from: f64, to: f64| generator.random_range(from..to);
        let (psi, phi) = (uniform(0.0, largest), uniform(-6.0, 6.0));
        let (theta, phi) = if near {
            let offset = k1.min(1.0) * uniform(-2.0, 2.0);
            ((-psi + offset).clamp(-largest, largest), 0.1 * offset)
        } else {
            (uniform(-largest, largest), phi)
        };
        let turn = uniform(-3.0, 3.0);
        let numbers = [0, 1, 2].map(|_| uniform(0.0, 1.0));
        Point {
            angles: [psi, theta, phi].map(narrow),
            source: direction(psi, turn),
            view: direction(theta, turn + phi),
            numbers: numbers.map(narrow),
        }
    };
    (0..count).map(|i| point(i % 2 == 0)).collect()
}

fn direction(zenith: f64, azimuth: f64) -> [f32; 3] {
    let (sin, cos) = azimuth.sin_cos();
    [zenith.sin() * cos, zenith.sin() * sin, zenith.cos()].map(narrow)
}

#[expect(clippy::cast_possible_truncation, reason = "the nearest is meant")]
fn narrow(x: f64) -> f32 {
    x as f32
}

/// The vector of numbers of single precision.
pub(crate) fn wide(vector: [f32; 3]) -> Vector3<f64> {
    Vector3::from(vector.map(f64::from))
}

/// The geometry of the directions of a point.
pub(crate) fn geometry(point: &Point) -> Geometry {
    Geometry::from_directions(&wide(point.source), &wide(point.view)).expect("directions")
}

/// The geometry of the angles of a point.
pub(crate) fn geometry_of_angles(point: &Point) -> Geometry {
    let [psi, theta, phi] = point.angles.map(f64::from);
    Geometry::new(psi, theta, phi).expect("angles")
}
