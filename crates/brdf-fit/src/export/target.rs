//! The forms in which a coating leaves.

use std::io::{self, Write};
use std::str::FromStr;

use brdf_core::GeometryError;

use super::csv::AngleGrid;
use super::interpolated::{MOST_ENTRIES, Unreachable};
use super::material::{Material, MaterialError};
use super::merl::{self, LookupError};
use super::source::{Language, NameError, Source};
use super::{astm, csv, mitsuba, zemax};

/// A form in which a coating leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// The model as versioned JSON: what [`Material::read`] reads.
    Json,
    /// A MERL table of three channels.
    Merl,
    /// ASTM E1392 text in Cornell's layout, a table.
    Astm,
    /// Zemax tabular BSDF.
    Zemax,
    /// Our own table on a grid of angles.
    Csv,
    /// Mitsuba 3: a BSDF plugin in Python, and a scene beside it.
    Mitsuba,
    /// Source code.
    Source(Language),
}

impl Target {
    /// All forms, with the names that options give them.
    pub const NAMED: [(Self, &str); 11] = [
        (Self::Json, "json"),
        (Self::Source(Language::C), "c"),
        (Self::Source(Language::Glsl), "glsl"),
        (Self::Source(Language::Wgsl), "wgsl"),
        (Self::Source(Language::Osl), "osl"),
        (Self::Source(Language::Python), "python"),
        (Self::Mitsuba, "mitsuba"),
        (Self::Merl, "merl"),
        (Self::Astm, "astm"),
        (Self::Zemax, "zemax"),
        (Self::Csv, "csv"),
    ];

    /// The extension of the second file of a form that has one.
    pub fn beside(self) -> Option<&'static str> {
        (self == Self::Mitsuba).then_some("xml")
    }
}

impl FromStr for Target {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::NAMED.iter().find(|(_, name)| *name == text);
        found.map(|(target, _)| *target).ok_or_else(|| {
            let names = Self::NAMED.map(|(_, name)| name).join(", ");
            format!("\"{text}\" is not a format: expected one of {names}")
        })
    }
}

/// The tolerance of interpolated tables where none is given.
pub const USUAL_TOLERANCE: f64 = 5e-2;

/// What a form may be told.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportOptions {
    /// The first word of the names in source code, and the type of the material in Mitsuba.
    pub name: String,
    /// The largest error of a table: of f_r interpolated between its entries, relative; of MERL
    /// tables that of f_r of the nearest bin. Where it is not given, [`USUAL_TOLERANCE`], and of
    /// MERL tables, whose bins are what they are, any.
    pub tolerance: Option<f64>,
    /// The angles of our own table.
    pub grid: AngleGrid,
    /// The wavelengths in micrometres that stand for red, green and blue; see [`Material::rgb`].
    pub rgb: Option<[f64; 3]>,
}

/// What the command has where nothing is said.
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

/// Why a coating does not leave.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The form has no room for it.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// No table of a size that is of use keeps to the tolerance.
    #[error(
        "a table within {tolerance:e} has more than {MOST_ENTRIES} entries: expected {}",
        expected(*.reachable)
    )]
    Tolerance {
        /// The tolerance that was asked for.
        tolerance: f64,
        /// One that can be kept to; `None` where the lobe is too narrow for any.
        reachable: Option<f64>,
    },
    /// The bins of a MERL table are too wide for the tolerance.
    #[error(
        "the bins of a MERL table, {found}, do not keep to {tolerance:e}: expected no --tolerance, or \
         another format"
    )]
    Bins {
        /// The tolerance that was asked for.
        tolerance: f64,
        /// What the bins keep to.
        found: LookupError,
    },
    /// Angles outside the model's domain.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The name is none in source code.
    #[error(transparent)]
    Name(#[from] NameError),
    /// It cannot be written.
    #[error(transparent)]
    Io(#[from] io::Error),
}

impl ExportError {
    pub(super) fn tolerance(tolerance: f64, unreachable: &Unreachable) -> Self {
        Self::Tolerance {
            tolerance,
            reachable: Some(unreachable.reachable).filter(|reachable| *reachable < 1.0),
        }
    }
}

fn expected(reachable: Option<f64>) -> String {
    match reachable {
        Some(tolerance) => format!("--tolerance {tolerance:.1e} or more"),
        None => "source code, as no table keeps to any tolerance".to_owned(),
    }
}

/// Writes a coating in a form. What there is to say of it: the error of a table of fixed bins.
pub fn export(
    coating: &Material,
    target: Target,
    options: &ExportOptions,
    writer: &mut dyn Write,
) -> Result<Option<LookupError>, ExportError> {
    let tolerance = options.tolerance.unwrap_or(USUAL_TOLERANCE);
    match target {
        Target::Merl => {
            let fits = coating.rgb(options.rgb)?;
            return merl::write(fits, options.tolerance, writer).map(Some);
        }
        Target::Json => coating.write(writer)?,
        Target::Astm => astm::write(coating, tolerance, writer)?,
        Target::Zemax => zemax::write(coating.only()?, tolerance, writer)?,
        Target::Csv => csv::write(coating, &options.grid, writer)?,
        Target::Mitsuba => mitsuba::write_plugin(coating, options, writer)?,
        Target::Source(language) => {
            let source = Source::new(&options.name, coating.only()?)?;
            writer.write_all(source.text(language).as_bytes())?;
        }
    }
    Ok(None)
}

/// Writes the second file of a form that has one ([`Target::beside`]), and nothing for others.
pub fn export_beside(
    target: Target,
    options: &ExportOptions,
    writer: &mut dyn Write,
) -> Result<(), ExportError> {
    if target == Target::Mitsuba {
        mitsuba::write_scene(options, writer)?;
    }
    Ok(())
}
