//! The readings that a plot shows: those of some incidences, in one plane, and no more of them than
//! the eye can distinguish. The selection depends on the data and the view but not on the theory, so
//! that it stays valid while parameters change.

use super::view::View;
use crate::scan::{Incidence, Measurements};

/// A column with more readings than this is thinned.
const READINGS_OF_COLUMN: usize = 3;

/// The readings that a plot shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// One trace for each incidence, in ascending order.
    pub traces: Vec<Trace>,
}

/// The readings of one incidence.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Incidence angle psi in radians.
    pub psi: f64,
    /// The indices of the readings that are shown, in ascending order of the view angle as shown.
    pub readings: Vec<usize>,
    /// How many readings of the incidence are in the plane.
    pub all: usize,
    /// How many of those are zero: a logarithmic axis cannot show them.
    pub zero: usize,
    /// How many of those are negative: neither a logarithmic axis nor the polar form can show them.
    pub negative: usize,
}

impl Selection {
    /// The readings of a view at the incidence angles `incidences`, psi in radians; `None` selects
    /// all incidences. An incidence without readings in the plane has a trace without readings.
    ///
    /// Where one of `columns` equal intervals of the view angle from -90 to 90 deg contains more than
    /// 3 readings of an incidence, only its first, lowest and highest readings are shown, so that
    /// outliers and the width of the noise remain visible.
    pub fn of(
        measurements: &Measurements,
        view: &View,
        incidences: Option<&[f64]>,
        columns: usize,
    ) -> Self {
        let known = measurements.incidences();
        let trace = |psi: f64, incidence: Option<&Incidence>| {
            let none = Incidence {
                psi,
                readings: Vec::new(),
            };
            Trace::of(measurements, view, incidence.unwrap_or(&none), columns)
        };
        let traces = match incidences {
            None => known.iter().map(|i| trace(i.psi, Some(i))).collect(),
            Some(wanted) => wanted
                .iter()
                .map(|&psi| trace(psi, known.iter().find(|i| i.psi == psi)))
                .collect(),
        };
        Self { traces }
    }

    /// How many readings are shown.
    pub fn shown(&self) -> usize {
        self.traces.iter().map(|trace| trace.readings.len()).sum()
    }

    /// How many readings of the incidences are in the plane.
    pub fn all(&self) -> usize {
        self.traces.iter().map(|trace| trace.all).sum()
    }

    /// How many of those are zero or negative.
    pub fn not_positive(&self) -> usize {
        let traces = self.traces.iter();
        traces.map(|trace| trace.zero + trace.negative).sum()
    }

    /// How many of those are negative.
    pub fn negative(&self) -> usize {
        self.traces.iter().map(|trace| trace.negative).sum()
    }
}

impl Trace {
    fn of(measurements: &Measurements, view: &View, of: &Incidence, columns: usize) -> Self {
        let all = measurements.readings();
        let mut readings: Vec<(f64, usize)> = of
            .readings
            .iter()
            .filter_map(|&i| Some((view.signed_deg(all[i].theta_in_plane(view.azimuth)?), i)))
            .collect();
        readings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let column = |theta_deg: f64| ((theta_deg + 90.0) / 180.0 * columns as f64).floor();
        let same = |a: &(f64, usize), b: &(f64, usize)| column(a.0) == column(b.0);
        let shown = readings
            .chunk_by(same)
            .flat_map(|chunk| thinned(chunk, |i| all[i].brdf));
        let count = |is: &dyn Fn(f64) -> bool| {
            let brdf = readings.iter().map(|(_, i)| all[*i].brdf);
            brdf.filter(|brdf| is(*brdf)).count()
        };
        Self {
            psi: of.psi,
            readings: shown.collect(),
            all: readings.len(),
            zero: count(&|brdf| brdf == 0.0),
            negative: count(&|brdf| brdf < 0.0),
        }
    }
}

/// The first, the lowest and the highest of the readings of a column, in their order; all of them
/// where they are few.
fn thinned(column: &[(f64, usize)], brdf: impl Fn(usize) -> f64) -> Vec<usize> {
    let value = |position: usize| brdf(column[position].1);
    let positions: Vec<usize> = if column.len() > READINGS_OF_COLUMN {
        let by_value = |a: &usize, b: &usize| value(*a).total_cmp(&value(*b));
        let lowest = (0..column.len()).min_by(by_value).unwrap_or(0);
        let highest = (0..column.len()).max_by(by_value).unwrap_or(0);
        let mut positions = vec![0, lowest, highest];
        positions.sort_unstable();
        positions.dedup();
        positions
    } else {
        (0..column.len()).collect()
    };
    let indices = positions.into_iter().map(|position| column[position].1);
    indices.collect()
}

