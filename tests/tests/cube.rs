//! `fit --cube` fits the scans of an array of NumPy, and writes an array with named fields.

use std::fs;
use std::path::PathBuf;
use std::process::Output;

use brdf_fit::batch::{BatchOptions, BatchPlan, Scans, Status};
use brdf_fit::{FitOptions, Measurements, RefractiveIndex, fit};
use brdf_tests::{fit_command, in_workspace};
use tempfile::TempDir;

/// The scans of the array: a measured one times a factor each, with a slope over theta.
const SCANS: usize = 6;

fn measured() -> Measurements {
    let path = in_workspace("data/measured/z307_on_aluminium.csv");
    Measurements::read_csv(path)
        .unwrap()
        .by_wavelength()
        .remove(0)
}

/// The readings of scan i.
fn readings(i: usize) -> Vec<f64> {
    let slope = |theta: f64| 1.0 + 0.1 * i as f64 * theta;
    let scan = measured();
    let readings = scan.readings().iter();
    readings
        .map(|reading| reading.brdf * slope(reading.theta))
        .collect()
}

/// A file of NumPy.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the elements are 32 bits wide"
)]
fn npy(descr: &str, shape: &[usize], fortran: bool, values: &[f64]) -> Vec<u8> {
    let shape: Vec<String> = shape.iter().map(|n| format!("{n},")).collect();
    let order = if fortran { "True" } else { "False" };
    let mut header = format!(
        "{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({}), }}",
        shape.join(" ")
    );
    let length = header.len() + 11;
    header.push_str(&" ".repeat(length.next_multiple_of(64) - length));
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(u16::try_from(header.len()).unwrap().to_le_bytes());
    bytes.extend(header.as_bytes());
    for value in values {
        match descr {
            "<f8" => bytes.extend(value.to_le_bytes()),
            "<f4" => bytes.extend((*value as f32).to_le_bytes()),
            _ => bytes.extend((*value as i32).to_le_bytes()),
        }
    }
    bytes
}

/// An array of named fields: its header, and the numbers of each record of k2, kD, k1, E, readings and
/// status.
fn records(bytes: &[u8]) -> (String, Vec<[f64; 6]>) {
    let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let header = String::from_utf8(bytes[10..10 + length].to_vec()).unwrap();
    let record = |bytes: &[u8]| {
        let float = |i: usize| f64::from_le_bytes(bytes[8 * i..8 * i + 8].try_into().unwrap());
        let count = u32::from_le_bytes(bytes[32..36].try_into().unwrap());
        let status = f64::from(bytes[36]);
        [
            float(0),
            float(1),
            float(2),
            float(3),
            f64::from(count),
            status,
        ]
    };
    let rows = bytes[10 + length..].chunks(37).map(record);
    (header, rows.collect())
}

struct Folder(TempDir);

impl Folder {
    /// A folder with the angles of the measured scan.
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        let scan = measured();
        let rows = scan.readings().iter().map(|reading| {
            let [psi, theta, phi] = [reading.psi, reading.theta, reading.phi].map(f64::to_degrees);
            format!("{psi},{theta},{phi}\n")
        });
        let table = format!("psi_deg,theta_deg,phi_deg\n{}", rows.collect::<String>());
        folder.write("angles.csv", table.as_bytes());
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, bytes: &[u8]) {
        fs::write(self.path(name), bytes).unwrap();
    }

    fn fit(&self, arguments: &[&str]) -> Output {
        let mut command = fit_command();
        command.current_dir(self.0.path());
        command.args(["--cube", "cube.npy", "--angles", "angles.csv"]);
        if !arguments.contains(&"--output") {
            command.args(["--output", "fits.npy"]);
        }
        command.args(arguments);
        command.output().unwrap()
    }

    fn fails(&self, arguments: &[&str]) -> String {
        let output = self.fit(arguments);
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    }
}

/// The scans one after the other, and the array with the readings as its first dimension.
fn both_orders() -> (Vec<f64>, Vec<f64>) {
    let scans: Vec<Vec<f64>> = (0..SCANS).map(readings).collect();
    let count = scans[0].len();
    let readings_first = (0..count).flat_map(|j| scans.iter().map(move |scan| scan[j]));
    let readings_first = readings_first.collect();
    (scans.concat(), readings_first)
}

#[test]
fn every_layout_gives_the_fits_of_the_library() {
    let (scans, readings_first) = both_orders();
    let count = scans.len() / SCANS;
    let plan = BatchPlan::new(measured().readings(), &BatchOptions::default()).unwrap();
    let expected = plan.fit_many(Scans::new(&scans, count).unwrap()).unwrap();
    let folder = Folder::new();
    // The dimensions of the scans are 2 and 3, of which the last one, or in Fortran's order the first,
    // runs fastest.
    for (shape, values, fortran) in [
        ([2, 3, count], &scans, false),
        ([count, 2, 3], &readings_first, false),
        ([count, 3, 2], &scans, true),
        ([3, 2, count], &readings_first, true),
    ] {
        folder.write("cube.npy", &npy("<f8", &shape, fortran, values));
        let output = folder.fit(&["--n", "1.5"]);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(
            text.contains(&format!("of {count} readings along dimension")),
            "{text}"
        );
        let (header, rows) = records(&fs::read(folder.path("fits.npy")).unwrap());
        let scan_shape: Vec<usize> = shape.into_iter().filter(|n| *n != count).collect();
        assert!(
            header.contains(&format!("({}, {}", scan_shape[0], scan_shape[1])),
            "{header}"
        );
        assert!(header.contains("('k1', '<f8')"), "{header}");
        assert!(
            header.contains(if fortran { "True" } else { "False" }),
            "{header}"
        );
        for (i, row) in rows.iter().enumerate() {
            let values = [
                expected.k2[i],
                expected.kd[i],
                expected.k1[i],
                expected.e_percent[i],
            ];
            assert_eq!(row[..4], values, "{shape:?}, scan {i}");
            assert_eq!(row[4..], [count as f64, 0.0]);
        }
    }
}

