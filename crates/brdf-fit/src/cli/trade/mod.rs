//! `brdf trade`: measures the trade-off of speed and accuracy on this machine.

mod arguments;
mod evaluators;
mod fits;
mod output;
mod values;

pub(super) use arguments::Arguments;

use super::failure::Failure;
use super::outcome::{Outcome, print_failures};
use arguments::Command;

pub(super) fn run(arguments: &Arguments) -> Outcome {
    let outcome = match &arguments.command {
        Some(Command::Fit(fitting)) => fits::compare(fitting),
        None => evaluators::compare(&arguments.evaluation, &arguments.outputs),
    };
    outcome.unwrap_or_else(print_failures)
}

/// How a comparison ended, or why it could not be made or delivered.
type Compared = Result<Outcome, Vec<Failure>>;
