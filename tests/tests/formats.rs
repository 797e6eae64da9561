//! Files of every format, from the file to the parameters, and back.

use std::ffi::OsStr;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};

use brdf_core::Parameters;
use brdf_fit::Format;
use brdf_fit::read::ReadOptions;
use brdf_fit::report::Document;
use brdf_fit::{Measurement, Measurements};
use brdf_tests::{export_command, fit_command, in_workspace, run_fit};

const BAD: i32 = 2;

fn file(name: &str) -> PathBuf {
    in_workspace("tests/data/formats").join(name)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// What `fit` prints and writes as JSON for a file.
fn fitted(path: &Path, options: &[&str]) -> (String, Document) {
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("fit.json");
    let mut arguments = vec![path.as_os_str(), "--json".as_ref(), json.as_os_str()];
    arguments.extend(options.iter().map(OsStr::new));
    let output = run_fit(arguments);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    (text(&output.stdout), Document::read(&json).unwrap())
}

fn assert_parameters(document: &Document, expected: &[(Option<f64>, [f64; 3])]) {
    assert_eq!(document.reports.len(), expected.len());
    for (report, (wavelength, [k2, kd, k1])) in document.reports.iter().zip(expected) {
        assert_eq!(report.wavelength_um, *wavelength);
        let Parameters {
            k2: a,
            kd: b,
            k1: c,
        } = report.fit.as_ref().unwrap().parameters;
        for (found, expected) in [(a, k2), (b, kd), (c, k1)] {
            assert!((found - expected).abs() < 2e-6, "{found} is not {expected}");
        }
    }
}

const SAND_YELLOW: [f64; 3] = [0.225, 0.246, 0.9];

/// The example files: the name, the format, the options, and what the report says of the reading.
const EXAMPLES: &[(&str, Format, &[&str], [&str; 3])] = &[
    (
        "plane_symmetrical.bsdf",
        Format::Zemax,
        &[],
        [
            "scatter angles about the specular ray are converted to view angles",
            "27 readings at or beyond 90 deg from the normal are left out",
            "16 readings that repeat the value of the same direction are left out",
        ],
    ),
    (
        "asymmetrical.bsdf",
        Format::Zemax,
        &[],
        [
            "2 rotations of the sample are read as one isotropic sample",
            "8 readings at or beyond 90 deg from the normal are left out",
            "40 readings that repeat the value of the same direction are left out",
        ],
    ),
    (
        "beam.astm",
        Format::Astm,
        &["--n", "1.62"],
        [
            "angles are in degrees, as the file states",
            "azimuth 0 is the forward side: azimuths are rotated by 180 deg",
            "4 readings at or beyond 90 deg from the normal are left out",
        ],
    ),
    (
        "goniometer.txt",
        Format::Goniometer,
        &[],
        [
            "BRDF cos theta is divided by cos theta",
            "4 readings not taken (no value) are left out",
            "",
        ],
    ),
    (
        "fred.txt",
        Format::Fred,
        &[],
        [
            "azimuths of the scatter directions are counted from the specular direction, on the \
                 forward side",
            "4 readings at or beyond 90 deg from the normal are left out",
            "",
        ],
    ),
    (
        "open_material.xompt",
        Format::OpenMaterial,
        &["--n", "1.62"],
        [
            "azimuth 0 is the source's side",
            "2 readings not taken (no value) are left out",
            "4 readings at or beyond 90 deg from the normal are left out",
        ],
    ),
    (
        "tracepro.txt",
        Format::TracePro,
        &["--n", "1.62", "--phi-zero", "source"],
        [
            "azimuth 0 is the source's side, as stated",
            "42 readings at or beyond 90 deg from the normal are left out",
            "16 readings of the specular direction at another azimuth are left out",
        ],
    ),
    (
        "specular.ssdd",
        Format::Ssdd,
        &[],
        [
            "scatter angles about the specular ray are converted to view angles",
            "the specular reflectance is not read",
            "16 readings with the value of the same direction before are left out",
        ],
    ),
    (
        "scan.xlsx",
        Format::Workbook,
        &[],
        [
            "the sheet \"Scan\" is read, \"Notes\" is not",
            "64 cells have the value of the cell that they are merged with",
            "4 readings not taken (no value) are left out",
        ],
    ),
    (
        "goniometer.xls",
        Format::Workbook,
        &[],
        [
            "the sheet \"Goniometer\" is read, \"Blank\" is not",
            "BRDF cos theta is divided by cos theta",
            "4 readings not taken (no value) are left out",
        ],
    ),
    (
        "percent.ods",
        Format::Workbook,
        &[],
        [
            "the sheet \"Scan\" is read, \"Raw\" (hidden) is not",
            "reflectance factors are divided by pi",
            "4 readings not taken (no value) are left out",
        ],
    ),
];

#[test]
fn files_of_each_format_give_the_parameters_that_they_were_made_from() {
    for &(name, format, options, said) in EXAMPLES {
        let (printed, document) = fitted(&file(name), options);
        assert_parameters(&document, &[(Some(0.62), SAND_YELLOW)]);
        assert_eq!(document.reports[0].format, format);
        for said in said.iter().filter(|said| !said.is_empty()) {
            let printed = brdf_tests::unwrapped(&printed);
            assert!(printed.contains(&format!("read {said}")), "{printed}");
            assert!(document.reports[0].conversions.iter().any(|c| c == said));
        }
    }
}

#[test]
fn files_for_other_programs_give_the_parameters_that_they_were_made_from() {
    for (name, format, wavelength, said) in [
        (
            "speos.brdf",
            Format::Speos,
            Some(0.62),
            "values are proportional to f_r: they are scaled to the stated reflectances, by 0.142857",
        ),
        (
            "speos.anisotropicbsdf",
            Format::Speos,
            None,
            "azimuth 0 is the forward side: azimuths are rotated by 180 deg",
        ),
        (
            "lighttools.txt",
            Format::LightTools,
            Some(0.62),
            "azimuths are counted from that of the source, 90 deg",
        ),
        (
            "rt300s.jdv",
            Format::Rt300s,
            None,
            "values are intensities in percent of a perfect diffuser: they are divided by 100 pi cos theta",
        ),
        (
            "rgl.bsdf",
            Format::Rgl,
            Some(0.62),
            "f_r at the nodes of the adaptive parameterisation: values are multiplied by D / (4 sigma \
             cos theta)",
        ),
        (
            "klems.xml",
            Format::Klems,
            Some(0.62),
            "Reflection Front is read",
        ),
    ] {
        let (printed, document) = fitted(&file(name), &["--n", "1.62"]);
        assert_parameters(&document, &[(wavelength, SAND_YELLOW)]);
        assert_eq!(document.reports[0].format, format);
        let printed = brdf_tests::unwrapped(&printed);
        assert!(printed.contains(&format!("read {said}")), "{printed}");
    }
}

#[test]
fn each_wavelength_of_a_file_is_fitted() {
    let (printed, document) = fitted(&file("black_lab.txt"), &["--n", "1.62"]);
    let expected = [
        (Some(0.62), SAND_YELLOW),
        (Some(0.852_23), [0.1, 0.05, 0.4]),
    ];
    assert_parameters(&document, &expected);
    assert!(printed.contains("  read      reflectance factors are divided by pi\n"));
    let (_, document) = fitted(&file("cornell.astm"), &[]);
    let kd = |i: u32| 0.1 + 0.01 * f64::from(i);
    let expected: Vec<_> = (0..31)
        .map(|i| (Some(f64::from(40 + i) / 100.0), [0.225, kd(i), 0.3]))
        .collect();
    assert_parameters(&document, &expected);
    assert_eq!(document.reports[0].format, Format::Astm);
}

#[test]
fn a_fit_is_done_again_with_the_sides_of_its_file() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["beam.astm", "plane_symmetrical.bsdf"] {
        let json = folder.path().join("fit.json");
        let path = file(name);
        let first = [
            path.as_os_str(),
            "--n".as_ref(),
            "1.62".as_ref(),
            "--verbose".as_ref(),
            "--json".as_ref(),
        ];
        let output = run_fit(first.into_iter().chain([json.as_os_str()]));
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let again = run_fit([
            path.as_os_str(),
            "--again".as_ref(),
            json.as_os_str(),
            "--verbose".as_ref(),
        ]);
        assert_eq!(again.status.code(), Some(0), "{}", text(&again.stderr));
        let parameters = |output: &Output| {
            let printed = text(&output.stdout);
            let line = printed.lines().find(|line| line.starts_with("  stage 2"));
            line.unwrap()
                .split("  ")
                .take(8)
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        assert_eq!(parameters(&again), parameters(&output));
    }
}

#[test]
fn of_several_files_each_is_done_again_with_its_own_sides() {
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("fit.json");
    let forward = folder.path().join("forward.csv");
    let rows = [(20, 20, 0.9), (20, 50, 0.2), (50, 50, 1.0), (50, 20, 0.2)];
    let rows =
        rows.map(|(psi, theta, brdf)| format!("{psi},{theta},0,{brdf}\n{psi},{theta},180,0.1\n"));
    let scan = "psi_deg,theta_deg,phi_deg,brdf_per_sr\n".to_owned() + &rows.concat();
    std::fs::write(&forward, scan).unwrap();
    let beam = file("beam.astm");
    let both = [beam.as_os_str(), forward.as_os_str()];
    let options = ["--phi-zero", "forward", "--n", "1.5", "--json"].map(OsStr::new);
    let output = run_fit(both.into_iter().chain(options).chain([json.as_os_str()]));
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let parameters = |document: Document| document.reports[0].fit.as_ref().unwrap().parameters;
    let first = Document::read(&json).unwrap();
    let expected = first.reports[1].fit.as_ref().unwrap().parameters;
    let (_, again) = fitted(&forward, &["--again", json.to_str().unwrap()]);
    assert_eq!(parameters(again), expected);
}

fn assert_refused(name: &str, content: &str, options: &[&str], message: &str) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, content).unwrap();
    let mut arguments = vec![path.as_os_str()];
    arguments.extend(options.iter().map(OsStr::new));
    let output = run_fit(arguments);
    let complaint = text(&output.stderr);
    assert_eq!(output.status.code(), Some(BAD), "{complaint}");
    let expected = format!("{}{message}\n", path.display());
    assert!(
        complaint.ends_with(&expected),
        "{complaint}\nis not\n{expected}"
    );
}

