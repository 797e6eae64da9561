//! `fit`, and what `brdf` has around it, as their user meets them, on input that is in order.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use brdf_core::{Geometry, ThreeParameterBrdf};
use brdf_fit::report::{CURVE_COLUMNS, Document, PARAMETER_COLUMNS};
use brdf_fit::{FitOptions, Measurements, RefractiveIndex, fit};
use brdf_tests::{brdf_command, fit_command, in_workspace, run_fit, run_with_input, without_times};
use serde_json::Value;

fn measured(file: &str) -> String {
    in_workspace("data/measured")
        .join(file)
        .to_str()
        .unwrap()
        .to_owned()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn succeeded(output: &Output) {
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(output.stderr.is_empty(), "a pipe gets no progress bar");
}

#[test]
fn the_table_tells_every_step() {
    let output = run_fit([
        &measured("z307_on_aluminium.csv"),
        "--n",
        "1.5",
        "--verbose",
    ]);
    succeeded(&output);
    let text = stdout(&output);
    for expected in [
        "Aeroglaze Z307",
        "0.63079 um, n = 1.5, 112 readings",
        "initial      ",
        "stage 1      0.0118084    0.0145258     0.770271     0.655175",
        "stage 2      0.0228598    0.0179801     0.190763      2.83966      2.83966       112",
        "LM: no further reduction",
        "stage 1: psi <= 60 deg",
        "k2, kD by least squares over the mirror readings",
        "psi deg              0           10           30           50           70",
        "readings             1           28           28           28           27",
        "global check: no lower minimum",
        "0.85223 um, n = 1.5, 112 readings",
    ] {
        assert!(text.contains(expected), "no \"{expected}\" in:\n{text}");
    }
}

#[test]
fn the_parameters_for_scripts_are_those_of_the_library() {
    let path = measured("z307_on_aluminium.csv");
    let output = run_fit([path.as_str(), "--n", "1.5", "--params-only"]);
    succeeded(&output);
    let mut reader = csv::Reader::from_reader(output.stdout.as_slice());
    assert_eq!(reader.headers().unwrap(), PARAMETER_COLUMNS.as_slice());
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    let scans = Measurements::read_csv(&path).unwrap().by_wavelength();
    let records: Vec<_> = reader.records().map(Result::unwrap).collect();
    assert_eq!(records.len(), scans.len());
    for (record, scan) in records.iter().zip(scans) {
        let fit = fit(&scan, &options).unwrap();
        let stage1 = fit.stage1.unwrap();
        let (p, q) = (fit.parameters, stage1.parameters);
        let numbers = [
            p.k2,
            p.kd,
            p.k1,
            fit.e_percent,
            q.k2,
            q.kd,
            q.k1,
            stage1.e_percent.own,
        ];
        for (i, number) in numbers.into_iter().enumerate() {
            assert_eq!(record[3 + i].parse::<f64>().unwrap(), number);
        }
        assert_eq!(&record[0], path.as_str());
        assert_eq!(&record[11], "ok");
    }
}

#[test]
fn every_run_is_the_same() {
    let run = |threads: &str| {
        let files = ["z307_on_aluminium.csv", "titanium_anodise.csv"].map(measured);
        fit_command()
            .env("RAYON_NUM_THREADS", threads)
            .args(files)
            .args(["--n", "1.5", "--params-only", "--stage1", "nm"])
            .output()
            .unwrap()
            .stdout
    };
    assert_eq!(run("1"), run("2"));
    assert_eq!(run("2"), run("2"));
}

#[test]
fn the_json_reads_back_and_the_curves_agree_with_the_model() {
    let folder = tempfile::tempdir().unwrap();
    let (json, curves) = (
        folder.path().join("fit.json"),
        folder.path().join("curves.csv"),
    );
    let output = fit_command()
        .arg(measured("titanium_anodise.csv"))
        .args(["--n", "1.5", "--json"])
        .arg(&json)
        .arg("--curves")
        .arg(&curves)
        .output()
        .unwrap();
    succeeded(&output);

    let document: Document = serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
    assert_eq!((document.format_version, document.reports.len()), (1, 2));
    let written = serde_json::to_value(&document).unwrap();
    let original: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
    assert_eq!(written, original);

    let mut reader = csv::Reader::from_path(&curves).unwrap();
    assert_eq!(reader.headers().unwrap(), CURVE_COLUMNS.as_slice());
    let mut rows = 0;
    for record in reader.records().map(Result::unwrap) {
        let number = |i: usize| record[i].parse::<f64>().unwrap();
        let report = document
            .reports
            .iter()
            .find(|r| r.wavelength_um == Some(number(1)))
            .unwrap();
        let fit = report.fit.as_ref().unwrap();
        let brdf = ThreeParameterBrdf::new(fit.parameters, fit.n).unwrap();
        let [psi, theta, phi] = [2, 3, 4].map(|i| number(i).to_radians());
        let theory = brdf.value(&Geometry::new(psi, theta, phi).unwrap());
        assert!((number(9) / theory - 1.0).abs() < 1e-9);
        rows += 1;
    }
    assert_eq!(rows, 108 + 104);
    assert_eq!(
        fs::read_dir(folder.path()).unwrap().count(),
        2,
        "nothing temporary is left"
    );
}

#[test]
fn a_fit_again_gives_the_same_numbers_to_the_last_digit() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["first.json", "second.json"].map(|name| folder.path().join(name));
    let files = ["titanium_anodise.csv", "z307_on_aluminium.csv"].map(measured);
    let run = |options: &[&str], json: &Path| {
        let mut command = fit_command();
        let command = command.args(&files).args(options).arg("--json").arg(json);
        succeeded(&command.output().unwrap());
    };
    let odd = "--model power+n --hold p=0.5 --stage1 nm --stage1-limit 41.4 --weights solid-angle \
               --g1 0=1,70=0.3 --max-iterations 500";
    run(&odd.split_whitespace().collect::<Vec<_>>(), &first);
    run(&["--again", first.to_str().unwrap()], &second);
    assert_eq!(without_times(&first), without_times(&second));
    let options = &without_times(&second)["reports"][0]["fit"]["options"];
    assert_eq!(options["held"], serde_json::json!({ "p": 0.5 }));
}

