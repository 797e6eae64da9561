//! What a goniometer can be set to, and how long it takes.

use std::f64::consts::PI;

use brdf_core::scene::{Azimuth, Domain};
use serde::{Deserialize, Serialize};

use super::setting::Setting;

/// The axis whose change takes long.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SlowAxis {
    /// The incidence angle.
    #[default]
    Incidence,
    /// The view azimuth.
    Azimuth,
}

/// The settings that a goniometer has, in radians, and its times in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instrument {
    /// The smallest angle between the source and the detector: below it, one shades the other.
    pub from_source: f64,
    /// The largest incidence angle.
    pub largest_incidence: f64,
    /// The largest view angle.
    pub largest_view: f64,
    /// The step of the incidence angle.
    pub incidence_step: f64,
    /// The step of the view angle.
    pub view_step: f64,
    /// The step of the view azimuth.
    pub azimuth_step: f64,
    /// The axis whose change takes `change_seconds`.
    pub slow: SlowAxis,
    /// The time of a reading with the change of the other axes.
    pub reading_seconds: f64,
    /// The time of a change of the slow axis.
    pub change_seconds: f64,
}

/// Up to 80 deg in steps of 5 deg (azimuth 15 deg), 5 deg from the source; half a minute a reading and two
/// minutes a change of incidence.
impl Default for Instrument {
    fn default() -> Self {
        let [five, largest, azimuth] = [5.0_f64, 80.0, 15.0].map(f64::to_radians);
        Self {
            from_source: five,
            largest_incidence: largest,
            largest_view: largest,
            incidence_step: five,
            view_step: five,
            azimuth_step: azimuth,
            slow: SlowAxis::Incidence,
            reading_seconds: 30.0,
            change_seconds: 120.0,
        }
    }
}

impl Instrument {
    /// All settings of the instrument within a scene, each of which is measured once: a view at the normal has no
    /// azimuth, and the surface is isotropic, so that azimuths are within half a turn.
    pub fn settings(&self, scene: &Domain) -> Vec<Setting> {
        let incidences = steps(
            scene.incidence(),
            self.largest_incidence,
            self.incidence_step,
        );
        let views = steps(scene.view(), self.largest_view, self.view_step);
        let azimuths = match scene.azimuth() {
            Azimuth::InPlane => vec![0.0],
            Azimuth::Full => steps((0.0, PI - self.azimuth_step), PI, self.azimuth_step),
        };
        let mut settings = Vec::new();
        for &psi in &incidences {
            for &view in &views {
                for &phi in &azimuths {
                    // At theta = 0 there is no azimuth; at psi = 0 all azimuths are one.
                    if phi > 0.0 && (view == 0.0 || psi == 0.0) {
                        continue;
                    }
                    settings.push(Setting {
                        psi,
                        theta: -view,
                        phi,
                    });
                    if view > 0.0 && psi > 0.0 {
                        settings.push(Setting {
                            psi,
                            theta: view,
                            phi,
                        });
                    }
                }
            }
        }
        settings.retain(|setting| setting.from_source() >= self.from_source - 1e-9);
        settings
    }

    /// The order in which settings are quick to drive: by the slow axis, and back and forth over the views of each
    /// of its values.
    pub fn order(&self, settings: &[Setting]) -> Vec<usize> {
        let mut order: Vec<usize> = (0..settings.len()).collect();
        let key = |i: usize| {
            let Setting { psi, theta, phi } = settings[i];
            match self.slow {
                SlowAxis::Incidence => [psi, phi, theta],
                SlowAxis::Azimuth => [phi, psi, theta],
            }
        };
        order.sort_by(|&a, &b| {
            let (a, b) = (key(a), key(b));
            a.iter()
                .zip(&b)
                .fold(std::cmp::Ordering::Equal, |found, (a, b)| {
                    found.then(a.total_cmp(b))
                })
        });
        let mut forward = true;
        for group in order.chunk_by_mut(|&a, &b| self.is_unchanged(&settings[a], &settings[b])) {
            if !forward {
                group.reverse();
            }
            forward = !forward;
        }
        order
    }

