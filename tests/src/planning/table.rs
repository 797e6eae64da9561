//! The table and the curves of the numbers of readings.

use std::fmt::Write as _;

use brdf_fit::planning::{PlanOptions, REVIEW_WITHIN};
use rayon::prelude::*;

use super::{Choices, Sample, Strategy, error_of};

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
                    "\"{}\",{},{count},{error:.4}",
                    needed.name,
                    strategy.name()
                );
            }
        }
    }
    text
}
