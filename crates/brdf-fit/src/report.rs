//! What a person or a program reads after the fits: the table, the JSON, the parameters and the
//! curves as CSV.

use std::fmt::Write as _;
use std::io;

use brdf_core::{AnyBrdf, Geometry, ModelParameters, Parameters};
use serde::{Deserialize, Serialize};

use crate::measurement::{Measurements, Metadata};
use crate::model::K1_RANGE;
use crate::solver::Ending;
use crate::stages::{FORMAT_VERSION, Fit, FitError, FitOptions, OwnAndAll, Stage, fit};
use crate::warning::{Warning, warnings};
use crate::words::{counted, in_degrees};

/// The result of one wavelength of one file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The file.
    pub file: String,
    /// What the file says of itself.
    pub metadata: Metadata,
    /// Columns of the file that were not used.
    pub ignored_columns: Vec<String>,
    /// Wavelength in micrometres, where the file states one.
    pub wavelength_um: Option<f64>,
    /// How many readings there are.
    pub readings: usize,
    /// The fit, where there is one.
    pub fit: Option<Fit>,
    /// Why there is none.
    pub error: Option<String>,
    /// What to know before trusting it.
    pub warnings: Vec<Warning>,
}

/// The JSON document of a run.
#[derive(Debug, Serialize, Deserialize)]
pub struct Document {
    /// [`FORMAT_VERSION`] of the program that wrote it.
    pub format_version: u32,
    /// One report for each file and wavelength.
    pub reports: Vec<Report>,
}

impl Document {
    /// A document of this version.
    pub fn new(reports: Vec<Report>) -> Self {
        Self {
            format_version: FORMAT_VERSION,
            reports,
        }
    }
}

impl Report {
    /// Fits one wavelength and reports on it. The error is returned beside the report, which holds
    /// its words.
    pub fn of(measurements: &Measurements, options: &FitOptions) -> (Self, Option<FitError>) {
        let (fit, error) = match fit(measurements, options) {
            Ok(fit) => (Some(fit), None),
            Err(error) => (None, Some(error)),
        };
        let report = Self {
            file: measurements.source.clone(),
            metadata: measurements.metadata.clone(),
            ignored_columns: measurements.ignored_columns.clone(),
            wavelength_um: measurements.wavelengths().first().copied().flatten(),
            readings: measurements.readings().len(),
            warnings: fit
                .as_ref()
                .map_or_else(Vec::new, |fit| warnings(measurements, fit)),
            fit,
            error: error.as_ref().map(ToString::to_string),
        };
        (report, error)
    }

    /// The table that a person reads.
    pub fn text(&self) -> String {
        let mut text = self.heading();
        if let Some(fit) = &self.fit {
            text += &stage_table(fit);
            text += &incidence_table(fit);
            text += &global_check_line(fit);
        } else {
            let error = self.error.as_deref().unwrap_or("no fit");
            let _ = writeln!(text, "  error: {error}");
        }
        for warning in &self.warnings {
            let _ = writeln!(text, "  warning: {warning}");
        }
        if !self.ignored_columns.is_empty() {
            let _ = writeln!(
                text,
                "  columns not used: {}",
                self.ignored_columns.join(", ")
            );
        }
        text
    }

    fn heading(&self) -> String {
        let mut text = self.file.clone();
        if let Some(sample) = self.metadata.get("sample") {
            let _ = write!(text, ": {sample}");
        }
        text.push('\n');
        let wavelength = self
            .wavelength_um
            .map_or_else(|| "wavelength not stated".to_owned(), |w| format!("{w} um"));
        let _ = write!(text, "  {wavelength}, ");
        if let Some(fit) = &self.fit {
            let _ = write!(text, "n = {}, ", fit.n);
        }
        let _ = writeln!(text, "{}", counted(self.readings, "reading"));
        text
    }

