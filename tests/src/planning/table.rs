//! The table and the curves of the numbers of readings.

use std::fmt::Write as _;

use brdf_fit::planning::{PlanOptions, REVIEW_WITHIN, choose_readings};
use rayon::prelude::*;

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
    /// The errors of all strategies over each scan.
    pub fn of_all(samples: &[Sample], strategies: &[Strategy], options: &PlanOptions) -> Vec<Self> {
        let of_sample = |sample: &Sample| {
            let scan = &sample.scan;
            let readings = scan.readings();
            let above: Vec<usize> = (0..readings.len())
                .filter(|&i| readings[i].brdf > 0.0)
                .collect();
            let full = error_of(scan, &above);
            let choices = strategies
                .iter()
                .map(|&s| Choices::of(s, scan, full, options));
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
pub fn table(all: &[Needed], strategies: &[Strategy]) -> String {
    let mut text = "| scan | readings | error of all |".to_owned();
    let mut rule = "|---|---|---|".to_owned();
    for strategy in strategies {
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

/// The readings of one strategy over those of another, for the scans where both reach the error: the median, the
/// largest, and the number of scans in which the first alone does not reach it.
pub fn ratios(all: &[Needed], first: usize, second: usize, within: f64) -> String {
    let mut ratios = Vec::new();
    let (mut not_first, mut not_second) = (0, 0);
    for needed in all {
        let [a, b] = [first, second].map(|i| needed.choices[i].needed(within));
        match (a, b) {
            (Some(a), Some(b)) => ratios.push(a as f64 / b as f64),
            (None, Some(_)) => not_first += 1,
            (Some(_), None) => not_second += 1,
            (None, None) => {}
        }
    }
    ratios.sort_by(f64::total_cmp);
    let Some(largest) = ratios.last() else {
        return "no scan in which both reach it".to_owned();
    };
    let more = ratios.iter().filter(|ratio| **ratio > 1.0).count();
    format!(
        "median {:.2}, largest {largest:.2}, more in {more} of {}; the first alone does not reach it in \
         {not_first}, the second alone in {not_second}",
        ratios[ratios.len() / 2],
        ratios.len()
    )
}

/// The errors of all strategies by the number of readings: scan, strategy, readings, multiple of the error of all.
pub fn curves_csv(all: &[Needed], strategies: &[Strategy]) -> String {
    let mut text = "scan,strategy,readings,error_over_full\n".to_owned();
    for needed in all {
        for (strategy, choices) in strategies.iter().zip(&needed.choices) {
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
