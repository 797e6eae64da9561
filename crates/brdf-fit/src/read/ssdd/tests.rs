//! Tests of the reader of surface scattering distribution data.

use proptest::prelude::*;

use super::*;
use crate::scan::Side;

const HEAD: &str = "VERSION 0.2\n# wavelength_um: 0.65\nSOFTWARE ours\n\n";

fn read_bytes(bytes: &[u8]) -> Result<Measurements, ReadError> {
    read(Path::new("a.ssdd"), bytes, &ReadOptions::default())
}

fn scan(text: &str) -> Measurements {
    read_bytes(text.as_bytes()).unwrap()
}

fn error(text: &str) -> String {
    read_bytes(text.as_bytes()).unwrap_err().to_string()
}

fn spherical() -> String {
    format!(
        "{HEAD}DATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE spherical_coordinate_system\n\
         REDUCTION_TYPE bilateral_symmetry\nPARAM0_LIST 10 30\nPARAM2_LIST 0 40 90 # degrees\nPARAM3_LIST 0 180\n\
         NAME Test paint # 5\nDATA ascii\n# PARAM3: 0\n0.1\n0.2\n0.3\n0.4 # a comment\n5\n6\n# PARAM3: 180\n\
         0.1\n0.2\n0.7\nnan\n11\n12\n"
    )
}

fn in_plane(scan: &Measurements) -> Vec<(f64, f64, f64)> {
    let readings = scan.readings().iter();
    readings
        .map(|r| {
            let theta = r.in_plane_theta().unwrap().to_degrees().round();
            (r.psi.to_degrees().round(), theta + 0.0, r.brdf)
        })
        .collect()
}

#[test]
fn the_first_list_runs_fastest_and_equal_azimuths_are_the_sources_side() {
    let scan = scan(&spherical());
    let expected = [
        (10.0, 0.0, 0.1),
        (30.0, 0.0, 0.2),
        (10.0, 40.0, 0.3),
        (30.0, 40.0, 0.4),
        (10.0, -40.0, 0.7),
    ];
    assert_eq!(in_plane(&scan), expected);
    assert_eq!(scan.wavelengths(), [Some(0.65)]);
    assert_eq!(scan.metadata.get("sample"), Some("Test paint # 5"));
    assert_eq!(
        scan.conversions,
        [
            "azimuths are those of source and view: equal ones are the source's side",
            "1 reading not taken (no value) is left out",
            "4 readings at or beyond 90 deg from the normal are left out",
            "2 readings with the value of the same direction before are left out"
        ]
    );
}

#[test]
fn colours_are_read_at_their_wavelengths() {
    let with = |color: &str, values: &str| {
        scan(&format!(
            "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL {color}\nPARAM_TYPE spherical_coordinate_system\n\
             PARAM0_LIST 0\nPARAM2_LIST 0\nPARAM3_LIST 0\nDATA ascii\n{values}\n"
        ))
    };
    let spectrum = with("spectrum\nWAVELENGTH_LIST 450.5 630.79", "0.1 0.2");
    assert_eq!(spectrum.wavelengths(), [Some(0.4505), Some(0.630_79)]);
    assert_eq!(spectrum.readings()[1].brdf, 0.2);
    let rgb = with("rgb", "0.1 0.2 0.3");
    assert_eq!(rgb.wavelengths(), [Some(0.464), Some(0.549), Some(0.611)]);
    assert_eq!(rgb.readings()[0].brdf, 0.1);
    assert!(rgb.conversions[1].contains("does not define their colour space"));
    let xyz = with("xyz", "0.1 0.2 0.3");
    assert_eq!(xyz.readings().len(), 1);
    assert_eq!(xyz.readings()[0].brdf, 0.2);
    assert_eq!(xyz.wavelengths(), [None]);
}

#[test]
fn directions_about_the_specular_ray_and_half_vectors_are_converted() {
    let with = |system: &str, zenith: f64, polar: f64, azimuth: f64| {
        let scan = scan(&format!(
            "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE {system}_coordinate_system\n\
             PARAM0_LIST {zenith}\nPARAM2_LIST {polar}\nPARAM3_LIST {azimuth}\nPARAM4_LIST 0\nDATA ascii\n0.1\n"
        ));
        in_plane(&scan)[0]
    };
    // Azimuth 0 leads from the specular ray towards the normal.
    assert_eq!(with("specular", 30.0, 20.0, 0.0), (30.0, -10.0, 0.1));
    assert_eq!(with("specular", 30.0, 20.0, 180.0), (30.0, -50.0, 0.1));
    // A half vector at 10 deg, the source 30 deg further from the normal than it.
    assert_eq!(with("half_difference", 10.0, 30.0, 0.0), (40.0, -20.0, 0.1));
    assert_eq!(
        with("half_difference", 10.0, 30.0, 180.0),
        (20.0, -40.0, 0.1)
    );
}

