//! Prints the tables of `docs/planning.md`: how many readings a scan needs.
//!
//! The arguments are a folder with measured samples and their table of optima, or `simulated`; with `curves`
//! behind it, the errors by the number of readings are printed as CSV instead of the table; with `predictions`, the
//! errors of planned fits over those that were predicted.

use std::path::Path;
use std::process::ExitCode;

use brdf_fit::planning::{PlanOptions, REVIEW_WITHIN};
use brdf_tests::planning::{
    Needed, Strategy, curves_csv, measured, predictions, ratios, simulated, table,
};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some(source) = arguments.first() else {
        eprintln!("error: expected a folder with expected_optima.csv, or the word simulated");
        return ExitCode::from(2);
    };
    let samples = if source == "simulated" {
        simulated()
    } else {
        measured(Path::new(source))
    };
    if arguments.get(1).is_some_and(|word| word == "predictions") {
        print!("{}", predictions(&samples, &PlanOptions::default()));
        return ExitCode::SUCCESS;
    }
    let strategies = Strategy::ALL;
    let all = Needed::of_all(&samples, &strategies, &PlanOptions::default());
    if arguments.get(1).is_some_and(|word| word == "curves") {
        print!("{}", curves_csv(&all, &strategies));
        return ExitCode::SUCCESS;
    }
    println!("{}", table(&all, &strategies));
    for within in REVIEW_WITHIN {
        for first in [0, 1] {
            let name = strategies[first].name();
            println!(
                "{name} over uniform grid, within {within}: {}",
                ratios(&all, first, 2, within)
            );
        }
    }
    ExitCode::SUCCESS
}