#[test]
fn readings_that_a_fit_left_out_are_left_out_again() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["first.json", "second.json"].map(|name| folder.path().join(name));
    let scan = measured("z307_on_aluminium.csv");
    let run = |options: &[&str], json: &Path| {
        let mut command = fit_command();
        let command = command.arg(&scan).args(options).arg("--json").arg(json);
        let output = command.output().unwrap();
        succeeded(&output);
        String::from_utf8(output.stdout).unwrap()
    };
    run(&["--n", "1.5"], &first);
    // As the viewer writes it.
    let mut document: Value = serde_json::from_str(&fs::read_to_string(&first).unwrap()).unwrap();
    document["reports"][0]["left_out"] = serde_json::json!([0, 5, 111]);
    fs::write(&first, document.to_string()).unwrap();
    let text = run(&["--again", first.to_str().unwrap()], &second);
    assert!(text.contains("3 readings are left out by choice"), "{text}");
    let again = Document::read(&second).unwrap().reports.remove(0);
    let all = Measurements::read(&scan, &brdf_fit::ReadOptions::default()).unwrap();
    let used = all.by_wavelength()[0].without(&[0, 5, 111]);
    let options = &again.fit.as_ref().unwrap().options;
    let (expected, _) = brdf_fit::Report::new(&used, options, brdf_fit::Depth::Fit);
    assert_eq!((again.readings, again.left_out), (109, vec![0, 5, 111]));
    assert_eq!(again.fit.unwrap().at(), expected.fit.unwrap().at());
}

