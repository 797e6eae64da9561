//! Directions of a scene over which errors are averaged.

use std::f64::consts::PI;

use brdf_core::scene::{Azimuth, Domain};

use super::setting::{Setting, Site};

/// The number of directions: the mean over them is that over the scene within a few percent.
pub(super) const DIRECTIONS: usize = 400;

/// Fractions of the root of x^4 = x + 1, whose multiples are spread evenly over the unit cube.
const STEPS: [f64; 3] = [
    0.819_172_513_396_164_4,
    0.671_043_606_703_789_2,
    0.549_700_477_901_971_4,
];

/// Directions spread evenly over the angles of a scene.
pub(super) fn directions(scene: &Domain) -> Vec<Site> {
    let within = |(from, to): (f64, f64), fraction: f64| from + (to - from) * fraction;
    let direction = |i: usize| {
        let [a, b, c] = STEPS.map(|step| (0.5 + step * (i + 1) as f64).fract());
        let view = within(scene.view(), b);
        let (theta, phi) = match scene.azimuth() {
            Azimuth::InPlane if c < 0.5 => (-view, 0.0),
            Azimuth::InPlane => (view, 0.0),
            Azimuth::Full => (view, c * PI),
        };
        let psi = within(scene.incidence(), a);
        Site::new(Setting { psi, theta, phi })
    };
    (0..DIRECTIONS).filter_map(direction).collect()
}

/// At most so many of the items, evenly.
pub(super) fn thinned<T: Copy>(items: &[T], most: usize) -> Vec<T> {
    let count = items.len();
    let kept = count.min(most);
    (0..kept).map(|i| items[i * count / kept]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_directions_are_spread_evenly_over_the_scene() {
        let scene = Domain::new((0.2, 1.2), (0.0, 1.4), Azimuth::Full).unwrap();
        let sites = directions(&scene);
        assert_eq!(sites.len(), DIRECTIONS);
        let mean = |of: fn(&Site) -> f64| sites.iter().map(of).sum::<f64>() / sites.len() as f64;
        assert!((mean(|s| s.setting.psi) - 0.7).abs() < 0.01);
        assert!((mean(|s| s.setting.theta) - 0.7).abs() < 0.01);
        assert!((mean(|s| s.setting.phi) - 0.5 * PI).abs() < 0.02);
        let in_plane = Domain::new((0.2, 1.2), (0.0, 1.4), Azimuth::InPlane).unwrap();
        let forward = directions(&in_plane)
            .iter()
            .filter(|s| s.setting.theta < 0.0)
            .count();
        assert!((forward as f64 / DIRECTIONS as f64 - 0.5).abs() < 0.02);
    }
}
