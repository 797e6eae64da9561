//! Prints the tables of `docs/planning.md`: how many readings a scan needs.
//!
//! The arguments are a folder with measured samples and their table of optima, or `simulated`; with `curves`
//! behind it, the errors by the number of readings are printed as CSV instead of the table; with `predictions`, the
//! errors of planned fits over those that were predicted.

use std::path::Path;
use std::process::ExitCode;

use brdf_fit::planning::{PlanOptions, REVIEW_WITHIN};
use brdf_tests::planning::{
    Needed, Strategy, curves_csv, measured, predictions, ratios, rises, simulated, table,
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
    let all = Needed::of_all(&samples, &PlanOptions::default());
    if arguments.get(1).is_some_and(|word| word == "curves") {
        print!("{}", curves_csv(&all));
        return ExitCode::SUCCESS;
    }
    println!("{}", table(&all));
    for first in [Strategy::Plan, Strategy::Untimed, Strategy::Pilot] {
        for second in [Strategy::Uniform, Strategy::Incidences, Strategy::Random] {
            for within in REVIEW_WITHIN {
                let names = format!("{} over {}", first.name(), second.name());
                println!("{names}, {within}: {}", ratios(&all, first, second, within));
            }
        }
    }
    for strategy in Strategy::ALL {
        println!("rise of {}: {}", strategy.name(), rises(&all, strategy));
    }
    ExitCode::SUCCESS
}