    /// The time from the start until each of the settings has been measured, in this order, in seconds.
    pub fn elapsed(&self, settings: &[Setting]) -> Vec<f64> {
        let mut seconds = 0.0;
        let mut before: Option<&Setting> = None;
        let mut elapsed = Vec::with_capacity(settings.len());
        for setting in settings {
            if !before.is_some_and(|before| self.is_unchanged(before, setting)) {
                seconds += self.change_seconds;
            }
            seconds += self.reading_seconds;
            elapsed.push(seconds);
            before = Some(setting);
        }
        elapsed
    }

    /// The time that one more setting takes among others: a change of the slow axis only for a value of its own.
    pub(super) fn further_seconds(&self, others: &[Setting], setting: &Setting) -> f64 {
        if others.iter().any(|other| self.is_unchanged(other, setting)) {
            self.reading_seconds
        } else {
            self.reading_seconds + self.change_seconds
        }
    }

    fn is_unchanged(&self, a: &Setting, b: &Setting) -> bool {
        let apart = match self.slow {
            SlowAxis::Incidence => a.psi - b.psi,
            SlowAxis::Azimuth => a.phi - b.phi,
        };
        apart.abs() < 1e-9
    }
}

/// The multiples of a step within a range and up to a limit; its end where there is none.
fn steps((from, to): (f64, f64), limit: f64, step: f64) -> Vec<f64> {
    let to = to.min(limit);
    // An angle that differs from a multiple by rounding is one.
    let (first, last) = ((from / step - 1e-9).ceil(), (to / step + 1e-9).floor());
    let mut angles = Vec::new();
    let mut multiple = first;
    while multiple <= last {
        angles.push(multiple * step);
        multiple += 1.0;
    }
    if angles.is_empty() {
        angles.push(from.min(to));
    }
    angles
}

#[cfg(test)]
mod tests {
    use super::*;

    fn domain(incidence: f64, view: f64, azimuth: Azimuth) -> Domain {
        let [incidence, view] = [incidence, view].map(f64::to_radians);
        Domain::new((0.0, incidence), (0.0, view), azimuth).unwrap()
    }

    #[test]
    fn the_settings_are_within_the_scene_and_away_from_the_source() {
        let instrument = Instrument {
            from_source: 10_f64.to_radians(),
            largest_view: 70_f64.to_radians(),
            ..Instrument::default()
        };
        let settings = instrument.settings(&domain(60.0, 80.0, Azimuth::Full));
        assert!(settings.len() > 1000);
        for setting in &settings {
            assert!(setting.psi <= 60_f64.to_radians() + 1e-9);
            assert!(setting.theta.abs() <= 70_f64.to_radians() + 1e-9);
            assert!(setting.from_source() >= 10_f64.to_radians() - 1e-8);
        }
        let in_plane = instrument.settings(&domain(60.0, 80.0, Azimuth::InPlane));
        assert!(in_plane.iter().all(|setting| setting.phi == 0.0));
        // No direction pair of an isotropic surface is there twice.
        let at_normal = settings.iter().filter(|setting| setting.psi == 0.0);
        assert!(at_normal.clone().all(|s| s.phi == 0.0 && s.theta < 0.0));
        assert_eq!(at_normal.count(), 13);
    }

    #[test]
    fn a_single_angle_of_a_scene_is_a_setting_though_it_is_no_step() {
        let scene = Domain::new((0.7, 0.7), (0.2, 0.3), Azimuth::InPlane).unwrap();
        let settings = Instrument::default().settings(&scene);
        assert!(!settings.is_empty());
        assert!(settings.iter().all(|setting| setting.psi == 0.7));
    }

    #[test]
    fn the_order_changes_the_slow_axis_once_a_value_and_its_time_is_counted() {
        let instrument = Instrument::default();
        let setting = |psi: f64, theta: f64| Setting {
            psi,
            theta,
            phi: 0.0,
        };
        let settings = [
            setting(0.5, 0.1),
            setting(0.1, 0.3),
            setting(0.5, -0.2),
            setting(0.1, -0.4),
        ];
        let order = instrument.order(&settings);
        assert_eq!(order, [3, 1, 0, 2]);
        let driven: Vec<Setting> = order.iter().map(|&i| settings[i]).collect();
        assert_eq!(instrument.elapsed(&driven), [150.0, 180.0, 330.0, 360.0]);
    }
}
