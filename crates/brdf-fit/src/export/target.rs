//! The formats of an export, and the dispatch to the code of each.

use std::io::Write;
use std::str::FromStr;

use super::error::ExportError;
use super::material::Material;
use super::nearest_bin::LookupError;
use super::options::{DEFAULT_TOLERANCE, ExportOptions};
use super::source::{Language, Source};
use super::{astm, csv, merl, mitsuba, source, zemax};

/// A format in which a material can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// The fits as versioned JSON, which [`Material::read`] reads.
    Json,
    /// A MERL table of the channels red, green and blue.
    Merl,
    /// ASTM E1392 text in the layout of Cornell University: a table.
    Astm,
    /// Zemax tabular BSDF.
    Zemax,
    /// CSV on a grid of angles, which [`read::csv`](crate::read::csv) reads.
    Csv,
    /// Mitsuba 3: a BSDF plugin in Python, with a scene as its companion file.
    Mitsuba,
    /// Source code.
    Source(Language),
}

impl Target {
    /// All formats with the names from which they are parsed.
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

    /// The extension of the companion file of a format that consists of two files; see
    /// [`export_companion`].
    pub fn companion_extension(self) -> Option<&'static str> {
        (self == Self::Mitsuba).then_some("xml")
    }
}

/// A text is not the name of a [`Target`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("\"{text}\" is not a format: expected one of {}", Target::NAMED.map(|(_, name)| name).join(", "))]
pub struct UnknownTarget {
    /// The text.
    pub text: String,
}

impl FromStr for Target {
    type Err = UnknownTarget;

    fn from_str(text: &str) -> Result<Self, UnknownTarget> {
        let found = Self::NAMED.iter().find(|(_, name)| *name == text);
        found
            .map(|(target, _)| *target)
            .ok_or_else(|| UnknownTarget {
                text: text.to_owned(),
            })
    }
}

/// Writes a material in a format. Returns the error of the table for [`Target::Merl`], whose bins
/// are fixed, and `None` for all other formats.
///
/// # Errors
///
/// [`ExportError::Selection`] where the format takes one fit and the material has several, or where
/// there is no fit for a colour; [`ExportError::Tolerance`] and [`ExportError::Bins`] where a table
/// does not satisfy the tolerance; [`ExportError::Geometry`] for an angle of the grid outside the
/// domain; [`ExportError::Name`] for a name that source code cannot have; [`ExportError::Io`] where
/// writing fails.
///
/// # Examples
///
/// ```no_run
/// use brdf_fit::export::{ExportOptions, Language, Material, Target, export};
///
/// let material = Material::read("fit.json")?.at_wavelength(0.55)?;
/// let options = ExportOptions {
///     name: "paint".to_owned(),
///     ..ExportOptions::default()
/// };
/// let mut header = Vec::new();
/// export(&material, Target::Source(Language::C), &options, &mut header)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn export(
    material: &Material,
    target: Target,
    options: &ExportOptions,
    writer: &mut dyn Write,
) -> Result<Option<LookupError>, ExportError> {
    let tolerance = options.tolerance.unwrap_or(DEFAULT_TOLERANCE);
    match target {
        Target::Merl => {
            let fits = material.rgb(options.rgb)?;
            return merl::write(fits, options.tolerance, writer).map(Some);
        }
        Target::Json => material.write(writer)?,
        Target::Astm => astm::write(material, tolerance, writer)?,
        Target::Zemax => zemax::write(material.only()?, tolerance, writer)?,
        Target::Csv => csv::write(material, &options.grid, writer)?,
        Target::Mitsuba => mitsuba::write_plugin(material, options, writer)?,
        Target::Source(language) => {
            let source = Source::new(&options.name, material.only()?)?;
            writer.write_all(source::text(&source, language).as_bytes())?;
        }
    }
    Ok(None)
}

/// Writes the companion file of a format that has one ([`Target::companion_extension`]), and
/// nothing for other formats.
///
/// # Errors
///
/// [`ExportError::Io`] where writing fails.
pub fn export_companion(
    target: Target,
    options: &ExportOptions,
    writer: &mut dyn Write,
) -> Result<(), ExportError> {
    if target == Target::Mitsuba {
        mitsuba::write_scene(options, writer)?;
    }
    Ok(())
}