#[test]
fn the_curves_of_every_model_are_of_their_own_scan() {
    let folder = tempfile::tempdir().unwrap();
    let curves = folder.path().join("curves.csv");
    let files = ["titanium_anodise.csv", "z307_on_aluminium.csv"].map(measured);
    let mut command = fit_command();
    command
        .args(files)
        .args(["--n", "1.5", "--params-only", "--compare"]);
    succeeded(&command.arg("--curves").arg(&curves).output().unwrap());
    let mut reader = csv::Reader::from_path(&curves).unwrap();
    let records = reader.records().map(Result::unwrap);
    let anodised = records.filter(|record| record[0].ends_with("titanium_anodise.csv"));
    assert_eq!(anodised.count(), 8 * (108 + 104));
}

#[test]
fn synthetic_scans_bring_their_index_and_give_back_table_1() {
    let path = in_workspace("data/synthetic/table1_001_0.44um.csv");
    let output = run_fit([path.to_str().unwrap(), "--params-only"]);
    succeeded(&output);
    let text = stdout(&output);
    let fields: Vec<&str> = text.lines().nth(1).unwrap().split(',').collect();
    assert_eq!(fields[2], "1.699");
    assert_eq!(fields[4], "0", "kD is exactly on its bound");
    assert!((fields[3].parse::<f64>().unwrap() - 1.137).abs() < 1e-8);
    assert!((fields[5].parse::<f64>().unwrap() - 0.130).abs() < 1e-9);
}

#[test]
fn the_index_can_be_given_for_each_wavelength() {
    let path = measured("z307_on_aluminium.csv");
    let output = run_fit([&path, "--n", "0.63=1.60,0.85=1.58", "--params-only"]);
    succeeded(&output);
    let text = stdout(&output);
    let index = |line: usize| text.lines().nth(line).unwrap().split(',').nth(2).unwrap();
    assert_eq!((index(1), index(2)), ("1.6", "1.58"));
}

/// The same scan in the other convention, as instruments write it.
#[test]
fn another_convention_gives_the_same_fit() {
    let original = fs::read_to_string(measured("z307_on_aluminium.csv")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("z307_on_aluminium.csv");
    let turned: String = original
        .lines()
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            let Ok(theta) = fields.get(2).unwrap_or(&"").parse::<f64>() else {
                return format!("{}\r\n", line.replace(',', ";"));
            };
            let row = format!("{};{};{};{}\r\n", fields[0], fields[1], -theta, fields[3]);
            row.replace('.', ",")
        })
        .collect();
    fs::write(&path, format!("\u{feff}{turned}")).unwrap();
    let run = |path: &str, convention: &[&str]| {
        let mut arguments = vec![path, "--n", "1.5", "--params-only"];
        arguments.extend(convention);
        let text = stdout(&run_fit(arguments));
        text.lines()
            .map(|line| line.split_once(',').unwrap().1.to_owned())
            .collect::<Vec<_>>()
    };
    let turned_back = run(path.to_str().unwrap(), &["--theta-positive", "forward"]);
    assert_eq!(turned_back, run(&measured("z307_on_aluminium.csv"), &[]));

    let json = folder.path().join("fit.json");
    let told = run_fit([
        path.to_str().unwrap(),
        "--n",
        "1.5",
        "--theta-positive",
        "forward",
        "--json",
        json.to_str().unwrap(),
    ]);
    let forward = "theta positive on the side of the mirror direction";
    let words = |output: &Output| {
        let text = stdout(output);
        brdf_tests::unwrapped(&text)
    };
    assert!(words(&told).contains(forward));
    // What is fitted again is read again as it was.
    let again = run_fit([path.to_str().unwrap(), "--again", json.to_str().unwrap()]);
    assert!(words(&again).contains(forward));

    let wrong = run_fit([path.to_str().unwrap(), "--n", "1.5"]);
    assert!(
        words(&wrong).contains("--theta-positive forward"),
        "{}",
        stdout(&wrong)
    );
}

