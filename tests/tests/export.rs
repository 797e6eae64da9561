//! `brdf export` as its user meets it: which fits it takes, and its messages.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use brdf_fit::export::Material;
use brdf_fit::report::Document;
use brdf_tests::{export_command, in_workspace, run_fit};
use tempfile::TempDir;

const BAD: i32 = 2;

/// Two scans of one wavelength each, and one of several.
const SCANS: [&str; 2] = ["table1_001_0.44um.csv", "table1_002_0.62um.csv"];
const SPECTRUM: &str = "tests/data/formats/black_lab.txt";

/// A folder with the fits of some scans.
struct Fits {
    folder: TempDir,
}

impl Fits {
    /// Fits scans of the workspace.
    fn of(files: &[PathBuf]) -> Self {
        let fits = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        let (files, json) = (files.iter().map(|file| file.as_os_str()), fits.json());
        let options = [
            "--n".as_ref(),
            "1.5".as_ref(),
            "--json".as_ref(),
            json.as_os_str(),
        ];
        let output = run_fit(files.chain(options));
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        fits
    }

    fn of_scans(count: usize) -> Self {
        let path = |name: &&str| in_workspace("data/synthetic").join(name);
        Self::of(&SCANS[..count].iter().map(path).collect::<Vec<_>>())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn json(&self) -> PathBuf {
        self.path("fit.json")
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn export(fits: &Path, arguments: &[&str]) -> Output {
    export_command().arg(fits).args(arguments).output().unwrap()
}

fn exported(fits: &Path, arguments: &[&str]) -> String {
    let output = export(fits, arguments);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr), "");
    text(&output.stdout)
}

/// The message where nothing is exported.
fn refused(fits: &Path, arguments: &[&str]) -> String {
    let output = export(fits, arguments);
    assert_eq!(
        (output.status.code(), text(&output.stdout)),
        (Some(BAD), String::new())
    );
    text(&output.stderr)
}

#[test]
fn the_json_of_a_model_is_read_again_as_the_fits_that_were_exported() {
    let fits = Fits::of_scans(2);
    let path = fits.path("model.json");
    // Without -o to standard output, with it to the file only.
    let printed = exported(&fits.json(), &["--to", "json", "--file", SCANS[0]]);
    let to_file = [
        "--to",
        "json",
        "--file",
        SCANS[0],
        "-o",
        path.to_str().unwrap(),
    ];
    assert_eq!(exported(&fits.json(), &to_file), "");
    assert_eq!(fs::read_to_string(&path).unwrap(), printed);
    assert_eq!(exported(&path, &["--to", "json"]), printed);
    for to in ["c", "python"] {
        let of_fits = exported(&fits.json(), &["--to", to, "--file", SCANS[0]]);
        assert_eq!(exported(&path, &["--to", to]), of_fits);
    }
    let material = Material::read(&path).unwrap();
    let document = Document::read(fits.json()).unwrap();
    let parameters = document.reports[0].fit.as_ref().unwrap().parameters;
    let at = material.only().unwrap().brdf.model_parameters();
    assert_eq!(
        [at.k2, at.kd, at.k1, at.n],
        [parameters.k2, parameters.kd, parameters.k1, 1.5]
    );
}

#[test]
fn the_output_does_not_overwrite_the_fits() {
    let fits = Fits::of_scans(1);
    let (path, before) = (fits.json(), fs::read(fits.json()).unwrap());
    let message = refused(&path, &["--to", "json", "-o", path.to_str().unwrap()]);
    assert!(
        message.contains("is an input or another output of this command"),
        "{message}"
    );
    assert_eq!(fs::read(path).unwrap(), before);
}

#[test]
fn one_of_several_files_is_chosen_by_its_name() {
    let fits = Fits::of_scans(2);
    let (path, c) = (fits.json().display().to_string(), ["--to", "c"]);
    let scan = |name: &str| {
        in_workspace("data/synthetic")
            .join(name)
            .display()
            .to_string()
    };
    let files = format!("{}, {}", scan(SCANS[0]), scan(SCANS[1]));
    let message = refused(&fits.json(), &c);
    let expected = format!("error: {path}: there are fits of several files: choose one of {files}");
    assert!(
        message.starts_with(&expected) && message.contains("--file"),
        "{message}"
    );
    let message = refused(&fits.json(), &["--to", "c", "--file", "none.csv"]);
    assert_eq!(
        message,
        format!("error: {path}: no fit of none.csv: expected one of {files}\n")
    );
    let by_name = exported(&fits.json(), &["--to", "c", "--file", SCANS[1]]);
    let by_path = exported(&fits.json(), &["--to", "c", "--file", &scan(SCANS[1])]);
    assert_eq!(by_name, by_path);
    assert!(by_name.contains(SCANS[1]) && by_name.contains("brdf_eval"));
}

#[test]
fn one_of_several_wavelengths_is_chosen() {
    let fits = Fits::of(&[in_workspace(SPECTRUM)]);
    let message = refused(&fits.json(), &["--to", "c"]);
    let several = "there are several fits: choose one of the wavelengths 0.62 um, 0.85223 um";
    assert!(
        message.contains(several) && message.contains("--wavelength"),
        "{message}"
    );
    let message = refused(&fits.json(), &["--to", "c", "--wavelength", "0.7"]);
    let path = fits.json().display().to_string();
    let expected =
        format!("error: {path}: no fit at 0.7 um: expected one of 0.62 um, 0.85223 um\n");
    assert_eq!(message, expected);
    let near = exported(&fits.json(), &["--to", "c", "--wavelength", "0.85"]);
    assert!(near.contains("0.85223"), "{near}");
}

#[test]
fn an_unknown_format_is_reported_with_the_known_ones() {
    let fits = Fits::of_scans(1);
    let message = refused(&fits.json(), &["--to", "obj"]);
    let names = "expected one of json, c, glsl, wgsl, osl, python, mitsuba, merl, astm, zemax, csv";
    assert!(
        message.contains(&format!("\"obj\" is not a format: {names}")),
        "{message}"
    );
}

#[test]
fn a_file_without_fits_is_reported_with_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.json");
    let message = refused(&path, &["--to", "c"]);
    assert!(
        message.starts_with(&format!("error: {}: cannot be read: ", path.display())),
        "{message}"
    );
    for (content, expected) in [
        (
            "psi_deg",
            ", line 1, column 1: expected value: expected JSON with a document of fits (brdf fit \
             writes it with --json)",
        ),
        (
            "{\"format_version\": 7, \"fits\": [{}]}",
            ": format_version 7 of a model: expected 1 (was it written by a later version?)",
        ),
        (
            "{\"format_version\": 7, \"reports\": [{}]}",
            ": format_version 7: expected one from 1 to 1 (was it written by a later version?)",
        ),
        (
            "{\"format_version\": 1, \"fits\": []}",
            ": contains no fit: expected a model of at least one",
        ),
    ] {
        fs::write(&path, content).unwrap();
        let message = refused(&path, &["--to", "c", "--wavelength", "0.5"]);
        assert_eq!(message, format!("error: {}{expected}\n", path.display()));
    }
}

