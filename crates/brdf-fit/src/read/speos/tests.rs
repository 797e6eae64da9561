//! Tests of files of both kinds.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;

use proptest::prelude::*;

use super::*;

const PHIS: [u32; 5] = [0, 90, 180, 270, 360];

/// A table with the values of a function of theta and phi in degrees.
fn table(value: impl Fn(u32, u32) -> f64) -> String {
    let mut text = "7\t5\n".to_owned();
    for phi in PHIS {
        write!(text, "\t{phi}").unwrap();
    }
    for theta in (0..=90).step_by(15) {
        write!(text, "\n{theta}").unwrap();
        for phi in PHIS {
            write!(text, "\t{}", value(theta, phi)).unwrap();
        }
    }
    text + "\n"
}

fn spectral(kind: u32, reflectance: f64, table: &str) -> String {
    format!(
        "OPTIS - brdf surface file v8.0\n0\na comment\n10\nTest paint\n1\t0\n{kind}\n2\t2\n\
         10\t30\n450\t650.5\n{reflectance}\n{table}{reflectance}\n{table}{reflectance}\n{table}\
         {reflectance}\n{table}"
    )
}

fn anisotropic(angles: &str, spectrum: &str, tables: &str) -> String {
    format!(
        "OPTIS - Anisotropic BSDF surface file v7.0\r\n0\r\nComment\r\n23\r\nMeasurement description\r\n\
         0\t1\t0\r\n1\t0\r\n1\r\n{angles}20\t0\r\n\r\n{spectrum}{tables}End of file\r\n"
    )
}

fn read_with(content: &str, options: &ReadOptions) -> Result<Measurements, ReadError> {
    read(Text::new(Path::new("a.brdf"), content.as_bytes())?, options)
}

fn scan(content: &str) -> Measurements {
    read_with(content, &ReadOptions::default()).unwrap()
}

fn error(content: &str) -> String {
    let read = read_with(content, &ReadOptions::default());
    read.unwrap_err().to_string()
}

/// f_r at an incidence, a view angle and an azimuth of the model in degrees.
fn f_r(scan: &Measurements, psi: f64, theta: f64, phi: f64) -> f64 {
    let found = scan.readings().iter().find(|r| {
        let turn = (r.phi.to_degrees() - phi).rem_euclid(360.0);
        let is = |a: f64, b: f64| (a - b).abs() < 1e-9;
        is(r.psi.to_degrees(), psi) && is(r.theta.to_degrees(), theta) && is(turn, 0.0)
    });
    found.unwrap().brdf
}

#[test]
fn values_are_scaled_to_the_reflectance_of_their_table() {
    let diffuse = table(|theta, _| if theta < 90 { 7.0 } else { 7.5 });
    let scan = scan(&spectral(1, 31.4, &diffuse));
    let wavelengths = [Some(0.45), Some(0.6505)];
    assert_eq!(scan.wavelengths(), wavelengths);
    let first = scan.readings()[0];
    assert_eq!(first.wavelength_um, Some(0.45));
    // The row at 90 deg adds little to the integral, and is left out.
    assert!((first.brdf / (0.314 / PI) - 1.0).abs() < 1e-2);
    assert!(scan.readings().iter().all(|r| r.brdf == first.brdf));
    assert_eq!(scan.metadata.get("sample"), Some("Test paint"));
    assert_eq!(scan.metadata.get("comment"), Some("a comment"));
    let said = scan.conversions.join("; ");
    assert!(
        said.contains("values are proportional to f_r: they are scaled to the stated reflectances"),
        "{said}"
    );
    // 4 tables, with 5 values at the horizon, 4 repetitions at theta = 0, and 5 at 360 deg.
    assert!(said.contains("20 readings at or beyond 90 deg"), "{said}");
    assert!(said.contains("36 readings that repeat the value"), "{said}");
    assert_eq!(scan.readings().len(), 4 * (7 * 5 - 5 - 4 - 5));
}

#[test]
fn the_specular_direction_is_at_azimuth_0() {
    let forward = table(|theta, phi| {
        let peak = if theta == 30 && phi % 360 == 0 {
            5.0
        } else {
            0.0
        };
        peak + f64::from(90 - theta)
    });
    let scan = scan(&spectral(1, 10.0, &forward));
    let (specular, retro) = (f_r(&scan, 30.0, 30.0, 180.0), f_r(&scan, 30.0, 30.0, 0.0));
    assert!((specular / retro - 65.0 / 60.0).abs() < 1e-12);
    assert_eq!(scan.convention.phi_zero, Side::Forward);
}

