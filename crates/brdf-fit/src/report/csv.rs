//! The parameters of fits, and their curves beside the readings, as CSV.
//!
//! Angles are in degrees, wavelengths in micrometres, BRDFs in 1/sr and E in percent.

use std::io;

use brdf_core::{AnyBrdf, ModelParameters, Parameters};

use super::run::Report;
use crate::fit::Fit;
use crate::format::{exact, in_degrees};
use crate::inference::{Estimate, Quality, Warning};
use crate::model::Parameter;
use crate::read::LazyScan;
use crate::scan::Measurements;

/// The columns of [`write_parameters`]. `stage1_e_percent` is E over the readings of stage 1, `_low` and
/// `_high` are the ends of an interval of 95 %, `rms_percent` is sqrt(E), and `warnings` the kinds of
/// warnings, separated by semicolons. A value that does not exist is an empty cell.
pub const PARAMETER_COLUMNS: [&str; 21] = [
    "file",
    "wavelength_um",
    "n",
    "k2",
    "kd",
    "k1",
    "e_percent",
    "stage1_k2",
    "stage1_kd",
    "stage1_k1",
    "stage1_e_percent",
    "status",
    "k2_low",
    "k2_high",
    "kd_low",
    "kd_high",
    "k1_low",
    "k1_high",
    "rms_percent",
    "quality",
    "warnings",
];

/// The columns of [`write_models`]. n is the fitted refractive index if the model fits it, p the
/// exponent of the facet distribution; the columns after it are those of [`PARAMETER_COLUMNS`].
pub const MODEL_COLUMNS: [&str; 27] = [
    "file",
    "wavelength_um",
    "n",
    "model",
    "k2",
    "kd",
    "k1",
    "e_percent",
    "stage1_k2",
    "stage1_kd",
    "stage1_k1",
    "stage1_e_percent",
    "status",
    "p",
    "k2_low",
    "k2_high",
    "kd_low",
    "kd_high",
    "k1_low",
    "k1_high",
    "n_low",
    "n_high",
    "p_low",
    "p_high",
    "rms_percent",
    "quality",
    "warnings",
];

/// Writes the parameters of fits, one line for each fit. The columns are [`PARAMETER_COLUMNS`].
///
/// # Errors
///
/// The writer fails.
pub fn write_parameters(reports: &[Report], writer: impl io::Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(PARAMETER_COLUMNS)?;
    for report in reports {
        let mut record = record(report);
        record.extend(inferred(report, &Parameter::ALL[..3]));
        csv.write_record(record)?;
    }
    csv.flush()
}

/// Writes the parameters and the models of fits, one line for each fit. The columns are
/// [`MODEL_COLUMNS`].
///
/// # Errors
///
/// The writer fails.
pub fn write_models(reports: &[Report], writer: impl io::Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(MODEL_COLUMNS)?;
    for report in reports {
        let fit = report.fit.as_ref();
        let mut record = record(report);
        record.insert(3, report.model.to_string());
        record.push(number(fit.map(|fit| fit.p)));
        record.extend(inferred(report, &Parameter::ALL));
        csv.write_record(record)?;
    }
    csv.flush()
}

/// A number, or nothing.
fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, exact)
}

/// The values of [`PARAMETER_COLUMNS`].
fn record(report: &Report) -> Vec<String> {
    let fit = report.fit.as_ref();
    let stage1 = fit.and_then(|fit| fit.stage1);
    let parameters =
        |at: Option<Parameters>| [at.map(|p| p.k2), at.map(|p| p.kd), at.map(|p| p.k1)].map(number);
    let mut record = vec![
        report.file.clone(),
        number(report.wavelength_um),
        number(fit.map(|fit| fit.n)),
    ];
    record.extend(parameters(fit.map(|fit| fit.parameters)));
    record.push(number(fit.map(|fit| fit.e_percent)));
    record.extend(parameters(
        stage1.map(|stage| stage.parameters.parameters()),
    ));
    record.push(number(stage1.map(|stage| stage.e_percent.own)));
    record.push(report.status());
    record
}

