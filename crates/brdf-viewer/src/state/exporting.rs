//! Writing of files, and the dialogs that ask for a path.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use brdf_fit::output::resolved;
use brdf_fit::plot::{Ground, Layout, View};

use super::interface::Dialog;
use super::sample::Sample;
use super::solid::Solid;
use super::{Effect, State};
use crate::job::{Drawing, FigureLayer, FileJob, Job, LobeDrawing, Output};
use crate::output_kind::OutputKind;

/// Why a file is not written.
#[derive(Debug, thiserror::Error)]
enum ExportError {
    /// The file is an open scan.
    #[error("{}: is an open scan: expected a different file for the {}", .0.display(), .1.name())]
    OpenScan(PathBuf, OutputKind),
    /// The file is the fit from which open samples were read.
    #[error(
        "{}: is the fit of open samples: expected a different file for the {}",
        .0.display(), .1.name()
    )]
    OpenFit(PathBuf, OutputKind),
    /// The file contains fits of samples that were closed.
    #[error(
        "{}: contains the fits of {total} scans, of which {open} are open: expected a different \
         file for the {}",
        path.display(), kind.name()
    )]
    ClosedFits {
        path: PathBuf,
        kind: OutputKind,
        total: usize,
        open: usize,
    },
    /// The extension is that of another kind of file.
    #[error(
        "{}: the {} is written as .{}: expected a path that ends with it",
        .0.display(), .1.name(), .1.extension()
    )]
    Extension(PathBuf, OutputKind),
    #[error("no sample is open")]
    NoSample,
    #[error("no lobe is shown: expected Lobe above the plot, and parameters in their domain")]
    NoLobe,
    #[error("the figure would be empty: no incidence is selected")]
    EmptyFigure,
}

impl State {
    /// Asks for the path of a file to open in the viewer's own dialog.
    pub fn ask_path(&mut self) {
        self.dialog = Some(Dialog::Open {
            path: String::new(),
        });
    }

    /// Asks for the path of a file to write in the viewer's own dialog, and suggests one.
    pub fn ask_export(&mut self, kind: OutputKind, path: &Path) {
        let path = path.display().to_string();
        self.dialog = Some(Dialog::Export { kind, path });
    }

    pub(super) fn set_path(&mut self, text: String) {
        if let Some(Dialog::Open { path } | Dialog::Export { path, .. }) = &mut self.dialog {
            *path = text;
        }
    }

    pub(super) fn confirm(&mut self) {
        match self.dialog.take() {
            Some(Dialog::Open { path }) if !path.trim().is_empty() => {
                self.open(vec![PathBuf::from(path.trim())]);
            }
            Some(Dialog::Export { kind, path }) if !path.trim().is_empty() => {
                self.write(kind, PathBuf::from(path.trim()));
            }
            Some(Dialog::About | Dialog::Close { .. }) | None => {}
            without_path => self.dialog = without_path,
        }
    }

    pub(super) fn browse(&mut self) {
        match self.dialog.take() {
            Some(Dialog::Open { .. }) => self.effects.push(Effect::AskOpen),
            Some(Dialog::Export { kind, path }) => {
                let path = PathBuf::from(path);
                self.effects.push(Effect::AskExport(kind, path));
            }
            other => self.dialog = other,
        }
    }

    /// A file name for an output of the active sample.
    pub(super) fn suggested_path(&self, kind: OutputKind) -> PathBuf {
        let Some(sample) = self.active_sample() else {
            return PathBuf::new();
        };
        let wavelength = sample.scan().wavelength_um();
        let wavelength = wavelength.map_or_else(String::new, |w| format!("_{w}um"));
        let is_allowed = |c: char| c.is_alphanumeric() || "._-".contains(c);
        let name: String = format!("{}{wavelength}", sample.name)
            .chars()
            .map(|c| if is_allowed(c) { c } else { '_' })
            .collect();
        PathBuf::from(format!("{name}.{}", kind.extension()))
    }

    /// Writes a file. A path without an extension gets that of the kind.
    pub(super) fn write(&mut self, kind: OutputKind, mut path: PathBuf) {
        if path.extension().is_none() {
            path.set_extension(kind.extension());
        }
        let output = self.check_target(kind, &path);
        match output.and_then(|()| self.output(kind, &path)) {
            Ok(output) => self.start(Job::File(FileJob::Write(path, output))),
            Err(error) => self.report_error(error.to_string()),
        }
    }

