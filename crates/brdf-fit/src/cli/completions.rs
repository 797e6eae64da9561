//! `brdf completions`: the script by which a shell completes the options of `brdf`.

use clap::{Args, CommandFactory as _};
use clap_complete::Shell;

use super::Brdf;
use super::failure::Failure;
use super::outcome::{Outcome, print_failures};
use crate::output;

/// Prints the script by which a shell completes the options of brdf
///
/// In bash, load it with: source <(brdf completions bash)
#[derive(Args)]
pub(super) struct Arguments {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

pub(super) fn run(arguments: &Arguments) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Brdf::command(), "brdf", &mut script);
    print_failures(output::print(&script).err().map(Failure::Print))
}
