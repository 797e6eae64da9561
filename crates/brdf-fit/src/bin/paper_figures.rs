//! `paper-figures DIR`: Figs. 3 to 10 of the paper from its Table 1, as SVG and PNG.

use std::io::{self, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

use brdf_fit::plot::{PlotError, paper_figures, write_figures};
use clap::Parser;

/// Draws Figs. 3 to 10 of Li, Yan and Wu (2002) from the parameters of its Table 1
///
/// Each figure is f_r over the view angle, in polar form for one incidence and on a logarithmic
/// axis for several. Theory only: the measured points of the paper were never published.
///
/// Exit status: 0 when all files are written, 2 otherwise.
#[derive(Parser)]
#[command(name = "paper-figures", version)]
struct Arguments {
    /// Folder for the files, made where it does not exist
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match written(&arguments) {
        Ok(files) => {
            // A reader that has seen enough (`| head`) is no error.
            let mut output = io::stdout().lock();
            for file in files {
                let _ = writeln!(output, "{}", file.display());
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            let _ = writeln!(io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}

fn written(arguments: &Arguments) -> Result<Vec<PathBuf>, PlotError> {
    write_figures(&paper_figures()?, &arguments.folder, "")
}