#[test]
fn azimuths_of_incidence_are_read_as_one_sample_and_whole_turns_once() {
    let scan = scan(&format!(
        "{HEAD}DATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE specular_coordinate_system\nPARAM0_LIST 10\n\
         PARAM1_LIST 0 90 360\nPARAM2_LIST 5\nPARAM3_LIST 0 360\nDATA ascii\n1\n2\n1\n1\n2\n1\n"
    ));
    assert_eq!(scan.readings().len(), 2);
    let notes = scan.conversions.join("; ");
    assert!(
        notes.contains("2 azimuths of incidence are read as one isotropic sample"),
        "{notes}"
    );
    assert!(
        notes.contains("4 readings with the value of the same direction"),
        "{notes}"
    );
}

#[test]
fn binary_values_are_in_single_precision() {
    let text = spherical();
    let (head, _) = text.split_once("DATA ascii").unwrap();
    let values = [
        0.1_f32,
        0.2,
        0.3,
        0.4,
        5.0,
        6.0,
        0.1,
        0.2,
        0.7,
        f32::NAN,
        11.0,
        12.0,
    ];
    let mut bytes = format!("{head}DATA binary\r\n").into_bytes();
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    let ascii = in_plane(&scan(&text));
    let binary = in_plane(&read_bytes(&bytes).unwrap());
    assert_eq!(binary.len(), ascii.len());
    for (binary, ascii) in binary.iter().zip(ascii) {
        assert_eq!((binary.0, binary.1), (ascii.0, ascii.1));
        assert!((binary.2 - ascii.2).abs() < 1e-7);
    }
    assert!((READER.recognises)(&bytes));
    bytes.pop();
    let short = read_bytes(&bytes).unwrap_err().to_string();
    assert!(
        short.contains("ends too early: 47 bytes of binary values"),
        "{short}"
    );
}

#[test]
fn other_blocks_are_named_and_not_read() {
    let others = "DATA_TYPE btdf\nCOLOR_MODEL monochrome\nPARAM_TYPE x\nPARAM0_LIST 0 10\nDATA ascii\n1\n2\n\
                  DATA_TYPE specular_reflectance\nCOLOR_MODEL rgb\nPARAM0_LIST 0\nDATA ascii\n1 2 3\n";
    let both = scan(&(spherical() + others));
    assert_eq!(both.readings().len(), 5);
    assert_eq!(
        &both.conversions[1..3],
        [
            "the BTDF is not read",
            "the specular reflectance is not read"
        ]
    );
    let none = error(&format!("{HEAD}{others}"));
    assert!(
        none.contains("has no BRDF, but BTDF and specular reflectance: the model describes"),
        "{none}"
    );
    assert!(error(&(spherical() + &spherical()[HEAD.len()..])).contains("a second BRDF"));
}

