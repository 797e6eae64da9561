//! Writes files: figures, curves and fits.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use brdf_core::{AnyBrdf, Geometry, ParameterError};
use brdf_fit::Measurements;
use brdf_fit::format::two_digits;
use brdf_fit::plot::{self, Figure, PlotError, View, figure_of, write_theory_alone};
use brdf_fit::report::{Document, Report, write_theory};

use egui::{Color32, ColorImage};
use image::RgbaImage;

use crate::job::{Drawing, FigureLayer, LobeDrawing, Output};
use crate::output_kind::FigureFormat;
use crate::platform::current::CurrentFiles;
use crate::platform::{self, Files};
use crate::solid::surface::Composition;
use crate::solid::{lobe_figure, write_obj};
use crate::state::parameters::EditedParameters;

/// Pixels of a PNG per unit of its figure, for print quality.
const PNG_SCALE: f32 = 3.0;

/// Pixels along the picture of a surface.
const SURFACE_SIDE: usize = 1024;

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(super) enum WriteError {
    /// The path leads to a folder, a pipe or a device.
    #[error("{}: is not a regular file: expected a file to write to", .0.display())]
    NotRegular(PathBuf),
    /// The parameters of a sample in a figure are outside the domain of the model.
    #[error("{sample}: {error}")]
    Sample {
        /// The name of the sample.
        sample: String,
        /// The parameter.
        error: ParameterError,
    },
    /// The parameters are outside the domain of the model.
    #[error(transparent)]
    Parameters(#[from] ParameterError),
    /// The figure cannot be drawn.
    #[error(transparent)]
    Figure(#[from] PlotError),
    /// A picture of pixels is not written as SVG.
    #[error("the surface consists of pixels: expected a PNG")]
    PixelsAsSvg,
    /// The pixels of the figure cannot be read or written.
    #[error(transparent)]
    Pixels(#[from] image::ImageError),
    /// The curves cannot be formatted.
    #[error(transparent)]
    Curves(#[from] io::Error),
    /// The fits cannot be formatted.
    #[error(transparent)]
    Fits(#[from] serde_json::Error),
    /// The file cannot be written.
    #[error(transparent)]
    File(#[from] platform::WriteError),
}

/// Writes a file. It is replaced only when it is complete.
///
/// # Errors
///
/// The output cannot be drawn or formatted, or the file cannot be written.
pub(super) fn write(path: &Path, output: &Output) -> Result<(), WriteError> {
    // Writing to a pipe could block this thread, and all following jobs, forever.
    if CurrentFiles::is_special(path) {
        return Err(WriteError::NotRegular(path.to_owned()));
    }
    let bytes = match output {
        Output::Figure(format, drawing) => figure(*format, drawing)?,
        Output::Mesh(lobe) => mesh(lobe)?,
        Output::Curves(measurements, parameters, psi) => curves(measurements, parameters, psi)?,
        Output::Fit(reports, _) => fits(reports)?,
    };
    CurrentFiles::write(path, &bytes)?;
    Ok(())
}

/// The standard error of the theory at a geometry, in 1/sr.
type Band<'a> = Box<dyn Fn(&Geometry) -> f64 + 'a>;

/// The pixels of a figure for the clipboard.
///
/// # Errors
///
/// The figure cannot be drawn.
pub(super) fn pixels(drawing: &Drawing) -> Result<ColorImage, WriteError> {
    let png = figure(FigureFormat::Png, drawing)?;
    let image = image::load_from_memory_with_format(&png, image::ImageFormat::Png)?.to_rgba8();
    let size = [image.width() as usize, image.height() as usize];
    Ok(ColorImage::from_rgba_unmultiplied(size, &image))
}

fn figure(format: FigureFormat, drawing: &Drawing) -> Result<Vec<u8>, WriteError> {
    let figure = match drawing {
        Drawing::Curves(layers, view) => figure_of_layers(layers, view)?,
        Drawing::Lobe(lobe) => {
            let title = lobe.title.each_ref().map(String::as_str);
            lobe_figure(&lobe.scene, &lobe.camera, title, lobe.ground)
        }
        Drawing::Surface(surface) => return surface_png(format, surface),
    };
    Ok(match format {
        FigureFormat::Svg => figure.svg.into_bytes(),
        FigureFormat::Png => figure.png(PNG_SCALE)?,
    })
}

fn surface_png(format: FigureFormat, surface: &Composition) -> Result<Vec<u8>, WriteError> {
    if format == FigureFormat::Svg {
        return Err(WriteError::PixelsAsSvg);
    }
    let image = surface.picture(SURFACE_SIDE);
    let size = image.size.map(|length| length as u32);
    let bytes: Vec<u8> = image.pixels.iter().flat_map(Color32::to_array).collect();
    let mut png = io::Cursor::new(Vec::new());
    // A picture has as many bytes as its size says.
    let image = RgbaImage::from_raw(size[0], size[1], bytes).unwrap_or_default();
    image.write_to(&mut png, image::ImageFormat::Png)?;
    Ok(png.into_inner())
}

fn mesh(lobe: &LobeDrawing) -> Result<Vec<u8>, WriteError> {
    let mut bytes = Vec::new();
    let title = lobe.title.each_ref().map(String::as_str);
    write_obj(&lobe.scene.lobe, lobe.scene.radius, title, &mut bytes)?;
    Ok(bytes)
}

fn figure_of_layers(layers: &[FigureLayer], view: &View) -> Result<Figure, WriteError> {
    let brdfs = brdfs(layers)?;
    let bands: Vec<Option<Band>> = layers
        .iter()
        .zip(&brdfs)
        .map(|(layer, brdf)| {
            let uncertainty = layer.fit.as_ref()?.uncertainty.as_ref()?;
            let band = move |at: &Geometry| uncertainty.band(brdf, at);
            Some(Box::new(band) as Band)
        })
        .collect();
    let layers: Vec<plot::Layer> = layers
        .iter()
        .zip(&brdfs)
        .zip(&bands)
        .map(|((layer, brdf), band)| plot::Layer {
            name: layer.name.clone(),
            measurements: &layer.measurements,
            brdf: *brdf,
            theory: theory_as_text(layer),
            sigma: band.as_deref(),
            incidences: Some(&layer.incidences),
            family: layer.family,
        })
        .collect();
    Ok(figure_of(&layers, view))
}

fn brdfs(layers: &[FigureLayer]) -> Result<Vec<AnyBrdf>, WriteError> {
    let brdf = |layer: &FigureLayer| {
        brdf(&layer.parameters).map_err(|error| WriteError::Sample {
            sample: layer.name.clone(),
            error,
        })
    };
    layers.iter().map(brdf).collect()
}

fn brdf(parameters: &EditedParameters) -> Result<AnyBrdf, ParameterError> {
    AnyBrdf::new(parameters.model.family(), &parameters.values)
}

/// The name of the model, its parameters, and the error of the fit if they are those of the fit.
fn theory_as_text(layer: &FigureLayer) -> String {
    let parameters = &layer.parameters;
    let all = parameters.model_parameters().into_iter();
    let values: Vec<String> = all
        .map(|p| format!("{p} = {:.4}", p.of(&parameters.values)))
        .collect();
    let fit = layer.fit.as_ref().and_then(|report| report.fit.as_ref());
    let error = fit.map_or_else(String::new, |fit| {
        let (rms, e) = (two_digits(fit.rms_percent()), two_digits(fit.e_percent));
        format!("; rms {rms} % (E = {e} %)")
    });
    format!("{}: {}{error}", parameters.model, values.join(", "))
}

fn curves(
    measurements: &Measurements,
    parameters: &EditedParameters,
    psi: &[f64],
) -> Result<Vec<u8>, WriteError> {
    let brdf = brdf(parameters)?;
    let mut bytes = Vec::new();
    if measurements.readings().is_empty() {
        write_theory_alone(&measurements.source, &brdf, psi, &mut bytes)?;
    } else {
        write_theory(measurements, &brdf, &mut bytes)?;
    }
    Ok(bytes)
}

fn fits(reports: &[Arc<Report>]) -> Result<Vec<u8>, WriteError> {
    let reports = reports.iter().map(|report| (**report).clone()).collect();
    let mut bytes = serde_json::to_vec_pretty(&Document::new(reports))?;
    bytes.push(b'\n');
    Ok(bytes)
}