#[test]
fn wrong_files_are_refused_with_line_and_value() {
    let with = |name: &str, from: &str, to: &str| {
        let content = fs::read_to_string(file(name)).unwrap();
        assert!(content.contains(from), "{from}");
        content.replacen(from, to, 1)
    };
    assert_refused(
        "a.bsdf",
        &with("plane_symmetrical.bsdf", "\tBRDF", "\tBTDF"),
        &[],
        ", line 7: ScatterType BTDF: the model describes reflection, expected BRDF",
    );
    assert_refused(
        "a.bsdf",
        &with("plane_symmetrical.bsdf", "DataEnd", ""),
        &[],
        ": ends too early: expected DataEnd",
    );
    assert_refused(
        "a.astm",
        &with("beam.astm", "DATA_POINTS 68", "DATA_POINTS 69"),
        &[],
        ", line 6: 68 rows follow: expected 69, as the header states",
    );
    assert_refused(
        "a.astm",
        &with("cornell.astm", "400nm", "theta_i"),
        &[],
        ", line 5: column theta_i is given twice",
    );
    assert_refused(
        "a.txt",
        &with("black_lab.txt", "0.47320122", "dark"),
        &[],
        ", line 5, column 620.00nm: \"dark\" is not a number: expected a reading, or nan where none was taken",
    );
    assert_refused(
        "a.txt",
        &with("goniometer.txt", ";70\n", ";120\n"),
        &[],
        ", line 5: the columns are azimuths, and the incidence angle is not given: expected a line \
         such as \"# psi_deg: 30\" in the file (or --declare psi_deg=30)",
    );
}

