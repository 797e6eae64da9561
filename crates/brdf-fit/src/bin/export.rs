//! The command line: writes fitted BRDFs in the forms that other programs take.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use brdf_fit::export::{AngleGrid, ExportOptions, Material, Target, export, export_companion};
use brdf_fit::output::{self, check_outputs, print_error, write_file};
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

    /// The form: json (the model); source code: c, glsl, wgsl, osl, python; mitsuba (a plugin, and a
    /// scene beside it: with -o x.py, x.xml); tables: merl, astm and zemax (within --tolerance), csv
    /// (on --grid)
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

    /// The wavelengths in um of the fits that are red, green and blue, for forms with colours
    /// [default: the only fit, for grey, or those nearest to 0.611,0.549,0.464]
    #[arg(long, value_name = "RED,GREEN,BLUE", value_parser = three, conflicts_with = "wavelength")]
    rgb: Option<[f64; 3]>,

    /// First word of the names in source code, and the type of the material in Mitsuba
    #[arg(long, value_name = "WORD", default_value = "brdf")]
    name: String,

    /// The largest relative error of a table, interpolated between its entries, of merl in the
    /// nearest bin [default: 5e-2; merl: any]
    #[arg(long, value_name = "ERROR", value_parser = tolerance)]
    tolerance: Option<f64>,

    /// The angles of csv in degrees, such as "psi=10:70:20 theta=-85:85:1 phi=0,90": FROM:TO:STEP or
    /// numbers between commas [default: psi=0:70:10 theta=-80:80:5 phi=0]
    #[arg(
        long,
        value_name = "ANGLES",
        default_value = "",
        hide_default_value = true
    )]
    grid: AngleGrid,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            print_error(&message);
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let (input, output) = (arguments.fits.as_path(), arguments.output.as_deref());
    let beside = arguments.beside()?;
    let outputs = output.into_iter().chain(beside.as_deref());
    check_outputs([input], outputs).map_err(|error| error.to_string())?;
    arguments.check()?;
    let coating = arguments.coating()?;
    let options = ExportOptions {
        name: arguments.name.clone(),
        tolerance: arguments.tolerance,
        grid: arguments.grid.clone(),
        rgb: arguments.rgb,
    };
    let (mut bytes, mut bytes_beside) = (Vec::new(), Vec::new());
    let found = export(&coating, arguments.to, &options, &mut bytes);
    let found = found.map_err(|error| error.to_string())?;
    export_companion(arguments.to, &options, &mut bytes_beside)
        .map_err(|error| error.to_string())?;
    let Some(path) = output else {
        if let Some(found) = &found {
            // Where standard error is gone, nobody is there to be told.
            let _ = writeln!(io::stderr(), "{found}");
        }
        return print(&bytes);
    };
    if let Some(beside) = &beside {
        write(beside, &bytes_beside)?;
    }
    write(path, &bytes)?;
    let path = path.display();
    match (beside, found) {
        (Some(beside), _) => say(&format!("written: {path}, {}", beside.display())),
        (None, Some(found)) => say(&format!("written: {path}; {found}")),
        (None, None) => Ok(()),
    }
}

fn say(line: &str) -> Result<(), String> {
    print(format!("{line}\n").as_bytes())
}

fn print(bytes: &[u8]) -> Result<(), String> {
    output::print(bytes).map_err(|error| format!("standard output: {error}"))
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    write_file(path, |writer| writer.write_all(bytes)).map_err(|error| error.to_string())
}

/// Three numbers with commas between them.
fn three(text: &str) -> Result<[f64; 3], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
    numbers.ok_or_else(|| "expected three numbers, as in 0.63,0.55,0.46".to_owned())
}

impl Arguments {
    /// No option is given that the form has no use for.
    fn check(&self) -> Result<(), String> {
        let defaults = ExportOptions::default();
        let is_source = matches!(self.to, Target::Source(_) | Target::Mitsuba);
        let of_colours = matches!(self.to, Target::Merl | Target::Mitsuba);
        let is_table = matches!(self.to, Target::Merl | Target::Astm | Target::Zemax);
        let idle = [
            ("name", self.name != defaults.name && !is_source),
            ("rgb", self.rgb.is_some() && !of_colours),
            ("tolerance", self.tolerance.is_some() && !is_table),
            ("grid", self.grid != defaults.grid && self.to != Target::Csv),
        ];
        match idle.iter().find(|(_, idle)| *idle) {
            Some((option, _)) => Err(format!("--{option} says nothing about this form")),
            None => Ok(()),
        }
    }

    /// The second file, of a form that has one: beside the first, which then has to be named.
    fn beside(&self) -> Result<Option<PathBuf>, String> {
        let Some(extension) = self.to.companion_extension() else {
            return Ok(None);
        };
        let output = self.output.as_ref();
        let beside = output.map(|path| path.with_extension(extension));
        beside.map(Some).ok_or_else(|| {
            format!("this form is two files, FILE and one of the extension {extension}: expected -o FILE")
        })
    }

    /// What is exported.
    fn coating(&self) -> Result<Material, String> {
        let all = Material::read(&self.fits).map_err(|error| error.to_string())?;
        let of_file = all.for_file(self.file.as_deref());
        let chosen = of_file.and_then(|coating| match self.wavelength {
            Some(wavelength) => coating.at_wavelength(wavelength),
            None => Ok(coating),
        });
        chosen.map_err(|error| format!("{}: {error}", self.fits.display()))
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && number < 1.0 => Ok(number),
        _ => Err("expected a number above 0 and below 1".to_owned()),
    }
}
