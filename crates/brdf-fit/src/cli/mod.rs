//! The command line: the programs `brdf` and `fit`, of which each is one call into this module.
//!
//! This layer alone knows options, exit statuses and the terminal. The library below names neither
//! an option nor a file that it was not given; `explain` adds the options to its messages.

mod completions;
mod energy;
mod explain;
mod export;
mod failure;
mod figures;
mod fit;
mod interrupt;
mod outcome;
mod plan;
mod problems;
mod progress;
mod reading;
mod scene;
mod stream;
mod threads;
mod trade;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Fits the three-parameter BRDF of Li, Yan and Wu (2002) to goniometer scans, and exports,
/// evaluates and draws the result.
///
/// The description of a command, with all its options: brdf COMMAND --help
#[derive(Parser)]
#[command(name = "brdf", version, max_term_width = 100, after_help = EXAMPLES)]
struct Brdf {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Fit(Box<fit::Arguments>),
    Export(export::Arguments),
    Trade(trade::Arguments),
    Plan(plan::Arguments),
    Figures(figures::Arguments),
    Completions(completions::Arguments),
}

const EXAMPLES: &str = "\
Examples:
  Fit the scans of a file, and keep the result for the other commands:
    brdf fit scan.csv --n 1.5 --json fit.json
  Write the BRDF at 0.63 um as a C header:
    brdf export fit.json --to c --wavelength 0.63 -o surface.h
  Measure which evaluator is fastest with a relative error of at most 1e-4:
    brdf trade --model fit.json --tolerance 1e-4
  Compare the ways to fit a scan:
    brdf trade fit scan.csv --n 1.5
  List the readings that a paint needs, for f_r within 5 % up to 70 deg:
    brdf plan --material paint --incidence 0:70 --view 0:80 --tolerance 0.05
  Ask what a scan still lacks, and which of its readings were needed:
    brdf plan scan.csv
    brdf plan --review scan.csv
  Draw the figures of the paper into a folder:
    brdf figures FOLDER
  Complete the options of brdf in bash:
    source <(brdf completions bash)";

/// The program `brdf`: runs the subcommand that the command line names.
pub fn brdf() -> ExitCode {
    let arguments = Brdf::parse_from(energy::command_line());
    interrupt::prepare();
    threads::prepare();
    let outcome = match arguments.command {
        Command::Fit(arguments) => fit::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::Trade(arguments) => trade::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Figures(arguments) => figures::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
    };
    outcome.into()
}

/// The program `fit`: the same as `brdf fit`.
pub fn fit() -> ExitCode {
    let arguments = fit::Arguments::parse_from(energy::command_line());
    interrupt::prepare();
    threads::prepare();
    fit::run(&arguments).into()
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn the_definitions_of_the_options_are_consistent() {
        Brdf::command().debug_assert();
        fit::Arguments::command().debug_assert();
    }
}
