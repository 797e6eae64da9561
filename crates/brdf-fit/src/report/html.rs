//! The report as one page that needs nothing else: tables and pictures, to read and to print.

use std::fmt::Write as _;

use super::Report;
use crate::fit::Fit;
use crate::format::{counted, rounded, shortest};
use crate::inference::{Assessment, Candidate, Estimate, Knowledge, Uncertainty};
use crate::model::Parameter;
use crate::plot::Figure;

const STYLE: &str = "
body { font: 15px/1.45 sans-serif; color: #222; background: #fff; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.25rem; border-bottom: 1px solid #bbb; margin-top: 2.5rem; }
h3 { font-size: 1.05rem; margin-bottom: 0.3rem; }
table { border-collapse: collapse; margin: 0.5rem 0 1rem; font-size: 0.9rem; }
th, td { padding: 0.15rem 0.7rem; text-align: right; border-bottom: 1px solid #ddd; }
th:first-child, td:first-child { text-align: left; }
.scroll { overflow-x: auto; }
.warning { border-left: 4px solid #d55e00; padding-left: 0.7rem; }
.error { border-left: 4px solid #b00020; padding-left: 0.7rem; }
figure { margin: 1.2rem 0; break-inside: avoid; } figure svg { max-width: 100%; height: auto; }
figcaption { font-size: 0.9rem; color: #444; }
nav ul { columns: 2; }
@media print { body { max-width: none; margin: 0; font-size: 11px; } h2 { break-before: page; } h2:first-of-type { break-before: auto; } }
";

/// One page for all reports, each with its figures.
pub fn html(reports: &[(&Report, &[Figure])]) -> String {
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
    for (i, (report, figures)) in reports.iter().enumerate() {
        let _ = writeln!(page, "<h2 id=\"fit-{i}\">{}</h2>", escaped(&title(report)));
        page += &section(report, figures);
    }
    page + "</body>\n</html>\n"
}

fn title(report: &Report) -> String {
    let name = report.metadata.get("sample").unwrap_or(&report.file);
    let wavelength = report
        .wavelength_um
        .map_or_else(String::new, |w| format!(", {w} um"));
    format!("{name}{wavelength}")
}

fn section(report: &Report, figures: &[Figure]) -> String {
    let mut text = format!("<p>{}: ", escaped(&report.file));
    text += &counted(report.readings, "reading");
    if let Some(fit) = &report.fit {
        let model = fit.model();
        let fitted = if fit.fits(Parameter::N) {
            " (fitted)"
        } else {
            ""
        };
        let _ = write!(
            text,
            ", model {model} ({}), n = {}{fitted}, E = {:.4} %",
            escaped(model.description()),
            shortest(fit.n),
            fit.e_percent
        );
        if let Some(scope) = fit.options.scope() {
            let _ = write!(text, "; stage 1 alone, {}", escaped(&scope));
        }
        if !fit.options.fixed.is_empty() {
            let _ = write!(text, "; fixed: {}", fit.options.fixed);
        }
    }
    text += "</p>\n";
    if let Some(error) = &report.error {
        let _ = writeln!(text, "<p class=\"error\">{}</p>", escaped(error));
    }
    for warning in &report.warnings {
        let warning = escaped(&warning.to_string());
        let _ = writeln!(text, "<p class=\"warning\">{warning}</p>");
    }
    if let Some(fit) = &report.fit {
        text += &stages(fit);
        if let Some(uncertainty) = &report.uncertainty {
            text += &parameters(uncertainty, report.assessment.as_ref());
        }
        text += &incidences(fit, report.assessment.as_ref());
    }
    if let Some(assessment) = &report.assessment {
        text += &models(assessment);
        text += &physics(assessment);
    }
    for figure in figures {
        // Without its XML declaration a picture is a part of the page.
        let svg = figure
            .svg
            .find("<svg")
            .map_or("", |start| &figure.svg[start..]);
        let caption = escaped(&figure.caption);
        let _ = writeln!(
            text,
            "<figure>{svg}<figcaption>{caption}</figcaption></figure>"
        );
    }
    text
}

/// A table of text cells; the first column is the name of the row.
fn table(caption: &str, heading: &[&str], rows: &[Vec<String>]) -> String {
    let mut text = format!(
        "<h3>{}</h3>\n<div class=\"scroll\"><table>\n<tr>",
        escaped(caption)
    );
    for cell in heading {
        let _ = write!(text, "<th>{}</th>", escaped(cell));
    }
    text += "</tr>\n";
    for row in rows {
        text += "<tr>";
        for cell in row {
            let _ = write!(text, "<td>{}</td>", escaped(cell));
        }
        text += "</tr>\n";
    }
    text + "</table></div>\n"
}

fn stages(fit: &Fit) -> String {
    let initial = &fit.initial.parameters;
    let number = |value: f64| format!("{value:.6}");
    let row = |name: &str, [k2, kd, k1]: [f64; 3], own: f64, all: f64, readings: String| {
        vec![
            name.to_owned(),
            number(k2),
            number(kd),
            number(k1),
            number(own),
            number(all),
            readings,
        ]
    };
    let mut rows = vec![row(
        "initial values",
        [initial.k2, initial.kd, initial.k1],
        fit.initial_e_percent.own,
        fit.initial_e_percent.all,
        String::new(),
    )];
    let done = [("stage 1", fit.stage1), ("stage 2", fit.stage2)];
    for (name, stage) in done
        .into_iter()
        .filter_map(|(name, stage)| Some((name, stage?)))
    {
        let at = stage.parameters;
        let e = stage.e_percent;
        let readings = stage.readings.to_string();
        rows.push(row(name, [at.k2, at.kd, at.k1], e.own, e.all, readings));
    }
    let heading = ["", "k2", "kD", "k1", "E own %", "E all %", "readings"];
    table("The two stages", &heading, &rows)
}

fn parameters(uncertainty: &Uncertainty, assessment: Option<&Assessment>) -> String {
    let row = |estimate: &Estimate| {
        let over = assessment
            .and_then(|a| {
                a.bootstrap
                    .iter()
                    .find(|s| s.parameter == estimate.parameter)
            })
            .map_or_else(String::new, |s| {
                let digits = |x: f64| rounded(x, s.standard_deviation);
                format!("{} ... {}", digits(s.from), digits(s.to))
            });
        let (value, reason) = match &estimate.knowledge {
            Knowledge::NotDetermined { reason, .. } => (String::new(), reason.clone()),
            Knowledge::OnBound { .. } => (estimate.to_string(), "on its bound".to_owned()),
            Knowledge::Determined { .. } | Knowledge::ConstrainedByEnergy => {
                (estimate.to_string(), String::new())
            }
        };
        let remark = if value.is_empty() {
            format!("not determined: {reason}")
        } else {
            reason
        };
        vec![estimate.parameter.to_string(), value, over, remark]
    };
    let rows: Vec<Vec<String>> = uncertainty.estimates.iter().map(row).collect();
    let heading = ["", "value (95 % interval)", "95 % over incidences", ""];
    table("Parameters", &heading, &rows)
}

fn incidences(fit: &Fit, assessment: Option<&Assessment>) -> String {
    let percent = |e: Option<f64>| e.map_or_else(|| "-".to_owned(), |e| format!("{e:.3}"));
    let predicted = assessment.and_then(|a| a.cross_validation.as_ref());
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (i, incidence) in fit.incidences.iter().enumerate() {
        let foreseen = predicted.and_then(|p| p.incidences.get(i)?.e_percent);
        rows.push(vec![
            incidence.psi_deg.to_string(),
            incidence.readings.to_string(),
            percent(incidence.e_percent),
            percent(foreseen),
        ]);
    }
    rows.push(vec![
        "all".to_owned(),
        fit.readings.to_string(),
        percent(Some(fit.e_percent)),
        percent(predicted.map(|p| p.e_percent)),
    ]);
    let heading = [
        "psi deg",
        "readings",
        "E %",
        "E % predicted from the others",
    ];
    table("Incidences", &heading, &rows)
}

fn models(assessment: &Assessment) -> String {
    let row = |rung: &Candidate| {
        let mut row = vec![
            rung.model.to_string(),
            format!("{:.3}", rung.e_percent),
            rung.predicted_e_percent
                .map_or_else(|| "-".to_owned(), |e| format!("{e:.3}")),
            rung.aicc_above_best
                .map_or_else(|| "-".to_owned(), |aicc| format!("{aicc:+.1}")),
        ];
        row.extend(Parameter::ALL.map(|parameter| {
            let estimate = rung.estimates.iter().find(|e| e.parameter == parameter);
            estimate.map_or_else(String::new, ToString::to_string)
        }));
        row.push(rung.violation_deg.map_or_else(
            || "kept".to_owned(),
            |psi| format!("rho > 1 from {psi:.0} deg"),
        ));
        row
    };
    let rows: Vec<Vec<String>> = assessment.models.iter().map(row).collect();
    let heading = [
        "model",
        "E %",
        "predicted %",
        "AICc",
        "k2",
        "kD",
        "k1",
        "n",
        "p",
        "energy",
    ];
    let mut text = table("Models (95 % intervals)", &heading, &rows);
    for missing in &assessment.left_out {
        let reason = escaped(&missing.reason);
        let _ = writeln!(text, "<p>{} was not fitted: {reason}.</p>", missing.model);
    }
    if let Some(verdict) = &assessment.verdict {
        let _ = writeln!(text, "<p>Verdict: {}.</p>", escaped(&verdict.to_string()));
    }
    text += "<p>AICc is above the best of the table and assumes independent, normal errors of equal size; the readings of a scan rarely are, so that the verdict rests on the prediction.</p>\n";
    text
}

fn physics(assessment: &Assessment) -> String {
    let physics = &assessment.physics;
    let angles: Vec<String> = physics
        .reflectance
        .iter()
        .map(|p| format!("{} deg", p.psi_deg))
        .collect();
    let mut heading = vec![""];
    heading.extend(angles.iter().map(String::as_str));
    let mut row = vec!["rho".to_owned()];
    row.extend(physics.reflectance.iter().map(|p| format!("{:.4}", p.rho)));
    let mut text = table("Directional-hemispherical reflectance", &heading, &[row]);
    text += &physics.violation_deg.map_or_else(
        || "<p>Below 1 up to 89 deg of incidence.".to_owned(),
        |psi| format!("<p class=\"warning\">Above 1 from {psi:.1} deg of incidence on."),
    );
    let _ = writeln!(
        text,
        " Facet reflectance at normal incidence: k2 implies {:.4}, the refractive index means {:.4}.</p>",
        physics.implied_facet_reflectance, physics.fresnel_reflectance
    );
    text
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Depth;
    use crate::scan::synthetic::scan;
    use crate::{FitOptions, RefractiveIndex};

    #[test]
    fn what_stands_in_a_file_is_no_markup() {
        let mut scan = scan(brdf_core::Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5);
        scan.source = "a<b>&\"c\".csv".to_owned();
        let options = FitOptions {
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            ..FitOptions::default()
        };
        let (report, _) = Report::of(&scan, &options, Depth::Assessed);
        let page = html(&[(&report, &[])]);
        assert!(page.contains("a&lt;b&gt;&amp;&quot;c&quot;.csv") && !page.contains("a<b>"));
        assert_eq!(
            page.matches("<table>").count(),
            page.matches("</table>").count()
        );
        assert!(page.contains("Verdict: three suffices"));
    }
}
