//! A plan and a review as text.

use std::fmt::Write as _;

use brdf_core::scene::Azimuth;

use crate::format::{counted, digits, shortest, two_digits};
use crate::planning::{
    Advice, Gap, MeasurementPlan, PlanOptions, PlannedReading, Prediction, REVIEW_WITHIN, Review,
    Setting, error_percent as percent, error_percent_beside, rounded_deg,
};
use crate::report::{Column, Row, Table};
use crate::scan::Measurements;

/// The directions of the scene and the tolerance.
fn scene(options: &PlanOptions) -> String {
    let range = |(from, to): (f64, f64)| {
        if from == to {
            return format!("{} deg", rounded_deg(from));
        }
        format!("{} ... {} deg", rounded_deg(from), rounded_deg(to))
    };
    let domain = &options.scene;
    let azimuth = match domain.azimuth() {
        Azimuth::InPlane => "in the plane of incidence",
        Azimuth::Full => "all azimuths",
    };
    format!(
        "psi {}, theta {}, {azimuth}; tolerance {} %",
        range(domain.incidence()),
        range(domain.view()),
        // Without the digits of rounding.
        shortest((1e11 * options.tolerance).round() / 1e9)
    )
}

/// How to look at a scan that the model does not follow.
const LOOK: &str = "brdf fit FILE --model three+n --weights relative --compare --plot FOLDER";

/// What is known and what is advised.
pub(super) fn summary(plan: &MeasurementPlan, name: Option<&str>, options: &PlanOptions) -> String {
    let mut text = String::new();
    line(&mut text, "scene", &scene(options));
    line(&mut text, "so far", &so_far(plan, name, options));
    // Of a model that fails, no prediction has a meaning.
    if !matches!(plan.advice, Advice::Fails { .. }) {
        line(&mut text, "error", &errors_now(plan, options));
    }
    line(&mut text, "advice", &advice(plan, options));
    text
}

/// The planned readings, if any.
pub(super) fn list(plan: &MeasurementPlan, options: &PlanOptions) -> String {
    if plan.readings.is_empty() {
        return String::new();
    }
    let table = table(&plan.readings, &plan.now, options);
    format!(
        "\n{}\
         angles in degrees, theta positive on the side of the source\n\
         error: predicted rms error of f_r over the scene after the readings up to this one; k2, kD, k1, n - 1: their\n\
         predicted standard errors; rank: the order in which the readings were chosen\n\
         then: brdf fit FILE --model three+n --weights relative\n",
        table.text()
    )
}

/// An error of ln f_r, with digits that tell it from the tolerance.
fn beside(error: f64, options: &PlanOptions) -> String {
    error_percent_beside(error, options.tolerance.ln_1p())
}

fn line(text: &mut String, label: &str, content: &str) {
    let _ = writeln!(text, "{label:<8}  {content}");
}

fn so_far(plan: &MeasurementPlan, name: Option<&str>, options: &PlanOptions) -> String {
    let at = &plan.parameters;
    let [k2, kd, k1, n] = [at.k2, at.kd, at.k1, at.n].map(two_digits);
    let parameters = format!("k2 {k2}, kD {kd}, k1 {k1}, n {n}");
    let Some(name) = name else {
        return format!(
            "no reading; likely for the material \"{}\": {parameters}",
            options.material
        );
    };
    let mut text = format!(
        "{name}, {}; most probable: {parameters}",
        counted(plan.used, "reading")
    );
    if plan.left_out > 0 {
        let _ = write!(
            text,
            "; {} not above zero without influence",
            counted(plan.left_out, "reading")
        );
    }
    text
}

fn errors_now(plan: &MeasurementPlan, options: &PlanOptions) -> String {
    let mut text = format!(
        "predicted {} rms over the scene",
        beside(plan.now.error, options)
    );
    if let Some(error) = plan.cross_validated {
        let _ = write!(
            text,
            ", {} for each reading from the others",
            beside(error, options)
        );
    }
    let _ = write!(
        text,
        "; the lowest found with further readings: {}",
        beside(plan.limit, options)
    );
    text
}

fn advice(plan: &MeasurementPlan, options: &PlanOptions) -> String {
    if let Advice::Fails { .. } = plan.advice {
        return format!("{}: {LOOK}", plan.advice);
    }
    if plan.advice != Advice::Continue {
        return plan.advice.to_string();
    }
    let last = plan.readings.last();
    let seconds = last.map_or(0.0, |reading| reading.seconds);
    let error = last.map_or(plan.now.error, |reading| reading.prediction.error);
    let reached = if error <= options.tolerance.ln_1p() {
        ""
    } else {
        ", still above the tolerance: plan again with their values"
    };
    format!(
        "take {} in {}: predicted error {}{reached}",
        counted(plan.readings.len(), "reading"),
        duration(seconds),
        beside(error, options)
    )
}

/// A time in the two units that tell readings apart: minutes and seconds, hours and minutes, days and hours.
fn duration(seconds: f64) -> String {
    let in_units = |unit: f64, names: [&str; 2], parts: f64| {
        let count = (seconds / unit * parts).round();
        let (whole, rest) = ((count / parts).floor(), count % parts);
        match (whole, rest) {
            (0.0, _) => format!("{rest} {}", names[1]),
            (_, 0.0) => format!("{whole} {}", names[0]),
            _ => format!("{whole} {} {rest} {}", names[0], names[1]),
        }
    };
    match seconds {
        ..59.5 => format!("{} s", two_digits(seconds)),
        ..3599.5 => in_units(60.0, ["min", "s"], 60.0),
        ..172_770.0 => in_units(3600.0, ["h", "min"], 60.0),
        ..86_400_000.0 => in_units(86400.0, ["d", "h"], 24.0),
        _ => format!("{} d", digits(seconds / 86400.0)),
    }
}

