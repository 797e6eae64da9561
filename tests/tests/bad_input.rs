//! Input and output that are not in order: what the program says, its exit status, and that
//! nothing half-written stays behind.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};

use brdf_tests::{fit_command, in_workspace, run_fit};
use tempfile::TempDir;

const FAILED: i32 = 1;
const BAD: i32 = 2;
const HEADER: &str = "psi_deg,theta_deg,brdf_per_sr\n";

/// A folder with a file of the given content in it.
fn file(content: impl AsRef<[u8]>) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scan.csv");
    fs::write(&path, content).unwrap();
    (folder, path)
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Fits a file of the content, and checks the exit status and the message, which begins with the
/// file.
fn expect(content: impl AsRef<[u8]>, status: i32, message: &str) {
    let (_folder, path) = file(content);
    let output = run_fit([path.to_str().unwrap(), "--n", "1.5"]);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(status), "{text}");
    assert!(
        text.starts_with(&format!("error: {}", path.display())),
        "{text}"
    );
    assert!(text.contains(message), "no \"{message}\" in: {text}");
    assert!(!text.contains("panicked"), "{text}");
}

fn rows(row: &str) -> String {
    format!("{HEADER}10,-10,0.5\n10,0,0.3\n30,-30,0.6\n{row}\n30,0,0.2\n")
}

#[test]
fn files_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    for (path, message) in [
        (
            folder.path().join("missing.csv"),
            "missing.csv: cannot be read: No such file",
        ),
        (folder.path().to_owned(), "cannot be read: Is a directory"),
    ] {
        let output = run_fit([path.to_str().unwrap(), "--n", "1.5"]);
        assert_eq!(output.status.code(), Some(BAD));
        assert!(stderr(&output).contains(message), "{}", stderr(&output));
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn files_that_are_no_scan() {
    expect("", BAD, "is empty");
    expect("# sample: nothing\n\n", BAD, "has no header");
    expect(HEADER, BAD, "line 1: no readings follow the header");
    expect(
        "psi_deg,brdf_per_sr\n1,2\n",
        BAD,
        "line 1: no column for the view angle (theta_deg)",
    );
    expect(
        format!("# quantity: btdf\n{}", rows("")),
        BAD,
        "line 1: quantity: \"btdf\" is not known",
    );
    let garbage: Vec<u8> = (0..4096_u32)
        .map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8)
        .collect();
    expect(garbage, BAD, "is binary data");
    let mut text_like_garbage: Vec<u8> = (0..4096_u32).map(|i| 128 + (i % 97) as u8).collect();
    text_like_garbage.push(b'\n');
    expect(text_like_garbage, BAD, "has no header");
}

#[test]
fn values_that_are_none() {
    expect(
        rows("ten,0,0.1"),
        BAD,
        "line 5, column psi_deg: \"ten\" is not a number",
    );
    expect(
        rows("10,0,-999"),
        BAD,
        "line 5, column brdf_per_sr: \"-999\" looks like a reading that was not taken",
    );
    expect(
        rows("10,inf,0.1"),
        BAD,
        "line 5, column theta_deg: \"inf\" is not a finite number",
    );
    expect(
        format!("{HEADER}90,0,0.1\n10,-90.5,0.1\n"),
        BAD,
        "line 1: all 2 readings are at or beyond 90 deg from the normal",
    );
    expect(
        rows("10,,0.1"),
        BAD,
        "line 5, column theta_deg: \"\" is missing",
    );
    let wavelength = format!("wavelength_um,{HEADER}-0.6,10,0,0.1\n");
    expect(
        wavelength,
        BAD,
        "line 2, column wavelength_um: \"-0.6\" is out of range",
    );
    let index = format!("n,{HEADER}0.5,10,0,0.1\n");
    expect(index, BAD, "line 2, column n: \"0.5\" is out of range");
}

#[test]
fn scans_that_cannot_be_fitted() {
    expect(
        format!("{HEADER}10,0,0.1\n10,10,0.2\n10,20,0.3\n"),
        FAILED,
        "3 readings",
    );
    let constant = |value: &str| {
        let rows: Vec<String> = (0..9)
            .map(|i| format!("{},{},{value}", 10 * i, 5 * i))
            .collect();
        let rows = rows.join(
            "
",
        );
        format!("{HEADER}{rows}")
    };
    expect(constant("0"), FAILED, "all readings are zero");
    expect(constant("0.25"), FAILED, "all 9 readings are 0.25 1/sr");
}