#[test]
fn a_file_of_no_known_format_says_which_are_known() {
    assert_refused(
        "a.dat",
        "angle value\n10 0.1\nx 0.2\n",
        &[],
        ": has no header: expected a line that names the columns, such as psi_deg, theta_deg and \
         brdf_per_sr, found \"angle value\"; known formats are csv, merl, astm, zemax, black-lab, \
         goniometer, workbook, fred, open-material, tracepro, ssdd, speos, lighttools, rt300s, rgl, klems",
    );
}

#[test]
fn the_content_goes_before_the_extension_of_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("beam.binary");
    fs::copy(file("beam.astm"), &path).unwrap();
    let (_, document) = fitted(&path, &["--n", "1.62"]);
    assert_eq!(document.reports[0].format, Format::Astm);
}

#[cfg(unix)]
#[test]
fn a_pipe_is_read_from_its_first_byte() {
    let content = "psi_deg,theta_deg,brdf_per_sr\n10,-10,0.1\n10,20,0.2\n30,-30,0.3\n30,0,0.1\n";
    let mut fit = fit_command()
        .args(["/dev/stdin", "--n", "1.5", "--model", "lambert"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Dropped at the end of the statement: the pipe ends.
    fit.stdin
        .take()
        .unwrap()
        .write_all(content.as_bytes())
        .unwrap();
    let output = fit.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("4 readings"));
}

#[test]
fn a_format_is_forced_and_its_sides_are_its_own() {
    let content = fs::read_to_string(file("goniometer.txt")).unwrap();
    assert_refused(
        "a.txt",
        &content,
        &["--format", "astm"],
        ": has no line VARS: expected one with theta_i, theta_s and a column of values",
    );
    let zemax = fs::read_to_string(file("plane_symmetrical.bsdf")).unwrap();
    assert_refused(
        "a.bsdf",
        &zemax,
        &["--phi-zero", "forward"],
        ": the angular convention cannot be chosen: the format measures angles from the specular ray, \
         with azimuth 0 towards the normal",
    );
    let unknown = run_fit(["a.csv", "--format", "merl-text"]);
    assert_eq!(unknown.status.code(), Some(BAD));
    assert!(
        text(&unknown.stderr).contains("is not a format: expected one of csv, merl, astm, zemax")
    );
}

/// What `export` writes of the fits of a file.
fn exported(fits: &Path, arguments: &[&str]) -> Vec<u8> {
    let output = export_command().arg(fits).args(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    output.stdout
}

#[test]
fn what_is_exported_as_a_table_is_read_and_fitted_again() {
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("fit.json");
    let path = file("goniometer.txt");
    let output = run_fit([path.as_os_str(), "--json".as_ref(), json.as_os_str()]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    for (to, options) in [
        ("csv", ["--grid", "psi=10:70:20 theta=-80:80:10 phi=0,45"]),
        ("zemax", ["--tolerance", "0.05"]),
        ("astm", ["--tolerance", "0.05"]),
    ] {
        let bytes = exported(&json, &[["--to", to].as_slice(), &options].concat());
        let scan = Measurements::from_bytes("a", &bytes, &ReadOptions::default()).unwrap();
        assert_eq!(scan.format.name(), to);
        let fit = brdf_fit::fit(&scan.thinned(2000), &brdf_fit::FitOptions::default()).unwrap();
        for (found, expected) in [
            (fit.parameters.k2, 0.225),
            (fit.parameters.kd, 0.246),
            (fit.parameters.k1, 0.9),
        ] {
            assert!(
                (found - expected).abs() < 2e-6,
                "{to}: {found} is not {expected}"
            );
        }
    }
}

#[test]
fn a_table_keeps_its_tolerance_between_its_entries() {
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("fit.json");
    let path = file("goniometer.txt");
    run_fit([path.as_os_str(), "--json".as_ref(), json.as_os_str()]);
    let bytes = exported(&json, &["--to", "astm", "--tolerance", "0.05"]);
    let scan = Measurements::from_bytes("a", &bytes, &ReadOptions::default()).unwrap();
    let document = Document::read(&json).unwrap();
    let parameters = document.reports[0].fit.as_ref().unwrap().parameters;
    let brdf = brdf_core::ThreeParameterBrdf::new(parameters, 1.62).unwrap();
    // Halfway between two entries that follow each other in azimuth.
    let mut checked = 0;
    for pair in scan.readings().windows(2) {
        let [a, b]: [Measurement; 2] = [pair[0], pair[1]];
        if a.psi == b.psi && a.theta == b.theta {
            let phi = 0.5 * (a.phi + b.phi);
            let geometry = brdf_core::Geometry::new(a.psi, a.theta, phi).unwrap();
            let exact = brdf.value(&geometry);
            let error = (0.5 * (a.brdf + b.brdf) / exact - 1.0).abs();
            assert!(error < 0.05, "{error} at {a:?}");
            checked += 1;
        }
    }
    assert!(checked > 1000);
}

#[test]
fn a_tolerance_that_no_table_keeps_is_an_error_that_says_which_one_does() {
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("fit.json");
    let path = file("goniometer.txt");
    run_fit([path.as_os_str(), "--json".as_ref(), json.as_os_str()]);
    let output = export_command()
        .arg(&json)
        .args(["--to", "zemax", "--tolerance", "1e-3"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(BAD));
    let complaint = text(&output.stderr);
    assert!(
        complaint
            .contains("a table within the tolerance 1e-3 has more than 4000000 entries: expected a tolerance of"),
        "{complaint}"
    );
}
