//! Writes and prints the results of `brdf trade`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::arguments::Outputs;
use crate::cli::failure::Failure;
use crate::cli::stream::{self, Named};
use crate::output::{self, FilesInUse};
use crate::plot::Figure;

/// A figure, and the wavelength in the name of its file if there are several.
type Drawn = (Option<f64>, Figure);

impl Outputs {
    /// Checks that no output replaces the input or another output, that each can be written, and that
    /// each standard stream is used once.
    pub(super) fn check(&self, input: Option<Named<'_>>) -> Result<FilesInUse, Vec<Failure>> {
        stream::check(input, self.files(), None).map_err(|error| vec![error.into()])
    }

    /// Checks that the figure of each of several wavelengths, which has a name of its own, replaces
    /// none of the files in use and can be written.
    pub(super) fn check_figures(
        &self,
        wavelengths: &[Option<f64>],
        in_use: &FilesInUse,
    ) -> Result<(), Vec<Failure>> {
        let plot = self.plot.as_ref().filter(|path| !stream::is_stream(path));
        let Some(plot) = plot.filter(|_| wavelengths.len() > 1) else {
            return Ok(());
        };
        for wavelength_um in wavelengths.iter().filter(|wavelength| wavelength.is_some()) {
            stream::check_further(&named(plot, *wavelength_um), in_use)
                .map_err(|error| vec![error.into()])?;
        }
        Ok(())
    }

    fn files(&self) -> impl Iterator<Item = Named<'_>> {
        let files = [
            ("--csv", &self.csv),
            ("--json", &self.json),
            ("--plot", &self.plot),
        ];
        let files = files.into_iter();
        files.filter_map(|(option, path)| Some((option, path.as_deref()?)))
    }

    /// Writes the files and prints. A failure of one output does not prevent the others.
    pub(super) fn deliver(
        &self,
        text: &str,
        document: &impl Serialize,
        csv: impl FnOnce(&mut dyn Write) -> io::Result<()>,
        figures: Vec<Drawn>,
    ) -> Result<(), Vec<Failure>> {
        let mut failures = Vec::new();
        if let Some(path) = &self.csv {
            failures.extend(stream::write(path, csv).err().map(Failure::from));
        }
        if let Some(path) = &self.json {
            let written = stream::write_json(path, document);
            failures.extend(written.err().map(Failure::from));
        }
        if let Some(path) = &self.plot {
            failures.extend(write_figures(path, figures));
        }
        if !self.files().any(|(_, path)| stream::is_stream(path)) {
            let printed = output::print_text(text);
            failures.extend(printed.err().map(Failure::Print));
        }
        if failures.is_empty() {
            Ok(())
        } else {
            Err(failures)
        }
    }
}

fn write_figures(path: &Path, figures: Vec<Drawn>) -> Vec<Failure> {
    if stream::is_stream(path) && figures.len() > 1 {
        return vec![Failure::SeveralFigures(figures.len())];
    }
    let written = figures
        .into_iter()
        .map(|(wavelength_um, figure)| write_figure(&named(path, wavelength_um), &figure));
    written.filter_map(Result::err).collect()
}

fn write_figure(path: &Path, figure: &Figure) -> Result<(), Failure> {
    let svg = figure.svg.as_bytes();
    Ok(stream::write(path, |writer| writer.write_all(svg))?)
}

/// `trade.svg` as `trade_0.63um.svg`.
fn named(path: &Path, wavelength_um: Option<f64>) -> PathBuf {
    let Some(wavelength_um) = wavelength_um else {
        return path.to_owned();
    };
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path
        .extension()
        .map_or_else(String::new, |e| format!(".{}", e.display()));
    path.with_file_name(format!("{stem}_{wavelength_um}um{extension}"))
}
