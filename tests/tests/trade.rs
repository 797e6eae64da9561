//! The program `trade`. Its measurements differ from machine to machine: only facts are tested, no
//! times.

use std::fs;
use std::path::Path;
use std::process::Output;

use brdf_fit::tradeoff::pareto::pareto;
use brdf_tests::{in_workspace, run_fit, trade_command};
use serde_json::Value;

fn run(arguments: &[&str]) -> Output {
    trade_command().args(arguments).output().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

fn z307() -> String {
    let path = in_workspace("data/measured/z307_on_aluminium.csv");
    path.to_str().unwrap().to_owned()
}

#[test]
fn evaluators_are_measured_and_one_is_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (document, table, picture) = (path("t.json"), path("t.csv"), path("t.svg"));
    let output = run(&[
        "--sample",
        "003 1.04",
        "--in-plane",
        "--incidence",
        "10:60",
        "--view",
        "0:70",
        "--tolerance",
        "1e-2",
        "--json",
        document.to_str().unwrap(),
        "--csv",
        table.to_str().unwrap(),
        "--plot",
        picture.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));

    let document = json(&document);
    let evaluators = document["evaluators"].as_array().unwrap();
    let plan = document["plan"].as_str().unwrap();
    let number = |e: &Value, key: &str| e[key].as_f64().unwrap();
    for e in evaluators {
        let name = e["name"].as_str().unwrap();
        assert!(number(e, "ns_per_evaluation") > 0.0, "{name}");
        assert!(
            number(e, "max_relative_error") >= number(e, "p99_relative_error"),
            "{name}"
        );
        assert!(
            number(e, "rms_relative_error") <= number(e, "max_relative_error"),
            "{name}"
        );
        assert!(
            number(e, "build_seconds") >= 0.0 && e["bytes"].is_u64(),
            "{name}"
        );
        assert!(e["ns_per_evaluation_all_threads"].is_number() || name == "value");
    }
    let choices: Vec<(f64, f64)> = evaluators
        .iter()
        .map(|e| {
            (
                number(e, "ns_per_evaluation"),
                number(e, "max_relative_error"),
            )
        })
        .collect();
    let front: Vec<bool> = evaluators
        .iter()
        .map(|e| e["pareto"].as_bool().unwrap())
        .collect();
    assert_eq!(front, pareto(&choices));
    let chosen = evaluators.iter().find(|e| e["name"] == plan).unwrap();
    assert!(number(chosen, "max_relative_error") <= 1e-2);
    let names: Vec<&str> = evaluators
        .iter()
        .map(|e| e["name"].as_str().unwrap())
        .collect();
    assert!(names.contains(&"table-in-plane") && names.contains(&"table-isotropic"));

    let text = stdout(&output);
    assert!(
        text.contains("incidence 10 ... 60 deg, view 0 ... 70 deg, in plane"),
        "{text}"
    );
    assert!(text.contains(&format!("plan: {plan}")));
    let mut rows = csv::Reader::from_path(table).unwrap();
    let rows: Vec<csv::StringRecord> = rows.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), evaluators.len());
    let svg = fs::read_to_string(picture).unwrap();
    assert!(svg.starts_with("<svg") && names.iter().all(|name| svg.contains(name)));
}

#[test]
fn the_model_of_a_fit_is_measured() {
    let folder = tempfile::tempdir().unwrap();
    let (fit, trade) = (
        folder.path().join("fit.json"),
        folder.path().join("trade.json"),
    );
    let (fit, trade) = (fit.to_str().unwrap(), trade.to_str().unwrap());
    run_fit([&z307(), "--model", "power+n", "--n", "1.5", "--json", fit]);
    let output = run(&[
        "--model",
        fit,
        "--json",
        trade,
        "--coordinates",
        "directions",
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let (fitted, measured) = (json(Path::new(fit)), json(Path::new(trade)));
    let fitted = &fitted["reports"][0]["fit"];
    assert_eq!(measured["brdf"]["family"], "power");
    assert_eq!(measured["brdf"]["k1"], fitted["parameters"]["k1"]);
    assert_eq!(measured["brdf"]["n"], fitted["n"]);
    assert_eq!(measured["brdf"]["p"], fitted["p"]);
    assert_eq!(measured["scene"]["coordinates"], "directions");
}

#[test]
fn a_tolerance_that_no_evaluator_meets_is_status_one_with_the_best() {
    let output = run(&["--tolerance", "1e-30", "--memory", "0.1"]);
    assert_eq!(output.status.code(), Some(1));
    let text = stdout(&output);
    assert!(
        text.contains("no plan: no evaluator is within the relative tolerance 1e-30"),
        "{text}"
    );
    assert!(text.contains("the best, exact, errs by"), "{text}");
}

#[test]
fn bad_usage_is_reported() {
    let missing = in_workspace("no/such/fit.json");
    let scan = z307();
    for (arguments, message) in [
        (
            vec!["--incidence", "10:95"],
            "expected degrees from 0 to below 90",
        ),
        (
            vec!["--incidence", "50:10"],
            "expected degrees from 0 to below 90",
        ),
        (vec!["--sample", "009 1"], "expected one of \"001 0.44\""),
        (vec!["--tolerance", "0"], "expected a number above 0"),
        (vec!["--model", missing.to_str().unwrap()], "cannot be read"),
        (
            vec!["--model", &scan],
            "expected JSON, as fit --json writes it",
        ),
        (vec!["fit", "no/such/scan.csv"], "no/such/scan.csv"),
        (vec!["fit", &scan], "refractive index"),
        (
            vec!["fit", &scan, "--n", "1.5", "--csv", &scan],
            "is an input or another output",
        ),
        (
            vec!["--json", "/no/such/folder/x.json"],
            "cannot be written",
        ),
    ] {
        let output = run(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(
            stderr(&output).contains(message),
            "{arguments:?}: {}",
            stderr(&output)
        );
    }
    assert!(fs::read_to_string(scan).unwrap().contains("Z307"));
}

#[test]
fn ways_to_fit_are_compared_for_each_wavelength() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let output = run(&[
        "fit",
        &z307(),
        "--n",
        "1.5",
        "--json",
        &path("t.json"),
        "--csv",
        &path("t.csv"),
        "--plot",
        &path("t.svg"),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let trades = json(&folder.path().join("t.json"));
    let trades = trades.as_array().unwrap();
    assert_eq!(trades.len(), 2);
    for trade in trades {
        let first = &trade["alternatives"][0];
        assert_eq!(first["method"], "levenberg-marquardt");
        assert_eq!(first["excess_e"], 0.0);
    }
    for wavelength in ["0.63079", "0.85223"] {
        assert!(
            folder
                .path()
                .join(format!("t_{wavelength}um.svg"))
                .is_file()
        );
        assert!(stdout(&output).contains(&format!("{wavelength} um, n = 1.5")));
    }
}