#[test]
fn intensities_are_divided_by_the_cosine() {
    let cosine = table(|theta, _| f64::from(theta).to_radians().cos());
    let scan = scan(&spectral(0, 50.0, &cosine));
    let first = scan.readings()[0].brdf;
    let equal = |brdf: f64| (brdf / first - 1.0).abs() < 1e-12;
    assert!(scan.readings().iter().all(|reading| equal(reading.brdf)));
    // The cosine is not linear between angles of 15 deg.
    assert!((first / (0.5 / PI) - 1.0).abs() < 1e-2, "{first}");
    assert!(scan.conversions[0].contains("proportional to f_r cos theta"));
}

#[test]
fn zeros_and_transmission_are_left_out() {
    let with_zeros = table(|theta, _| if theta < 60 { 1.0 } else { 0.0 });
    let both = spectral(1, 10.0, &with_zeros).replace("1\t0\n1\n", "1\t1\n1\n");
    let scan = scan(&format!("{both}12\nwhatever\n"));
    let said = scan.conversions.join("; ");
    assert!(
        said.contains("tables of transmission are not read"),
        "{said}"
    );
    assert!(said.contains("40 readings of exactly 0"), "{said}");
}

#[test]
fn ratios_between_incidences_are_kept_where_a_spectrum_scales_all() {
    let tables = [1.0, 2.0].map(|value| table(|_, _| value)).concat();
    let spectrum = "2\r\n400\t50\r\n700\t25\r\n";
    let one = anisotropic("1\r\n0\r\n2\r\n10\t40\r\n", spectrum, &tables);
    let scan = scan(&one);
    assert_eq!(scan.wavelengths(), [Some(0.4), Some(0.7)]);
    // At 20 deg, a third of the way from 10 to 40 deg: 1 / (pi value), interpolated.
    let factor = (2.0 / 3.0 + 0.5 / 3.0) / PI;
    for (reading, expected) in [
        (scan.readings()[0], 0.5 * factor),
        (scan.readings()[1], 0.25 * factor),
        (*scan.readings().last().unwrap(), 0.5 * factor),
    ] {
        assert!((reading.brdf / expected - 1.0).abs() < 1e-12, "{reading:?}");
    }
    let said = scan.conversions.join("; ");
    assert!(
        said.contains("f_r at its 2 wavelengths differs by factors only"),
        "{said}"
    );
}

#[test]
fn a_constant_spectrum_gives_no_wavelength() {
    let spectrum = "2\r\n350\t5.3229\r\n850\t5.3229\r\n";
    let one = anisotropic("1\r\n0\r\n1\r\n10\r\n", spectrum, &table(|_, _| 3.0));
    let scan = scan(&one);
    assert_eq!(scan.wavelengths(), [None]);
    assert!((scan.readings()[0].brdf / (0.053_229 / PI) - 1.0).abs() < 1e-12);
    let said = scan.conversions.join("; ");
    assert!(
        said.contains("5.3229 % at 2 wavelengths: it is read without a wavelength"),
        "{said}"
    );
}

#[test]
fn anisotropy_angles_must_agree() {
    let spectrum = "1\r\n550\t10\r\n";
    let angles = "2\r\n0\t90\r\n1\r\n10\r\n1\r\n10\r\n";
    let same = [1.0, 1.0].map(|value| table(|_, _| value)).concat();
    let said = scan(&anisotropic(angles, spectrum, &same))
        .conversions
        .join("; ");
    assert!(
        said.contains("1 table of other anisotropy angles"),
        "{said}"
    );
    let other = [1.0, 1.5].map(|value| table(|_, _| value)).concat();
    let message = error(&anisotropic(angles, spectrum, &other));
    assert!(
        message.contains(
            "line 28: the table of the incidence 10 deg differs between the anisotropy angles 0 and 90 \
             deg: the sample is anisotropic"
        ),
        "{message}"
    );
}

