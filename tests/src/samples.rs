//! The document with a table for every measured sample: what each model makes of it.

use std::fmt::Write as _;
use std::path::Path;

use brdf_fit::inference::{Assessment, Candidate, Estimate, Knowledge};
use brdf_fit::report::{Depth, Report};
use brdf_fit::{FitOptions, Measurements, RefractiveIndex};
use rayon::prelude::*;

use crate::expected_optima;

/// Of a sample with more wavelengths than this, so many are shown, evenly.
const MOST_WAVELENGTHS: usize = 5;

const HEADING: &str = "\
# What the models make of every measured sample

Made by `cargo run --release -p brdf-tests --bin make-samples`, from the measured samples that the
optima of the tests were computed for, which are not all part of this project; n = 1.5 where n is
not fitted. E is that of eq. (5), *predicted* that of each incidence predicted from a fit of the
others, both in percent; AICc is above the best of the table and assumes independent normal errors.
In parentheses stand 95 % profile-likelihood intervals from the residuals; \"over incidences\" is the
bootstrap. The verdict names the smallest model of the ladder (lambert ... power+n) whose prediction
errs by at most 10 % more, root mean square, than the best one; ggx and beckmann are the neighbours
that a user would otherwise take.
";

/// The document over the samples of a folder, with the files and wavelengths of its table of optima.
pub fn document(folder: &Path) -> String {
    let optima = expected_optima(&folder.join("expected_optima.csv"));
    let mut files: Vec<String> = optima.into_iter().map(|optimum| optimum.file).collect();
    files.dedup();
    let mut text = HEADING.to_owned();
    for file in files {
        let scan = Measurements::read_csv(folder.join(&file)).expect("a readable sample");
        let name = scan.metadata.get("sample").unwrap_or(&file).to_owned();
        let _ = write!(text, "\n## {name}\n\n`{file}`");
        let scans = scan.by_wavelength();
        let shown = evenly(scans.len(), MOST_WAVELENGTHS);
        if shown.len() < scans.len() {
            let _ = write!(text, ", {} of its {} wavelengths", shown.len(), scans.len());
        }
        text.push('\n');
        let tables: Vec<String> = shown.into_par_iter().map(|i| table(&scans[i])).collect();
        text.extend(tables);
    }
    text
}

/// Up to `most` indices below `count`, the first and the last among them.
fn evenly(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|i| i * (count - 1) / (most - 1)).collect()
}

fn table(scan: &Measurements) -> String {
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    let (report, _) = Report::of(scan, &options, Depth::Compared);
    let wavelength = report.wavelength_um.unwrap_or_default();
    let mut text = format!("\n### {wavelength} um, {} readings\n\n", report.readings);
    let Some(assessment) = &report.assessment else {
        let error = report.error.as_deref().unwrap_or("no fit");
        let _ = writeln!(text, "{error}");
        return text;
    };
    text += "| model | E % | predicted % | AICc | k2 | kD | k1 | n | p | energy |\n";
    text += "|---|---|---|---|---|---|---|---|---|---|\n";
    for rung in &assessment.models {
        text += &row(rung);
    }
    text.push('\n');
    text += &remarks(assessment);
    for warning in &report.warnings {
        let _ = writeln!(text, "- {warning}.");
    }
    text
}

fn row(rung: &Candidate) -> String {
    let predicted = rung
        .predicted_e_percent
        .map_or_else(|| "-".to_owned(), percent);
    let mut text = format!(
        "| {} | {} | {predicted} | {} |",
        rung.model,
        percent(rung.e_percent),
        rung.aicc_above_best
            .map_or_else(|| "-".to_owned(), |aicc| format!("{aicc:+.0}"))
    );
    for parameter in brdf_fit::model::Parameter::ALL {
        let estimate = rung.estimates.iter().find(|e| e.parameter == parameter);
        let _ = write!(text, " {} |", estimate.map_or_else(String::new, cell));
    }
    let energy = rung.violation_deg.map_or_else(
        || "kept".to_owned(),
        |psi| format!("rho > 1 from {psi:.0} deg"),
    );
    let _ = writeln!(text, " {energy} |");
    text
}

fn cell(estimate: &Estimate) -> String {
    match estimate.knowledge {
        Knowledge::NotDetermined { .. } => "open".to_owned(),
        _ => estimate.to_string(),
    }
}

fn remarks(assessment: &Assessment) -> String {
    let mut text = String::new();
    if let Some(verdict) = &assessment.verdict {
        let _ = writeln!(text, "- Verdict: {verdict}.");
    }
    let by = |e: fn(&Candidate) -> Option<f64>| {
        let rungs = assessment
            .models
            .iter()
            .filter_map(|rung| Some((rung.model, e(rung)?)));
        rungs.min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let fitted = by(|rung| (rung.model.free().len() <= 3).then_some(rung.e_percent));
    let free = by(|rung| Some(rung.e_percent));
    let predicted = by(|rung| rung.predicted_e_percent);
    for (what, best) in [
        ("Lowest E at n = 1.5", fitted),
        ("Lowest E of all", free),
        ("Best prediction of all", predicted),
    ] {
        if let Some((model, e)) = best {
            let _ = writeln!(text, "- {what}: {model}, {} %.", percent(e));
        }
    }
    let spreads: Vec<String> = assessment
        .bootstrap
        .iter()
        .map(|s| format!("{} {:.3e} ... {:.3e}", s.parameter, s.from, s.to))
        .collect();
    if !spreads.is_empty() {
        let _ = writeln!(
            text,
            "- The paper's three over incidences: {}.",
            spreads.join(", ")
        );
    }
    text
}

fn percent(value: f64) -> String {
    match value {
        v if v < 0.1 => format!("{v:.4}"),
        v if v < 1.0 => format!("{v:.3}"),
        v if v < 100.0 => format!("{v:.2}"),
        v => format!("{v:.0}"),
    }
}
