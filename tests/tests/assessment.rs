//! The assessment of a fit by the program: cross-validation, model comparison, robust fits, energy.

use std::fs;
use std::process::Output;

use brdf_fit::report::Document;
use brdf_tests::{in_workspace, run_fit};

fn measured(name: &str) -> String {
    let path = in_workspace("data/measured").join(name);
    path.to_str().unwrap().to_owned()
}

fn run(extra: &[&str]) -> Output {
    let path = measured("z307_on_aluminium.csv");
    let mut arguments = vec![path.as_str()];
    arguments.extend(extra);
    run_fit(arguments)
}

fn text(extra: &[&str]) -> String {
    let output = run(extra);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn the_tables_contain_intervals_cross_validation_models_and_physics() {
    let text = text(&["--n", "1.5", "--verbose"]);
    for part in [
        "correlations: k2-kD",
        "leave-one-incidence-out cross-validation: rms 44 %",
        "  three+n         3.0 ",
        "verdict   smith+n suffices",
        "k2 and k1 rest on 70 deg",
        "reflectance rho(psi):",
        "facet reflectance at normal incidence: k2 implies 0.0096, n = 1.5 implies 0.0400",
    ] {
        assert!(text.contains(part), "no \"{part}\" in\n{text}");
    }
    assert!(!text.contains("ggx"));
}

#[test]
fn compare_adds_the_reference_models_and_a_line_for_each_model() {
    assert!(text(&["--n", "1.5", "--compare", "-v"]).contains("  ggx+n"));
    let csv = text(&["--n", "1.5", "--compare", "--params-only"]);
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(header[2..4], ["n", "model"]);
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let models: Vec<&str> = rows.iter().take(8).map(|row| row[3]).collect();
    let expected = [
        "three",
        "three+n",
        "smith+n",
        "power+n",
        "ggx",
        "ggx+n",
        "beckmann",
        "beckmann+n",
    ];
    assert_eq!(models, expected);
    assert_eq!(rows.len(), 16);
    let n = |row: &[&str]| row[2].parse::<f64>().unwrap();
    assert_eq!(n(&rows[0]), 1.5);
    assert!((n(&rows[1]) - 1.1094).abs() < 1e-3);
}

#[test]
fn a_model_can_be_chosen_by_name_or_by_the_data() {
    let free = text(&["--model", "three+n", "--params-only"]);
    assert!(free.lines().nth(1).unwrap().contains(",three+n,"));
    assert!(text_of_three_n().contains("  three      not fitted: no refractive index"));
    let auto = text(&["--model", "auto", "--n", "1.5", "--params-only"]);
    assert!(auto.lines().nth(1).unwrap().contains(",smith+n,"));
    assert!(auto.lines().nth(2).unwrap().contains(",smith+n,"));
    let lambert = text(&["--model", "lambert", "--n", "1.5"]);
    assert!(lambert.contains("model lambert: Lambertian only"));
    let output = run(&["--model", "phong"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("\"phong\": expected one of lambert"));
}

/// Without a refractive index only the models that do not need one are fitted.
fn text_of_three_n() -> String {
    text(&["--model", "three+n", "--verbose"])
}

#[test]
fn robust_fits_list_what_they_reject() {
    let folder = tempfile::tempdir().unwrap();
    let scan = folder.path().join("scan.csv");
    let mut lines = vec!["psi_deg,theta_deg,brdf_per_sr".to_owned()];
    for psi in [0, 20, 40, 60] {
        for theta in (-70..=70).step_by(5) {
            let ripple = 1.0 + 0.01 * f64::from(theta * (psi + 3)).sin();
            let bad = if (psi, theta) == (20, 35) { 3.0 } else { 1.0 };
            lines.push(format!("{psi},{theta},{}", 0.1 * ripple * bad));
        }
    }
    fs::write(&scan, lines.join("\n")).unwrap();
    let arguments = |loss: &str| {
        let path = scan.to_str().unwrap();
        let output = run_fit([
            path, "--n", "1.5", "--model", "lambert", "--robust", loss, "-v",
        ]);
        String::from_utf8(output.stdout).unwrap()
    };
    for loss in ["huber", "tukey"] {
        let text = arguments(loss);
        assert!(text.contains("1 reading rejected"), "{text}");
        assert!(
            text.contains("psi 20 deg, theta 35 deg, phi 0 deg: 0."),
            "{text}"
        );
    }
}

/// What the file says of its readings, n among it, stays with those that are not rejected.
#[test]
fn a_robust_fit_takes_the_index_of_the_file_for_its_assessment_too() {
    let folder = tempfile::tempdir().unwrap();
    let sample = in_workspace("data/synthetic/table1_003_0.91um_noise5.csv");
    let mut scan = fs::read_to_string(sample).unwrap();
    scan.push_str("0.91,30,40,9\n");
    let path = folder.path().join("scan.csv");
    fs::write(&path, scan).unwrap();
    let output = run_fit([path.to_str().unwrap(), "--robust", "tukey", "--verbose"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(
        text.contains("least-squares fits without the rejected readings"),
        "{text}"
    );
    assert!(text.contains("  verdict   three suffices"), "{text}");
    assert!(text.contains("  quality   good"), "{text}");
}

#[test]
fn energy_is_conserved_where_asked_for() {
    let sample = in_workspace("data/synthetic");
    let file = fs::read_dir(sample)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .find(|path| {
            path.to_string_lossy().contains("002") && path.to_string_lossy().contains("1.04")
        })
        .expect("the scan of sample 002");
    let path = file.to_str().unwrap();
    let run = |extra: &str| {
        let output = run_fit([path, extra, "--verbose"]);
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        String::from_utf8(output.stdout).unwrap()
    };
    let text = run("--energy-conserving=80");
    assert!(
        text.contains("energy: constrained by rho(psi) <= 1 up to 80 deg, which raises E from")
    );
    assert!(run("--energy-conserving").contains("up to 85 deg"));
}

#[test]
fn masks_and_solid_angles_weigh_the_readings() {
    let text = text(&[
        "--n",
        "1.5",
        "--mask-source",
        "12",
        "--mask-mirror",
        "2",
        "--weights",
        "solid-angle",
    ]);
    let text = brdf_tests::unwrapped(&text);
    assert!(text.contains(
        "readings weighted by solid angle, 0 within 12 deg of the source, 0 within 2 deg of the mirror direction"
    ));
    assert!(text.contains("with a weight of zero, without influence on the fit"));
}

#[test]
fn the_json_of_an_assessed_fit_reads_back() {
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("fit.json");
    text(&["--n", "1.5", "--compare", "--json", json.to_str().unwrap()]);
    let written = fs::read_to_string(&json).unwrap();
    let document: Document = serde_json::from_str(&written).unwrap();
    let assessment = document.reports[0].assessment.as_ref().unwrap();
    assert_eq!(assessment.models.len(), 10);
    assert_eq!(
        serde_json::to_string_pretty(&document).unwrap(),
        written.trim_end()
    );
}

#[test]
fn a_folder_of_pictures_has_a_page_that_needs_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let plots = folder.path().join("new/plots");
    text(&["--n", "1.5", "--plot", plots.to_str().unwrap()]);
    let page = fs::read_to_string(plots.join("report.html")).unwrap();
    assert_eq!(page.matches("<figure>").count(), 12);
    assert_eq!(page.matches("<svg").count(), 12);
    assert!(!page.contains("src=") && !page.contains("href=\"http"));
    let files: Vec<String> = fs::read_dir(&plots)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    for end in [".svg", ".png"] {
        assert_eq!(
            files.iter().filter(|name| name.ends_with(end)).count(),
            12,
            "{files:?}"
        );
    }
}

/// A scan as text: incidences and views in degrees, f_r of each.
fn scan_file(folder: &std::path::Path, rows: impl Iterator<Item = (i32, i32, f64)>) -> String {
    let path = folder.join("scan.csv");
    let header = "psi_deg,theta_deg,brdf_per_sr".to_owned();
    let lines = rows.map(|(psi, theta, brdf)| format!("{psi},{theta},{brdf}"));
    let lines: Vec<String> = std::iter::once(header).chain(lines).collect();
    fs::write(&path, lines.join("\n")).unwrap();
    path.to_str().unwrap().to_owned()
}

/// A background taken off too much: the best Lambertian weight is 0, and no parameter is left.
#[test]
fn a_model_all_of_whose_parameters_are_on_their_bounds_does_not_panic() {
    let folder = tempfile::tempdir().unwrap();
    let angles = [0, 30, 60]
        .into_iter()
        .flat_map(|psi| (-80..=80).step_by(10).map(move |theta| (psi, theta)));
    let rows = angles.map(|(psi, theta)| {
        let peak = if theta == -psi { 1.0 } else { -0.3 };
        (psi, theta, peak)
    });
    let file = scan_file(folder.path(), rows);
    for extra in [
        "--compare",
        "--model=lambert",
        "--robust=huber",
        "--robust=tukey",
    ] {
        let output = run_fit([file.as_str(), "--n", "1.5", extra]);
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
}

#[test]
fn tiny_scans_have_no_numbers_that_are_none() {
    let folder = tempfile::tempdir().unwrap();
    for count in [2, 4, 5, 6] {
        let rows = (0..count).map(|i| (20 * (i % 3), 10 * i - 20, 0.1 + 0.03 * f64::from(i % 4)));
        let file = scan_file(folder.path(), rows);
        let json = folder.path().join("fit.json");
        let model = if count == 2 { "lambert" } else { "three" };
        let output = run_fit([
            file.as_str(),
            "--n",
            "1.5",
            "--model",
            model,
            "--json",
            json.to_str().unwrap(),
        ]);
        let text = String::from_utf8_lossy(&output.stdout);
        if output.status.success() {
            assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        }
        let document = fs::read_to_string(&json).unwrap();
        assert!(serde_json::from_str::<Document>(&document).is_ok());
    }
}

#[test]
fn many_incidences_are_assessed_in_folds() {
    let folder = tempfile::tempdir().unwrap();
    let angles = (0..80).flat_map(|psi| (-80..=80).step_by(10).map(move |theta| (psi, theta)));
    let rows = angles.map(|(psi, theta)| {
        let off = f64::from(theta + psi) / 20.0;
        (psi, theta, 0.05 + 0.2 / (1.0 + off * off))
    });
    let file = scan_file(folder.path(), rows);
    let output = run_fit([file.as_str(), "--n", "1.5", "--verbose"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        text.contains("leave-one-incidence-out cross-validation: rms"),
        "{text}"
    );
    assert!(text.contains("the 80 incidences are left out several at a time, in 24 folds"));
}

#[test]
fn the_page_of_the_pictures_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("report.html");
    let output = run(&[
        "--n",
        "1.5",
        "--plot",
        folder.path().to_str().unwrap(),
        "--json",
        page.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(2));
    assert!(!page.exists());
}
