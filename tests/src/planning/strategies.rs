//! The ways to choose readings of a scan.

use brdf_fit::Measurements;
use brdf_fit::planning::{PlanOptions, choose_readings};
use rand::seq::index::sample;

use super::error_of;
use crate::generator;

/// The largest number of readings that a plan chooses.
const MOST_PLANNED: usize = 40;

/// The fewest readings of a fit of four parameters.
const FEWEST: usize = 5;

/// The numbers of readings that are tried at random.
const RANDOM_COUNTS: [usize; 14] = [5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 32, 40, 60, 80];

/// The choices at random of each number.
const RANDOM_CHOICES: u64 = 100;

/// The readings of a pilot that a plan goes on from.
const PILOT: usize = 6;

/// The number of pilots.
const PILOTS: u64 = 20;

/// How readings are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strategy {
    /// By a plan, from nothing.
    Plan,
    /// The same on an instrument whose changes of incidence take no time.
    Untimed,
    /// By a plan, from six readings at random: the median of 20.
    Pilot,
    /// On a grid with one step in all angles.
    Uniform,
    /// Evenly in each incidence.
    Incidences,
    /// At random: the median of 100.
    Random,
    /// At random: exceeded by a tenth of 100.
    RandomWorst,
}

impl Strategy {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Plan,
        Self::Untimed,
        Self::Pilot,
        Self::Uniform,
        Self::Incidences,
        Self::Random,
        Self::RandomWorst,
    ];

    /// The place among all of them.
    pub fn index(self) -> usize {
        let found = Self::ALL.iter().position(|own| *own == self);
        found.expect("a strategy")
    }

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plan => "plan",
            Self::Untimed => "plan without times",
            Self::Pilot => "plan from 6 at random",
            Self::Uniform => "uniform grid",
            Self::Incidences => "grid by incidences",
            Self::Random => "random, median",
            Self::RandomWorst => "random, worst tenth",
        }
    }
}

/// The errors of a strategy, as multiples of that of the whole scan, by the number of readings.
#[derive(Debug, Clone, Default)]
pub struct Choices(pub Vec<(usize, f64)>);

impl Choices {
    /// The errors of a strategy.
    pub fn of(strategy: Strategy, scan: &Measurements, full: f64, options: &PlanOptions) -> Self {
        let error = |chosen: &[usize]| error_of(scan, chosen) / full;
        match strategy {
            Strategy::Plan => planned(scan, &[], options, &error),
            Strategy::Untimed => planned(scan, &[], &untimed(options), &error),
            Strategy::Pilot => piloted(scan, options, &error),
            Strategy::Uniform => grids(uniform(scan), &error),
            Strategy::Incidences => grids(by_incidence(scan), &error),
            Strategy::Random => at_random(scan, 0.5, &error),
            Strategy::RandomWorst => at_random(scan, 0.9, &error),
        }
    }

    /// The smallest number of readings from which on the error is within a multiple of that of the whole scan.
    pub fn needed(&self, within: f64) -> Option<usize> {
        let after = self.0.iter().rposition(|(_, error)| *error > within);
        let first = after.map_or(0, |last| last + 1);
        self.0.get(first).map(|(count, _)| *count)
    }
}

fn planned(
    scan: &Measurements,
    pilot: &[usize],
    options: &PlanOptions,
    error: &dyn Fn(&[usize]) -> f64,
) -> Choices {
    let chosen = choose_readings(scan, pilot, MOST_PLANNED, options).expect("one wavelength");
    let first = FEWEST.max(pilot.len());
    let counts = first..=chosen.len();
    Choices(
        counts
            .map(|count| (count, error(&chosen[..count])))
            .collect(),
    )
}

/// The same options without the time of a change of incidence.
fn untimed(options: &PlanOptions) -> PlanOptions {
    let mut options = options.clone();
    options.instrument.change_seconds = 0.0;
    options
}

/// The median over the pilots at each number of readings.
fn piloted(scan: &Measurements, options: &PlanOptions, error: &dyn Fn(&[usize]) -> f64) -> Choices {
    let above: Vec<usize> = above_zero(scan);
    let of_pilots: Vec<Choices> = (0..PILOTS)
        .map(|seed| {
            let pilot = sample(&mut generator(seed), above.len(), PILOT);
            let pilot: Vec<usize> = pilot.into_iter().map(|i| above[i]).collect();
            planned(scan, &pilot, options, error)
        })
        .collect();
    let counts = of_pilots[0].0.iter().map(|(count, _)| *count).enumerate();
    let median = |i: usize| quantile(of_pilots.iter().map(|choices| choices.0[i].1), 0.5);
    Choices(counts.map(|(i, count)| (count, median(i))).collect())
}

