//! The committed data are those that their command makes.

use std::fs;

use brdf_fit::Measurements;
use brdf_tests::{data, in_workspace, picture};

/// The numbers of a text, and what stands between them.
fn numbers(text: &str) -> (Vec<f64>, String) {
    let is_number = |c: char| c.is_ascii_digit() || c == '.';
    let numbers = text
        .split(|c| !is_number(c))
        .filter_map(|word| word.parse().ok());
    (numbers.collect(), text.split(is_number).collect())
}

/// Whether two texts agree but for the last digits of their numbers, or a pixel of a picture,
/// which may differ from one processor to the next.
fn agree(one: &str, other: &str, is_picture: bool) -> bool {
    let ((one, between_one), (other, between_other)) = (numbers(one), numbers(other));
    let near = |(a, b): (&f64, &f64)| {
        let allowed = if is_picture { 1.0 } else { 1e-12 * a.abs() };
        (a - b).abs() <= allowed
    };
    between_one == between_other && one.len() == other.len() && one.iter().zip(&other).all(near)
}

#[test]
fn generated_files_are_current() {
    let mut files = data::files();
    files.push(("docs/z307.svg".to_owned(), picture::svg().unwrap()));
    for (path, text) in files {
        let committed = fs::read_to_string(in_workspace(&path)).unwrap_or_default();
        let is_picture = path.ends_with("svg");
        assert!(
            agree(&committed, &text, is_picture),
            "{path} is not current: run cargo run --release -p brdf-tests --bin make-data"
        );
    }
}

#[test]
fn every_scan_in_the_data_can_be_read_and_says_where_it_comes_from() {
    for folder in ["data/measured", "data/synthetic"] {
        let mut count = 0;
        for entry in fs::read_dir(in_workspace(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|extension| extension != "csv") {
                continue;
            }
            let scan = Measurements::read_csv(&path).unwrap();
            assert!(scan.readings().len() >= 100 && scan.ignored_columns.is_empty());
            assert!(scan.metadata.get("source").is_some(), "{}", path.display());
            count += 1;
        }
        assert!(count >= 4, "{folder}");
    }
}

#[test]
fn copies_of_measured_samples_are_those_of_the_shared_folder() {
    let Some(shared) = brdf_tests::shared_data() else {
        return;
    };
    for entry in fs::read_dir(shared.join("blacklab")).unwrap() {
        let original = entry.unwrap().path();
        let copy = in_workspace("data/measured").join(original.file_name().unwrap());
        assert_eq!(fs::read(original).unwrap(), fs::read(copy).unwrap());
    }
}
