//! `brdf plan` as its user meets it.

use std::fmt::Write as _;
use std::fs;
use std::process::Output;

use brdf_core::{AnyBrdf, Family, Geometry, ModelParameters};
use brdf_fit::Measurements;
use brdf_fit::planning::{Advice, PlanOptions, plan_readings};
use brdf_tests::{brdf_command, generator, in_workspace, run_fit, shared_data, unwrapped};
use rand::seq::index::sample;

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
    let advice = stderr(&output);
    assert!(advice.contains("advice    take 6 readings"), "{advice}");
}

/// Readings in a table with names and a unit of its own, in a file for each incidence.
#[test]
fn a_scan_so_far_is_read_with_the_options_of_fit() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for psi in [20, 40, 60] {
        let file = folder.path().join(format!("{psi}.csv"));
        let mut rows = "Incident,View,R\n".to_owned();
        for theta in (-80..=80).step_by(20) {
            writeln!(
                rows,
                "{psi},{theta},{}",
                5.0 + f64::from(theta).abs() / 40.0
            )
            .unwrap();
        }
        fs::write(&file, rows).unwrap();
        files.push(file.to_str().unwrap().to_owned());
    }
    let reading = [
        "--columns",
        "Incident=psi_deg,View=theta_deg,R=reflectance_factor",
        "--declare",
        "unit=percent",
    ];
    let mut arguments: Vec<&str> = files.iter().map(String::as_str).collect();
    arguments.extend(reading);
    let several = run(&arguments);
    assert_eq!(several.status.code(), Some(2));
    assert!(stderr(&several).contains("3 files: expected one, or --join"));
    arguments.push("--join");
    let output = run(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(
        stdout(&output).contains("27 readings"),
        "{}",
        stdout(&output)
    );
}

#[test]
fn a_review_takes_no_option_of_a_list() {
    for option in ["--tolerance", "--readings", "--step-view", "--largest-view"] {
        let output = run(&["--review", &z307(), "--wavelength", "0.63", option, "6"]);
        assert_eq!(output.status.code(), Some(2), "{option}");
        let message = stderr(&output);
        assert!(message.contains("cannot be used with"), "{message}");
    }
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
            for scan in scan.by_wavelength() {
                assert!(!fails(&scan), "{}", path.display());
                // Nor for a few readings at random.
                for seed in 0..4 {
                    let readings = scan.readings();
                    let chosen = sample(&mut generator(seed), readings.len(), 6);
                    let chosen = chosen.into_iter().map(|i| readings[i]).collect();
                    let few = Measurements::new("few", chosen).unwrap();
                    assert!(!fails(&few), "{} {seed}", path.display());
                }
            }
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
            let from_mirror = f64::from(theta + psi).abs();
            let spike = if from_mirror == 0.0 { 300.0 } else { 0.0 };
            let lobe = 2.0 * (-from_mirror / 20.0).exp();
            writeln!(rows, "{psi},{theta},{}", 0.05 + lobe + spike).unwrap();
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
fn a_scan_without_a_wavelength_has_none_to_choose() {
    let folder = tempfile::tempdir().unwrap();
    let scan = folder.path().join("scan.csv");
    fs::write(
        &scan,
        "psi_deg,theta_deg,brdf_per_sr\n10,20,0.1\n30,-20,0.2\n",
    )
    .unwrap();
    let path = scan.to_str().unwrap();
    let output = run(&[path, "--wavelength", "0.5"]);
    assert!(
        stderr(&output).contains("no scan of 0.5 um: the file states no wavelength"),
        "{}",
        stderr(&output)
    );
    let single = run(&[path, "--incidence", "45", "--in-plane"]);
    assert!(stdout(&single).contains("scene     psi 45 deg, theta 0 ... 85 deg"));
    let review = run(&["--review", path]);
    assert!(stderr(&review).contains("2 readings above zero: expected at least 6"));
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
        (vec!["--review".to_owned()], "FILE"),
        (
            vec!["--incidence".to_owned(), "-5:30".to_owned()],
            "expected degrees from 0 to below 90",
        ),
        (
            vec!["--tolerance".to_owned(), "-0.1".to_owned()],
            "expected a number above 0",
        ),
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