/// The indices of the readings above zero.
pub(super) fn above_zero(scan: &Measurements) -> Vec<usize> {
    let readings = scan.readings();
    (0..readings.len())
        .filter(|&i| readings[i].brdf > 0.0)
        .collect()
}

/// The value that a fraction of all are below.
pub(super) fn quantile(values: impl Iterator<Item = f64>, fraction: f64) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let index = (fraction * (values.len() - 1) as f64).round();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "an index"
    )]
    let index = index as usize;
    values[index]
}

fn at_random(scan: &Measurements, fraction: f64, error: &dyn Fn(&[usize]) -> f64) -> Choices {
    let above = above_zero(scan);
    let counts = RANDOM_COUNTS
        .into_iter()
        .filter(|count| *count < above.len());
    let of_count = |count: usize| {
        let errors = (0..RANDOM_CHOICES).map(|seed| {
            let mut random = generator(1000 * count as u64 + seed);
            let chosen = sample(&mut random, above.len(), count);
            let chosen: Vec<usize> = chosen.into_iter().map(|i| above[i]).collect();
            error(&chosen)
        });
        (count, quantile(errors, fraction))
    };
    Choices(counts.map(of_count).collect())
}

fn grids(mut grids: Vec<Vec<usize>>, error: &dyn Fn(&[usize]) -> f64) -> Choices {
    grids.sort_by_key(Vec::len);
    grids.dedup_by_key(|grid| grid.len());
    grids.retain(|grid| grid.len() >= FEWEST);
    let errors = grids.iter().map(|grid| (grid.len(), error(grid)));
    Choices(errors.collect())
}

/// Grids with one step in psi, theta and phi, from 60 to 4 deg: the readings nearest to their points.
fn uniform(scan: &Measurements) -> Vec<Vec<usize>> {
    let steps = (4..=60).rev().map(f64::from);
    steps.map(|step_deg| uniform_grid(scan, step_deg)).collect()
}

fn uniform_grid(scan: &Measurements, step_deg: f64) -> Vec<usize> {
    let above = above_zero(scan);
    let readings = scan.readings();
    let angles: Vec<[f64; 3]> = above
        .iter()
        .map(|&i| [readings[i].psi, readings[i].theta, readings[i].phi].map(f64::to_degrees))
        .collect();
    let mut chosen = Vec::new();
    for psi in points(angles.iter().map(|a| a[0]), step_deg) {
        let nearest = nearest(angles.iter().map(|a| (a[0] - psi).abs()));
        let incidence = angles[nearest][0];
        let own: Vec<usize> = (0..angles.len())
            .filter(|&i| (angles[i][0] - incidence).abs() < 0.05)
            .collect();
        for theta in points(own.iter().map(|&i| angles[i][1]), step_deg) {
            for phi in points(own.iter().map(|&i| angles[i][2]), step_deg) {
                let apart = |a: &[f64; 3]| {
                    let across = (a[2] - phi) * theta.abs().max(10.0).to_radians().sin();
                    (a[1] - theta).hypot(across)
                };
                let place = self::nearest(own.iter().map(|&i| apart(&angles[i])));
                chosen.push(above[own[place]]);
            }
        }
    }
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// Evenly spaced points over a range, at about a step.
fn points(values: impl Iterator<Item = f64> + Clone, step: f64) -> Vec<f64> {
    let from = values.clone().fold(f64::INFINITY, f64::min);
    let to = values.fold(f64::NEG_INFINITY, f64::max);
    #[expect(clippy::cast_possible_truncation, reason = "some tens of points")]
    let intervals = ((to - from) / step).round() as i32;
    if intervals == 0 {
        return vec![0.5 * (from + to)];
    }
    let of = |i: i32| from + (to - from) * f64::from(i) / f64::from(intervals);
    (0..=intervals).map(of).collect()
}

fn nearest(distances: impl Iterator<Item = f64>) -> usize {
    let found = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
    found.map_or(0, |(i, _)| i)
}

/// From 1 to 40 readings evenly over each incidence.
fn by_incidence(scan: &Measurements) -> Vec<Vec<usize>> {
    let grid = |each: usize| {
        let mut chosen = Vec::new();
        for incidence in scan.incidences() {
            let mut own: Vec<usize> = incidence.readings;
            own.retain(|&i| scan.readings()[i].brdf > 0.0);
            let place = |&i: &usize| (scan.readings()[i].phi, scan.readings()[i].theta);
            own.sort_by(|a, b| place(a).partial_cmp(&place(b)).expect("finite angles"));
            let last = own.len().saturating_sub(1);
            let kept = each.min(own.len());
            chosen.extend(
                (0..kept).map(|k| own[(k * last).checked_div(kept - 1).unwrap_or(last / 2)]),
            );
        }
        chosen
    };
    (1..=40).map(grid).collect()
}
