//! Compares the evaluators of a BRDF over the directions of a scene.

use std::io::Write;
use std::path::Path;

use brdf_core::scene::Scene;
use brdf_core::{AnyBrdf, ModelParameters};

use super::Compared;
use super::arguments::{Evaluation, Outputs};
use super::values::Row;
use crate::cli::failure::Failure;
use crate::cli::outcome::Outcome;
use crate::fit::Fit;
use crate::format::distinct;
use crate::report::{Document, Report};
use crate::scan::WAVELENGTH_TOLERANCE;
use crate::tradeoff::evaluators::{
    EvaluatorTradeoff, evaluator_tradeoff, write_evaluator_tradeoff,
};

/// Measures every evaluator; [`Outcome::Incomplete`] if none is within the tolerance.
pub(super) fn compare(evaluation: &Evaluation, outputs: &Outputs) -> Compared {
    let model = evaluation.model.as_deref();
    outputs.check(model.map(|path| ("--model", path)))?;
    let (name, brdf) = evaluation.brdf().map_err(|failure| vec![failure])?;
    let scene = evaluation.scene().map_err(|failure| vec![failure])?;
    let trade: EvaluatorTradeoff = evaluator_tradeoff(&name, &brdf, &scene);
    let figures = vec![(None, trade.figure())];
    let csv = |writer: &mut dyn Write| write_evaluator_tradeoff(&trade, writer);
    outputs.deliver(&trade.text(), &trade, csv, figures)?;
    Ok(if trade.plan.is_some() {
        Outcome::Complete
    } else {
        Outcome::Incomplete
    })
}

impl Evaluation {
    /// The BRDF to evaluate, and its name.
    fn brdf(&self) -> Result<(String, AnyBrdf), Failure> {
        let Some(path) = &self.model else {
            let row = self.sample.clone();
            let row = row.map_or_else(|| "001 0.91".parse(), Ok);
            let Row { name, brdf } = row.map_err(Failure::Row)?;
            return Ok((name, brdf));
        };
        let document = Document::read(path)?;
        let (report, fit) = self.fit(path, &document)?;
        let at = ModelParameters {
            p: fit.p,
            ..ModelParameters::three(fit.parameters, fit.n)
        };
        let brdf = AnyBrdf::new(fit.options.model.family(), &at)
            .map_err(|error| Failure::from(error).in_file(path))?;
        let wavelength = fit
            .wavelength_um
            .map_or_else(String::new, |w| format!(", {w} um"));
        Ok((format!("{}{wavelength}", report.file), brdf))
    }

    /// The fit to evaluate: the first, or the one nearest to the wavelength.
    fn fit<'a>(
        &self,
        path: &Path,
        document: &'a Document,
    ) -> Result<(&'a Report, &'a Fit), Failure> {
        let reports = document.reports.iter();
        let mut fits = reports.filter_map(|report| Some((report, report.fit.as_ref()?)));
        let Some(wanted) = self.wavelength else {
            return fits.next().ok_or_else(|| Failure::NoFit(path.to_owned()));
        };
        let distance = |fit: &Fit| Some((fit.wavelength_um? / wanted - 1.0).abs());
        let near = fits.clone().filter_map(|(report, fit)| {
            let distance = distance(fit).filter(|d| *d <= WAVELENGTH_TOLERANCE)?;
            Some((distance, (report, fit)))
        });
        let nearest = near.min_by(|(a, _), (b, _)| a.total_cmp(b));
        nearest.map(|(_, found)| found).ok_or_else(|| {
            let name = |(_, fit): (&Report, &Fit)| {
                fit.wavelength_um.map_or_else(
                    || "one without a wavelength".to_owned(),
                    |wavelength| format!("{wavelength} um"),
                )
            };
            Failure::NoSuchWavelength {
                path: path.to_owned(),
                wavelength_um: wanted,
                found: distinct(fits.map(name)),
            }
        })
    }

    fn scene(&self) -> Result<Scene, Failure> {
        Ok(Scene {
            domain: self.scene.domain()?,
            coordinates: self.coordinates.into(),
            tolerance: self.tolerance,
            evaluations: self.evaluations,
        })
    }
}
