//! Ansys Speos (formerly OPTIS) tables of a surface: `.brdf`, with a distribution for each wavelength,
//! and `.anisotropicbsdf`, with one distribution that a spectrum scales. Both are read in their text
//! mode.
//!
//! ```text
//! OPTIS - brdf surface file v8.0
//! 0                                  0 text, 1 binary
//! a comment
//! 10                                 length of the description, which may have several lines
//! Test paint
//! 1  0                               is there reflection, is there transmission
//! 1                                  1 proportional to the BSDF, 0 to the intensity
//! 2  1                               numbers of incidence angles and of wavelengths
//! 10  30                             incidence angles
//! 550                                wavelengths in nm
//! 31.5                               reflectance in percent at 10 deg and 550 nm
//! 3  5                               numbers of theta and phi
//!     0     90    180   270   360    phi
//! 0   0.10  0.10  0.10  0.10  0.10   theta, and a value for each phi
//! 45  0.12  0.10  0.09  0.10  0.12
//! 90  0     0     0     0     0
//! 31.9                               the same at 30 deg, ...
//! ```
//!
//! (The numbers are made up.) Tables follow each other for all wavelengths of an incidence, then for the
//! next incidence. In an `.anisotropicbsdf`, the lines from the sixth on are the anisotropy vector;
//! reflection and transmission; the kind of values; the number of anisotropy angles and the angles; for
//! each of these the number of incidence angles and the angles; the direction (theta, phi) at which the
//! spectrum was measured; a description of the spectrum; the number of wavelengths, and for each a line
//! with the wavelength in nm and the reflectance in percent. Then the tables follow, without
//! reflectances.
//!
//! # Conventions
//!
//! Angles are in degrees and spherical coordinates about the normal. phi = 0 is the forward side: the
//! specular direction is (theta, phi) = (incidence, 0). The model's phi is phi + 180 deg.
//!
//! The values are only proportional to f_r, or with 0 in the line of the kind to f_r cos theta, and the
//! program normalises them:
//!
//! ```text
//! f_r = v R / I,   I = integral of v cos theta over the hemisphere
//! ```
//!
//! with v the value, or value / cos theta, and R the reflectance. In a `.brdf` each table has its own R
//! and I. In an `.anisotropicbsdf` the R of the spectrum and the I of the table at the incidence of the
//! spectrum apply to all tables, so that the ratios between incidences are kept; between two incidences,
//! 1 / I is interpolated linearly, and outside of them that of the nearest one is taken. I is computed
//! here from values that are linear between the angles of the table. Tables in which phi covers 180 deg
//! are taken to be symmetrical about the plane of incidence.
//!
//! # What is left out, and what is an error
//!
//! Left out and counted are: directions at or beyond 90 deg from the normal; values of exactly 0, as
//! tables cover the hemisphere and have no other mark for a direction that was not measured; equal
//! values at theta = 0 and at azimuths of 0 and 360 deg, which are one direction; tables of
//! transmission. Errors are: transmission only; an `.anisotropicbsdf` whose tables differ between
//! anisotropy angles, since the model is isotropic; files before version 7 (`.brdf`: 8), whose tables do
//! not state their sizes.
//!
//! Sources: "Structure of BRDF files", "Structure of Anisotropic BSDF Files" and "Anisotropic BSDF
//! Surface Overview" of the Ansys Speos Labs guide (2024 R2); the class `BsdfStructure` of
//! github.com/ansys/optical-automation, which reads both kinds, and
//! `tests/workflows/example_models/test_13_brdf_one_wavelength_speos.brdf` there, whose values integrate
//! to another reflectance than it states.

mod header;
mod lines;
mod readings;
mod table;

use super::error::ReadError;
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use super::text::{Text, head_lines};
use crate::scan::{Convention, Format, Measurements, Side};
use header::{Header, Spectrum};
use lines::Lines;
use readings::Readings;

pub(super) const READER: Reader = Reader {
    format: Format::Speos,
    extensions: &["brdf", "anisotropicbsdf"],
    recognises: is_text_mode,
    content: Content::Text(read),
};

/// What the first line of a `.brdf` begins with.
const SPECTRAL: &str = "OPTIS - brdf surface file";
/// What the first line of an `.anisotropicbsdf` begins with.
const ANISOTROPIC: &str = "OPTIS - Anisotropic BSDF surface file";

/// Whether a file has the first line of one of the two kinds, and is not in binary mode.
fn is_text_mode(bytes: &[u8]) -> bool {
    let mut lines = head_lines(bytes);
    let first = lines.next().unwrap_or_default();
    let is_binary = lines.next().is_some_and(|line| line.trim_ascii() == b"1");
    let begins = |start: &str| {
        let head = first.get(..start.len());
        head.is_some_and(|head| head.eq_ignore_ascii_case(start.as_bytes()))
    };
    (begins(SPECTRAL) || begins(ANISOTROPIC)) && !is_binary
}

/// # Errors
///
/// The text is not such a file, has no reflection, is anisotropic, or `options` set another angular
/// convention.
pub(super) fn read(text: Text<'_>, options: &ReadOptions) -> Result<Measurements, ReadError> {
    let of_format = Convention {
        phi_zero: Side::Forward,
        ..Convention::default()
    };
    let why = "in Speos, theta is counted from the normal and phi = 0 is the forward side";
    let convention = options.fixed_convention(text.path, of_format, why)?;
    let mut lines = Lines::new(text);
    let header = Header::read(&mut lines)?;
    let mut readings = Readings::default();
    match &header.spectrum {
        Spectrum::OfTables(wavelengths) => {
            readings.add_spectral(&mut lines, &header, wavelengths)?;
        }
        Spectrum::OfAll(spectrum) => readings.add_anisotropic(&mut lines, &header, spectrum)?,
    }
    if readings.kept.is_empty() {
        return Err(text.error("has no reading above the surface"));
    }
    Ok(Measurements {
        source: text.path.display().to_string(),
        conversions: readings.conversions(&header),
        metadata: header.metadata,
        convention,
        format: Format::Speos,
        readings: readings.kept,
        ..Measurements::default()
    })
}

#[cfg(test)]
mod tests;
