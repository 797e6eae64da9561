//! `fit --again` reads the files as the earlier run did: with its columns, its declarations and its
//! joined files.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use brdf_tests::{fit_command, in_workspace, without_times};
use serde_json::{Value, json};
use tempfile::TempDir;

/// The readings of one wavelength of a measured sample: psi and theta in degrees, f_r in 1/sr.
fn readings() -> Vec<[f64; 3]> {
    let path = in_workspace("data/measured/z307_on_aluminium.csv");
    let text = fs::read_to_string(path).unwrap();
    let lines = text
        .lines()
        .filter_map(|line| line.strip_prefix("0.63079,"));
    let numbers =
        |line: &str| -> Vec<f64> { line.split(',').map(|n| n.parse().unwrap()).collect() };
    lines
        .map(|line| numbers(line).try_into().unwrap())
        .collect()
}

/// A table of some of the readings, with a header.
fn table(header: &str, row: impl Fn([f64; 3]) -> Option<String>) -> String {
    let mut text = format!("{header}\n");
    for row in readings().into_iter().filter_map(row) {
        writeln!(text, "{row}").unwrap();
    }
    text
}

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.0.path().join(name), text).unwrap();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, arguments: &[&str]) -> Output {
        let mut command = fit_command();
        command.current_dir(self.0.path()).args(arguments);
        command.output().unwrap()
    }

    fn succeeds(&self, arguments: &[&str]) {
        let output = self.run(arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {message}");
    }

    /// Fits files with options, fits them again with the document alone, and compares the documents,
    /// whose reports must have this description of the reading.
    fn repeats(&self, files: &[&str], options: &[&str], reading: &Value) {
        self.succeeds(&[files, options, &["--n", "1.5", "--json", "first.json"]].concat());
        self.succeeds(&[files, &["--again", "first.json", "--json", "second.json"]].concat());
        let [first, second] = ["first.json", "second.json"].map(|name| reports(&self.path(name)));
        assert_eq!(first, second);
        assert!(
            first.iter().all(|report| &report["reading"] == reading),
            "{}",
            first[0]
        );
    }
}

/// The reports in a document, without their times.
fn reports(path: &Path) -> Vec<Value> {
    without_times(path)["reports"].as_array().unwrap().clone()
}

/// A table whose columns have names that say nothing.
fn unnamed() -> String {
    table("A,B,C", |[psi, theta, f_r]| {
        Some(format!("{psi},{theta},{f_r}"))
    })
}

const NAMES: &str = "A=psi_deg,B=theta_deg,C=brdf_per_sr";

#[test]
fn the_columns_are_those_of_the_earlier_run() {
    let folder = Folder::new();
    folder.write("scan.csv", &unnamed());
    let columns = json!([["A", "psi_deg"], ["B", "theta_deg"], ["C", "brdf_per_sr"]]);
    folder.repeats(
        &["scan.csv"],
        &["--columns", NAMES],
        &json!({ "columns": columns }),
    );
    // Another sample of the same instrument is read in the same way.
    folder.write("other.csv", &unnamed());
    folder.succeeds(&["other.csv", "--again", "first.json"]);
    // What is stated anew takes precedence, and the rest stays.
    folder.succeeds(&[
        "scan.csv",
        "--again",
        "first.json",
        "--columns",
        "C=reflectance_factor",
        "--json",
        "second.json",
    ]);
    let [first, second] = ["first.json", "second.json"].map(|name| reports(&folder.path(name)));
    let k2 = |report: &Value| report["fit"]["parameters"]["k2"].as_f64().unwrap();
    assert!((k2(&first[0]) / k2(&second[0]) - std::f64::consts::PI).abs() < 1e-3);
    let columns = json!([
        ["A", "psi_deg"],
        ["B", "theta_deg"],
        ["C", "reflectance_factor"]
    ]);
    assert_eq!(second[0]["reading"], json!({ "columns": columns }));
}

#[test]
fn the_declarations_are_those_of_the_earlier_run() {
    let folder = Folder::new();
    let percent = table("psi_deg,theta_deg,brdf", |[psi, theta, f_r]| {
        Some(format!(
            "{psi},{theta},{}",
            100.0 * std::f64::consts::PI * f_r
        ))
    });
    folder.write("scan.csv", &percent);
    let options = [
        "--declare",
        "quantity=reflectance_factor",
        "--declare",
        "unit=percent",
    ];
    let declared = json!([["quantity", "reflectance_factor"], ["unit", "percent"]]);
    folder.repeats(
        &["scan.csv"],
        &options,
        &json!({ "declarations": declared }),
    );
}

#[test]
fn files_are_joined_as_in_the_earlier_run() {
    let folder = Folder::new();
    let files = ["0.csv", "10.csv", "30.csv", "50.csv", "70.csv"];
    for file in files {
        let of_file = table("A,B,C", |[psi, theta, f_r]| {
            (file == format!("{psi}.csv")).then(|| format!("{psi},{theta},{f_r}"))
        });
        folder.write(file, &of_file);
    }
    let columns = json!([["A", "psi_deg"], ["B", "theta_deg"], ["C", "brdf_per_sr"]]);
    let reading = json!({ "columns": columns, "joined": files });
    folder.repeats(&files, &["--join", "--columns", NAMES], &reading);
    let report = &reports(&folder.path("second.json"))[0];
    assert_eq!(report["readings"], readings().len());
}

#[test]
fn documents_without_settings_of_the_reading_are_read() {
    let folder = Folder::new();
    let named = table("psi_deg,theta_deg,brdf_per_sr", |[psi, theta, f_r]| {
        Some(format!("{psi},{theta},{f_r}"))
    });
    folder.write("scan.csv", &named);
    folder.succeeds(&["scan.csv", "--n", "1.5", "--json", "first.json"]);
    let earlier = fs::read_to_string(folder.path("first.json")).unwrap();
    assert!(
        !earlier.contains("\"reading\""),
        "as in documents of earlier versions"
    );
    folder.succeeds(&["scan.csv", "--again", "first.json", "--json", "second.json"]);
    let [first, second] = ["first.json", "second.json"].map(|name| reports(&folder.path(name)));
    assert_eq!(first, second);
}