#[test]
fn errors_name_line_and_value() {
    let good = spectral(1, 31.4, &table(|_, _| 1.0));
    let with = |from: &str, to: &str| error(&good.replacen(from, to, 1));
    assert_eq!(
        with("v8.0", "v1.0"),
        "a.brdf, line 1: version \"v1.0\" of the format cannot be read: expected v8 or later (open \
         and save the file in the BSDF viewer)"
    );
    assert!(with("brdf surface", "scattering").contains("line 1: expected \"OPTIS - brdf"));
    assert!(with("0\na comment", "1\na comment").contains("line 2: 1: the file is in binary mode"));
    assert!(with("10\nTest", "ten\nTest").contains("line 4, column the length of the description"));
    assert!(with("1\t0", "0\t1").contains("line 6: the file has no reflection"));
    assert!(
        with("1\t0", "1").contains("line 6: 1 fields: expected 2, whether there is reflection")
    );
    assert!(with("2\t2", "0\t2").contains("line 8: \"0\": expected 1 or more"));
    assert!(
        with("10\t30", "10\t95").contains("line 9, column incidence angles in degrees: \"95\"")
    );
    assert!(with("650.5", "red").contains("line 10: \"red\": expected a wavelength in nm"));
    assert!(with("31.4", "-3").contains("line 11, column a reflectance in percent: \"-3\""));
    assert!(with("7\t5", "7\t6").contains("line 13: 5 fields: expected 6, phi in degrees"));
    assert!(with("7\t5", "9\t5").contains("line 21: 1 fields: expected 6, theta and a value"));
    assert!(with("\n30\t1", "\n30\tx").contains("line 16, column a value: \"x\" is not a number"));
    assert!(
        with("\n30\t1", "\n10\t1").contains("line 16: theta 10 follows 15: expected ascending")
    );
    assert!(
        with("\t90\t180\t270\t360", "\t1\t2\t3\t4")
            .contains("line 12: phi covers neither 180 nor 360")
    );
    assert!(error(&good[..good.len() - 30]).contains("expected"));
    assert!(error(&format!("{good}5\n")).contains("a line follows the last table"));
    let dark = spectral(1, 31.4, &table(|_, _| -1.0));
    assert!(error(&dark).contains("line 12: the values of the table reflect no light"));
    let zero = spectral(1, 31.4, &table(|_, _| 0.0));
    assert!(error(&zero).contains("has no reading above the surface"));
    let huge = spectral(
        1,
        31.4,
        &table(|theta, _| if theta == 0 { 1e290 } else { 1e-290 }),
    );
    assert!(read_with(&huge, &ReadOptions::default()).is_ok());
}

#[test]
fn counts_allocate_no_memory() {
    let good = spectral(1, 31.4, &table(|_, _| 1.0));
    let claims = good.replacen("7\t5", "18446744073709551615\t5", 1);
    assert!(error(&claims).contains("line 21: 1 fields: expected 6"));
    let claims = good.replacen("7\t5", "7\t18446744073709551615", 1);
    assert!(error(&claims).contains("line 13: 5 fields: expected 18446744073709551615"));
}

#[test]
fn the_angular_convention_cannot_be_chosen() {
    let options = ReadOptions {
        phi_zero: Some(Side::Source),
        ..ReadOptions::default()
    };
    let good = spectral(1, 31.4, &table(|_, _| 1.0));
    let error = read_with(&good, &options).unwrap_err().to_string();
    assert!(error.contains("phi = 0 is the forward side"), "{error}");
}

#[test]
fn binary_files_and_other_surfaces_are_not_recognised() {
    for (head, is_table) in [
        ("OPTIS - brdf surface file v8.0\n0\n", true),
        (
            "\u{feff}OPTIS - Anisotropic BSDF surface file v8.0\r\n0\r\n",
            true,
        ),
        ("OPTIS - Anisotropic BSDF surface file v8.0\n1\n", false),
        ("OPTIS - scattering surface file v3.0\n", false),
    ] {
        assert_eq!(is_text_mode(head.as_bytes()), is_table, "{head}");
    }
}

proptest! {
    #[test]
    fn damaged_files_give_an_error_or_readings_in_the_domain(
        at in any::<proptest::sample::Index>(),
        length in 0..30_usize,
        by in "[0-9.\t\n eE-]{0,6}",
    ) {
        let mut text = spectral(0, 31.4, &table(|theta, _| f64::from(100 - theta)));
        let from = at.index(text.len());
        text.replace_range(from..(from + length).min(text.len()), &by);
        if let Ok(scan) = read_with(&text, &ReadOptions::default()) {
            for reading in scan.readings() {
                reading.validated().unwrap();
            }
        }
    }
}
