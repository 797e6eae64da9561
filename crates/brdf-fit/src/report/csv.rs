//! The parameters and the curves of fits as CSV.

use std::io;

use brdf_core::{AnyBrdf, ModelParameters, Parameters};

use super::Report;
use crate::fit::Fit;
use crate::format::in_degrees;
use crate::plot::theory_curves;
use crate::read::LazyScan;
use crate::scan::Measurements;

/// The header of the CSV for scripts. E is in percent, each over its own stage's readings.
pub const PARAMETER_COLUMNS: [&str; 12] = [
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
];

/// The header of the CSV for scripts where models are chosen or compared: n is the fitted one where
/// the model has it free, p the exponent.
pub const MODEL_COLUMNS: [&str; 14] = [
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
];

/// Writes the CSV for scripts: one line a fit.
pub fn write_parameters(reports: &[Report], writer: impl io::Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(PARAMETER_COLUMNS)?;
    for report in reports {
        csv.write_record(record(report))?;
    }
    csv.flush()
}

/// Writes the CSV for scripts with the columns `model` and `p`: one line a fit.
pub fn write_models(reports: &[Report], writer: impl io::Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(MODEL_COLUMNS)?;
    for report in reports {
        let fit = report.fit.as_ref();
        let mut record = record(report);
        record.insert(3, report.model.to_string());
        record.push(number(fit.map(|fit| fit.p)));
        csv.write_record(record)?;
    }
    csv.flush()
}

fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// The line of a fit, in the order of [`PARAMETER_COLUMNS`].
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

/// The header of the curves.
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

/// The header of the curves of one BRDF.
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

/// Writes theory and experiment side by side, incidence by incidence: f_r as measured, of the
/// initial values, of stage 1 and of the fit, at every reading, in the model's convention. The
/// readings of a table are read once more.
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

/// Writes theory and experiment side by side for one BRDF, incidence by incidence: f_r as measured
/// and of the theory at every reading, in the model's convention.
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

/// Writes the theory alone, in the plane of incidence: f_r at these incidences psi in radians, at the
/// view angles at which it is drawn; `name` says of what. The columns are those of
/// [`write_theory`].
pub fn write_theory_alone(
    name: &str,
    brdf: &AnyBrdf,
    incidences: &[f64],
    writer: impl io::Write,
) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(THEORY_COLUMNS)?;
    for curve in theory_curves(brdf, incidences) {
        for at in &curve.theory {
            let mut record = [(); 8].map(|()| String::new());
            name.clone_into(&mut record[0]);
            record[2] = in_degrees(curve.psi).to_string();
            record[3] = at.theta_deg.to_string();
            "0".clone_into(&mut record[4]);
            record[7] = at.value.to_string();
            csv.write_record(record)?;
        }
    }
    csv.flush()
}

fn write_curves_of(
    measurements: &Measurements,
    fit: &Fit,
    csv: &mut csv::Writer<impl io::Write>,
) -> io::Result<()> {
    let model = |at: ModelParameters| {
        AnyBrdf::new(fit.model().family(), &at).map_err(|error| io::Error::other(error.to_string()))
    };
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

/// The readings incidence by incidence, each with the values of some BRDFs.
fn write_readings(
    measurements: &Measurements,
    theories: &[Option<AnyBrdf>],
    csv: &mut csv::Writer<impl io::Write>,
) -> io::Result<()> {
    let degrees = |angle: f64| in_degrees(angle).to_string();
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
            let geometry = reading
                .geometry()
                .map_err(|error| io::Error::other(error.to_string()))?;
            let mut record = vec![
                measurements.source.clone(),
                number(reading.wavelength_um),
                degrees(reading.psi),
                degrees(reading.theta),
                degrees(reading.phi),
                reading.brdf.to_string(),
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
