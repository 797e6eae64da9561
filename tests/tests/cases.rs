//! Files as people have them, with what is expected of each: the parameters that they were computed from,
//! or a message that says what the file is or what is missing.
//!
//! The files are beside the workspace; where they are absent, the test is skipped.

use std::path::{Path, PathBuf};

use brdf_tests::run_fit;

/// k2, kD and k1 of the paint that most files were computed from.
const PAINT: [f64; 3] = [0.12, 0.3, 0.25];

/// What a file gives.
enum Expected {
    /// The parameters, once for each wavelength, to the relative tolerance.
    Fits(&'static [[f64; 3]], f64),
    /// A message on standard error.
    Message(&'static str),
    /// A warning in the table, by its kind.
    Warning(&'static str),
}
use Expected::{Fits, Message, Warning};

const WAVELENGTHS: &[[f64; 3]] = &[[0.12, 0.1, 0.25], [0.12, 0.2, 0.25], [0.12, 0.4, 0.25]];
const TWO: &[[f64; 3]] = &[[0.12, 0.1, 0.25], [0.12, 0.4, 0.25]];
const ONE: &[[f64; 3]] = &[PAINT];
const AS_PAINT: Expected = Fits(ONE, 1e-4);

const CASES: &[(&str, &[&str], Expected)] = &[
    ("00-reference/paint.csv", &[], AS_PAINT),
    ("01-fred-tabulated/paint_fred.txt", &[], AS_PAINT),
    // A measured sample: the fit of the same readings in columns of ours.
    (
        "01-fred-tabulated/AnoBlackEC1onAlum.txt",
        &[],
        Fits(&[[0.091_136_7, 0.024_019_0, 0.160_772]], 1e-4),
    ),
    // The values are normalised by their integral, which a grid of 10 deg by 30 deg gives to 3 %.
    ("02-speos-brdf/paint.brdf", &[], Fits(ONE, 3e-2)),
    ("04-lighttools/paint_lighttools.txt", &[], AS_PAINT),
    ("04-lighttools/edited_as_told.txt", &[], AS_PAINT),
    ("07-pabopto-files/paint_10.dat", &[], Fits(ONE, 1e-3)),
    ("07-pabopto-files/paint_65.dat", &[], Fits(ONE, 1e-3)),
    ("08-openmaterial-json/paint.xompt", &[], AS_PAINT),
    (
        "11-wavelengths-in-columns/wide.csv",
        &[],
        Fits(WAVELENGTHS, 1e-4),
    ),
    ("12-percent-reflectance/percent_declared.csv", &[], AS_PAINT),
    ("12-percent-reflectance/percent_header.csv", &[], AS_PAINT),
    ("12-percent-reflectance/percent_quantity.csv", &[], AS_PAINT),
    (
        "12-percent-reflectance/percent_undeclared.csv",
        &[],
        Warning("too-bright?"),
    ),
    (
        "12-percent-reflectance/percent_undeclared.csv",
        &["--declare", "quantity=reflectance_factor_percent"],
        AS_PAINT,
    ),
    ("13-azimuth-0-360/hemisphere_0_360.csv", &[], AS_PAINT),
    ("13-azimuth-0-360/signed.csv", &[], AS_PAINT),
    ("13-azimuth-0-360/theta_phi.csv", &[], AS_PAINT),
    (
        "13-azimuth-0-360/hemisphere_forward_zero.csv",
        &[],
        Warning("turned-round"),
    ),
    (
        "13-azimuth-0-360/hemisphere_forward_zero.csv",
        &["--phi-zero", "forward"],
        AS_PAINT,
    ),
    ("14-negative-incidence/negative_psi.csv", &[], AS_PAINT),
    (
        "15-starlink-raw/chassis_brdf.csv",
        &[],
        Message("azimuths exchanged"),
    ),
    (
        "15-starlink-raw/vegetation_head.csv",
        &[],
        Message("azimuths exchanged"),
    ),
    (
        "16-azimuth-columns/aoi30.txt",
        &[],
        Message("columns are azimuths"),
    ),
    (
        "16-azimuth-columns/aoi30_quadrant.txt",
        &[],
        Message("columns are azimuths"),
    ),
    (
        "16-azimuth-columns/aoi30.txt",
        &["--declare", "psi_deg=30"],
        Fits(ONE, 2e-3),
    ),
    ("17-fixed-detector/sweep.csv", &[], AS_PAINT),
    ("17-fixed-detector/sweep_normal_view.csv", &[], AS_PAINT),
    (
        "18-lab-frame-angles/lab.csv",
        &[],
        Message("\"tilt_deg\" is not known"),
    ),
    (
        "18-lab-frame-angles/lab_renamed.csv",
        &[],
        Warning("angles-from-source?"),
    ),
    ("19-nan-occluded/empty.csv", &[], AS_PAINT),
    ("19-nan-occluded/nan.csv", &[], AS_PAINT),
    (
        "20-zero-occluded/zero.csv",
        &[],
        Warning("detector-shadow?"),
    ),
    (
        "20-zero-occluded/zero.csv",
        &["--mask-source", "6"],
        AS_PAINT,
    ),
    ("21-unicode-minus/minus_only.csv", &[], AS_PAINT),
    ("21-unicode-minus/supplier.csv", &[], AS_PAINT),
    ("22-wavelength-nm/column_nm.csv", &[], Fits(TWO, 1e-4)),
    (
        "22-wavelength-nm/um_column_with_nm.csv",
        &[],
        Warning("nanometres?"),
    ),
    (
        "22-wavelength-nm/um_column_with_nm.csv",
        &["--columns", "wavelength_um=wavelength_nm"],
        Fits(TWO, 1e-4),
    ),
    ("25-repeats/repeats.csv", &[], Fits(ONE, 3e-2)),
    ("25-repeats/repeats.csv", &[], Warning("repeated-readings")),
    ("27-rows-at-90/gonio90.csv", &[], AS_PAINT),
    ("27-rows-at-90/grid90.csv", &[], AS_PAINT),
    // All patches have one value.
    (
        "28-klems-xml/paint.xml",
        &[],
        Message("all 1681 readings are 0.0955"),
    ),
    (
        "29-rgl-tensor-bsdf/paint_rgb.bsdf",
        &[],
        Message("RGL tensor"),
    ),
    ("30-xlsx/scan.xls", &[], Message("is damaged")),
    ("30-xlsx/scan.xlsx", &[], Message("is damaged")),
    (
        "30-xlsx/test_excel.xls",
        &[],
        Message("sheet \"Sheet1\", line 2: no column for the incidence"),
    ),
    ("31-cosines/cosines.csv", &[], AS_PAINT),
    ("32-other-headers/hash_header_space.txt", &[], AS_PAINT),
    (
        "32-other-headers/noheader.txt",
        &[],
        Message("has no header"),
    ),
    ("32-other-headers/space_separated.txt", &[], AS_PAINT),
    ("32-other-headers/spaces.csv", &[], AS_PAINT),
    ("32-other-headers/thetai_thetar.csv", &[], AS_PAINT),
    ("32-other-headers/units_in_brackets.csv", &[], AS_PAINT),
    ("33-ccbrdf-astm/brdf_cos.astm", &[], AS_PAINT),
    ("33-ccbrdf-astm/ccbrdf.astm", &[], AS_PAINT),
    ("33-ccbrdf-astm/percent.astm", &[], AS_PAINT),
    ("33-ccbrdf-astm/refl.astm", &[], AS_PAINT),
    ("36-quoted-decimal-comma/digitised.csv", &[], AS_PAINT),
    ("36-quoted-decimal-comma/semicolon_point.csv", &[], AS_PAINT),
    // The white standard of this scan reflects 99 %.
    (
        "38-signal-and-reference/counts.csv",
        &["--declare", "factor=0.99"],
        AS_PAINT,
    ),
    (
        "38-signal-and-reference/signal_as_brdf.csv",
        &[],
        Warning("too-bright?"),
    ),
    ("40-angle-offset/offset.csv", &[], Warning("peak-offset?")),
    // Raw values below zero, of an instrument that was not calibrated.
    (
        "41-rt300s-exports/test_jdv.jdv",
        &[],
        Warning("all-negative?"),
    ),
    // Its plane of incidence is not that of the instrument's exports.
    (
        "41-rt300s-exports/paint_like_export.jdv",
        &[],
        Message("mirrored at the azimuths 0"),
    ),
    (
        "41-rt300s-exports/test_raywiz.jdv",
        &[],
        Message("expected BRDF(RT-300S)"),
    ),
    (
        "41-rt300s-exports/test_lighttools.txt",
        &[],
        Message("Reflet goniophotometer"),
    ),
    (
        "41-rt300s-exports/test_excel.xls",
        &[],
        Message("sheet \"Sheet1\", line 2: no column for the incidence"),
    ),
    (
        "41-rt300s-exports/test_speos.rtd",
        &[],
        Message("version \"v1.0\""),
    ),
    ("49-radians/radians.csv", &[], AS_PAINT),
    ("50-incidence-in-comment/single.csv", &[], Fits(ONE, 1e-3)),
];

fn cases() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/cases");
    folder.is_dir().then_some(folder)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// k2, kD and k1 of each row of the table, and its warnings.
fn fits(table: &str) -> Vec<([f64; 3], String)> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let names = reader.headers().unwrap().clone();
    let column = |name: &str| names.iter().position(|other| other == name).unwrap();
    let columns = ["k2", "kd", "k1"].map(column);
    let warnings = column("warnings");
    reader
        .records()
        .map(|record| {
            let record = record.unwrap();
            let parameters = columns.map(|i| record[i].parse().unwrap());
            (parameters, record[warnings].to_owned())
        })
        .collect()
}

#[test]
fn each_file_gives_its_paint_or_says_what_is_wrong() {
    let Some(folder) = cases() else {
        eprintln!("skipped: no cases beside the workspace");
        return;
    };
    let mut problems = Vec::new();
    for (name, options, expected) in CASES {
        let path = folder.join(name);
        let mut arguments = vec![path.to_str().unwrap(), "--n", "1.5", "--params-only"];
        arguments.extend(*options);
        let output = run_fit(arguments);
        let (table, message) = (text(&output.stdout), text(&output.stderr));
        let as_expected = match expected {
            Message(words) => !output.status.success() && message.contains(words),
            Warning(kind) => fits(&table)
                .iter()
                .all(|(_, warnings)| warnings.contains(kind)),
            Fits(truth, tolerance) => {
                let fits = fits(&table);
                let near = |(found, truth): (f64, f64)| (found / truth - 1.0).abs() <= *tolerance;
                fits.len() == truth.len()
                    && fits
                        .iter()
                        .zip(*truth)
                        .all(|((found, _), truth)| found.iter().copied().zip(*truth).all(near))
            }
        };
        if !as_expected {
            problems.push(format!("{name} {options:?}\n{table}{message}"));
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn a_sample_in_several_files_is_one_scan() {
    let Some(folder) = cases() else {
        eprintln!("skipped: no cases beside the workspace");
        return;
    };
    for names in [
        [
            "paint_10.dat",
            "paint_30.dat",
            "paint_50.dat",
            "paint_65.dat",
        ],
        ["own_10.csv", "own_30.csv", "own_50.csv", "own_65.csv"],
    ] {
        let paths = names.map(|name| folder.join("07-pabopto-files").join(name));
        let mut arguments = vec!["--join", "--n", "1.5", "--params-only"];
        arguments.extend(paths.iter().map(|path| path.to_str().unwrap()));
        let output = run_fit(arguments);
        let fits = fits(&text(&output.stdout));
        assert_eq!(fits.len(), 1, "{}", text(&output.stderr));
        for (found, truth) in fits[0].0.into_iter().zip(PAINT) {
            assert!((found / truth - 1.0).abs() < 1e-4, "{fits:?}");
        }
        assert!(!fits[0].1.contains("few-incidences"), "{fits:?}");
    }
}

#[test]
fn text_of_a_file_does_not_control_the_terminal() {
    let Some(folder) = cases() else {
        eprintln!("skipped: no cases beside the workspace");
        return;
    };
    for name in ["esc.csv", "c1.csv"] {
        let path = folder.join("attack").join(name);
        let output = run_fit([path.to_str().unwrap(), "--n", "1.5", "--verbose"]);
        assert!(output.status.success());
        let printed = text(&output.stdout) + &text(&output.stderr);
        let controls = |c: char| c.is_control() && c != '\n' && c != '\t';
        assert_eq!(printed.find(controls), None, "{name}");
        assert_eq!(printed.find('\u{202e}'), None, "{name}");
    }
}
