//! The built-in samples: measured ones of the project, and Table 1 of the paper.

use std::path::Path;

use brdf_core::published::PUBLISHED;
use brdf_fit::Convention;
use brdf_fit::Measurements;
use brdf_fit::read::ReadError;

use super::sample::{Opened, Scan, published_name};

macro_rules! measured {
    ($name:literal) => {
        (
            concat!("data/measured/", $name),
            include_str!(concat!("../../samples/", $name)),
        )
    };
}
/// The measured samples: their paths in the project, and their content.
const MEASURED: [(&str, &str); 4] = [
    measured!("z307_on_aluminium.csv"),
    measured!("z307_on_aluminium_cycled.csv"),
    measured!("black_anodise_on_aluminium.csv"),
    measured!("titanium_anodise.csv"),
];

/// An entry of the built-in menu.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BuiltIn {
    /// The name in the menu.
    pub name: String,
    /// Whether the sample has readings; otherwise it has only a theory.
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

/// Opens an entry; `None` if there is no entry of this index.
pub fn open(entry: usize) -> Option<Result<Opened, ReadError>> {
    if let Some((path, text)) = MEASURED.get(entry) {
        return Some(measured(path, text));
    }
    let row = PUBLISHED.get(entry - MEASURED.len())?;
    Some(Ok(opened(published_name(row), vec![Scan::published(row)])))
}

/// The index of the entry with a source.
pub fn entry_of(source: &str) -> Option<usize> {
    let measured = MEASURED.iter().map(|(path, _)| (*path).to_owned());
    let published = PUBLISHED.iter().map(published_name);
    measured.chain(published).position(|known| known == source)
}

/// The names of the measured samples in links to a page: those of their files without extension.
pub fn link_names() -> impl Iterator<Item = String> {
    let stem = |path: &str| Some(Path::new(path).file_stem()?.to_str()?.to_owned());
    MEASURED.iter().filter_map(move |(path, _)| stem(path))
}

/// The index of the entry with a name in links.
pub fn entry_named(name: &str) -> Option<usize> {
    link_names().position(|known| known == name)
}

/// The source of a measured entry.
pub fn source_of(entry: usize) -> Option<&'static str> {
    MEASURED.get(entry).map(|(path, _)| *path)
}

/// The content of the measured sample with a source.
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

fn measured(path: &str, text: &str) -> Result<Opened, ReadError> {
    let convention = Convention::default();
    let all = Measurements::from_reader_with(text.as_bytes(), path, convention)?;
    let scans = all.by_wavelength().into_iter().map(Scan::new);
    Ok(opened(path.to_owned(), scans.collect()))
}