#[test]
fn a_line_of_a_hundred_megabytes() {
    let mut content = rows("").into_bytes();
    content.resize(100 << 20, b'7');
    expect(content, BAD, "line 7: the line is longer than 65536 bytes");
}

#[test]
fn an_index_that_is_missing_or_impossible() {
    let (_folder, path) = file(rows("30,-20,0.4"));
    let run = |arguments: &[&str]| {
        let output = run_fit([&[path.to_str().unwrap()], arguments].concat());
        assert_eq!(output.status.code(), Some(BAD));
        stderr(&output)
    };
    let missing = run(&[]);
    assert!(
        missing.contains("no refractive index: give it with --n 1.5"),
        "{missing}"
    );
    assert!(missing.contains("# refractive_index: 1.5"), "{missing}");
    assert!(run(&["--n", "0.9"]).contains("refractive index n = 0.9"));
    assert!(run(&["--n", "glass"]).contains("\"glass\" is not a refractive index"));
    let scan = in_workspace("data/measured/z307_on_aluminium.csv");
    let output = run_fit([scan.to_str().unwrap(), "--n", "0.63=1.5", "--params-only"]);
    assert_eq!(output.status.code(), Some(BAD));
    assert!(
        stderr(&output).contains(", 0.85223 um: no refractive index: give it with --n 1.5"),
        "{}",
        stderr(&output)
    );
    assert!(
        String::from_utf8_lossy(&output.stdout).contains(",ok,"),
        "the other is delivered"
    );
}

#[test]
fn an_error_in_the_options_is_printed_once() {
    let scan = in_workspace("data/measured/z307_on_aluminium.csv");
    let other = in_workspace("data/measured/titanium_anodise.csv");
    let run = |arguments: &[&str]| {
        let output = fit_command().arg(&scan).args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(BAD));
        stderr(&output)
    };
    let wavelengths = format!("{}, 0.63079 um, 0.85223 um", scan.display());
    let index = "no refractive index: give it with --n 1.5 or --n 0.63=1.60,0.85=1.58, by a column \
                 n, or by a line \"# refractive_index: 1.5\" in the file\n";
    let once = format!("error: {wavelengths}: {index}");
    assert_eq!(run(&[]), once);
    // Where n is fitted, none is needed.
    assert_eq!(
        run(&["--params-only", "--compare"]),
        format!("error: {wavelengths} (fitting three, ggx, beckmann): {index}")
    );
    let both = run(&[other.to_str().unwrap()]);
    assert!(both.starts_with(&format!("error: {wavelengths}; {}, ", other.display())));
    assert!(both.lines().count() == 1 && both.ends_with(index), "{both}");
    let stages = run(&["--n", "1.5", "--stage1", "none", "--stage2", "none"]);
    assert_eq!(stages.lines().count(), 1, "{stages}");
    assert!(stages.starts_with(&format!("error: {wavelengths}: no stage")));
    assert!(stages.contains("--stage1"), "{stages}");
}

#[test]
fn incorrect_usage_is_an_error() {
    let (_folder, path) = file(rows("30,-20,0.4"));
    for (arguments, message) in [
        (vec!["--stage1", "simplex"], "invalid value 'simplex'"),
        (
            vec!["--stage1-limit", "91"],
            "expected degrees from 0 to 90",
        ),
        (vec!["--max-iterations", "0"], "invalid value '0'"),
        (vec!["--g1", "60"], "expected DEGREES=WEIGHT"),
        (
            vec!["--weights", "sigma"],
            "need the standard deviation of every reading",
        ),
        (vec!["--stage1", "none", "--stage2", "none"], "no stage"),
        (
            vec!["--stage2", "none", "--stage1-limit", "5"],
            "stage 1 alone cannot be fitted: 0 readings up to 5 deg",
        ),
        (vec!["--fix", "k3=1"], "\"k3\" is not a parameter"),
        (vec!["--fix", "k1"], "expected NAME=VALUE"),
        (vec!["--fix", "k1=2000"], "k1 = 2000 cannot be fixed"),
        (
            vec!["--fix", "p=1"],
            "p cannot be fixed: model three fits k2, kD, k1",
        ),
        (vec!["--nonsense"], "unexpected argument"),
    ] {
        let file = path.to_str().unwrap();
        let output = run_fit([vec![file, "--n", "1.5"], arguments].concat());
        assert_eq!(output.status.code(), Some(BAD), "{message}");
        assert!(stderr(&output).contains(message), "{}", stderr(&output));
    }
    let output = run_fit::<&str>([]);
    assert_eq!(output.status.code(), Some(BAD));
}