/// At most `most` of the items, evenly spaced from the first to the last.
pub(super) fn evenly<T: Clone>(items: &[T], most: usize) -> Vec<T> {
    if items.len() <= most {
        return items.to_vec();
    }
    let last = items.len() - 1;
    (0..most)
        .map(|i| items[i * last / (most - 1)].clone())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::Measurement;
    use crate::scan::Side;

    fn scan(readings: impl IntoIterator<Item = (f64, f64, f64, f64)>) -> Measurements {
        let reading = |(psi_deg, theta_deg, phi_deg, brdf): (f64, f64, f64, f64)| Measurement {
            wavelength_um: None,
            psi: psi_deg.to_radians(),
            theta: theta_deg.to_radians(),
            phi: phi_deg.to_radians(),
            brdf,
            sigma: None,
        };
        Measurements::new("test", readings.into_iter().map(reading).collect()).unwrap()
    }

    #[test]
    fn evenly_spaced_items_include_both_ends() {
        let all: Vec<usize> = (0..90).collect();
        let chosen = evenly(&all, 8);
        assert_eq!(chosen, [0, 12, 25, 38, 50, 63, 76, 89]);
        assert_eq!(evenly(&all[..3], 8), [0, 1, 2]);
    }

    #[test]
    fn the_side_of_the_plane_gives_the_view_angle_its_sign() {
        let scan = scan([
            (30.0, 20.0, 0.0, 0.1),
            (30.0, -20.0, 0.0, 0.2),
            (30.0, 40.0, 90.0, 0.3),
            (30.0, 50.0, 270.0, 0.4),
            (30.0, 0.0, 0.0, 0.5),
        ]);
        let mut view = View::default();
        let of = |view: &View| {
            Selection::of(&scan, view, None, 400).traces[0]
                .readings
                .clone()
        };
        assert_eq!(of(&view), [1, 4, 0]);
        view.theta_positive = Side::Forward;
        assert_eq!(of(&view), [0, 4, 1]);
        view.azimuth = 90_f64.to_radians();
        assert_eq!(of(&view), [2, 4, 3]);
    }

    #[test]
    fn thinning_keeps_outliers_and_counts_all_readings() {
        let many = (0..9000).map(|i| {
            let brdf = if i == 4321 {
                7.0
            } else {
                0.1 + 0.01 * f64::from(i % 13)
            };
            (10.0, -85.0 + 0.018 * f64::from(i), 0.0, brdf)
        });
        let scan = scan(many);
        let selection = Selection::of(&scan, &View::default(), None, 100);
        assert_eq!(selection.all(), 9000);
        assert!(selection.shown() <= 300 && selection.shown() > 200);
        assert!(selection.traces[0].readings.contains(&4321));
        let all = Selection::of(&scan, &View::default(), None, 1_000_000);
        assert_eq!(all.shown(), 9000);
    }

    #[test]
    fn readings_that_an_axis_cannot_show_are_counted_before_thinning() {
        let many = (0..9000).map(|i| {
            let brdf = 0.1 * f64::from(i % 3 - 1);
            (10.0, -85.0 + 0.018 * f64::from(i), 0.0, brdf)
        });
        let selection = Selection::of(&scan(many), &View::default(), None, 100);
        assert!(selection.shown() < 400);
        assert_eq!(
            (selection.not_positive(), selection.negative()),
            (6000, 3000)
        );
    }

    #[test]
    fn an_incidence_without_readings_has_an_empty_trace() {
        let scan = scan([(10.0, 5.0, 0.0, 0.1), (20.0, 5.0, 45.0, 0.1)]);
        let psi: Vec<f64> = scan.incidences().iter().map(|i| i.psi).collect();
        let selection = Selection::of(&scan, &View::default(), Some(&psi[1..]), 100);
        assert_eq!((selection.traces.len(), selection.shown()), (1, 0));
        let theory = Selection::of(&Measurements::default(), &View::default(), Some(&[0.5]), 9);
        assert_eq!(theory.traces[0].psi, 0.5);
    }
}
