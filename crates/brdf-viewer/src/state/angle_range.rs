//! The range of view angles that a fit uses: its ends are those of the readings that are not left out.

use std::collections::BTreeSet;

use brdf_fit::Measurements;
use brdf_fit::plot::View;

/// Angles that differ by less than this are equal, in degrees: the rounding of a conversion.
const ROUNDING_DEG: f64 = 1e-6;

/// An end of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum End {
    /// The lower end.
    Low,
    /// The upper end.
    High,
}

impl End {
    /// Both ends.
    pub const BOTH: [Self; 2] = [Self::Low, Self::High];

    /// The end of a range.
    pub fn of(self, range: [f64; 2]) -> f64 {
        range[self as usize]
    }

    /// The word for view angles at this end.
    pub fn word(self) -> &'static str {
        match self {
            Self::Low => "lowest",
            Self::High => "highest",
        }
    }

    /// Whether an angle is beyond an end at `end_deg`.
    fn is_beyond(self, angle_deg: f64, end_deg: f64) -> bool {
        match self {
            Self::Low => angle_deg < end_deg - ROUNDING_DEG,
            Self::High => angle_deg > end_deg + ROUNDING_DEG,
        }
    }
}

/// The view angles of the readings in the plane of a view, in degrees and with its sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngleRange {
    /// The ends of all readings.
    pub all: [f64; 2],
    /// The ends of the readings that are used.
    pub used: [f64; 2],
}

impl AngleRange {
    /// The range of readings; `None` where none in the plane is used.
    pub fn new(scan: &Measurements, left_out: &BTreeSet<usize>, view: &View) -> Option<Self> {
        let ends = |angles: &mut dyn Iterator<Item = (usize, f64)>| {
            let none = [f64::INFINITY, f64::NEG_INFINITY];
            let ends = angles.fold(none, |[low, high], (_, angle)| {
                [low.min(angle), high.max(angle)]
            });
            (ends[0] <= ends[1]).then_some(ends)
        };
        let all = ends(&mut angles(scan, view))?;
        let used = if left_out.is_empty() {
            all
        } else {
            ends(&mut angles(scan, view).filter(|(i, _)| !left_out.contains(i)))?
        };
        Some(Self { all, used })
    }

    /// Whether readings beyond an end are left out.
    pub fn is_limited(&self, end: End) -> bool {
        end.is_beyond(end.of(self.all), end.of(self.used))
    }

    /// What is left out once an end is moved: all readings beyond it. Those between its old and its
    /// new place are used again. The end stays within the other one, so that readings remain.
    pub fn moved(
        &self,
        end: End,
        to_deg: f64,
        scan: &Measurements,
        left_out: &BTreeSet<usize>,
        view: &View,
    ) -> BTreeSet<usize> {
        let to = match end {
            End::Low => to_deg.min(self.used[1]),
            End::High => to_deg.max(self.used[0]),
        };
        let before = end.of(self.used);
        let mut moved = left_out.clone();
        for (i, angle) in angles(scan, view) {
            if end.is_beyond(angle, to) {
                moved.insert(i);
            } else if end.is_beyond(angle, before) {
                moved.remove(&i);
            }
        }
        moved
    }
}

/// The readings in the plane of a view: their indices and signed view angles in degrees.
fn angles(scan: &Measurements, view: &View) -> impl Iterator<Item = (usize, f64)> {
    let readings = scan.readings().iter().enumerate();
    readings.filter_map(|(i, reading)| {
        let theta = reading.theta_in_plane(view.azimuth)?;
        Some((i, view.signed_deg(theta)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use brdf_fit::{Measurement, Side};

    fn scan() -> Measurements {
        let reading = |i: i32| Measurement {
            wavelength_um: None,
            psi: 0.5,
            theta: f64::from(10 * i).to_radians(),
            phi: 0.0,
            brdf: 1.0,
            sigma: None,
        };
        Measurements::new("test", (-3..=3).map(reading).collect()).unwrap()
    }

    #[test]
    fn a_moved_end_leaves_out_what_is_beyond_it_and_uses_what_is_within() {
        let (scan, view) = (scan(), View::default());
        let none = BTreeSet::new();
        let whole = AngleRange::new(&scan, &none, &view).unwrap();
        assert!(whole.all.map(f64::round) == [-30.0, 30.0] && whole.all == whole.used);
        assert!(!whole.is_limited(End::Low) && !whole.is_limited(End::High));
        // -30, -20; an angle at the end itself is used.
        let narrow = whole.moved(End::Low, -10.0, &scan, &none, &view);
        assert!(narrow.iter().copied().eq([0, 1]));
        let range = AngleRange::new(&scan, &narrow, &view).unwrap();
        assert!((range.used[0] + 10.0).abs() < 1e-9 && range.is_limited(End::Low));
        // A reading within the range that is left out by itself stays left out.
        let with_one: BTreeSet<usize> = narrow.iter().copied().chain([4]).collect();
        let wider = range.moved(End::Low, -25.0, &scan, &with_one, &view);
        assert!(wider.iter().copied().eq([0, 4]));
    }

    #[test]
    fn readings_remain_between_the_ends() {
        let (scan, none) = (scan(), BTreeSet::new());
        let forward = View {
            theta_positive: Side::Forward,
            ..View::default()
        };
        let whole = AngleRange::new(&scan, &none, &forward).unwrap();
        let one = whole.moved(End::Low, 90.0, &scan, &none, &forward);
        assert!(one.iter().copied().eq(1..7), "{one:?}");
        let all: BTreeSet<usize> = (0..7).collect();
        assert_eq!(AngleRange::new(&scan, &all, &forward), None);
        assert_eq!(
            AngleRange::new(&Measurements::default(), &none, &forward),
            None
        );
    }
}