    /// The line of this fit in the CSV for scripts, in the order of [`PARAMETER_COLUMNS`].
    fn parameter_record(&self) -> Vec<String> {
        let number = |value: Option<f64>| value.map_or_else(String::new, |v| v.to_string());
        let fit = self.fit.as_ref();
        let stage1 = fit.and_then(|fit| fit.stage1);
        let parameters = fit.map(|fit| fit.parameters);
        let of = |parameters: Option<Parameters>| {
            [
                parameters.map(|p| p.k2),
                parameters.map(|p| p.kd),
                parameters.map(|p| p.k1),
            ]
            .map(number)
        };
        let mut record = vec![
            self.file.clone(),
            number(self.wavelength_um),
            number(fit.map(|fit| fit.n)),
        ];
        record.extend(of(parameters));
        record.push(number(fit.map(|fit| fit.e_percent)));
        record.extend(of(stage1.map(|stage| stage.parameters.parameters())));
        record.push(number(stage1.map(|stage| stage.e_percent.own)));
        record.push(self.status());
        record
    }

    /// One word on how the fit ended: `ok`; `global`, where the global check took a lower minimum;
    /// `iteration-limit`; or `failed: ` and why.
    pub fn status(&self) -> String {
        let Some(fit) = &self.fit else {
            return format!("failed: {}", self.error.as_deref().unwrap_or("no fit"));
        };
        let taken = fit
            .global_check
            .as_ref()
            .is_some_and(|check| check.lower_minimum_taken);
        match fit.stage2.ending {
            _ if taken => "global",
            Ending::IterationLimit => "iteration-limit",
            _ => "ok",
        }
        .to_owned()
    }
}

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

/// Writes the CSV for scripts: one line a fit.
pub fn write_parameters(reports: &[Report], writer: impl io::Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(PARAMETER_COLUMNS)?;
    for report in reports {
        csv.write_record(report.parameter_record())?;
    }
    csv.flush()
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

/// Writes theory and experiment side by side, incidence by incidence: f_r as measured, of the
/// initial values, of stage 1 and of the fit, at every reading, in the model's convention.
pub fn write_curves<'a>(
    fits: impl Iterator<Item = (&'a Measurements, &'a Fit)>,
    writer: impl io::Write,
) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(CURVE_COLUMNS)?;
    for (measurements, fit) in fits {
        write_curves_of(measurements, fit, &mut csv)?;
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
    let number = |value: Option<f64>| value.map_or_else(String::new, |v| v.to_string());
    let degrees = |angle: f64| in_degrees(angle).to_string();
    for incidence in measurements.incidences() {
        let mut order = incidence.readings;
        let readings = measurements.readings();
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
            let theory = |brdf: &AnyBrdf, at: &Geometry| brdf.value(at).to_string();
            csv.write_record([
                measurements.source.clone(),
                number(fit.wavelength_um),
                degrees(reading.psi),
                degrees(reading.theta),
                degrees(reading.phi),
                reading.brdf.to_string(),
                number(reading.sigma),
                theory(&initial, &geometry),
                stage1
                    .as_ref()
                    .map_or_else(String::new, |brdf| theory(brdf, &geometry)),
                theory(&last, &geometry),
            ])?;
        }
    }
    Ok(())
}

