//! The settings of an export.

use super::grid::AngleGrid;

/// The default tolerance of the interpolated tables, ASTM and Zemax: a relative error of f_r of 5
/// %.
pub const DEFAULT_TOLERANCE: f64 = 5e-2;

/// The settings of an export. A format ignores those that do not concern it.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportOptions {
    /// The prefix of all names in source code, and the type of the BSDF in Mitsuba: letters a-z,
    /// digits and single underscores between them, beginning with a letter.
    pub name: String,
    /// The largest relative error of f_r that a table may have, in (0, 1): between its entries
    /// where they are interpolated (ASTM, Zemax), in the nearest bin of MERL tables. `None` means
    /// [`DEFAULT_TOLERANCE`] for the former and no limit for the latter, whose resolution is fixed.
    pub tolerance: Option<f64>,
    /// The angles of the CSV table.
    pub grid: AngleGrid,
    /// The wavelengths in micrometres of the fits for red, green and blue, in MERL tables and in
    /// Mitsuba; see [`Material::rgb`](super::Material::rgb).
    pub rgb: Option<[f64; 3]>,
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self {
            name: "brdf".to_owned(),
            tolerance: None,
            grid: AngleGrid::default(),
            rgb: None,
        }
    }
}
