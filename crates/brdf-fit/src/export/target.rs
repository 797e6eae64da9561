//! The forms in which a coating leaves.

use std::io::{self, Write};
use std::str::FromStr;

use super::coating::{Coating, CoatingError};
use super::mitsuba;
use super::source::{Language, NameError, Source};

/// A form in which a coating leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// The model as versioned JSON: what [`Coating::read`] reads.
    Json,
    /// Mitsuba 3: a BSDF plugin in Python, and a scene beside it.
    Mitsuba,
    /// Source code.
    Source(Language),
}

impl Target {
    /// All forms, with the names that options give them.
    pub const NAMED: [(Self, &str); 7] = [
        (Self::Json, "json"),
        (Self::Source(Language::C), "c"),
        (Self::Source(Language::Glsl), "glsl"),
        (Self::Source(Language::Wgsl), "wgsl"),
        (Self::Source(Language::Osl), "osl"),
        (Self::Source(Language::Python), "python"),
        (Self::Mitsuba, "mitsuba"),
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

/// What a form may be told.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportOptions {
    /// The first word of the names in source code, and the type of the material in Mitsuba.
    pub name: String,
    /// The largest error of a table: of f_r interpolated between its entries, relative.
    pub tolerance: f64,
    /// The wavelengths in micrometres that stand for red, green and blue; see [`Coating::rgb`].
    pub rgb: Option<[f64; 3]>,
}

/// Why a coating does not leave.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The form has no room for it.
    #[error(transparent)]
    Coating(#[from] CoatingError),
    /// The name is none in source code.
    #[error(transparent)]
    Name(#[from] NameError),
    /// It cannot be written.
    #[error(transparent)]
    Io(#[from] io::Error),
}

/// Writes a coating in a form.
pub fn export(
    coating: &Coating,
    target: Target,
    options: &ExportOptions,
    writer: &mut dyn Write,
) -> Result<(), ExportError> {
    match target {
        Target::Json => coating.write(writer)?,
        Target::Mitsuba => mitsuba::write_plugin(coating, options, writer)?,
        Target::Source(language) => {
            let source = Source::new(&options.name, coating.only()?)?;
            writer.write_all(source.text(language).as_bytes())?;
        }
    }
    Ok(())
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