#[cfg(unix)]
#[test]
fn fits_are_read_from_a_pipe() {
    let fits = Fits::of_scans(1);
    let mut command = std::process::Command::new("sh");
    let pipe = "cat \"$1\" | \"$0\" export /dev/stdin --to json";
    let program = export_command();
    command
        .args(["-c", pipe])
        .arg(program.get_program())
        .arg(fits.json());
    let output = command.output().unwrap();
    assert_eq!(text(&output.stderr), "");
    assert_eq!(
        text(&output.stdout),
        exported(&fits.json(), &["--to", "json"])
    );
}

#[test]
fn a_tolerance_is_above_0_and_below_1() {
    let fits = Fits::of_scans(1);
    for tolerance in ["0", "1", "-0.1", "NaN", "small"] {
        let option = format!("--tolerance={tolerance}");
        let message = refused(&fits.json(), &["--to", "astm", &option]);
        assert!(
            message.contains("expected a number above 0 and below 1"),
            "{message}"
        );
    }
}

#[test]
fn an_option_without_effect_on_the_format_is_an_error() {
    let fits = Fits::of(&[in_workspace("data/synthetic").join(SCANS[0])]);
    for (form, option, value) in [
        ("c", "grid", "psi=10"),
        ("csv", "tolerance", "0.1"),
        ("astm", "rgb", "0.6,0.5,0.4"),
        ("json", "name", "paint"),
    ] {
        let message = refused(&fits.json(), &["--to", form, &format!("--{option}"), value]);
        assert_eq!(
            message,
            format!("error: --{option} has no effect on the format {form}\n")
        );
    }
}
