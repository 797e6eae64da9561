//! Writes `docs/samples.md`, the table of all models for every measured sample.

use std::process::ExitCode;

use brdf_fit::output::write_file;
use brdf_tests::samples::document;
use brdf_tests::{in_workspace, shared_data};

fn main() -> ExitCode {
    let Some(folder) = shared_data() else {
        return ExitCode::from(2);
    };
    let text = document(&folder);
    let path = in_workspace("docs/samples.md");
    match write_file(&path, |writer| writer.write_all(text.as_bytes())) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
