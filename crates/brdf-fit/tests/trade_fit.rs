//! The trade-off of fitting for a measured sample: facts that do not depend on the machine, no times.

use std::path::Path;
use std::sync::LazyLock;

use brdf_fit::tradeoff::fitting::{
    Alternative, FIT_TRADEOFF_COLUMNS, FitTradeoff, Measured, Outcome, fit_tradeoff,
    write_fit_tradeoffs,
};
use brdf_fit::{FitOptions, Measurements, RefractiveIndex, fit};

fn options() -> FitOptions {
    FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    }
}

/// The readings of Z307 at 0.631 um.
fn sample() -> Measurements {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/measured");
    let scan = Measurements::read_csv(folder.join("z307_on_aluminium.csv")).unwrap();
    scan.by_wavelength().remove(0)
}

fn tradeoff() -> &'static FitTradeoff {
    static TRADEOFF: LazyLock<FitTradeoff> =
        LazyLock::new(|| fit_tradeoff(&sample(), &options()).unwrap());
    &TRADEOFF
}

fn all_measured(tradeoff: &FitTradeoff) -> impl Iterator<Item = (&Alternative, &Measured)> {
    let all = tradeoff.alternatives.iter();
    all.filter_map(|alternative| Some((alternative, alternative.measured()?)))
}

fn find<'a>(tradeoff: &'a FitTradeoff, name: &str) -> &'a Measured {
    let mut all = all_measured(tradeoff);
    all.find(|(alternative, _)| alternative.name == name)
        .unwrap()
        .1
}

#[test]
fn the_reference_is_the_fit_and_the_first_alternative() {
    let (tradeoff, fit) = (tradeoff(), fit(&sample(), &options()).unwrap());
    assert_eq!(tradeoff.reference.parameters, fit.at());
    assert_eq!(tradeoff.reference.e_percent, fit.e_percent);
    assert_eq!(
        (tradeoff.reference.readings, tradeoff.reference.incidences),
        (112, 5)
    );
    let first = &tradeoff.alternatives[0];
    assert_eq!(first.name, "LM + check");
    assert_eq!(
        (first.method.as_str(), first.stages.as_str()),
        ("levenberg-marquardt", "both")
    );
    assert_eq!(first.measured().unwrap().parameters, fit.at());
}

#[test]
fn levenberg_marquardt_in_both_stages_is_not_shifted() {
    let tradeoff = tradeoff();
    for name in ["LM + check", "LM"] {
        for of in &find(tradeoff, name).shift_in_sigma {
            assert_eq!(of.value, Some(0.0), "{name}, {}", of.parameter);
        }
    }
    for name in ["LM, stage 2 only", "NM", "NM, then LM", "profile, refined"] {
        for of in &find(tradeoff, name).shift_in_sigma {
            assert!(of.value.unwrap().abs() < 1e-3, "{name}, {of:?}");
        }
    }
}

#[test]
fn every_alternative_is_compared_with_the_best_over_all_readings() {
    let tradeoff = tradeoff();
    for (alternative, measured) in all_measured(tradeoff) {
        let name = &alternative.name;
        assert!(measured.excess_e >= 0.0, "{name}");
        let ratio = measured.e_percent / tradeoff.reference.e_percent - 1.0;
        assert!((ratio - measured.excess_e).abs() < 2e-9, "{name}: {ratio}");
    }
}

#[test]
fn fewer_readings_cost_accuracy_and_stage_1_alone_is_a_fit_of_its_readings() {
    let tradeoff = tradeoff();
    let excess = |name: &str| find(tradeoff, name).excess_e;
    assert!(excess("every 2nd reading") < excess("every 4th reading"));
    assert!(excess("every 4th reading") < excess("every 8th reading"));
    // In this scan the incidences up to 60 deg are all except the largest.
    let stage1 = find(tradeoff, "LM, stage 1 only").e_percent;
    let smaller = find(tradeoff, "without 70 deg").e_percent;
    assert!((stage1 / smaller - 1.0).abs() < 1e-9);
    let limited = find(tradeoff, "1 iteration");
    assert!(!limited.converged && limited.excess_e > 0.0);
}

#[test]
fn the_pareto_front_consists_of_the_alternatives_that_none_beats() {
    let tradeoff = tradeoff();
    let all: Vec<&Measured> = all_measured(tradeoff)
        .map(|(_, measured)| measured)
        .collect();
    for one in &all {
        let beaten = all.iter().any(|other| {
            other.seconds <= one.seconds
                && other.excess_e <= one.excess_e
                && (other.seconds < one.seconds || other.excess_e < one.excess_e)
        });
        assert_eq!(one.pareto, !beaten);
        assert!(one.seconds > 0.0 && one.runs >= 3);
    }
    assert!(all.iter().any(|one| one.pareto && one.excess_e == 0.0));
}

#[test]
fn table_json_csv_and_figure_contain_every_alternative() {
    let tradeoff = tradeoff();
    let text = tradeoff.text();
    let json = serde_json::to_value(tradeoff).unwrap();
    let listed = json["alternatives"].as_array().unwrap();
    assert_eq!(listed.len(), tradeoff.alternatives.len());
    let mut csv = Vec::new();
    write_fit_tradeoffs(std::slice::from_ref(tradeoff), &mut csv).unwrap();
    let mut reader = csv::Reader::from_reader(csv.as_slice());
    assert_eq!(reader.headers().unwrap(), &FIT_TRADEOFF_COLUMNS[..]);
    assert_eq!(reader.records().count(), tradeoff.alternatives.len());
    let figure = tradeoff.figure();
    assert!(figure.png(1.0).is_ok());
    assert!(figure.caption.contains("of zero at the lower edge"));
    for alternative in &tradeoff.alternatives {
        assert!(text.contains(&alternative.name), "{}", alternative.name);
    }
    for field in [
        "seconds",
        "excess_e",
        "shift_in_sigma",
        "pareto",
        "e_percent",
        "ended_by",
    ] {
        assert!(!listed[0][field].is_null(), "{field}");
    }
}

#[test]
fn a_scan_too_small_for_some_alternatives_lists_them_with_their_error() {
    let scan = sample();
    let mut last: Vec<_> = scan.readings().to_vec();
    let few = Measurements::new("few", last.split_off(last.len() - 10)).unwrap();
    let tradeoff = fit_tradeoff(&few, &options()).unwrap();
    let failed = tradeoff
        .alternatives
        .iter()
        .filter_map(|one| match &one.outcome {
            Outcome::Failed { error } => Some((one.name.as_str(), error.to_string())),
            Outcome::Fitted(_) => None,
        });
    let failed: Vec<(&str, String)> = failed.collect();
    assert!(failed.contains(&(
        "every 8th reading",
        "2 readings: 3 free parameters need at least 4".to_owned()
    )));
    assert!(failed.iter().any(|(name, _)| *name == "LM, stage 1 only"));
    assert!(tradeoff.text().contains("not fitted: 2 readings"));
}
