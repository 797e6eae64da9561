//! `-` in the place of a file: standard input and standard output of `brdf`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use brdf_fit::report::CURVE_COLUMNS;
use brdf_tests::{
    brdf_command, export_command, fit_command, in_workspace, run_fit, run_with_input, trade_command,
};
use serde_json::Value;

const BAD: i32 = 2;

/// A scene that is measured quickly.
const SCENE: [&str; 6] = [
    "--in-plane",
    "--incidence",
    "10:20",
    "--view",
    "0:30",
    "--tolerance=1e-2",
];

fn z307() -> PathBuf {
    in_workspace("data/measured/z307_on_aluminium.csv")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The standard output of a command that succeeds without a message.
fn succeeded(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr), "");
    text(&output.stdout)
}

/// The JSON of the fits of a scan, written to standard output.
fn fits() -> String {
    let output = fit_command()
        .arg(z307())
        .args(["--n", "1.5", "--json", "-"])
        .output();
    succeeded(&output.unwrap())
}

fn fit_input(arguments: &[&str], input: &[u8]) -> Output {
    run_with_input(fit_command().args(arguments), input)
}

#[test]
fn a_scan_is_read_from_standard_input() {
    let rows = |output: &Output| -> Vec<(String, String)> {
        let lines = succeeded(output);
        let rows = lines.lines().skip(1);
        rows.map(|row| row.split_once(',').unwrap())
            .map(|(file, rest)| (file.to_owned(), rest.to_owned()))
            .collect()
    };
    let options = ["-", "--n", "1.5", "--params-only"];
    let from_stream = rows(&fit_input(&options, &fs::read(z307()).unwrap()));
    let of_file = fit_command().arg(z307()).args(&options[1..]).output();
    let of_file = rows(&of_file.unwrap());
    assert_eq!(from_stream.len(), 2);
    for (stream, file) in from_stream.iter().zip(&of_file) {
        assert_eq!((stream.0.as_str(), &stream.1), ("standard input", &file.1));
    }
    // The format is detected by content, and a message names the input.
    let astm = fs::read(in_workspace("tests/data/formats/cornell.astm")).unwrap();
    assert!(succeeded(&fit_input(&["-", "--n", "1.5"], &astm)).contains("standard input"));
    let output = fit_input(&["-"], b"psi_deg,theta_deg\n1,2\n");
    assert_eq!(output.status.code(), Some(BAD));
    let message = text(&output.stderr);
    assert!(
        message.starts_with("error: standard input, line 1: no column for the reading"),
        "{message}"
    );
}

#[test]
fn data_on_standard_output_replace_the_tables() {
    let document: Value = serde_json::from_str(&fits()).unwrap();
    assert_eq!(document["reports"].as_array().unwrap().len(), 2);
    let output = fit_command()
        .arg(z307())
        .args(["--n", "1.5", "--curves", "-"])
        .output();
    let curves = succeeded(&output.unwrap());
    let mut reader = csv::Reader::from_reader(curves.as_bytes());
    assert_eq!(reader.headers().unwrap(), CURVE_COLUMNS.as_slice());
    assert_eq!(reader.records().map(Result::unwrap).count(), 224);
}

