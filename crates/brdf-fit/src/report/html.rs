//! The report as one self-contained HTML page with tables and pictures, to read and to print.

use std::fmt::Write as _;

use super::run::Report;
use super::sentences::{fit_options, parameters_notes, refractive_index, verdict_sentence};
use super::table::{Column, Row, Table, escaped};
use super::{incidences, models, parameters, stages};
use crate::fit::Fit;
use crate::format::{counted, two_digits};
use crate::inference::{Assessment, Quality};

const STYLE: &str = "
body { font: 15px/1.45 sans-serif; color: #222; background: #fff; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.25rem; border-bottom: 1px solid #bbb; margin-top: 2.5rem; }
h3 { font-size: 1.05rem; margin-bottom: 0.3rem; }
table { border-collapse: collapse; margin: 0.5rem 0 1rem; font-size: 0.9rem; }
th, td { padding: 0.15rem 0.7rem; text-align: right; border-bottom: 1px solid #ddd; }
th.left, td.left { text-align: left; }
.scroll { overflow-x: auto; }
.warning { border-left: 4px solid #d55e00; padding-left: 0.7rem; }
.error { border-left: 4px solid #b00020; padding-left: 0.7rem; }
figure { margin: 1.2rem 0; break-inside: avoid; } figure svg { max-width: 100%; height: auto; }
figcaption { font-size: 0.9rem; color: #444; }
nav ul { columns: 2; }
h2, h3 { break-after: avoid; } tr { break-inside: avoid; }
dl { display: grid; grid-template-columns: max-content auto; gap: 0.2rem 1rem; font-size: 0.9rem; } dd { margin: 0; }
footer { border-top: 1px solid #bbb; margin-top: 3rem; }
@page { size: A4; margin: 14mm; }
@media print {
body { max-width: none; margin: 0; padding: 0; font-size: 10px; }
h2 { break-before: page; } h2:first-of-type { break-before: auto; }
.scroll { overflow: visible; break-inside: avoid; } table { font-size: 8px; } th, td { padding: 0.1rem 0.3rem; }
figure svg { max-height: 112mm; width: 100%; }
}
";

/// A picture of the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Picture<'a> {
    /// The picture, as an SVG document.
    pub svg: &'a str,
    /// Its caption.
    pub caption: &'a str,
}

/// One page with all reports, each with its pictures.
pub fn html(reports: &[(&Report, &[Picture<'_>])]) -> String {
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>BRDF fits</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<h1>BRDF fits</h1>\n"
    );
    if reports.len() > 1 {
        page += "<nav><ul>\n";
        for (i, (report, _)) in reports.iter().enumerate() {
            let title = escaped(&title(report));
            let _ = writeln!(page, "<li><a href=\"#fit-{i}\">{title}</a></li>");
        }
        page += "</ul></nav>\n";
    }
    for (i, (report, pictures)) in reports.iter().enumerate() {
        let _ = writeln!(page, "<h2 id=\"fit-{i}\">{}</h2>", escaped(&title(report)));
        page += &section(report, pictures);
    }
    page + &legend() + "</body>\n</html>\n"
}

/// The sample, or else the file, and the wavelength.
fn title(report: &Report) -> String {
    let name = report.metadata.get("sample").unwrap_or(&report.file);
    let wavelength = report
        .wavelength_um
        .map_or_else(String::new, |w| format!(", {w} um"));
    format!("{name}{wavelength}")
}

/// What a reader wants first: how well the model describes the sample, warnings, the verdict and the
/// pictures. The tables follow.
fn section(report: &Report, pictures: &[Picture<'_>]) -> String {
    let mut text = introduction(report);
    if let Some(error) = &report.error {
        let _ = writeln!(text, "<p class=\"error\">{}</p>", escaped(error));
    }
    if let Some(fit) = &report.fit {
        text += &quality(report, fit);
    }
    let assessment = report.assessment.as_ref();
    if let (Some(fit), Some(assessment)) = (&report.fit, assessment) {
        let verdict = escaped(&verdict_sentence(fit, assessment));
        let _ = writeln!(text, "<p><strong>Verdict:</strong> {verdict}.</p>");
    }
    for warning in &report.warnings {
        let warning = escaped(&warning.to_string());
        let _ = writeln!(text, "<p class=\"warning\">{warning}</p>");
    }
    for picture in pictures {
        // Without its XML declaration an SVG document is an element of the page.
        let start = picture.svg.find("<svg");
        let svg = start.map_or("", |start| &picture.svg[start..]);
        let caption = escaped(picture.caption);
        let _ = writeln!(
            text,
            "<figure>{svg}<figcaption>{caption}</figcaption></figure>"
        );
    }
    if let Some(uncertainty) = &report.uncertainty {
        let mut table = parameters::table(uncertainty, assessment);
        let notes = parameters_notes(uncertainty, assessment);
        table.notes = notes.iter().map(|note| sentence(note)).collect();
        text += &table.html();
    }
    if let Some(fit) = &report.fit {
        let deviations = report.deviations.as_ref();
        text += &incidences::one_below_another(fit, deviations, assessment).html();
    }
    if let Some(assessment) = assessment {
        text += &models(assessment).html();
    }
    if let Some(fit) = &report.fit {
        text += &stages::brief(fit).html();
    }
    if let Some(assessment) = assessment {
        text += &physics(assessment);
    }
    text + &readings(report)
}

/// The error of the fit in a paragraph.
fn quality(report: &Report, fit: &Fit) -> String {
    let rms = fit.rms_percent();
    let quality = Quality::of(fit);
    let mut text = format!(
        "<p><strong>{}:</strong> {quality}. The rms error is {} % of the rms of f_r cos \u{3b8} (E = {:.3} %)",
        capitalised(quality.word()),
        two_digits(rms),
        fit.e_percent
    );
    if let Some(deviations) = &report.deviations {
        let _ = write!(
            text,
            "; half of the readings are within {} %, 90 % within {} % of the measured f_r",
            two_digits(deviations.median_percent),
            two_digits(deviations.ninety_percent)
        );
    }
    text + ".</p>\n"
}

/// A clause about the intervals as a sentence.
fn sentence(clause: &str) -> String {
    match clause.strip_prefix("from ") {
        Some(errors) => format!("The intervals come from {errors}."),
        None => format!("{}.", capitalised(clause)),
    }
}

fn capitalised(word: &str) -> String {
    let mut letters = word.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}

/// What was read, and how.
fn readings(report: &Report) -> String {
    let mut text = String::new();
    for conversion in &report.conversions {
        let _ = writeln!(text, "<p>Read: {}.</p>", escaped(conversion));
    }
    if !report.ignored_columns.is_empty() {
        let columns = escaped(&report.ignored_columns.join(", "));
        let _ = writeln!(text, "<p>Columns that are not used: {columns}.</p>");
    }
    text
}

/// The symbols and terms of the page, and the program.
const LEGEND: [(&str, &str); 9] = [
    ("k2, kD", "weights of the specular and the diffuse part"),
    ("k1", "width of the facet distribution"),
    (
        "n",
        "refractive index; fitted, it stands in for what the model lacks",
    ),
    (
        "p",
        "exponent of the facet distribution, 1 in the paper's model",
    ),
    (
        "E",
        "sum of (f_r,measured - f_r,model)^2 cos^2 \u{3b8} over the sum of f_r,measured^2 cos^2 \u{3b8} (eq. 5)",
    ),
    ("rms", "sqrt(E): the rms error over the rms reading"),
    (
        "predicted rms",
        "of each incidence by a fit of E to the other incidences",
    ),
    (
        "predicts",
        "typical relative error of that, by fits of relative errors",
    ),
    (
        "95 %",
        "holds the best-fit value of ideal readings at such angles in 95 of 100 scans, if relative errors are \
         alike at all incidences and independent between them",
    ),
];

fn legend() -> String {
    let mut text = "<footer>\n<h3>Symbols</h3>\n<dl>\n".to_owned();
    for (symbol, meaning) in LEGEND {
        let _ = writeln!(text, "<dt>{symbol}</dt><dd>{meaning}</dd>");
    }
    let version = env!("CARGO_PKG_VERSION");
    let _ = writeln!(text, "</dl>\n<p>brdf {version}</p>\n</footer>");
    text
}

/// A paragraph with the file, the number of readings, the model and the options.
fn introduction(report: &Report) -> String {
    let mut text = format!("<p>{}: ", escaped(&report.file));
    text += &counted(report.readings, "reading");
    if let Some(fit) = &report.fit {
        let model = fit.model();
        let _ = write!(
            text,
            ", model {model} ({}), {}",
            escaped(model.description()),
            refractive_index(fit)
        );
        for option in fit_options(fit) {
            let _ = write!(text, "; {}", escaped(&option));
        }
    }
    text + "</p>\n"
}

fn models(assessment: &Assessment) -> Table {
    let mut table = models::model_table(assessment);
    let missing = assessment.left_out.iter();
    table.notes.extend(
        missing.map(|missing| format!("{} was not fitted: {}.", missing.model, missing.reason)),
    );
    table.notes.push(models::legend());
    table
}

fn physics(assessment: &Assessment) -> String {
    let physics = &assessment.physics;
    let mut columns = vec![Column::left("", 9)];
    let mut cells = vec!["rho".to_owned()];
    for point in &physics.reflectance {
        columns.push(Column::right(format!("{} deg", point.psi_deg), 9));
        cells.push(format!("{:.4}", point.rho));
    }
    let table = Table {
        caption: "Directional-hemispherical reflectance".to_owned(),
        columns,
        rows: vec![Row::new(cells)],
        notes: Vec::new(),
    };
    let mut text = table.html();
    text += &physics.violation_deg.map_or_else(
        || "<p>Below 1 up to 89 deg of incidence.".to_owned(),
        |psi| format!("<p class=\"warning\">Above 1 from {psi:.1} deg of incidence on."),
    );
    let _ = writeln!(
        text,
        " Facet reflectance at normal incidence: k2 implies {:.4}, the refractive index implies {:.4}.</p>",
        physics.implied_facet_reflectance, physics.fresnel_reflectance
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::FitOptions;
    use crate::report::run::Depth;
    use crate::scan::RefractiveIndex;
    use crate::scan::synthetic::scan;

    #[test]
    fn text_from_a_file_is_escaped() {
        let mut scan = scan(brdf_core::Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5);
        scan.source = "a<b>&\"c\".csv".to_owned();
        let options = FitOptions {
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            ..FitOptions::default()
        };
        let (report, _) = Report::new(&scan, &options, Depth::Assessed);
        let page = html(&[(&report, &[])]);
        assert!(page.contains("a&lt;b&gt;&amp;&quot;c&quot;.csv") && !page.contains("a<b>"));
        assert_eq!(
            page.matches("<table>").count(),
            page.matches("</table>").count()
        );
        assert!(page.contains("<strong>Verdict:</strong> three suffices"));
        assert!(page.contains("<h3>Symbols</h3>"));
    }
}
