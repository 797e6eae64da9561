//! The program `brdf`: fits scans, and exports, evaluates and draws the result.

use std::process::ExitCode;

fn main() -> ExitCode {
    brdf_fit::cli::brdf()
}
