//! Writing of figures to files.

use std::fs;
use std::path::{Path, PathBuf};

use super::error::PlotError;
use super::figure::Figure;
use crate::output::write_file;

/// Pixels of a written PNG for each unit of the SVG: print quality.
const PRINT_SCALE: f32 = 2.0;

/// The endings of the files of a figure.
pub(super) const ENDINGS: [&str; 2] = ["svg", "png"];

/// The name of the files of a figure without their ending.
pub(super) fn stem(prefix: &str, name: &str) -> String {
    let hyphen = if prefix.is_empty() { "" } else { "-" };
    format!("{prefix}{hyphen}{name}")
}

/// Creates a folder if it does not exist.
pub(super) fn create_folder(folder: &Path) -> Result<(), PlotError> {
    fs::create_dir_all(folder).map_err(|error| PlotError::Folder {
        path: folder.to_owned(),
        error,
    })
}

/// Writes each figure as `prefix-name.svg` and `prefix-name.png` (without the hyphen where the
/// prefix is empty) to a folder, which is created where it does not exist. Returns the paths of the
/// files.
///
/// # Errors
///
/// Where the folder cannot be created, a figure cannot be converted to PNG, or a file cannot be
/// written; the files before it remain.
pub fn write_figures(
    figures: &[Figure],
    folder: &Path,
    prefix: &str,
) -> Result<Vec<PathBuf>, PlotError> {
    create_folder(folder)?;
    let mut files = Vec::new();
    for figure in figures {
        let stem = stem(prefix, &figure.name);
        let png = figure.png(PRINT_SCALE)?;
        for (ending, content) in ENDINGS.into_iter().zip([figure.svg.as_bytes(), &png]) {
            let path = folder.join(format!("{stem}.{ending}"));
            write_file(&path, |writer| writer.write_all(content))?;
            files.push(path);
        }
    }
    Ok(files)
}