#[test]
fn stages_methods_limit_and_weights_can_be_chosen() {
    let path = measured("z307_on_aluminium.csv");
    let run = |extra: &[&str]| {
        let mut arguments = vec![path.as_str(), "--n", "1.5", "--verbose"];
        arguments.extend(extra);
        let output = run_fit(arguments);
        succeeded(&output);
        stdout(&output)
    };
    let text = run(&[
        "--stage1",
        "nelder-mead",
        "--stage2",
        "nm",
        "--stage1-limit",
        "30",
    ]);
    assert!(text.contains("NM: simplex converged"));
    assert!(text.contains("stage 1: psi <= 30 deg"));
    assert!(!run(&["--stage1", "none"]).contains("stage 1"));
    let alone = run(&["--stage2", "none"]);
    assert!(alone.contains("stage 1 alone, psi <= 60 deg: 85 readings"));
    assert!(!alone.contains("stage 2") && alone.contains("0.655175"));
    assert!(run(&["--stage2", "none", "--params-only"]).contains("ok (stage 1 alone)"));
    assert!(run(&["--stage1-limit", "5"]).contains("stage 1 skipped: 1 reading up to 5 deg"));
    let weighted = run(&["--g1", "60=1,70=0", "--g2", "-90=0.5,0=1"]);
    assert!(!weighted.contains("2.83966"));
    assert!(weighted.contains("readings weighted by g1(psi), g2(theta)"));
    let text = run(&["--max-iterations", "1"]);
    assert!(text.contains("stage 2 reached its iteration limit"));
    assert!(text.contains("found and adopted a lower minimum"));
    assert!(text.contains("result       0.0228598    0.0179801     0.19076"));
}

#[test]
fn parameters_can_be_fixed() {
    let path = measured("z307_on_aluminium.csv");
    let output = run_fit([path.as_str(), "--n", "1.5", "--fix", "K1=0.2,kd=0.02", "-v"]);
    succeeded(&output);
    let text = stdout(&output);
    assert!(
        text.contains("  fit       fixed: kD = 0.02, k1 = 0.2\n"),
        "{text}"
    );
    assert!(text.contains("no lower minimum at the fixed k1"));
    let value_of = |name: &str| text.contains(&format!("\n  {name:<9}     "));
    assert!(
        value_of("k2") && !value_of("kD") && !value_of("k1"),
        "{text}"
    );
    let output = run_fit([
        path.as_str(),
        "--n",
        "1.5",
        "--fix",
        "k1=0.2",
        "--params-only",
        "--compare",
    ]);
    succeeded(&output);
    let text = stdout(&output);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    assert!(reader.records().all(|record| &record.unwrap()[6] == "0.2"));
}

#[test]
fn hold_is_an_older_name_of_fix() {
    let path = measured("z307_on_aluminium.csv");
    let run = |option: &str| {
        let output = run_fit([
            path.as_str(),
            "--n",
            "1.5",
            "--params-only",
            option,
            "k1=0.2",
        ]);
        succeeded(&output);
        stdout(&output)
    };
    assert_eq!(run("--fix"), run("--hold"));
    assert!(run("--fix").contains(",0.2,"));
}

#[test]
fn the_limit_of_the_energy_constraint_follows_with_or_without_an_equals_sign() {
    let path = measured("z307_on_aluminium.csv");
    let limit = |words: &[&str]| {
        let arguments = [words, &["--n", "1.5", "--model", "lambert", "--json", "-"]].concat();
        let output = run_fit(arguments);
        succeeded(&output);
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        let limit = &document["reports"][0]["fit"]["options"]["energy_limit_deg"];
        limit.as_f64().unwrap().round()
    };
    let option = "--energy-conserving";
    for (words, expected) in [
        (vec![path.as_str(), option, "80"], 80.0),
        (vec![option, "80", &path], 80.0),
        (vec!["--energy-conserving=80", &path], 80.0),
        (vec![&path, "--energy-conserving=80"], 80.0),
        (vec![option, &path], 85.0),
        (vec![&path, option], 85.0),
    ] {
        assert_eq!(limit(&words), expected, "{words:?}");
    }
}

