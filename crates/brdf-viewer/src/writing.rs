//! Writing files: figures, curves and fits.

use std::path::Path;
use std::sync::Arc;

use brdf_core::{AnyBrdf, Geometry};
use brdf_fit::Measurements;
use brdf_fit::output::write_file;
use brdf_fit::plot::write_theory_alone;
use brdf_fit::plot::{self, View, figure_of};
use brdf_fit::report::{Document, Report, write_theory};

use crate::intent::Picture;
use crate::job::{Layer, Writing};
use crate::state::sample::Knobs;

/// Pixels of a PNG for each unit of its figure: print quality.
const PNG_SCALE: f32 = 3.0;

/// Writes a file, whole or not at all.
///
/// Errors: what is wrong with the path or with what is written, in words.
pub fn write(path: &Path, writing: &Writing) -> Result<(), String> {
    // A pipe would be waited for without end, with everything that is written after it.
    if path.exists() && !path.is_file() {
        return Err(format!(
            "{}: is no regular file: expected a file to write to",
            path.display()
        ));
    }
    let bytes = match writing {
        Writing::Figure(picture, layers, view) => figure(*picture, layers, view)?,
        Writing::Curves(measurements, knobs, psi) => curves(measurements, knobs, psi)?,
        Writing::Fit(reports) => fits(reports)?,
    };
    write_file(path, |writer| writer.write_all(&bytes)).map_err(|error| error.to_string())
}

/// The standard error of the theory at a geometry.
type Band<'a> = Box<dyn Fn(&Geometry) -> f64 + 'a>;

fn figure(picture: Picture, layers: &[Layer], view: &View) -> Result<Vec<u8>, String> {
    let mut brdfs: Vec<AnyBrdf> = Vec::new();
    for layer in layers {
        let knobs = &layer.knobs;
        let brdf = AnyBrdf::new(knobs.model.family(), &knobs.at);
        brdfs.push(brdf.map_err(|error| format!("{}: {error}", layer.name))?);
    }
    let bands: Vec<Option<Band>> = layers
        .iter()
        .zip(&brdfs)
        .map(|(layer, brdf)| {
            let uncertainty = layer.fitted.as_ref()?.uncertainty.as_ref()?;
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
            theory: theory_in_words(&layer.knobs),
            sigma: band.as_deref(),
            incidences: Some(&layer.incidences),
            family: layer.family,
        })
        .collect();
    let figure = figure_of(&layers, view);
    match picture {
        Picture::Svg => Ok(figure.svg.into_bytes()),
        Picture::Png => figure.png(PNG_SCALE).map_err(|error| error.to_string()),
    }
}

/// The model and its parameters in words.
fn theory_in_words(knobs: &Knobs) -> String {
    let values = knobs.parameters().into_iter();
    let values: Vec<String> = values
        .map(|p| format!("{p} = {:.4}", p.of(&knobs.at)))
        .collect();
    format!("{}: {}", knobs.model, values.join(", "))
}

fn curves(measurements: &Measurements, knobs: &Knobs, psi: &[f64]) -> Result<Vec<u8>, String> {
    let brdf = AnyBrdf::new(knobs.model.family(), &knobs.at).map_err(|error| error.to_string())?;
    let mut bytes = Vec::new();
    let written = if measurements.readings().is_empty() {
        write_theory_alone(&measurements.source, &brdf, psi, &mut bytes)
    } else {
        write_theory(measurements, &brdf, &mut bytes)
    };
    written.map_err(|error| error.to_string())?;
    Ok(bytes)
}

fn fits(reports: &[Arc<Report>]) -> Result<Vec<u8>, String> {
    let reports = reports.iter().map(|report| (**report).clone()).collect();
    let mut bytes =
        serde_json::to_vec_pretty(&Document::new(reports)).map_err(|error| error.to_string())?;
    bytes.push(b'\n');
    Ok(bytes)
}
