//! The viewer as a program, beside the command line: the same numbers, and pictures without a
//! display.

use std::process::Output;

use brdf_core::ModelParameters;
use brdf_fit::Fit;
use brdf_fit::report::{Document, Report};
use brdf_tests::{fit_command, in_workspace, viewer_command};
use brdf_viewer::Viewer;
use brdf_viewer::intent::Intent;
use brdf_viewer::output_kind::OutputKind;
use brdf_viewer::platform::current::NativeDialogs;
use brdf_viewer::screenshot::OffscreenWindow;
use brdf_viewer::state::fit_settings::{Scope, Stages};
use brdf_viewer::state::saved::Settings;

fn viewer(arguments: &[&str]) -> Output {
    viewer_command()
        .args(arguments)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .expect("the program starts")
}

/// A report without what differs from run to run.
fn without_times(mut report: Report) -> Report {
    if let Some(fit) = &mut report.fit {
        let Fit {
            seconds,
            stage1,
            stage2,
            global_check,
            ..
        } = fit;
        *seconds = 0.0;
        for stage in [stage1, stage2].into_iter().flatten() {
            stage.seconds = 0.0;
        }
        if let Some(check) = global_check {
            check.seconds = 0.0;
        }
    }
    report
}

#[test]
fn the_viewer_fits_as_the_command_line_does_to_the_last_digit() {
    let folder = tempfile::tempdir().unwrap();
    let (by_fit, by_viewer) = (
        folder.path().join("fit.json"),
        folder.path().join("viewer.json"),
    );
    let scan = in_workspace("data/measured/z307_on_aluminium.csv");
    let output = fit_command()
        .arg(&scan)
        .args(["--n", "1.5", "--json"])
        .arg(&by_fit)
        .output()
        .unwrap();
    assert!(output.status.success());

    let mut window = OffscreenWindow::new([900.0, 600.0], 1.0);
    let mut viewer = Viewer::new(
        window.context(),
        Box::new(NativeDialogs),
        Settings::in_memory(),
    );
    viewer.state.apply(Intent::Open(vec![scan]));
    window.picture(&mut viewer).unwrap();
    viewer.state.apply(Intent::Fit(Stages::Both, Scope::All));
    window.picture(&mut viewer).unwrap();
    viewer
        .state
        .apply(Intent::Write(OutputKind::Fit, by_viewer.clone()));
    while !by_viewer.exists() {
        window.picture(&mut viewer).unwrap();
    }
    let reports = |path| {
        let reports = Document::read(path).unwrap().reports;
        reports
            .into_iter()
            .map(without_times)
            .collect::<Vec<Report>>()
    };
    let (expected, found) = (reports(&by_fit), reports(&by_viewer));
    assert_eq!(expected.len(), 2);
    assert_eq!(found, expected);

    // And what the viewer wrote is fitted again by the command line.
    let again = folder.path().join("again.json");
    let output = fit_command()
        .arg(in_workspace("data/measured/z307_on_aluminium.csv"))
        .arg("--again")
        .arg(&by_viewer)
        .arg("--json")
        .arg(&again)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let at = |reports: Vec<Report>| -> Vec<ModelParameters> {
        reports
            .iter()
            .map(|report| report.fit.as_ref().unwrap().at())
            .collect()
    };
    assert_eq!(at(reports(&again)), at(expected));
}

#[test]
fn a_screenshot_needs_no_display() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("window.png");
    let scan = in_workspace("data/measured/z307_on_aluminium.csv");
    let (path, scan) = (path.to_str().unwrap(), scan.to_str().unwrap());
    let mut sizes = Vec::new();
    for options in [
        ["--size", "900x600", "--theme", "light", "--log"].as_slice(),
        &[
            "--size", "900x600", "--theme", "dark", "--fit", "--layout", "panels",
        ],
        &[
            "--size",
            "900x600",
            "--scale",
            "2",
            "--residuals",
            "--results",
            "profile",
        ],
    ] {
        let mut arguments = vec![scan, "--screenshot", path];
        arguments.extend(options);
        let output = viewer(&arguments);
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        let bytes = std::fs::read(path).unwrap();
        assert!(bytes.starts_with(b"\x89PNG"));
        // Width and height stand in the header.
        sizes.push(
            [&bytes[16..20], &bytes[20..24]]
                .map(|side| u32::from_be_bytes(side.try_into().unwrap())),
        );
    }
    assert_eq!(sizes, [[900, 600], [900, 600], [1800, 1200]]);
}

#[test]
fn a_screenshot_does_not_take_the_place_of_a_scan() {
    let folder = tempfile::tempdir().unwrap();
    let scan = folder.path().join("paint.csv");
    let fit = folder.path().join("fit.json");
    let text = std::fs::read(in_workspace("data/measured/z307_on_aluminium.csv")).unwrap();
    std::fs::write(&scan, &text).unwrap();
    let fitted = fit_command()
        .arg(&scan)
        .args(["--n", "1.5", "--json"])
        .arg(&fit)
        .output();
    assert!(fitted.unwrap().status.success());
    let [scan, fit] = [&scan, &fit].map(|path| path.to_str().unwrap());
    // Its own, and that of a fit.
    for (file, picture) in [(scan, scan), (fit, fit), (fit, scan)] {
        let before = std::fs::read(picture).unwrap();
        let output = viewer(&[file, "--screenshot", picture, "--size", "900x600"]);
        assert_eq!(output.status.code(), Some(2));
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(message.contains("is an input of this command"), "{message}");
        assert_eq!(std::fs::read(picture).unwrap(), before);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_screenshot_that_cannot_be_written_is_told_by_its_own_name() {
    let output = viewer(&["--screenshot", "/proc/a.png", "--size", "900x600"]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(
        message.contains("/proc/a.png: cannot be written"),
        "{message}"
    );
    assert!(!message.contains(".tmp"), "{message}");
}

#[test]
fn bad_usage_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("window.png");
    let path = path.to_str().unwrap();
    for (arguments, words) in [
        (["--size", "10x10"].as_slice(), "900x600"),
        (&["--size", "wide"], "WIDTHxHEIGHT"),
        (&["--scale", "99"], "0.5 to 4"),
        (
            &["--size", "8192x8192", "--scale", "4", "--screenshot", path],
            "--size 8192x8192 with --scale 4: 1074 million pixels: expected 67 million at most",
        ),
        (&["--model", "phong"], "expected one of"),
        (
            &["/no/such/scan.csv", "--screenshot", path],
            "/no/such/scan.csv",
        ),
        (
            &["--screenshot", "/no/such/folder/a.png"],
            "/no/such/folder/a.png",
        ),
    ] {
        let output = viewer(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(message.contains(words), "{message}");
        assert!(!message.contains("panicked"), "{message}");
    }
    // Without a display a window cannot be opened, and the message says what to do.
    let output = viewer(&[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--screenshot"));
}