#[test]
fn errors_name_line_and_value() {
    let with = |from: &str, to: &str| {
        let text = spherical();
        assert!(text.contains(from), "{from}");
        error(&text.replacen(from, to, 1))
    };
    assert_eq!(
        with("0.3\n", "x\n"),
        "a.ssdd, line 17, column value: \"x\" is not a number: expected a value in 1/sr"
    );
    assert!(
        with("0.3\n", "0.3 0.4\n").contains("line 17: 2 values: expected 1, one for each channel")
    );
    assert!(with("11\n12\n", "11\n").contains("ends too early: 11 colours, expected 12"));
    assert!(
        with("PARAM0_LIST 10 30", "PARAM0_LIST 10 95")
            .contains("PARAM0_LIST: \"95\" is out of range")
    );
    assert!(with("10 30", "10 y").contains("line 9, column PARAM0_LIST: \"y\" is not a number"));
    assert!(with("10 30", "").contains("line 9: PARAM0_LIST is empty"));
    assert!(
        with("PARAM0_LIST", "PARAM9_LIST").contains("line 9: \"PARAM9_LIST\": expected a keyword")
    );
    assert!(
        with("spherical_", "distorted_")
            .contains("PARAM_TYPE \"distorted_coordinate_system\": expected")
    );
    assert!(
        with("bilateral_symmetry", "half")
            .contains("line 8: \"half\": expected bilateral_symmetry")
    );
    assert!(with("monochrome", "spectrum").contains("line 5: the block has no WAVELENGTH_LIST"));
    assert!(with("COLOR_MODEL monochrome\n", "").contains("line 5: the block has no COLOR_MODEL"));
    assert!(with("DATA ascii", "DATA hex").contains("DATA \"hex\": expected ascii or binary"));
    assert!(with("DATA_TYPE brdf", "DATA_TYPE x").contains("line 5: \"x\": expected brdf or btdf"));
    assert!(
        with("PARAM3_LIST 0 180", "PARAM3_LIST 0 180\nPARAM4_LIST 0 5")
            .contains("PARAM4_LIST: the specular directions are offset")
    );
    assert!(with("SOFTWARE", "HARDWARE").contains("line 3: \"HARDWARE\": expected SOFTWARE"));
    assert!(error(HEAD).contains("expected DATA_TYPE"));
    let low = "VERSION 1\nDATA_TYPE brdf\nCOLOR_MODEL rgb\nPARAM_TYPE spherical_coordinate_system\n\
               PARAM0_LIST 90\nDATA ascii\n1 2 3\n";
    assert!(error(low).contains("has no reading above the surface"));
}

#[test]
fn lists_that_claim_more_than_the_file_holds_allocate_no_memory() {
    let list = vec!["1"; 60_000].join(" ");
    let text = format!(
        "{HEAD}DATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE spherical_coordinate_system\nPARAM0_LIST {list}\n\
         PARAM1_LIST {list}\nPARAM2_LIST {list}\nDATA ascii\n1\n"
    );
    assert!(error(&text).contains("ends too early: 1 colours"));
    let binary = text.replace("ascii", "binary");
    assert!(error(&binary).contains("ends too early"));
    let overflow = text.replace("DATA ascii", &format!("PARAM3_LIST {list}\nDATA ascii"));
    assert!(error(&overflow).contains("ends too early") || error(&overflow).contains("too long"));
}

#[test]
fn the_format_is_known_and_fixes_the_convention() {
    assert!((READER.recognises)(spherical().as_bytes()));
    assert!(!(READER.recognises)(b"VERSION 1\npsi_deg,theta_deg\n"));
    let options = ReadOptions {
        phi_zero: Some(Side::Forward),
        ..ReadOptions::default()
    };
    let refused = read(Path::new("a"), spherical().as_bytes(), &options);
    assert!(
        refused
            .unwrap_err()
            .to_string()
            .contains("cannot be chosen")
    );
}

proptest! {
    #[test]
    fn any_lines_are_read_or_refused(
        lines in proptest::collection::vec(
            proptest::sample::select(vec![
                "DATA_TYPE brdf", "COLOR_MODEL rgb", "COLOR_MODEL monochrome", "PARAM0_LIST 0 45 90",
                "PARAM1_LIST 0 360", "PARAM2_LIST 0 180", "PARAM3_LIST 0 1e9", "DATA ascii", "DATA binary",
                "PARAM_TYPE specular_coordinate_system", "PARAM_TYPE half_difference_coordinate_system",
                "PARAM_TYPE spherical_coordinate_system", "1 2 3", "0.5", "nan", "-1e300", "# x: y", "",
            ]),
            0..40,
        ),
    ) {
        let text = format!("VERSION 0.2\n{}\n", lines.join("\n"));
        if let Ok(scan) = read_bytes(text.as_bytes()) {
            for reading in scan.readings() {
                reading.validated().unwrap();
            }
        }
    }

    #[test]
    fn binary_values_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..60)) {
        let head = "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL rgb\nPARAM_TYPE half_difference_coordinate_system\n\
                    PARAM0_LIST 0 30\nPARAM2_LIST 10 20\nDATA binary\n";
        if let Ok(scan) = read_bytes(&[head.as_bytes(), &bytes].concat()) {
            for reading in scan.readings() {
                reading.validated().unwrap();
            }
        }
    }
}