#[test]
fn a_scan_whose_name_is_a_number_is_no_limit() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(measured("z307_on_aluminium.csv"), folder.path().join("80")).unwrap();
    let output = fit_command()
        .current_dir(folder.path())
        .args(["--n", "1.5", "--model", "lambert", "--params-only"])
        .args(["--energy-conserving", "80"])
        .output()
        .unwrap();
    succeeded(&output);
    assert!(stdout(&output).contains("\n80,0.63079,"));
}

/// The tables without the lines that contain times.
fn without_stages(text: &str) -> Vec<&str> {
    let lines = text.lines();
    lines.filter(|line| !line.starts_with("  stage ")).collect()
}

#[test]
fn the_subcommand_is_the_program() {
    let path = measured("z307_on_aluminium.csv");
    let path = path.as_str();
    let run = |arguments: &[&str]| {
        let output = brdf_command().arg("fit").args(arguments).output().unwrap();
        (output, run_fit(arguments))
    };
    for arguments in [
        vec![path, "--n", "1.5"],
        vec![path, "--n", "1.5", "--params-only", "--compare"],
        vec![path, "--n", "1.5", "--curves", "-"],
        vec![path],
        vec![path, "--n", "1.5", "--fix", "p=1"],
        vec!["no/such/scan.csv"],
    ] {
        let (of_brdf, of_fit) = run(&arguments);
        assert_eq!(of_brdf.status, of_fit.status);
        assert_eq!(of_brdf.stderr, of_fit.stderr);
        let [of_brdf, of_fit] = [of_brdf, of_fit].map(|output| stdout(&output));
        assert_eq!(without_stages(&of_brdf), without_stages(&of_fit));
        assert!(arguments.len() < 3 || arguments[2] != "1.5" || of_fit.len() > 100);
    }
    let (of_brdf, of_fit) = run(&["--help"]);
    let help = stdout(&of_brdf).replace("Usage: brdf fit", "Usage: fit");
    assert_eq!(help, stdout(&of_fit));

    let folder = tempfile::tempdir().unwrap();
    let [of_brdf, of_fit] = ["brdf.json", "fit.json"].map(|name| folder.path().join(name));
    for (mut command, json) in [(brdf_command(), &of_brdf), (fit_command(), &of_fit)] {
        if json == &of_brdf {
            command.arg("fit");
        }
        let output = command
            .args([path, "--n", "1.5", "--json"])
            .arg(json)
            .output();
        succeeded(&output.unwrap());
    }
    assert_eq!(without_times(&of_brdf), without_times(&of_fit));
}

