//! The command line: writes fitted BRDFs in the forms that other programs take.

use std::path::PathBuf;
use std::process::ExitCode;

use brdf_fit::export::{Coating, ExportOptions, Target, export};
use brdf_fit::output::{self, check_outputs, complain, write_file};
use clap::Parser;

/// Writes a fitted BRDF in the form that another program takes.
///
/// Exit status: 0 when it was written, 2 for bad usage, unreadable input or output that cannot be
/// written.
#[derive(Parser)]
#[command(name = "export", version, max_term_width = 100)]
struct Arguments {
    /// The fits, as `fit --json` or `export --to json` wrote them
    #[arg(value_name = "FILE")]
    fits: PathBuf,

    /// The form: json; source code: c, glsl, wgsl, osl, python
    #[arg(long, value_name = "FORMAT")]
    to: Target,

    /// Write to this file [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// The scan whose fits are written, by its path or its name, where there are fits of several
    #[arg(long, value_name = "NAME")]
    file: Option<String>,

    /// The wavelength of the fit that is written, in um, where there are several
    #[arg(long, value_name = "UM")]
    wavelength: Option<f64>,

    /// First word of the names in source code
    #[arg(long, value_name = "WORD", default_value = "brdf")]
    name: String,

    /// The largest relative error of a table, interpolated between its entries
    #[arg(long, value_name = "ERROR", default_value = "1e-3")]
    tolerance: f64,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            complain(&message);
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let (input, output) = (arguments.fits.as_path(), arguments.output.as_deref());
    check_outputs([input], output).map_err(|error| error.to_string())?;
    let coating = arguments.coating().map_err(|message| {
        let path = input.display();
        if message.starts_with(&path.to_string()) {
            message
        } else {
            format!("{path}: {message}")
        }
    })?;
    let options = ExportOptions {
        name: arguments.name.clone(),
        tolerance: arguments.tolerance,
    };
    let mut bytes = Vec::new();
    export(&coating, arguments.to, &options, &mut bytes).map_err(|error| error.to_string())?;
    match output {
        Some(path) => {
            write_file(path, |writer| writer.write_all(&bytes)).map_err(|error| error.to_string())
        }
        None => output::print(&bytes).map_err(|error| format!("standard output: {error}")),
    }
}

impl Arguments {
    /// What is exported.
    fn coating(&self) -> Result<Coating, String> {
        let all = Coating::read(&self.fits).map_err(|error| error.to_string())?;
        let of_file = all.of_file(self.file.as_deref());
        let chosen = of_file.and_then(|coating| match self.wavelength {
            Some(wavelength) => coating.of_wavelength(wavelength),
            None => Ok(coating),
        });
        chosen.map_err(|error| error.to_string())
    }
}