#[test]
fn the_fits_are_those_of_a_scan_by_itself() {
    let (scans, _) = both_orders();
    let count = scans.len() / SCANS;
    let folder = Folder::new();
    folder.write("cube.npy", &npy("<f8", &[SCANS, count], false, &scans));
    assert_eq!(folder.fit(&["--n", "1.5"]).status.code(), Some(0));
    let (_, rows) = records(&fs::read(folder.path("fits.npy")).unwrap());
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    for (row, values) in rows.iter().zip(scans.chunks(count)) {
        let mut readings = measured().readings().to_vec();
        for (reading, value) in readings.iter_mut().zip(values) {
            reading.brdf = *value;
        }
        let own = fit(&Measurements::new("scan", readings).unwrap(), &options).unwrap();
        assert!((row[3] / own.e_percent - 1.0).abs() < 1e-9);
    }
}

#[test]
fn the_quantity_of_the_readings_is_declared() {
    let folder = Folder::new();
    let values = readings(0);
    folder.write("cube.npy", &npy("<f8", &[1, values.len()], false, &values));
    folder.fit(&["--n", "1.5"]);
    let (_, plain) = records(&fs::read(folder.path("fits.npy")).unwrap());
    let factors: Vec<f64> = values
        .iter()
        .map(|value| 100.0 * std::f64::consts::PI * value)
        .collect();
    folder.write(
        "cube.npy",
        &npy("<f8", &[factors.len(), 1], false, &factors),
    );
    let declared = [
        "--n",
        "1.5",
        "--declare",
        "quantity=reflectance_factor_percent",
    ];
    let output = folder.fit(&declared);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("values in percent are divided by 100; reflectance"),
        "{text}"
    );
    let (_, converted) = records(&fs::read(folder.path("fits.npy")).unwrap());
    for (a, b) in plain[0].iter().zip(converted[0]).take(4) {
        assert!((a / b - 1.0).abs() < 1e-6, "{plain:?} {converted:?}");
    }
}

#[test]
fn scans_that_cannot_be_fitted_are_counted() {
    let folder = Folder::new();
    let count = readings(0).len();
    let mut values = readings(0);
    values[3] = f64::NAN;
    values.extend(vec![0.0; count]);
    values.extend(vec![f64::NAN; count]);
    folder.write("cube.npy", &npy("<f4", &[3, count], false, &values));
    let output = folder.fit(&["--n", "1.5"]);
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("1 all readings are zero (status 5)"),
        "{text}"
    );
    assert!(text.contains("1 too few readings (status 4)"), "{text}");
    let (_, rows) = records(&fs::read(folder.path("fits.npy")).unwrap());
    let statuses = rows.iter().map(|row| row[5]);
    let expected = [Status::Fitted, Status::AllZero, Status::TooFewReadings];
    assert!(statuses.eq(expected.map(|status| f64::from(status as u8))));
    assert_eq!(rows[0][4], count as f64 - 1.0);
}

#[test]
fn what_cannot_be_fitted_replaces_no_earlier_result() {
    let folder = Folder::new();
    folder.write("fits.npy", b"earlier");
    let values = readings(0);
    let shape = [1, values.len()];
    let whole = npy("<f8", &shape, false, &values);
    let cases: [(Vec<u8>, &[&str], &str); 6] = [
        (
            whole.clone(),
            &[],
            "no refractive index: give it with --n 1.5",
        ),
        (
            whole.clone(),
            &["--n", "1.5", "--axis", "0"],
            "dimension 0 of the shape (1, 112) has 1",
        ),
        (whole.clone(), &["--model", "auto"], "expected one model"),
        (
            whole[..whole.len() - 1].to_vec(),
            &["--n", "1.5"],
            "is cut off",
        ),
        (
            npy("<i4", &shape, false, &values),
            &["--n", "1.5"],
            "has elements of type '<i4'",
        ),
        (b"psi_deg".to_vec(), &["--n", "1.5"], "is no array of NumPy"),
    ];
    for (cube, arguments, expected) in cases {
        folder.write("cube.npy", &cube);
        let message = folder.fails(arguments);
        assert!(message.contains(expected), "{message}");
        assert_eq!(fs::read(folder.path("fits.npy")).unwrap(), b"earlier");
    }
    folder.write("cube.npy", &whole);
    let message = folder.fails(&["--n", "1.5", "--output", "cube.npy"]);
    assert!(message.contains("cube.npy"), "{message}");
    assert_eq!(fs::read(folder.path("cube.npy")).unwrap(), whole);
    let message = folder.fails(&["--n", "1.5", "scan.csv"]);
    assert!(message.contains("cannot be used with"), "{message}");
}
