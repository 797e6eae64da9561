//! `brdf figures`: Figs. 3 to 10 of the paper from its Table 1, as SVG and PNG.

use std::path::PathBuf;

use clap::Args;

use super::failure::Failure;
use super::outcome::{Outcome, print_failures};
use super::stream;
use crate::output;
use crate::plot::{paper_figures, write_figures};

/// Draws Figs. 3 to 10 of Li, Yan and Wu (2002) from the parameters of its Table 1
///
/// Each figure shows f_r as a function of the view angle, in polar form for one incidence angle and
/// on a logarithmic axis for several. The figures contain theory only: the measured points of the
/// paper were never published. The names of the files, SVG and PNG, are printed.
///
/// Exit status: 0 if all files were written, 2 otherwise.
#[derive(Args)]
pub(super) struct Arguments {
    /// Folder for the files; it is created if it does not exist
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

pub(super) fn run(arguments: &Arguments) -> Outcome {
    print_failures(draw(arguments).err())
}

fn draw(arguments: &Arguments) -> Result<(), Failure> {
    stream::check_folder(("FOLDER", &arguments.folder))?;
    let files = write_figures(&paper_figures()?, &arguments.folder, "")?;
    let lines = files.iter().map(|file| format!("{}\n", file.display()));
    output::print_text(&lines.collect::<String>()).map_err(Failure::Print)
}