#[test]
fn documents_that_cannot_be_fitted_again() {
    let scan = in_workspace("data/measured/z307_on_aluminium.csv");
    let scan = scan.to_str().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("fit.json");
    let again = |more: &[&str]| {
        let output = run_fit([&[scan, "--again", json.to_str().unwrap()], more].concat());
        assert_eq!(output.status.code(), Some(BAD));
        assert!(!stderr(&output).contains("panicked"));
        stderr(&output)
    };
    assert!(again(&[]).contains("fit.json: cannot be read: No such file"));
    for (text, message) in [
        (
            "psi_deg,theta_deg\n1,2\n",
            "fit.json, line 1, column 1: expected",
        ),
        ("{\"format_version\": 1", "fit.json, line 1, column 20: EOF"),
        ("{\"reports\": []}", "missing field `format_version`"),
        (
            "{\"format_version\": 2}",
            "format_version 2: expected one from 1 to 1",
        ),
        (
            "{\"format_version\": 1, \"reports\": []}",
            "fit.json: contains no fit",
        ),
    ] {
        fs::write(&json, text).unwrap();
        let error = again(&[]);
        assert!(error.contains(message), "no \"{message}\" in: {error}");
    }
    let other = in_workspace("data/synthetic/table1_001_0.44um.csv");
    let written = run_fit([other.to_str().unwrap(), "--json", json.to_str().unwrap()]);
    assert_eq!(written.status.code(), Some(0));
    let error = again(&[]);
    assert!(
        error.contains("0.85223 um: no fit of this wavelength in"),
        "{error}"
    );
    assert!(again(&["--n", "1.5"]).contains("cannot be used with"));
    assert!(again(&["--stage1", "none"]).contains("cannot be used with"));
    assert!(again(&["--json", json.to_str().unwrap()]).contains("is an input"));
}

#[test]
fn one_bad_file_does_not_keep_the_others() {
    let (_folder, bad) = file(rows("ten,0,0.1"));
    let (_other, short) = file(format!("{HEADER}10,0,0.1\n"));
    let good = in_workspace("data/measured/z307_on_aluminium.csv");
    let run = |files: &[&Path]| {
        fit_command()
            .args(files)
            .args(["--n", "1.5", "--params-only"])
            .output()
            .unwrap()
    };
    let lines = |output: &Output| String::from_utf8_lossy(&output.stdout).lines().count();
    let output = run(&[&bad, &good]);
    assert_eq!((output.status.code(), lines(&output)), (Some(BAD), 3));
    let output = run(&[&short, &good]);
    assert_eq!((output.status.code(), lines(&output)), (Some(FAILED), 4));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        text.contains("failed: 1 reading: 3 free parameters need at least 4"),
        "{text}"
    );
}

#[test]
fn a_device_that_is_full_does_not_keep_the_tables() {
    let scan = in_workspace("data/measured/z307_on_aluminium.csv");
    let scan = scan.to_str().unwrap();
    for option in ["--json", "--curves"] {
        let output = run_fit([scan, "--n", "1.5", option, "/dev/full"]);
        assert_eq!(output.status.code(), Some(BAD));
        let message = "/dev/full: cannot be written: No space left on device";
        assert!(stderr(&output).contains(message), "{}", stderr(&output));
        assert!(
            !output.stdout.is_empty(),
            "the tables are delivered all the same"
        );
    }
    let full = fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let output = fit_command()
        .args([scan, "--n", "1.5"])
        .stdout(Stdio::from(full))
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
        .wait_with_output()
        .unwrap();
    assert_eq!(output.status.code(), Some(BAD));
    assert!(
        stderr(&output).contains("standard output: No space left"),
        "{}",
        stderr(&output)
    );
    assert!(
        Path::new("/dev/full").exists(),
        "a device is written to, not replaced"
    );
}

#[test]
fn a_full_standard_output_does_not_keep_the_files() {
    let (folder, path) = file(rows("30,-20,0.4"));
    let json = folder.path().join("fit.json");
    let full = fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let status = fit_command()
        .arg(&path)
        .args(["--n", "1.5", "--json"])
        .arg(&json)
        .stdout(Stdio::from(full))
        .stderr(Stdio::null())
        .status()
        .unwrap();
    assert_eq!(status.code(), Some(BAD));
    assert!(fs::read_to_string(json).unwrap().contains("format_version"));
}
