//! The program `fit`: the subcommand `fit` of `brdf` under its own name.

use std::process::ExitCode;

fn main() -> ExitCode {
    brdf_fit::cli::fit()
}
