//! The trade of fitting over a measured sample: facts that hold whatever the machine is, no times.

use std::path::Path;
use std::sync::LazyLock;

use brdf_fit::trade::fitting::{
    Alternative, FIT_TRADE_COLUMNS, FitTrade, Measured, Outcome, trade_fits, write_fit_trades,
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

fn trade() -> &'static FitTrade {
    static TRADE: LazyLock<FitTrade> = LazyLock::new(|| trade_fits(&sample(), &options()).unwrap());
    &TRADE
}

fn all_measured(trade: &FitTrade) -> impl Iterator<Item = (&Alternative, &Measured)> {
    let all = trade.alternatives.iter();
    all.filter_map(|alternative| Some((alternative, alternative.measured()?)))
}

fn find<'a>(trade: &'a FitTrade, name: &str) -> &'a Measured {
    let mut all = all_measured(trade);
    all.find(|(alternative, _)| alternative.name == name)
        .unwrap()
        .1
}

#[test]
fn the_reference_is_the_whole_fit_and_the_first_alternative() {
    let (trade, fit) = (trade(), fit(&sample(), &options()).unwrap());
    assert_eq!(trade.reference.parameters, fit.at());
    assert_eq!(trade.reference.e_percent, fit.e_percent);
    assert_eq!(
        (trade.reference.readings, trade.reference.incidences),
        (112, 5)
    );
    let first = &trade.alternatives[0];
    assert_eq!(first.name, "LM + check");
    assert_eq!(
        (first.method.as_str(), first.stages.as_str()),
        ("levenberg-marquardt", "both")
    );
    assert_eq!(first.measured().unwrap().parameters, fit.at());
}

#[test]
fn levenberg_marquardt_in_both_stages_is_not_shifted() {
    let trade = trade();
    for name in ["LM + check", "LM"] {
        for of in &find(trade, name).shift_in_sigma {
            assert_eq!(of.value, Some(0.0), "{name}, {}", of.parameter);
        }
    }
    for name in ["LM, stage 2 only", "NM", "NM, then LM", "profile, refined"] {
        for of in &find(trade, name).shift_in_sigma {
            assert!(of.value.unwrap().abs() < 1e-3, "{name}, {of:?}");
        }
    }
}

#[test]
fn no_alternative_is_better_than_the_best_and_all_are_of_the_whole_scan() {
    let trade = trade();
    for (alternative, measured) in all_measured(trade) {
        let name = &alternative.name;
        assert!(measured.excess_e >= 0.0, "{name}");
        let ratio = measured.e_percent / trade.reference.e_percent - 1.0;
        assert!((ratio - measured.excess_e).abs() < 2e-9, "{name}: {ratio}");
    }
}

#[test]
fn fewer_readings_cost_accuracy_and_stage_1_alone_is_the_fit_of_its_readings() {
    let trade = trade();
    let excess = |name: &str| find(trade, name).excess_e;
    assert!(excess("every 2nd reading") < excess("every 4th reading"));
    assert!(excess("every 4th reading") < excess("every 8th reading"));
    // Of this scan, those up to 60 deg are all but the largest incidence.
    let stage1 = find(trade, "LM, stage 1 only").e_percent;
    let smaller = find(trade, "without 70 deg").e_percent;
    assert!((stage1 / smaller - 1.0).abs() < 1e-9);
    let limited = find(trade, "1 iteration");
    assert!(!limited.converged && limited.excess_e > 0.0);
}

#[test]
fn the_pareto_front_is_what_nothing_beats() {
    let trade = trade();
    let all: Vec<&Measured> = all_measured(trade).map(|(_, measured)| measured).collect();
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
fn table_json_csv_and_picture_hold_every_alternative() {
    let trade = trade();
    let text = trade.text();
    let json = serde_json::to_value(trade).unwrap();
    let listed = json["alternatives"].as_array().unwrap();
    assert_eq!(listed.len(), trade.alternatives.len());
    let mut csv = Vec::new();
    write_fit_trades(std::slice::from_ref(trade), &mut csv).unwrap();
    let mut reader = csv::Reader::from_reader(csv.as_slice());
    assert_eq!(reader.headers().unwrap(), &FIT_TRADE_COLUMNS[..]);
    assert_eq!(reader.records().count(), trade.alternatives.len());
    let figure = trade.figure();
    assert!(figure.png(1.0).is_ok());
    assert!(figure.caption.contains("of zero at the lower edge"));
    for alternative in &trade.alternatives {
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
    let trade = trade_fits(&few, &options()).unwrap();
    let failed = trade
        .alternatives
        .iter()
        .filter_map(|one| match &one.outcome {
            Outcome::Failed { error } => Some((one.name.as_str(), error.as_str())),
            Outcome::Fitted(_) => None,
        });
    let failed: Vec<(&str, &str)> = failed.collect();
    assert!(failed.contains(&(
        "every 8th reading",
        "2 readings: 3 free parameters need at least 4"
    )));
    assert!(failed.iter().any(|(name, _)| *name == "LM, stage 1 only"));
    assert!(trade.text().contains("not fitted: 2 readings"));
}
