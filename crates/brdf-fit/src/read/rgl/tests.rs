//! Tests of whole files.

use std::f64::consts::{FRAC_PI_2, PI};

use proptest::prelude::*;

use super::*;
use crate::scan::Side;

/// A tensor of 32-bit floating-point numbers.
type Named = (&'static str, Vec<usize>, Vec<f32>);

/// The bytes of a tensor file.
fn file(tensors: &[Named]) -> Vec<u8> {
    let header = |offset_of: &dyn Fn(usize) -> usize| {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend(u32::try_from(tensors.len()).unwrap().to_le_bytes());
        for (i, (name, shape, _)) in tensors.iter().enumerate() {
            bytes.extend(u16::try_from(name.len()).unwrap().to_le_bytes());
            bytes.extend(name.as_bytes());
            bytes.extend(u16::try_from(shape.len()).unwrap().to_le_bytes());
            bytes.push(10);
            bytes.extend((offset_of(i) as u64).to_le_bytes());
            for size in shape {
                bytes.extend((*size as u64).to_le_bytes());
            }
        }
        bytes
    };
    let start = header(&|_| 0).len();
    let before = |i: usize| {
        tensors
            .iter()
            .take(i)
            .map(|(_, _, values)| 4 * values.len())
    };
    let mut bytes = header(&|i| start + before(i).sum::<usize>());
    for (_, _, values) in tensors {
        bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    }
    bytes
}

/// A material with constant densities, two incidences, two wavelengths and 3 x 4 nodes of the values.
fn tensors(value: impl Fn(usize) -> f32) -> Vec<Named> {
    vec![
        ("theta_i", vec![2], vec![0.0, 0.5]),
        ("phi_i", vec![1], vec![0.0]),
        ("ndf", vec![2, 2], vec![0.3; 4]),
        ("sigma", vec![2, 2], vec![0.5; 4]),
        ("vndf", vec![1, 2, 2, 3], vec![1.0; 12]),
        ("wavelengths", vec![2], vec![450.0, 650.0]),
        ("spectra", vec![1, 2, 2, 3, 4], (0..48).map(value).collect()),
    ]
}

fn with(name: &str, change: impl Fn(&mut Named)) -> Vec<u8> {
    let mut all = tensors(|_| 1.0);
    let found = all.iter_mut().find(|tensor| tensor.0 == name);
    change(found.unwrap());
    file(&all)
}

fn read_bytes(bytes: &[u8]) -> Result<Measurements, ReadError> {
    read(Path::new("a.bsdf"), bytes, &ReadOptions::default())
}

fn error(bytes: &[u8]) -> String {
    read_bytes(bytes).unwrap_err().to_string()
}

#[test]
fn a_node_is_the_view_mirrored_at_its_facet() {
    let scan = read_bytes(&file(&tensors(|i| i as f32))).unwrap();
    assert_eq!(scan.wavelengths(), [Some(0.45), Some(0.65)]);
    // A constant density takes the node (column, row) to (u, v) itself. At normal incidence, the view
    // is at twice the tilt of the facet.
    let tilts = [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|u| u * u * FRAC_PI_2);
    let first: Vec<_> = scan.readings().iter().take(9).collect();
    for (i, reading) in first.iter().enumerate() {
        let (row, column) = (i / 3, i % 3);
        let theta = 2.0 * tilts[column];
        assert!((reading.theta - theta).abs() < 1e-12, "{reading:?}");
        let azimuth = [-PI, 0.0, PI][row];
        if column > 0 {
            assert!(
                (reading.phi.cos() - azimuth.cos()).abs() < 1e-12,
                "{reading:?}"
            );
        }
        let value = (4 * row + column) as f64;
        let expected = value * f64::from(0.3_f32) / (4.0 * 0.5) / theta.cos();
        assert!((reading.brdf - expected).abs() < 1e-12, "{reading:?}");
    }
    // Without tilt, the view is the specular direction.
    let specular = scan.readings().iter().find(|r| r.psi == 0.5).unwrap();
    assert!((specular.theta - 0.5).abs() < 1e-12 && (specular.phi.abs() - PI).abs() < 1e-12);
    let said = scan.conversions.join("; ");
    assert!(said.contains("readings at or beyond 90 deg"), "{said}");
}

#[test]
fn colours_are_assigned_to_wavelengths() {
    let mut all = tensors(|_| 1.0);
    all.truncate(5);
    all.push(("rgb", vec![1, 2, 3, 3, 4], vec![1.0; 72]));
    let scan = read_bytes(&file(&all)).unwrap();
    assert_eq!(scan.wavelengths(), [Some(0.464), Some(0.549), Some(0.611)]);
    let said = scan.conversions.join("; ");
    assert!(
        said.contains("red, green and blue are assigned to 0.611, 0.549 and 0.464 um"),
        "{said}"
    );
}

#[test]
fn values_without_the_factor_are_f_r_cos_theta() {
    let mut all = tensors(|_| 0.5);
    all.push(("jacobian", vec![1], vec![0.0]));
    let scan = read_bytes(&file(&all)).unwrap();
    for reading in scan.readings() {
        assert!((reading.brdf * reading.theta.cos() - 0.5).abs() < 1e-12);
    }
}

#[test]
fn values_that_are_no_numbers_are_left_out() {
    let scan = read_bytes(&file(&tensors(|i| if i == 1 { f32::NAN } else { 1.0 }))).unwrap();
    let said = scan.conversions.join("; ");
    assert!(
        said.contains("1 reading not taken (no value) is left out"),
        "{said}"
    );
}

#[test]
fn large_files_are_thinned_evenly() {
    let bytes = file(&tensors(|i| i as f32));
    let tensors = TensorFile::new(&bytes).unwrap();
    let material = Material::new(&tensors).unwrap();
    let found = material.readings(20).unwrap();
    let said = found.thinned.unwrap();
    assert_eq!(
        said,
        "one node of 2 is read of each row and column of 3 x 4: 16 values in place of 48 values"
    );
    assert!(found.readings.len() <= 16);
    assert_eq!(material.readings(48).unwrap().thinned, None);
    let error = material.readings(3).err().unwrap();
    assert_eq!(
        error,
        "has 2 incidences and 2 wavelengths: expected 3 pairs of them at most"
    );
}

#[test]
fn errors_say_what_the_file_is() {
    assert!(error(b"x").contains("does not begin with \"tensor_file\""));
    let good = file(&tensors(|_| 1.0));
    assert!(error(&good[..40]).contains("is a truncated RGL tensor file: expected the list"));
    assert!(
        error(&good[..good.len() - 1]).contains(
            "is truncated: the tensor spectra of 1 x 2 x 2 x 3 x 4 numbers extends beyond"
        )
    );
    let mut version = good.clone();
    version[12] = 2;
    assert!(error(&version).contains("of version 2.0: expected 1.0"));
    let anisotropic = with("phi_i", |(_, shape, values)| {
        *shape = vec![3];
        *values = vec![0.0; 3];
    });
    assert!(
        error(&anisotropic)
            .contains("3 azimuths of the source (phi_i): the material is anisotropic")
    );
    let named = |name: &'static str| with(name, |tensor| tensor.0 = "other");
    assert!(
        error(&named("vndf")).contains("cannot be read because it has no tensor vndf: expected")
    );
    assert!(error(&named("spectra")).contains("has no tensor spectra"));
    let flat = with("vndf", |(_, shape, _)| *shape = vec![1, 2, 1, 6]);
    assert!(error(&flat).contains("has 1 x 6 nodes in the tensor vndf: expected 2 x 2 or more"));
    let sizes = with("spectra", |(_, shape, _)| *shape = vec![1, 1, 4, 3, 4]);
    assert!(
        error(&sizes)
            .contains("has a tensor spectra of 1 x 1 x 4 x 3 x 4 numbers: expected 1 x 2 x 2")
    );
    let dark = with("vndf", |(_, _, values)| values.fill(0.0));
    assert!(error(&dark).contains("has no visible facets at 0.000 deg in the tensor vndf"));
    let negative = with("ndf", |(_, _, values)| values[1] = -1.0);
    assert!(error(&negative).contains("has the value -1 in the tensor ndf"));
    let no_area = with("sigma", |(_, _, values)| values.fill(0.0));
    assert!(error(&no_area).contains("has values out of range: f_r would be inf"));
    let below = with("theta_i", |(_, _, values)| values.fill(1.6));
    assert!(error(&below).contains("has no reading above the surface"));
    let negative = with("theta_i", |(_, _, values)| values[0] = -0.1);
    assert!(error(&negative).contains("has the incidence -0.1"));
    let dark = with("wavelengths", |(_, _, values)| values[0] = 0.0);
    assert!(error(&dark).contains("has the wavelength 0 nm"));
}

#[test]
fn equal_azimuths_of_the_source_are_isotropic() {
    let two = |last: f32| {
        let mut all = tensors(|_| 1.0);
        all[1] = ("phi_i", vec![2], vec![0.0, 3.0]);
        all[4] = ("vndf", vec![2, 2, 2, 3], vec![1.0; 24]);
        let mut values = vec![1.0; 96];
        values[95] = last;
        all[6] = ("spectra", vec![2, 2, 2, 3, 4], values);
        file(&all)
    };
    assert!(read_bytes(&two(1.0)).is_ok());
    assert!(
        error(&two(2.0)).contains("second azimuth of the source (phi_i) in the tensor spectra")
    );
}

#[test]
fn claims_allocate_no_memory() {
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0, 255, 255, 255, 255, 1, 0, b'a', 4, 0, 10]);
    bytes.extend([255; 48]);
    assert!(error(&bytes).contains("is truncated: the tensor a of 18446744073709551615 x"));
}

#[test]
fn the_angular_convention_cannot_be_chosen() {
    let options = ReadOptions {
        phi_zero: Some(Side::Forward),
        ..ReadOptions::default()
    };
    let bytes = file(&tensors(|_| 1.0));
    let error = read(Path::new("a"), &bytes, &options)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("counted from the normal and from the source"),
        "{error}"
    );
}

proptest! {
    #[test]
    fn damaged_files_give_an_error_or_readings_in_the_domain(
        changes in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 1..6),
        end in proptest::option::of(any::<proptest::sample::Index>()),
    ) {
        let mut bytes = file(&tensors(|i| i as f32));
        for (at, by) in changes {
            let at = at.index(bytes.len());
            bytes[at] = by;
        }
        if let Some(end) = end {
            bytes.truncate(end.index(bytes.len() + 1));
        }
        if let Ok(scan) = read_bytes(&bytes) {
            for reading in scan.readings() {
                reading.validated().unwrap();
            }
        }
    }
}