    /// Refuses a path where data of open samples would be lost.
    fn check_target(&self, kind: OutputKind, path: &Path) -> Result<(), ExportError> {
        let target = resolved(path);
        let path = path.to_owned();
        let expected = kind.extension();
        let has_expected = |extension: &std::ffi::OsStr| extension.eq_ignore_ascii_case(expected);
        if !path.extension().is_some_and(has_expected) {
            return Err(ExportError::Extension(path, kind));
        }
        let mut samples = self.samples.iter();
        if samples.any(|sample| sample.has_readings_from(&target)) {
            return Err(ExportError::OpenScan(path, kind));
        }
        let of_document = || self.samples.iter().filter(|s| s.was_opened_from(&target));
        let Some(first) = of_document().next() else {
            return Ok(());
        };
        let (total, open) = (first.samples_in_source, of_document().count());
        let active = self.active_sample();
        let is_own_fit = active.is_some_and(|s| s.was_opened_from(&target));
        if kind != OutputKind::Fit || !is_own_fit {
            Err(ExportError::OpenFit(path, kind))
        } else if open < total {
            Err(ExportError::ClosedFits {
                path,
                kind,
                total,
                open,
            })
        } else {
            Ok(())
        }
    }

    /// The samples that a figure shows.
    fn layers(&self) -> Result<Vec<FigureLayer>, ExportError> {
        let layers: Vec<FigureLayer> = self
            .plotted()
            .into_iter()
            .map(|plotted| FigureLayer::new(plotted.sample, plotted.scan, plotted.family))
            .collect();
        if layers.iter().all(|layer| layer.incidences.is_empty()) {
            return Err(ExportError::EmptyFigure);
        }
        Ok(layers)
    }

    /// The view with what of it is shown, on the ground of the window.
    fn view_of_figure(&self) -> View {
        View {
            // Panels show all, because each may show another part.
            zoom: self.zoom.filter(|_| self.view.layout == Layout::Together),
            ground: self.ground(),
            ..self.view
        }
    }

    pub(super) fn ground(&self) -> Ground {
        if self.is_dark() {
            Ground::Dark
        } else {
            Ground::Light
        }
    }

    /// What a figure shows.
    fn drawing(&self) -> Result<Drawing, ExportError> {
        Ok(match self.solid.shown {
            None => Drawing::Curves(self.layers()?, self.view_of_figure()),
            Some(Solid::Lobe) => Drawing::Lobe(Box::new(self.lobe_drawing()?)),
            Some(Solid::Surface) => {
                let drawing = self.surface_drawing();
                Drawing::Surface(drawing.ok_or(ExportError::NoSample)?)
            }
        })
    }

    fn lobe_drawing(&self) -> Result<LobeDrawing, ExportError> {
        self.drawn_lobe().ok_or(ExportError::NoLobe)
    }

    /// Copies the figure to the clipboard.
    pub(super) fn copy_figure(&mut self) {
        match self.drawing() {
            Ok(drawing) => self.start(Job::File(FileJob::Draw(drawing))),
            Err(error) => self.report_error(error.to_string()),
        }
    }

    fn output(&self, kind: OutputKind, path: &Path) -> Result<Output, ExportError> {
        let sample = self.active_sample().ok_or(ExportError::NoSample)?;
        Ok(match kind {
            OutputKind::Figure(format) => Output::Figure(format, self.drawing()?),
            OutputKind::Mesh => Output::Mesh(Box::new(self.lobe_drawing()?)),
            OutputKind::Curves => {
                let scan = sample.scan();
                let psi = scan.incidences.iter().map(|incidence| incidence.psi);
                Output::Curves(
                    Arc::clone(&scan.measurements),
                    scan.parameters,
                    psi.collect(),
                )
            }
            OutputKind::Fit => {
                let target = resolved(path);
                // If the target is the document of the sample, the fits of the other samples from
                // this document are written as well.
                let samples = self.samples.iter();
                let samples = samples.filter(|s| s.id == sample.id || s.was_opened_from(&target));
                let ids = samples.clone().map(|sample| sample.id).collect();
                let scans = samples.flat_map(|sample: &Sample| &sample.scans);
                let reports = scans.filter_map(|scan| scan.last_fit.clone()).collect();
                Output::Fit(reports, ids)
            }
        })
    }
}