#[test]
fn bash_completes_the_options() {
    let output = brdf_command()
        .args(["completions", "bash"])
        .output()
        .unwrap();
    succeeded(&output);
    let script = stdout(&output);
    for expected in [
        "_brdf()",
        "--energy-conserving",
        "export",
        "trade",
        "-F _brdf",
    ] {
        assert!(script.contains(expected), "no \"{expected}\" in:\n{script}");
    }
    let check = run_with_input(Command::new("bash").arg("-n"), script.as_bytes());
    succeeded(&check);
    let output = brdf_command()
        .args(["completions", "sheel"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn the_figures_of_the_paper_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let figures = folder.path().join("new").join("figures");
    let output = brdf_command()
        .arg("figures")
        .arg(&figures)
        .output()
        .unwrap();
    succeeded(&output);
    let files = stdout(&output);
    assert!(files.lines().count() > 10 && files.lines().all(|file| Path::new(file).is_file()));
}

#[test]
fn the_help_has_an_example_of_each_command() {
    let output = brdf_command().arg("--help").output().unwrap();
    succeeded(&output);
    let text = stdout(&output);
    for command in [
        "fit",
        "export",
        "trade",
        "trade fit",
        "figures",
        "completions",
    ] {
        assert!(
            text.contains(&format!("brdf {command} ")),
            "{command}:\n{text}"
        );
    }
}

#[test]
fn what_is_odd_about_the_readings_is_counted_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("odd.csv");
    let mut text = "psi_deg,theta_deg,brdf_per_sr,temperature\n".to_owned();
    for theta in [60, 50, 50, 40, 30, 20, 10, 5, 0] {
        let brdf = 0.01 + 0.2 / (1.0 + f64::from((theta - 45) * (theta - 45)) / 50.0);
        writeln!(
            text,
            "45,{theta},{},20",
            if theta == 0 { -0.001 } else { brdf }
        )
        .unwrap();
    }
    fs::write(&path, text).unwrap();
    let output = run_fit([
        path.to_str().unwrap(),
        "--n",
        "1.5",
        "--theta-positive",
        "source",
    ]);
    succeeded(&output);
    let text = stdout(&output);
    let text = brdf_tests::unwrapped(&text);
    for expected in [
        "wavelength not stated, n = 1.5, 9 readings",
        "1 reading below zero, kept",
        "1 reading at the same angles as another one, all kept",
        "1 incidence angle: the dependence on the incidence angle is poorly constrained",
        "no reading is near the mirror direction",
        "not used temperature",
    ] {
        assert!(text.contains(expected), "no \"{expected}\" in:\n{text}");
    }
}

#[test]
fn a_flat_scan_has_no_width() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flat.csv");
    let mut text = "psi_deg,theta_deg,brdf_per_sr\n".to_owned();
    for psi in [0, 30, 60] {
        for theta in (-80..=80).step_by(10) {
            // Falls towards grazing, where any specular part would rise.
            let brdf =
                0.3 - f64::from((theta + psi) * (theta + psi)) * -1e-6 - f64::from(psi) * 1e-3;
            writeln!(text, "{psi},{theta},{brdf}").unwrap();
        }
    }
    fs::write(&path, text).unwrap();
    let output = run_fit([path.to_str().unwrap(), "--n", "1.5", "--verbose"]);
    succeeded(&output);
    let text = stdout(&output);
    assert!(text.contains("the data do not determine k1"), "{text}");
    assert!(text.contains("on its bound: k2 = 0"), "{text}");
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let mut child = fit_command()
        .args([measured("z307_on_aluminium.csv").as_str(), "--n", "1.5"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stderr.is_empty());
}

#[test]
fn the_help_names_every_option_with_its_unit_and_default() {
    let output = run_fit(["--help"]);
    succeeded(&output);
    let text = stdout(&output);
    for expected in [
        "--n <INDEX>",
        "--stage1 <METHOD>",
        "--stage2 <METHOD>",
        "in degrees",
        "[default: 60]",
        "[default: levenberg-marquardt]",
        "[default: 10000]",
        "--theta-positive <SIDE>",
        "--phi-zero <SIDE>",
        "source or forward",
        "--params-only",
        "Exit status",
    ] {
        assert!(text.contains(expected), "no \"{expected}\" in:\n{text}");
    }
}

#[test]
fn a_run_without_a_fit_keeps_the_earlier_results() {
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("fit.json");
    let curves = folder.path().join("curves.csv");
    let run = |extra: &[&str]| {
        let scan = measured("z307_on_aluminium.csv");
        let mut arguments = vec![scan.as_str(), "--json", json.to_str().unwrap()];
        arguments.extend(["--curves", curves.to_str().unwrap()]);
        arguments.extend(extra);
        run_fit(arguments)
    };
    succeeded(&run(&["--n", "1.5"]));
    let earlier = [&json, &curves].map(|path| fs::read(path).unwrap());
    // No refractive index is given.
    let failed = run(&[]);
    assert_eq!(failed.status.code(), Some(2));
    let message = String::from_utf8_lossy(&failed.stderr).into_owned();
    assert!(message.contains("the earlier result is kept"), "{message}");
    assert_eq!(
        [&json, &curves].map(|path| fs::read(path).unwrap()),
        earlier
    );
}
