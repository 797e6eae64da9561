//! The fit of one scan.

use brdf_fit::report::html;
use brdf_fit::{
    AssumedErrors, Depth, Document, FitOptions, FixedParameters, Loss, ModelChoice, Parameter,
    RefractiveIndex, Warning, Weights, report,
};
use pyo3::prelude::*;

use crate::error::{FitError, value_error};
use crate::pool;
use crate::scan::Scan;

/// A fit with everything that is computed from it.
#[pyclass(frozen, module = "brdf_fit._native")]
pub(crate) struct Report(pub(crate) report::Report);

/// The options of a fit.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Options {
    n: Option<f64>,
    model: String,
    weights: String,
    robust: Option<String>,
    fixed: Vec<(String, f64)>,
    energy_limit: Option<f64>,
    global_check: bool,
}

/// Fits a scan in two stages.
#[pyfunction]
pub(crate) fn fit(
    py: Python<'_>,
    scan: &Scan,
    options: Options,
    depth: &str,
    threads: Option<usize>,
) -> PyResult<Report> {
    let choice = if options.model == "auto" {
        ModelChoice::Auto
    } else {
        ModelChoice::Given
    };
    let depth = match depth {
        "fit" => Depth::Fit,
        "assessed" => Depth::Assessed,
        "compared" => Depth::Compared,
        _ => {
            return Err(value_error(format!(
                "depth \"{depth}\": expected fit, assessed or compared"
            )));
        }
    };
    let options = options.checked()?;
    let (report, error) = pool::run(py, threads, |interrupt| {
        report::Report::observed(&scan.0, &options, choice, depth, interrupt)
    })?;
    match error {
        Some(error) => Err(FitError::new_err(error.to_string())),
        None => Ok(Report(report)),
    }
}

impl Options {
    fn checked(&self) -> PyResult<FitOptions> {
        let mut fixed = FixedParameters::none();
        for (name, value) in &self.fixed {
            let parameter: Parameter = name.parse().map_err(value_error)?;
            fixed = fixed.with(parameter, *value);
        }
        let errors = match self.weights.as_str() {
            "constant" => AssumedErrors::Constant,
            "stated" => AssumedErrors::Stated,
            "relative" => AssumedErrors::Relative,
            other => {
                return Err(value_error(format!(
                    "weights \"{other}\": expected constant, stated or relative"
                )));
            }
        };
        let model = match self.model.as_str() {
            "auto" => Ok(brdf_fit::Model::default()),
            name => name.parse(),
        };
        let robust = self.robust.as_deref().map(str::parse::<Loss>);
        Ok(FitOptions {
            model: model.map_err(value_error)?,
            refractive_index: self.n.map(RefractiveIndex::Same),
            weights: Weights {
                errors,
                ..Weights::default()
            },
            robust: robust.transpose().map_err(value_error)?,
            energy_limit: self.energy_limit,
            global_check: self.global_check,
            fixed,
            ..FitOptions::default()
        })
    }
}

#[pymethods]
impl Report {
    /// From the text that `to_json` gives.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        let document = Document::from_bytes("text", text.as_bytes()).map_err(value_error)?;
        match <[_; 1]>::try_from(document.reports) {
            Ok([report]) => Ok(Self(report)),
            Err(several) => Err(value_error(format!(
                "{} reports: expected one",
                several.len()
            ))),
        }
    }

    /// A document of this report alone, as the command line writes it.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&Document::new(vec![self.0.clone()])).map_err(value_error)
    }

    /// The report as text, as the command line prints it.
    fn text(&self) -> String {
        self.0.text()
    }

    /// The report as text with all details.
    fn detailed_text(&self) -> String {
        self.0.detailed_text()
    }

    /// The report as a page of HTML.
    fn html(&self) -> String {
        html(&[(&self.0, &[])])
    }

    #[getter]
    fn status(&self) -> String {
        self.0.status()
    }

    #[getter]
    fn file(&self) -> &str {
        &self.0.file
    }

    #[getter]
    fn model(&self) -> &'static str {
        self.0.model.name()
    }

    #[getter]
    fn wavelength_um(&self) -> Option<f64> {
        self.0.wavelength_um
    }

    /// k2, kD, k1, n and p.
    #[getter]
    fn parameters(&self) -> PyResult<(f64, f64, f64, f64, f64)> {
        let at = self.fit()?.at();
        Ok((at.k2, at.kd, at.k1, at.n, at.p))
    }

    #[getter]
    fn e_percent(&self) -> PyResult<f64> {
        Ok(self.fit()?.e_percent)
    }

    #[getter]
    fn readings(&self) -> PyResult<usize> {
        Ok(self.fit()?.readings)
    }

    /// For each free parameter its name, its standard error, and the ends of its interval of 95 %; NaN
    /// where there is none.
    #[getter]
    fn estimates(&self) -> Vec<(String, f64, f64, f64)> {
        let estimates = self.0.uncertainty.iter().flat_map(|all| &all.estimates);
        let row = estimates.map(|estimate| {
            let nan = f64::NAN;
            let interval = estimate.interval_95();
            (
                estimate.parameter.to_string().to_lowercase(),
                estimate.standard_error().unwrap_or(nan),
                interval.from.unwrap_or(nan),
                interval.to.unwrap_or(nan),
            )
        });
        row.collect()
    }

    /// The kind and the sentence of each warning.
    #[getter]
    fn warnings(&self) -> Vec<(&'static str, String)> {
        let pair = |warning: &Warning| (warning.kind(), warning.to_string());
        self.0.warnings.iter().map(pair).collect()
    }
}

impl Report {
    fn fit(&self) -> PyResult<&brdf_fit::Fit> {
        let fit = self.0.fit.as_ref();
        fit.ok_or_else(|| FitError::new_err(self.0.status()))
    }
}
