//! Every reader on arbitrary input: it returns readings in the model's domain or an error, and does not
//! panic.

use std::ffi::OsStr;
use std::fs;
use std::path::Path;

use brdf_fit::Measurements;
use brdf_fit::read::ReadOptions;
use brdf_fit::{Format, Side};
use proptest::prelude::*;

/// Reads in every format, and in the format that is detected.
fn read_as_all(bytes: &[u8]) {
    let forced = Format::NAMED.map(|(format, _)| Some(format));
    for format in forced.into_iter().chain([None]) {
        for phi_zero in [None, Some(Side::Forward)] {
            let options = ReadOptions {
                format,
                phi_zero,
                ..ReadOptions::default()
            };
            if let Ok(scan) = Measurements::from_bytes("a.bsdf", bytes, &options) {
                check(&scan);
            }
        }
    }
}

/// Checks that the readings are in the model's domain.
fn check(scan: &Measurements) {
    assert!(!scan.readings().is_empty());
    for reading in scan.readings() {
        reading.validated().unwrap();
        reading.geometry().unwrap();
    }
}

fn is_workbook(path: &Path) -> bool {
    let extensions = Format::Workbook.extensions().iter();
    let mut extensions = extensions.map(OsStr::new);
    extensions.any(|extension| path.extension() == Some(extension))
}

fn valid_files() -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/formats");
    let mut files: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension != "md"))
        .filter(|path| cfg!(feature = "workbook") || !is_workbook(path))
        .collect();
    files.sort();
    let mut contents: Vec<_> = files.iter().map(|path| fs::read(path).unwrap()).collect();
    contents.push(b"# quantity: brdf_cos\npsi_deg,theta_deg,brdf_per_sr\n10,20,0.1\n".to_vec());
    contents
}

/// Reads a valid file. Where its format does not say on which side azimuth 0 is, the side of the source is
/// stated.
fn read_valid(bytes: &[u8]) -> Measurements {
    let read = Measurements::from_bytes("a", bytes, &ReadOptions::default());
    let stated = ReadOptions {
        phi_zero: Some(Side::Source),
        ..ReadOptions::default()
    };
    read.or_else(|_| Measurements::from_bytes("a", bytes, &stated))
        .unwrap()
}

#[test]
fn valid_files_are_read() {
    for file in valid_files() {
        check(&read_valid(&file));
        read_as_all(&file);
    }
}

#[test]
fn each_file_is_known_by_its_content() {
    for file in valid_files() {
        let detected = Format::detect(&file, Path::new("a")).unwrap();
        assert_eq!(detected, read_valid(&file).format);
    }
}

#[test]
fn a_document_in_one_long_line_is_read_to_its_end() {
    let row = "[6.2e-7,0.5,0.5,0,0.1]";
    let rows = vec![row; 5000].join(",");
    let document = format!("{{\"brdf\":{{\"lookupTable\":[{rows}]}}}}");
    let options = ReadOptions::default();
    let scan = Measurements::from_stream("a", document.as_bytes(), &options).unwrap();
    assert_eq!(scan.readings().len(), 5000);
}

/// A word that may replace a part of a file.
fn word() -> impl Strategy<Value = Vec<u8>> {
    let known = [
        "",
        "0",
        "-1",
        "90",
        "180",
        "1e308",
        "-1e308",
        "1e-320",
        "nan",
        "inf",
        "18446744073709551615",
        "99999999999999999999",
        "VARS",
        "TIS",
        "DataBegin",
        "src_z",
        "theta_i",
        "nm",
        "-nm",
        "#",
        "\"",
        "\n",
        "\r",
        ",",
        ";",
        "\t",
        "\0",
        "\u{fffd}",
        "R,G,B",
        "X,Y,Z",
        "deg",
        "BTDF",
        "AOI",
        "ScatterRadial",
        "OPTIS - brdf surface file v8.0\n0\n",
        "DataType:\tBRDF(RT-300S)\n",
        "Raw data\n",
        "tensor_file\0",
        "<WindowElement>",
    ];
    prop_oneof![
        proptest::sample::select(known.to_vec()).prop_map(|word| word.as_bytes().to_vec()),
        proptest::collection::vec(any::<u8>(), 0..8),
    ]
}

proptest! {
    #[test]
    fn arbitrary_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        read_as_all(&bytes);
    }

    #[test]
    fn words_of_the_formats_in_any_order_are_read_or_refused(
        words in proptest::collection::vec(word(), 0..60),
        separator in proptest::sample::select(vec![" ", "\n", ",", "\t"]),
    ) {
        read_as_all(&words.join(separator.as_bytes()));
    }

    #[test]
    fn damaged_files_are_read_or_refused(
        file in 0..valid_files().len(),
        changes in proptest::collection::vec((any::<proptest::sample::Index>(), 0..40_usize, word()), 1..4),
        end in proptest::option::of(any::<proptest::sample::Index>()),
    ) {
        let mut bytes = valid_files().swap_remove(file);
        // Changes are made near the beginning, where the headers are.
        for (at, length, word) in changes {
            let from = at.index(bytes.len().clamp(1, 1500)).min(bytes.len());
            let to = (from + length).min(bytes.len());
            bytes.splice(from..to, word);
        }
        if let Some(end) = end {
            bytes.truncate(end.index(bytes.len() + 1));
        }
        read_as_all(&bytes);
    }
}