#[test]
fn a_reader_that_closes_the_data_early_is_no_error() {
    let mut child = fit_command()
        .arg(z307())
        .args(["--n", "1.5", "--curves", "-"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert_eq!(succeeded(&child.wait_with_output().unwrap()), "");
}

#[test]
fn fits_go_from_standard_output_to_standard_input() {
    let fits = fits();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fit.json");
    fs::write(&path, &fits).unwrap();

    let wanted = ["--to", "c", "--wavelength", "0.63079"];
    let of_file = succeeded(&export_command().arg(&path).args(wanted).output().unwrap());
    for output in [vec![], vec!["-o", "-"]] {
        let mut command = export_command();
        command.arg("-").args(wanted).args(output);
        assert_eq!(
            succeeded(&run_with_input(&mut command, fits.as_bytes())),
            of_file
        );
    }

    let scan = z307();
    let again = [scan.to_str().unwrap(), "--again", "-", "--params-only"];
    let from_stream = succeeded(&fit_input(&again, fits.as_bytes()));
    let of_file = fit_command()
        .arg(&scan)
        .args(["--params-only", "--again"])
        .arg(&path)
        .output();
    assert_eq!(from_stream, succeeded(&of_file.unwrap()));

    let mut command = trade_command();
    command.args(["--model", "-", "--json", "-"]).args(SCENE);
    let measured = succeeded(&run_with_input(&mut command, fits.as_bytes()));
    let (fits, measured): (Value, Value) = (
        serde_json::from_str(&fits).unwrap(),
        serde_json::from_str(&measured).unwrap(),
    );
    let fitted = &fits["reports"][0]["fit"]["parameters"]["k1"];
    assert_eq!(&measured["brdf"]["k1"], fitted);
}

#[test]
fn comparisons_are_written_to_standard_output() {
    let table = trade_command().args(SCENE).args(["--csv", "-"]).output();
    let table = succeeded(&table.unwrap());
    assert!(csv::Reader::from_reader(table.as_bytes()).records().count() > 3);
    let figure = trade_command().args(SCENE).args(["--plot", "-"]).output();
    assert!(succeeded(&figure.unwrap()).starts_with("<svg"));
    let scan = fs::read(z307()).unwrap();
    let mut command = trade_command();
    command.args(["fit", "-", "--n", "1.5", "--json", "-"]);
    let trades: Value =
        serde_json::from_str(&succeeded(&run_with_input(&mut command, &scan))).unwrap();
    assert_eq!(trades.as_array().unwrap().len(), 2);
    // One figure for each wavelength: standard output takes only one.
    let mut command = trade_command();
    command.args(["fit", "-", "--n", "1.5", "--plot", "-"]);
    let output = run_with_input(&mut command, &scan);
    assert_eq!(
        (output.status.code(), text(&output.stdout)),
        (Some(BAD), String::new())
    );
    let message = text(&output.stderr);
    assert!(message.contains("there are 2 figures"), "{message}");
}

#[test]
fn a_stream_that_is_used_twice_is_an_error_of_usage() {
    let scan = z307();
    let scan = scan.to_str().unwrap();
    let once = "standard input can be read only once";
    let one = "written to standard output: expected a file for one of them";
    for (arguments, messages) in [
        (vec!["fit", "-", "-"], ["(FILE, FILE)", once]),
        (vec!["fit", "-", "--again", "-"], ["(FILE, --again)", once]),
        (
            vec!["fit", scan, "--json", "-", "--curves", "-"],
            ["--json and --curves are both", one],
        ),
        (
            vec!["fit", scan, "--params-only", "--json", "-"],
            ["--params-only and --json are both", one],
        ),
        (
            vec!["trade", "--json", "-", "--csv", "-"],
            ["--csv and --json are both", one],
        ),
        (
            vec!["trade", "fit", scan, "--json", "-", "--plot", "-"],
            ["--json and --plot are both", one],
        ),
        (
            vec!["fit", scan, "--plot", "-"],
            ["--plot names a folder", "cannot be -"],
        ),
        (
            vec!["figures", "-"],
            ["FOLDER names a folder", "cannot be -"],
        ),
        (
            vec!["export", scan, "--to", "mitsuba", "-o", "-"],
            ["mitsuba is two files", "expected -o FILE"],
        ),
    ] {
        let output = brdf_command()
            .args(&arguments)
            .stdin(Stdio::null())
            .output();
        let output = output.unwrap();
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(BAD), "{arguments:?}: {message}");
        assert_eq!(text(&output.stdout), "");
        for expected in messages {
            assert!(message.contains(expected), "{arguments:?}: {message}");
        }
    }
    assert!(!Path::new("-").exists(), "no file of this name is written");
}

/// A MERL table, which is binary, comes through a pipe as well.
#[test]
fn a_table_is_read_from_standard_input() {
    let bins = [6_i32, 5, 8];
    let mut bytes: Vec<u8> = bins.iter().flat_map(|n| n.to_le_bytes()).collect();
    for i in 0..3 * 6 * 5 * 8 {
        bytes.extend((100.0 + f64::from(i % 37)).to_le_bytes());
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("small.binary");
    fs::write(&path, &bytes).unwrap();
    let options = ["--n", "1.5", "--model", "lambert", "--params-only"];
    let stream = fit_input(&[&["-"], options.as_slice()].concat(), &bytes);
    let file = run_fit([&[path.to_str().unwrap()], options.as_slice()].concat());
    let file = succeeded(&file).replace(path.to_str().unwrap(), "standard input");
    assert_eq!(succeeded(&stream), file);
}

/// A shell pipe of two programs, as a user writes it.
#[cfg(unix)]
#[test]
fn a_pipe_of_commands_exports_what_it_fits() {
    let program = brdf_command();
    let pipe = "\"$0\" fit - --n 1.5 --json - | \"$0\" export - --to json --wavelength 0.85223";
    let mut command = Command::new("sh");
    command.args(["-c", pipe]).arg(program.get_program());
    let model = succeeded(&run_with_input(&mut command, &fs::read(z307()).unwrap()));
    let model: Value = serde_json::from_str(&model).unwrap();
    assert_eq!(model["fits"][0]["file"], "standard input");
}
