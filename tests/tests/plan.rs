//! `brdf plan` as its user meets it.

use std::fmt::Write as _;
use std::fs;
use std::process::Output;

use brdf_core::{AnyBrdf, Family, Geometry, ModelParameters};
use brdf_fit::Measurements;
use brdf_fit::planning::{Advice, PlanOptions, plan_readings};
use brdf_tests::{brdf_command, in_workspace, run_fit, shared_data, unwrapped};

fn run(arguments: &[&str]) -> Output {
    brdf_command().arg("plan").args(arguments).output().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn z307() -> String {
    let path = in_workspace("data/measured/z307_on_aluminium.csv");
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_plan_from_nothing_lists_readings_with_their_errors_and_times() {
    let output = run(&["--material", "paint", "--incidence", "0:70", "--in-plane"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for part in [
        "material \"paint\"",
        "psi 0 ... 70 deg",
        "advice    take ",
        "rank",
        "after",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

/// What a plan lists is measured on a surface, read by `fit`, and planned on from, until the advice is another one.
#[test]
fn the_list_is_a_scan_that_fit_reads_once_it_is_filled() {
    let folder = tempfile::tempdir().unwrap();
    let list = folder.path().join("list.csv");
    let scan = folder.path().join("scan.csv");
    let at = ModelParameters {
        k2: 0.1,
        kd: 0.04,
        k1: 0.25,
        n: 1.6,
        p: 1.0,
    };
    let truth = AnyBrdf::new(Family::Paper, &at).unwrap();
    let scene = ["--incidence", "0:75", "--view", "0:80", "--in-plane"];
    let mut rows = String::new();
    for round in 0..6 {
        let mut arguments = scene.to_vec();
        arguments.extend(["--csv", list.to_str().unwrap()]);
        if round > 0 {
            arguments.push(scan.to_str().unwrap());
        }
        let output = run(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        if stdout(&output).contains("advice    enough") {
            break;
        }
        assert!(round < 5, "{}", stdout(&output));
        // The readings so far are in the list as well.
        rows.clear();
        for line in fs::read_to_string(&list).unwrap().lines() {
            let angles = line.strip_suffix(',').map(|row| row.split(','));
            let Some(angles) = angles else {
                writeln!(rows, "{line}").unwrap();
                continue;
            };
            let angles: Vec<f64> = angles
                .map(|x| x.parse::<f64>().unwrap().to_radians())
                .collect();
            let geometry = Geometry::new(angles[0], angles[1], angles[2]).unwrap();
            writeln!(rows, "{line}{}", truth.value(&geometry)).unwrap();
        }
        fs::write(&scan, &rows).unwrap();
    }
    let output = run_fit([
        scan.to_str().unwrap(),
        "--model",
        "three+n",
        "--weights",
        "relative",
    ]);
    let text = unwrapped(&String::from_utf8(output.stdout).unwrap());
    assert!(text.contains("k1 0.25000"), "{text}");
    let count = Measurements::read_csv(&scan).unwrap().readings().len();
    assert!((8..=36).contains(&count), "{count}");
}

#[test]
fn the_list_of_an_instrument_has_no_sign_and_azimuth_180_is_forward() {
    let output = run(&["--in-plane", "--readings", "6", "--list", "-"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    assert_eq!(text.lines().count(), 6, "{text}");
    for line in text.lines() {
        let numbers: Vec<f64> = line.split(' ').map(|x| x.parse().unwrap()).collect();
        assert!(
            numbers[1] >= 0.0 && (numbers[2] == 0.0 || numbers[2] == 180.0),
            "{line}"
        );
    }
    assert!(text.contains(" 180\n"), "{text}");
}

#[test]
fn a_scan_is_reviewed_and_what_it_lacks_is_named() {
    let output = run(&["--review", &z307(), "--wavelength", "0.63"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for part in [
        "112 readings",
        "stay within 1.1 times that error",
        "incidences beyond 70 deg",
        "outside the plane of incidence",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    let needed = text.lines().find(|line| line.contains("within 1.1 times"));
    let needed: u32 = needed
        .unwrap()
        .split_whitespace()
        .nth(1)
        .unwrap()
        .parse()
        .unwrap();
    assert!(needed <= 20, "{text}");
}

/// Whether the advice for a scan is that the model fails.
fn fails(scan: &Measurements) -> bool {
    let options = PlanOptions::default().within(scan);
    let plan = plan_readings(Some(scan), &options).unwrap();
    matches!(plan.advice, Advice::Fails { .. })
}

/// Of the measured samples, those that the model does not follow, and no other.
#[test]
fn the_model_fails_for_mirrors_and_narrow_peaks_and_for_no_paint_or_anodise() {
    for entry in fs::read_dir(in_workspace("data/measured")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "csv") {
            let scan = Measurements::read_csv(&path).unwrap();
            let failing = scan
                .by_wavelength()
                .iter()
                .filter(|scan| fails(scan))
                .count();
            assert_eq!(failing, 0, "{}", path.display());
        }
    }
    let Some(shared) = shared_data() else {
        return;
    };
    for (folder, expected) in [
        ("mwir", true),
        ("satellite", true),
        ("rt300s", false),
        ("ptfe", false),
    ] {
        for entry in fs::read_dir(shared.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "csv") {
                let scan = Measurements::read_csv(&path).unwrap();
                for scan in scan.by_wavelength() {
                    assert_eq!(fails(&scan), expected, "{}", path.display());
                }
            }
        }
    }
}

/// A broad lobe with a spike in the mirror direction: the advice names it, and what to do.
#[test]
fn a_scan_that_the_model_does_not_follow_gets_no_list_but_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let scan = folder.path().join("mirror.csv");
    let mut rows = "psi_deg,theta_deg,brdf_per_sr\n".to_owned();
    for psi in [10, 30, 50, 70] {
        for theta in (-80..=80).step_by(10) {
            let spike = if theta == -psi { 50.0 } else { 0.0 };
            writeln!(rows, "{psi},{theta},{}", 0.05 + spike).unwrap();
        }
    }
    fs::write(&scan, rows).unwrap();
    let output = run(&[scan.to_str().unwrap(), "--in-plane"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for part in [
        "advice    the model fails for this surface: it misses the readings by ",
        "most of all at the mirror direction",
        "brdf fit FILE --model three+n",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    assert!(!text.contains("rank"), "{text}");
}

#[test]
fn incorrect_usage_says_what_is_expected() {
    for (arguments, part) in [
        (vec![z307()], "2 wavelengths"),
        (
            vec![z307(), "--wavelength".to_owned(), "0.5".to_owned()],
            "expected one of 0.63079, 0.85223",
        ),
        (
            vec!["--material".to_owned(), "glass".to_owned()],
            "expected one of paint, anodise, metal, unknown",
        ),
        (vec!["--review".to_owned()], "<FILE>"),
        (
            vec![
                "--from-source".to_owned(),
                "89".to_owned(),
                "--incidence".to_owned(),
                "40".to_owned(),
                "--view".to_owned(),
                "0:10".to_owned(),
            ],
            "--step-view",
        ),
    ] {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let output = run(&arguments);
        assert_eq!(
            output.status.code(),
            Some(2),
            "{arguments:?}: {}",
            stdout(&output)
        );
        assert!(
            stderr(&output).contains(part),
            "{part} in {}",
            stderr(&output)
        );
    }
}
