//! `brdf export`: writes a fitted BRDF in the format of another program.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::Failure;
use super::outcome::{Outcome, print_failures};
use super::stream;
use crate::export::{AngleGrid, ExportOptions, Material, Target, export, export_companion};
use crate::output;

/// Writes a fitted BRDF in the format of another program
///
/// Exit status: 0 if it was written; 2 for incorrect usage, input that cannot be read, or output
/// that cannot be written.
#[derive(Args)]
pub(super) struct Arguments {
    /// The fits, as written by brdf fit --json or brdf export --to json; - is standard input
    #[arg(value_name = "FILE")]
    fits: PathBuf,

    /// The format: json (the model); source code: c, glsl, wgsl, osl, python; mitsuba (a plugin and
    /// a scene beside it: with -o x.py also x.xml); tables: merl, astm and zemax (see --tolerance),
    /// csv (see --grid)
    #[arg(long, value_name = "FORMAT")]
    to: Target,

    /// Write to this file; - is standard output [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Of fits of several scans, the scan to export, by its path or its file name
    #[arg(long, value_name = "NAME")]
    file: Option<String>,

    /// Of fits at several wavelengths, the wavelength to export, in um (the nearest within 1 %)
    #[arg(long, value_name = "UM")]
    wavelength: Option<f64>,

    /// The wavelengths for red, green and blue, in um, for formats with colours: merl and mitsuba
    /// [default: a single fit for all three, otherwise the fits nearest to 0.611,0.549,0.464]
    #[arg(long, value_name = "RED,GREEN,BLUE", value_parser = three, conflicts_with = "wavelength")]
    rgb: Option<[f64; 3]>,

    /// Prefix of the names in source code; type of the material in Mitsuba
    #[arg(long, value_name = "WORD", default_value = "brdf")]
    name: String,

    /// Largest relative error of a table: of astm and zemax between entries [default: 5e-2], of merl
    /// in the nearest bin [default: no limit]
    #[arg(long, value_name = "ERROR", value_parser = tolerance)]
    tolerance: Option<f64>,

    /// The angles of csv in degrees, each as FROM:TO:STEP or as numbers separated by commas, such as
    /// "psi=10:70:20 theta=-85:85:1 phi=0,90" [default: psi=0:70:10 theta=-80:80:5 phi=0]
    #[arg(
        long,
        value_name = "ANGLES",
        default_value = "",
        hide_default_value = true
    )]
    grid: AngleGrid,
}

pub(super) fn run(arguments: &Arguments) -> Outcome {
    print_failures(arguments.export().err())
}

impl Arguments {
    fn export(&self) -> Result<(), Failure> {
        let beside = self.check()?;
        let material = self.material()?;
        let options = ExportOptions {
            name: self.name.clone(),
            tolerance: self.tolerance,
            grid: self.grid.clone(),
            rgb: self.rgb,
        };
        let (mut bytes, mut bytes_beside) = (Vec::new(), Vec::new());
        let found = export(&material, self.to, &options, &mut bytes)?;
        export_companion(self.to, &options, &mut bytes_beside)?;
        let Some(path) = self.file() else {
            if let Some(found) = &found {
                // Without standard error, nobody reads the note.
                let _ = writeln!(io::stderr(), "{found}");
            }
            return output::print(&bytes).map_err(Failure::Print);
        };
        if let Some(beside) = &beside {
            write(beside, &bytes_beside)?;
        }
        write(path, &bytes)?;
        let path = path.display();
        let note = match (beside, found) {
            (Some(beside), _) => format!("written: {path}, {}\n", beside.display()),
            (None, Some(found)) => format!("written: {path}; {found}\n"),
            (None, None) => return Ok(()),
        };
        output::print_text(&note).map_err(Failure::Print)
    }

    /// The output, unless it is standard output.
    fn file(&self) -> Option<&Path> {
        let output = self.output.as_deref();
        output.filter(|path| !stream::is_stream(path))
    }

    /// Checks that the options apply to the format and that no output replaces the input. Returns
    /// the second file of a format that has one.
    fn check(&self) -> Result<Option<PathBuf>, Failure> {
        let beside = self.beside()?;
        let outputs = self.file().into_iter().chain(beside.as_deref());
        stream::check(
            [("FILE", self.fits.as_path())],
            outputs.map(|path| ("--output", path)),
            None,
        )?;
        self.check_effects()?;
        Ok(beside)
    }

    /// Checks that every option that is given has an effect on the format.
    fn check_effects(&self) -> Result<(), Failure> {
        let defaults = ExportOptions::default();
        let is_source = matches!(self.to, Target::Source(_) | Target::Mitsuba);
        let has_colours = matches!(self.to, Target::Merl | Target::Mitsuba);
        let is_table = matches!(self.to, Target::Merl | Target::Astm | Target::Zemax);
        let without_effect = [
            ("name", self.name != defaults.name && !is_source),
            ("rgb", self.rgb.is_some() && !has_colours),
            ("tolerance", self.tolerance.is_some() && !is_table),
            ("grid", self.grid != defaults.grid && self.to != Target::Csv),
        ];
        let format = self.format();
        match without_effect.iter().find(|(_, is_idle)| *is_idle) {
            Some(&(option, _)) => Err(Failure::NoEffect { option, format }),
            None => Ok(()),
        }
    }

    /// The name of the format.
    fn format(&self) -> &'static str {
        let mut named = Target::NAMED.iter();
        let found = named.find(|(target, _)| *target == self.to);
        found.map_or("", |(_, name)| name)
    }

    /// The second file of a format that has one. It stands beside the first, which must be named
    /// then.
    fn beside(&self) -> Result<Option<PathBuf>, Failure> {
        let Some(extension) = self.to.companion_extension() else {
            return Ok(None);
        };
        let format = self.format();
        let beside = self.file().map(|path| path.with_extension(extension));
        beside
            .map(Some)
            .ok_or(Failure::TwoFiles { format, extension })
    }

    /// What is exported.
    fn material(&self) -> Result<Material, Failure> {
        let all = if stream::is_stream(&self.fits) {
            let bytes = stream::bytes().map_err(Failure::from)?;
            Material::from_bytes(stream::shown(&self.fits), &bytes)?
        } else {
            Material::read(&self.fits)?
        };
        let of_file = all.for_file(self.file.as_deref());
        let chosen = of_file.and_then(|material| match self.wavelength {
            Some(wavelength) => material.at_wavelength(wavelength),
            None => Ok(material),
        });
        chosen.map_err(|error| Failure::from(error).in_file(&self.fits))
    }
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    Ok(stream::write(path, |writer| writer.write_all(bytes))?)
}

/// Three numbers, separated by commas.
fn three(text: &str) -> Result<[f64; 3], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
    numbers.ok_or_else(|| "expected three numbers, as in 0.63,0.55,0.46".to_owned())
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && number < 1.0 => Ok(number),
        _ => Err("expected a number above 0 and below 1".to_owned()),
    }
}