/// The intervals of some parameters, the error, and the warnings.
fn inferred(report: &Report, parameters: &[Parameter]) -> Vec<String> {
    let mut cells = Vec::new();
    for &parameter in parameters {
        let uncertainty = report.uncertainty.as_ref();
        let estimate = uncertainty.and_then(|uncertainty| uncertainty.estimate(parameter));
        let interval = estimate.map(Estimate::interval_95);
        cells.push(number(interval.and_then(|interval| interval.from)));
        cells.push(number(interval.and_then(|interval| interval.to)));
    }
    let rms = report.fit.as_ref().map(Fit::rms_percent);
    cells.push(number(rms));
    let quality = report.fit.as_ref().map(Quality::of);
    cells.push(quality.map_or("", Quality::word).to_owned());
    let kinds: Vec<&str> = report.warnings.iter().map(Warning::kind).collect();
    cells.push(kinds.join(";"));
    cells
}

/// The columns of [`write_curves`].
pub const CURVE_COLUMNS: [&str; 10] = [
    "file",
    "wavelength_um",
    "psi_deg",
    "theta_deg",
    "phi_deg",
    "measured_per_sr",
    "sigma_per_sr",
    "initial_per_sr",
    "stage1_per_sr",
    "fit_per_sr",
];

/// The columns of [`write_theory`].
pub const THEORY_COLUMNS: [&str; 8] = [
    "file",
    "wavelength_um",
    "psi_deg",
    "theta_deg",
    "phi_deg",
    "measured_per_sr",
    "sigma_per_sr",
    "theory_per_sr",
];

/// Writes the readings, one incidence after the other, with the BRDFs of the initial values, of
/// stage 1 and of the fit at the angles of each. The columns are [`CURVE_COLUMNS`].
///
/// Angles are in the convention of the model. The readings of a table are read again.
///
/// # Errors
///
/// The writer fails, or the readings of a table cannot be read again.
pub fn write_curves<'a>(
    fits: impl Iterator<Item = (&'a LazyScan, &'a Fit)>,
    writer: impl io::Write,
) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(CURVE_COLUMNS)?;
    for (scan, fit) in fits {
        let measurements = scan.measurements().map_err(io::Error::other)?;
        write_curves_of(&measurements, fit, &mut csv)?;
    }
    csv.flush()
}

/// Writes the readings, one incidence after the other, with a BRDF at the angles of each. The columns
/// are [`THEORY_COLUMNS`].
///
/// Angles are in the convention of the model.
///
/// # Errors
///
/// The writer fails.
pub fn write_theory(
    measurements: &Measurements,
    brdf: &AnyBrdf,
    writer: impl io::Write,
) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(THEORY_COLUMNS)?;
    write_readings(measurements, &[Some(*brdf)], &mut csv)?;
    csv.flush()
}

fn write_curves_of(
    measurements: &Measurements,
    fit: &Fit,
    csv: &mut csv::Writer<impl io::Write>,
) -> io::Result<()> {
    let model =
        |at: ModelParameters| AnyBrdf::new(fit.model().family(), &at).map_err(io::Error::other);
    let initial = model(ModelParameters {
        p: 1.0,
        ..ModelParameters::three(fit.initial.parameters, fit.n)
    })?;
    let stage1 = fit
        .stage1
        .map(|stage| model(stage.parameters))
        .transpose()?;
    let last = model(fit.at())?;
    write_readings(measurements, &[Some(initial), stage1, Some(last)], csv)
}

/// Writes the readings, one incidence after the other and in ascending order of phi and theta, each
/// with the values of some BRDFs.
fn write_readings(
    measurements: &Measurements,
    theories: &[Option<AnyBrdf>],
    csv: &mut csv::Writer<impl io::Write>,
) -> io::Result<()> {
    let degrees = |angle: f64| exact(in_degrees(angle));
    let readings = measurements.readings();
    for incidence in measurements.incidences() {
        let mut order = incidence.readings;
        let key = |i: usize| (readings[i].phi, readings[i].theta);
        order.sort_by(|&a, &b| {
            key(a)
                .partial_cmp(&key(b))
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        for reading in order.into_iter().map(|i| &readings[i]) {
            let geometry = reading.geometry().map_err(io::Error::other)?;
            let mut record = vec![
                measurements.source.clone(),
                number(reading.wavelength_um),
                degrees(reading.psi),
                degrees(reading.theta),
                degrees(reading.phi),
                exact(reading.brdf),
                number(reading.sigma),
            ];
            let values = theories
                .iter()
                .map(|brdf| brdf.map(|brdf| brdf.value(&geometry)));
            record.extend(values.map(number));
            csv.write_record(record)?;
        }
    }
    Ok(())
}