fn stage_table(fit: &Fit) -> String {
    let mut text = format!(
        "\n  {:<9}{:>13}{:>13}{:>13}{:>13}{:>13}{:>10}{:>7}{:>7}{:>9}  ended by\n",
        "", "k2", "kD", "k1", "E own %", "E all %", "readings", "iter.", "eval.", "time us"
    );
    let mut line = |name: &str, p: &Parameters, e: OwnAndAll, rest: &str| {
        let row = format!(
            "  {name:<9}{:>13}{:>13}{:>13}{:>13}{:>13}{rest}",
            digits(p.k2),
            digits(p.kd),
            digits(p.k1),
            digits(e.own),
            digits(e.all)
        );
        let _ = writeln!(text, "{}", row.trim_end());
    };
    let work = |stage: &Stage| {
        format!(
            "{:>10}{:>7}{:>7}{:>9.1}  {}: {}",
            stage.readings,
            stage.iterations,
            stage.evaluations,
            1e6 * stage.seconds,
            stage.method.short_name(),
            stage.ending
        )
    };
    line(
        "initial",
        &fit.initial.parameters,
        fit.initial_e_percent,
        "",
    );
    if let Some(stage) = &fit.stage1 {
        line(
            "stage 1",
            &stage.parameters.parameters(),
            stage.e_percent,
            &work(stage),
        );
    }
    line(
        "stage 2",
        &fit.stage2.parameters.parameters(),
        fit.stage2.e_percent,
        &work(&fit.stage2),
    );
    if fit.at() != fit.stage2.parameters {
        let both = OwnAndAll {
            own: fit.e_percent,
            all: fit.e_percent,
        };
        line("result", &fit.parameters, both, "");
    }
    if let Some(reason) = &fit.stage1_left_out {
        let _ = writeln!(text, "  stage 1 left out: {reason}");
    } else if fit.stage1.is_some() {
        let limit = in_degrees(fit.options.stage1_limit);
        let _ = writeln!(text, "  stage 1: psi <= {limit} deg");
    }
    let _ = writeln!(text, "  initial values: {}", fit.initial);
    let weights = fit.options.weights.to_string();
    if !weights.is_empty() {
        let _ = writeln!(text, "  readings weighted by {weights}");
    }
    let Parameters { k2, kd, k1 } = fit.parameters;
    for (on_bound, name) in [
        (k2 == 0.0, "k2 = 0"),
        (kd == 0.0, "kD = 0"),
        (
            k2 > 0.0 && k1 == K1_RANGE.0,
            "k1 = 1e-6, the smallest that is searched",
        ),
        (
            k2 > 0.0 && k1 == K1_RANGE.1,
            "k1 = 1e3, the largest that is searched",
        ),
    ] {
        if on_bound {
            let _ = writeln!(text, "  on its bound: {name}");
        }
    }
    text
}

fn incidence_table(fit: &Fit) -> String {
    const A_ROW: usize = 9;
    let mut text = String::new();
    for chunk in fit.incidences.chunks(A_ROW) {
        let row = |name: &str, cell: &dyn Fn(usize) -> String| {
            let mut row = format!("  {name:<9}");
            for i in 0..chunk.len() {
                let _ = write!(row, "{:>13}", cell(i));
            }
            row + "
"
        };
        text.push('\n');
        text += &row("psi deg", &|i| chunk[i].psi_deg.to_string());
        text += &row("readings", &|i| chunk[i].readings.to_string());
        text += &row("E %", &|i| {
            chunk[i].e_percent.map_or_else(|| "-".to_owned(), digits)
        });
    }
    text.push('\n');
    text
}

fn global_check_line(fit: &Fit) -> String {
    match &fit.global_check {
        None => "  global check: left out\n".to_owned(),
        Some(check) if check.lower_minimum_taken => format!(
            "  global check: a lower minimum exists and was taken (E {} % instead of {} %)\n",
            digits(fit.e_percent),
            digits(check.stage2_e_percent)
        ),
        Some(check) => format!(
            "  global check: no lower minimum for k1 from {:.0e} to {:.0e} ({} widths)\n",
            check
                .profile
                .first()
                .map_or(0.0, |point| point.parameters.k1),
            check
                .profile
                .last()
                .map_or(0.0, |point| point.parameters.k1),
            check.profile.len()
        ),
    }
}

/// Six significant digits, in whichever notation is short.
fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let scientific = format!("{value:.5e}");
    let exponent = scientific
        .split_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok());
    match exponent {
        Some(exponent @ -4..=5) => {
            let decimals = usize::try_from(5_i32 - exponent).unwrap_or(0);
            format!("{value:.decimals$}")
        }
        _ => scientific,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_six_significant_digits() {
        assert_eq!(digits(0.0), "0");
        assert_eq!(digits(0.022_859_766), "0.0228598");
        assert_eq!(digits(301.502_668), "301.503");
        assert_eq!(digits(-2.839_658), "-2.83966");
        assert_eq!(digits(123_456_789.0), "1.23457e8");
        assert_eq!(digits(1.5e-9), "1.50000e-9");
    }
}