fn table(readings: &[PlannedReading], now: &Prediction, options: &PlanOptions) -> Table {
    let columns = [
        Column::right("psi", 5),
        Column::right("theta", 6),
        Column::right("phi", 5),
        Column::right("rank", 5),
        Column::right("error", 7),
        Column::right("k2", 7),
        Column::right("kD", 7),
        Column::right("k1", 7),
        Column::right("n - 1", 7),
        Column::right("after", 12),
    ];
    let before = [String::new(), String::new(), String::new(), String::new()];
    let before = before
        .into_iter()
        .chain(predicted(now, options))
        .chain(["0 s".to_owned()]);
    let rows = readings.iter().map(|reading| {
        let Setting { psi, theta, phi } = reading.setting;
        let angles = [psi, theta, phi].map(rounded_deg);
        let cells = angles.into_iter().chain([reading.rank.to_string()]);
        let cells = cells.chain(predicted(&reading.prediction, options));
        Row::new(cells.chain([duration(reading.seconds)]))
    });
    Table {
        caption: String::new(),
        columns: columns.into(),
        rows: std::iter::once(Row::new(before)).chain(rows).collect(),
        notes: Vec::new(),
    }
}

fn predicted(prediction: &Prediction, options: &PlanOptions) -> impl Iterator<Item = String> {
    let error = beside(prediction.error, options);
    std::iter::once(error).chain(prediction.deviations.map(percent))
}

/// What a scan had and lacks.
pub(super) fn review(
    review: &Review,
    scan: &Measurements,
    name: &str,
    options: &PlanOptions,
) -> String {
    let mut text = String::new();
    let settings: Vec<Setting> = scan.readings().iter().map(Setting::from).collect();
    let instrument = &options.instrument;
    let time = |settings: &[Setting]| {
        let order = instrument.order(settings);
        let driven: Vec<Setting> = order.iter().map(|&i| settings[i]).collect();
        duration(instrument.elapsed(&driven).last().copied().unwrap_or(0.0))
    };
    let readings = counted(review.used, "reading");
    line(
        &mut text,
        "scan",
        &format!("{name}, {readings}, {}", time(&settings)),
    );
    if review.left_out > 0 {
        let left_out = counted(review.left_out, "reading");
        line(
            &mut text,
            "",
            &format!("{left_out} not above zero without influence"),
        );
    }
    let error = percent(review.error);
    line(
        &mut text,
        "error",
        &format!("{error} rms of theory/measured over them (three+n, relative weights)"),
    );
    for within in REVIEW_WITHIN {
        let sentence = match review.needed(within) {
            Some(count) => {
                let steps = &review.steps[..count];
                let chosen: Vec<Setting> =
                    steps.iter().map(|step| settings[step.reading]).collect();
                format!(
                    "{} in {} stay within {within} times that error",
                    counted(count, "reading"),
                    time(&chosen)
                )
            }
            None => format!(
                "more than {}, to stay within {within} times that error",
                counted(review.steps.len(), "reading")
            ),
        };
        line(&mut text, "needed", &sentence);
    }
    for gap in &review.gaps {
        line(&mut text, "missing", &gap_text(gap));
    }
    if review.gaps.is_empty() {
        line(&mut text, "missing", "nothing of the scene");
    }
    let _ = write!(text, "\n{}", order_table(review, &settings).text());
    text.push_str(
        "error: rms of theory/measured over all readings, of the fit to those up to this one\n",
    );
    text
}

fn gap_text(gap: &Gap) -> String {
    match gap {
        Gap::Incidence { scan, scene } => format!(
            "incidences beyond {} deg: the scene has them up to {} deg",
            rounded_deg(*scan),
            rounded_deg(*scene)
        ),
        Gap::View { scan, scene } => format!(
            "views beyond {} deg: the scene has them up to {} deg",
            rounded_deg(*scan),
            rounded_deg(*scene)
        ),
        Gap::Region(region) => format!("a reading at {region}"),
    }
}

/// The readings that were needed for the smallest multiple, in the order in which they were chosen.
fn order_table(review: &Review, settings: &[Setting]) -> Table {
    let count = review
        .needed(REVIEW_WITHIN[0])
        .unwrap_or(review.steps.len());
    let rows = review.steps[..count].iter().enumerate().map(|(i, step)| {
        let Setting { psi, theta, phi } = settings[step.reading];
        let [psi, theta, phi] = [psi, theta, phi].map(rounded_deg);
        let error = step.error.map_or_else(|| "-".to_owned(), percent);
        Row::new([(i + 1).to_string(), psi, theta, phi, error])
    });
    Table {
        caption: String::new(),
        columns: vec![
            Column::right("", 3),
            Column::right("psi", 8),
            Column::right("theta", 8),
            Column::right("phi", 8),
            Column::right("error", 8),
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_the_units_that_tell_readings_apart() {
        for (seconds, text) in [
            (0.25, "0.25 s"),
            (30.0, "30 s"),
            (59.7, "1 min"),
            (150.0, "2 min 30 s"),
            (180.0, "3 min"),
            (3599.9, "1 h"),
            (17_640.0, "4 h 54 min"),
            (1e6, "11 d 14 h"),
            (1e12, "1.15741e7 d"),
        ] {
            assert_eq!(duration(seconds), text, "{seconds}");
        }
    }
}
