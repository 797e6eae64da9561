//! The table and the curves of the numbers of readings.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use brdf_fit::planning::{PlanOptions, REVIEW_WITHIN, choose_readings};
use rayon::prelude::*;

use super::strategies::{above_zero, quantile};
use super::{Choices, Sample, Strategy, error_of, predicted_error};

/// The multiples of the error of the whole scan that count as reached.
const WITHIN: [f64; 2] = REVIEW_WITHIN;

/// A scan with the errors of all strategies.
pub struct Needed {
    /// The scan.
    pub name: String,
    /// The number of its readings above zero.
    pub readings: usize,
    /// The error of the fit to all of them.
    pub full: f64,
    /// The errors of each of [`Strategy::ALL`].
    pub choices: Vec<Choices>,
}

impl Needed {
    /// The name without the wavelength.
    fn sample(&self) -> &str {
        match self.name.rsplit_once(' ') {
            Some((sample, wavelength)) if wavelength.parse::<f64>().is_ok() => sample,
            _ => &self.name,
        }
    }

    /// The errors of all strategies over each scan.
    pub fn of_all(samples: &[Sample], options: &PlanOptions) -> Vec<Self> {
        let of_sample = |sample: &Sample| {
            let scan = &sample.scan;
            let above = above_zero(scan);
            let full = error_of(scan, &above);
            let each = Strategy::ALL.iter();
            let choices = each.map(|&s| Choices::of(s, scan, full, options));
            Self {
                name: sample.name.clone(),
                readings: above.len(),
                full,
                choices: choices.collect(),
            }
        };
        samples.par_iter().map(of_sample).collect()
    }
}

/// A table in Markdown of the readings that each strategy needs.
pub fn table(all: &[Needed]) -> String {
    let mut text = "| scan | readings | error of all |".to_owned();
    let mut rule = "|---|---|---|".to_owned();
    for strategy in Strategy::ALL {
        let _ = write!(text, " {} |", strategy.name());
        rule.push_str("---|");
    }
    let _ = write!(text, "\n{rule}\n");
    for needed in all {
        let _ = write!(
            text,
            "| {} | {} | {:.3} |",
            needed.name, needed.readings, needed.full
        );
        for choices in &needed.choices {
            let each = WITHIN.map(|within| number(choices.needed(within)));
            let _ = write!(text, " {} |", each.join(" / "));
        }
        text.push('\n');
    }
    text
}

fn number(count: Option<usize>) -> String {
    count.map_or_else(|| "-".to_owned(), |count| count.to_string())
}

/// The readings of one strategy over those of another, where both reach a multiple of the error: the median over the
/// scans and over the samples (each by the median over its wavelengths), the largest, and the numbers of scans in which
/// the first needs more, or either alone does not reach it.
pub fn ratios(all: &[Needed], first: Strategy, second: Strategy, within: f64) -> String {
    let places = [first, second].map(Strategy::index);
    let mut ratios: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    let (mut not_first, mut not_second) = (0, 0);
    for needed in all {
        let [a, b] = places.map(|i| needed.choices[i].needed(within));
        match (a, b) {
            (Some(a), Some(b)) => ratios
                .entry(needed.sample())
                .or_default()
                .push(a as f64 / b as f64),
            (None, Some(_)) => not_first += 1,
            (Some(_), None) => not_second += 1,
            (None, None) => {}
        }
    }
    let every: Vec<f64> = ratios.values().flatten().copied().collect();
    if every.is_empty() {
        return "no scan in which both reach it".to_owned();
    }
    let of_samples = ratios
        .values()
        .map(|own| quantile(own.iter().copied(), 0.5));
    format!(
        "median {:.2}, each sample once {:.2}, largest {:.2}, more in {} of {}; the first alone does not reach it in \
         {not_first}, the second alone in {not_second}",
        quantile(every.iter().copied(), 0.5),
        quantile(of_samples, 0.5),
        quantile(every.iter().copied(), 1.0),
        every.iter().filter(|ratio| **ratio > 1.0).count(),
        every.len()
    )
}

/// From this number of readings on an error should not rise.
const RISES_FROM: usize = 8;

/// By how much the error of a strategy rises above its lowest value before, from eight readings on.
pub fn rises(all: &[Needed], strategy: Strategy) -> String {
    let of_scan = |needed: &Needed| {
        let (mut lowest, mut rise) = (f64::INFINITY, 1.0_f64);
        for (count, error) in &needed.choices[strategy.index()].0 {
            if *count >= RISES_FROM && error.is_finite() {
                rise = rise.max(error / lowest.min(*error));
                lowest = lowest.min(*error);
            }
        }
        rise
    };
    let rises: Vec<f64> = all.iter().map(of_scan).collect();
    let at = |fraction| quantile(rises.iter().copied(), fraction);
    format!("median {:.2}, nine tenths {:.2}", at(0.5), at(0.9))
}

/// The errors of all strategies by the number of readings: scan, strategy, readings, multiple of the error of all.
pub fn curves_csv(all: &[Needed]) -> String {
    let mut text = "scan,strategy,readings,error_over_full\n".to_owned();
    for needed in all {
        for (strategy, choices) in Strategy::ALL.iter().zip(&needed.choices) {
            for (count, error) in &choices.0 {
                let _ = writeln!(
                    text,
                    "\"{}\",\"{}\",{count},{error:.4}",
                    needed.name,
                    strategy.name()
                );
            }
        }
    }
    text
}

/// The numbers of readings at which predictions are compared with what came out.
const PREDICTED_AT: [usize; 6] = [6, 8, 10, 12, 16, 24];

/// A table in Markdown of the errors of planned fits over those that were predicted.
pub fn predictions(samples: &[Sample], options: &PlanOptions) -> String {
    let most = PREDICTED_AT[PREDICTED_AT.len() - 1];
    let of_sample = |sample: &Sample| -> Vec<f64> {
        let scan = &sample.scan;
        let chosen = choose_readings(scan, &[], most, options).expect("one wavelength");
        let ratio = |count: &usize| {
            error_of(scan, &chosen[..*count]) / predicted_error(scan, &chosen[..*count], options)
        };
        PREDICTED_AT.iter().map(ratio).collect()
    };
    let ratios: Vec<Vec<f64>> = samples.par_iter().map(of_sample).collect();
    let mut text = "| readings | median | nine tenths lie within | within a factor of 1.5 |\n|---|---|---|---|\n".to_owned();
    for (i, count) in PREDICTED_AT.iter().enumerate() {
        let mut own: Vec<f64> = ratios.iter().map(|ratios| ratios[i]).collect();
        own.sort_by(f64::total_cmp);
        let at = |part: usize| own[part * (own.len() - 1) / 20];
        let near = own
            .iter()
            .filter(|r| (1.0 / 1.5..=1.5).contains(*r))
            .count();
        let _ = writeln!(
            text,
            "| {count} | {:.2} | {:.2} ... {:.2} | {near} of {} |",
            at(10),
            at(1),
            at(19),
            own.len()
        );
    }
    text
}
