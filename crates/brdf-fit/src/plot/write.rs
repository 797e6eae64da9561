//! Figures as files.

use std::fs;
use std::path::{Path, PathBuf};

use super::error::PlotError;
use super::figure::Figure;
use crate::output::write_file;

/// Pixels of a written PNG for each unit of the SVG.
const PRINT_SCALE: f32 = 2.0;

/// Writes each figure as `prefix-name.svg` and `prefix-name.png` (without the hyphen where the
/// prefix is empty) into a folder, which is made where it does not exist. Returns the files.
pub fn write_figures(
    figures: &[Figure],
    folder: &Path,
    prefix: &str,
) -> Result<Vec<PathBuf>, PlotError> {
    fs::create_dir_all(folder).map_err(|error| PlotError::Folder {
        path: folder.to_owned(),
        error,
    })?;
    let hyphen = if prefix.is_empty() { "" } else { "-" };
    let mut files = Vec::new();
    for figure in figures {
        let stem = format!("{prefix}{hyphen}{}", figure.name);
        let png = figure.png(PRINT_SCALE)?;
        for (ending, content) in [("svg", figure.svg.as_bytes()), ("png", &png)] {
            let path = folder.join(format!("{stem}.{ending}"));
            write_file(&path, |writer| writer.write_all(content))?;
            files.push(path);
        }
    }
    Ok(files)
}
