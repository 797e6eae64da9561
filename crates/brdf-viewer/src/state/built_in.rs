//! The samples that are always at hand: the project's measured ones, and Table 1 of the paper.

use brdf_core::published::PUBLISHED;
use brdf_fit::Measurements;
use brdf_fit::read::ReadError;

use super::sample::{Scan, published_name};
use crate::job::Opened;

macro_rules! measured {
    ($name:literal) => {
        (
            concat!("data/measured/", $name),
            include_str!(concat!("../../../../data/measured/", $name)),
        )
    };
}
/// The measured samples: where they stand in the project, and their text.
const MEASURED: [(&str, &str); 4] = [
    measured!("z307_on_aluminium.csv"),
    measured!("z307_on_aluminium_cycled.csv"),
    measured!("black_anodise_on_aluminium.csv"),
    measured!("titanium_anodise.csv"),
];

/// An entry of the menu.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BuiltIn {
    /// Its name in the menu.
    pub name: String,
    /// Whether it was measured; the others are theory alone.
    pub measured: bool,
}

/// The entries of the menu.
pub fn entries() -> Vec<BuiltIn> {
    let measured = MEASURED.iter().map(|(path, _)| BuiltIn {
        name: path.rsplit('/').next().unwrap_or(path).to_owned(),
        measured: true,
    });
    let published = PUBLISHED.iter().map(|row| BuiltIn {
        name: published_name(row),
        measured: false,
    });
    measured.chain(published).collect()
}

/// The scans of an entry; `None` where there is none of this number.
pub fn open(entry: usize) -> Option<Result<Opened, ReadError>> {
    if let Some((path, text)) = MEASURED.get(entry) {
        return Some(scans(path, text));
    }
    let row = PUBLISHED.get(entry - MEASURED.len())?;
    Some(Ok(opened(published_name(row), vec![Scan::published(row)])))
}

/// The entry whose source this is.
pub fn entry_of(source: &str) -> Option<usize> {
    let measured = MEASURED.iter().map(|(path, _)| (*path).to_owned());
    let published = PUBLISHED.iter().map(published_name);
    measured.chain(published).position(|known| known == source)
}

/// The text of the measured sample that a fit names, where it is one of these.
pub fn text_of(source: &str) -> Option<&'static str> {
    let found = MEASURED.iter().find(|(path, _)| *path == source);
    found.map(|(_, text)| *text)
}

fn opened(source: String, scans: Vec<Scan>) -> Opened {
    Opened {
        source,
        file: None,
        scans,
    }
}

fn scans(path: &str, text: &str) -> Result<Opened, ReadError> {
    let convention = brdf_fit::scan::Convention::default();
    let all = Measurements::from_reader_with(text.as_bytes(), path, convention)?;
    let scans = all.by_wavelength().into_iter().map(Scan::new);
    Ok(opened(path.to_owned(), scans.collect()))
}
