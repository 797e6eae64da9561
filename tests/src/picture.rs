//! The picture of the README: theory against experiment for one measured sample.

use std::error::Error;

use brdf_fit::Model;
use brdf_fit::plot::report_figures;
use brdf_fit::report::{Depth, Report};
use brdf_fit::{FitOptions, RefractiveIndex};

use crate::{in_workspace, one_wavelength};

/// Z307 at 0.631 um and the paper's model with n fitted, on a logarithmic axis.
pub fn svg() -> Result<String, Box<dyn Error>> {
    let path = in_workspace("data/measured/z307_on_aluminium.csv");
    let mut scan = one_wavelength(&path, 0.63079);
    "data/measured/z307_on_aluminium.csv".clone_into(&mut scan.source);
    let options = FitOptions {
        model: Model::ThreeN,
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    let (report, _) = Report::new(&scan, &options, Depth::Fit);
    let figures = report_figures(&scan, &report)?;
    let figure = figures
        .into_iter()
        .find(|figure| figure.name == "theory-log");
    Ok(figure.ok_or("no such picture")?.svg)
}
