//! The lines before the tables.

use super::lines::Lines;
use super::{ANISOTROPIC, SPECTRAL};
use crate::read::error::ReadError;
use crate::read::number::{is_angle, micrometres};
use crate::read::text::quotable;
use crate::scan::Metadata;

/// The wavelengths of the tables.
pub(super) enum Spectrum {
    /// Each incidence has a table for each of these wavelengths in micrometres.
    OfTables(Vec<f64>),
    /// One distribution is scaled by a spectrum.
    OfAll(Reflectances),
}

/// The spectrum that scales the distribution of an `.anisotropicbsdf`.
#[derive(Default)]
pub(super) struct Reflectances {
    /// The incidence angle at which it was measured, in degrees.
    pub(super) psi_deg: f64,
    /// Wavelengths in micrometres with reflectances, 1 being all light.
    pub(super) at: Vec<(f64, f64)>,
}

/// What the lines before the tables state.
pub(super) struct Header {
    pub(super) metadata: Metadata,
    pub(super) has_transmission: bool,
    /// Whether the values are proportional to f_r cos theta instead of f_r.
    pub(super) is_intensity: bool,
    /// For each anisotropy angle in degrees the incidence angles in degrees; a `.brdf` has one, 0.
    pub(super) incidences: Vec<(f64, Vec<f64>)>,
    pub(super) spectrum: Spectrum,
}

impl Header {
    /// # Errors
    ///
    /// A line is not as expected, the version is too old, or there is no reflection.
    pub(super) fn read(lines: &mut Lines<'_>) -> Result<Self, ReadError> {
        let is_anisotropic = check_first_line(lines)?;
        if lines.flags(1, "0 for text or 1 for binary mode")? == [true] {
            let message = "1: the file is in binary mode, which cannot be read: expected 0, the text \
                           mode (save it as text in the BSDF viewer)";
            return Err(lines.error(message));
        }
        let metadata = metadata(lines)?;
        if is_anisotropic {
            lines.numbers(3, "the three numbers of the anisotropy vector", is_angle)?;
        }
        let parts = lines.flags(2, "whether there is reflection and transmission")?;
        if parts.first() != Some(&true) {
            let message = "the file has no reflection: its transmission cannot be read because the \
                           model describes reflection, expected 1 first";
            return Err(lines.error(message));
        }
        let has_transmission = parts.get(1) == Some(&true);
        let kind = "1 for values proportional to the BSDF or 0 for intensities";
        let is_intensity = lines.flags(1, kind)? == [false];
        let (incidences, spectrum) = if is_anisotropic {
            anisotropic(lines, has_transmission)?
        } else {
            spectral(lines)?
        };
        Ok(Self {
            metadata,
            has_transmission,
            is_intensity,
            incidences,
            spectrum,
        })
    }
}

/// Whether the file is an `.anisotropicbsdf`.
///
/// # Errors
///
/// The first line is that of neither kind, or the version is too old.
fn check_first_line(lines: &mut Lines<'_>) -> Result<bool, ReadError> {
    let line = lines.any("a first line \"OPTIS - ...\"")?;
    let line = String::from_utf8_lossy(line.trim_ascii()).into_owned();
    let after = |start: &str| {
        let head = line.get(..start.len())?;
        let is_kind = head.eq_ignore_ascii_case(start);
        is_kind.then(|| line.get(start.len()..).unwrap_or_default().trim())
    };
    let (is_anisotropic, version) = match (after(SPECTRAL), after(ANISOTROPIC)) {
        (Some(version), _) => (false, version),
        (None, Some(version)) => (true, version),
        (None, None) => {
            let message = format!("expected \"{SPECTRAL} v8.0\" or \"{ANISOTROPIC} v8.0\"");
            return Err(lines.error(message));
        }
    };
    let oldest = if is_anisotropic { 7.0 } else { 8.0 };
    let number = version.strip_prefix(['v', 'V']).map(str::parse::<f64>);
    match number {
        Some(Ok(number)) if number >= oldest => Ok(is_anisotropic),
        _ => {
            let message = format!(
                "version \"{}\" of the format cannot be read: expected v{oldest} or later (open and \
                 save the file in the BSDF viewer)",
                quotable(version.as_bytes())
            );
            Err(lines.error(message))
        }
    }
}

/// The comment, and the description with the stated length.
fn metadata(lines: &mut Lines<'_>) -> Result<Metadata, ReadError> {
    let mut metadata = Metadata::default();
    let mut add = |key: &str, value: &str| {
        if !value.trim().is_empty() {
            let value = value.trim().to_owned();
            metadata.0.push((key.to_owned(), value));
        }
    };
    let comment = lines.any("a comment")?;
    add("comment", &String::from_utf8_lossy(comment));
    let what = "the length of the description";
    let length = lines.numbers(1, what, |length| length >= 0.0)?;
    let length = length.first().copied().unwrap_or(0.0);
    let (mut description, mut characters) = (String::new(), 0);
    loop {
        let line = String::from_utf8_lossy(lines.any("the description")?);
        characters += line.chars().count();
        description.push_str(&line);
        if characters as f64 >= length {
            break;
        }
        // A line end is a character of the description.
        characters += 1;
        description.push(' ');
    }
    add("sample", &description);
    Ok(metadata)
}

type Parts = (Vec<(f64, Vec<f64>)>, Spectrum);

fn spectral(lines: &mut Lines<'_>) -> Result<Parts, ReadError> {
    let what = "the numbers of incidence angles and of wavelengths";
    let (incidences, wavelengths) = lines.two_counts(what)?;
    let incidences = lines.numbers(incidences, "incidence angles in degrees", is_incidence)?;
    let found = lines.counted_words(wavelengths, "wavelengths in nm")?;
    let wavelength = |word: &&[u8]| wavelength(lines, word);
    let wavelengths = found.iter().map(wavelength).collect::<Result<_, _>>()?;
    Ok((vec![(0.0, incidences)], Spectrum::OfTables(wavelengths)))
}

fn anisotropic(lines: &mut Lines<'_>, has_transmission: bool) -> Result<Parts, ReadError> {
    let incidences = incidences(lines)?;
    if has_transmission {
        self::incidences(lines)?;
    }
    let spectrum = reflectances(lines)?;
    if has_transmission {
        reflectances(lines)?;
    }
    Ok((incidences, Spectrum::OfAll(spectrum)))
}

/// The anisotropy angles, each with its incidence angles.
fn incidences(lines: &mut Lines<'_>) -> Result<Vec<(f64, Vec<f64>)>, ReadError> {
    let count = lines.count("the number of anisotropy angles")?;
    let angles = lines.numbers(count, "anisotropy angles in degrees", is_angle)?;
    let of_angle = |angle| {
        let count = lines.count("the number of incidence angles")?;
        let incidences = lines.numbers(count, "incidence angles in degrees", is_incidence)?;
        Ok((angle, incidences))
    };
    angles.into_iter().map(of_angle).collect()
}

fn reflectances(lines: &mut Lines<'_>) -> Result<Reflectances, ReadError> {
    let what = "theta and phi of the measurement of the spectrum";
    let direction = lines.numbers(2, what, is_angle)?;
    lines.any("a description of the spectrum")?;
    let count = lines.count("the number of wavelengths of the spectrum")?;
    let mut at = Vec::new();
    for _ in 0..count {
        let found = lines.counted_words(2, "a wavelength in nm and a reflectance in percent")?;
        if let [nanometres, percent] = found.as_slice() {
            let percent = lines.number_in(percent, "a reflectance in percent", is_percent)?;
            at.push((wavelength(lines, nanometres)?, percent / 100.0));
        }
    }
    Ok(Reflectances {
        psi_deg: direction.first().copied().unwrap_or(0.0),
        at,
    })
}

fn wavelength(lines: &Lines<'_>, word: &[u8]) -> Result<f64, ReadError> {
    micrometres(word).ok_or_else(|| {
        let message = format!("\"{}\": expected a wavelength in nm", quotable(word));
        lines.error(message)
    })
}

fn is_incidence(degrees: f64) -> bool {
    (0.0..=90.0).contains(&degrees)
}

/// Whether a number can be a reflectance in percent; those of noisy measurements may exceed 100.
pub(super) fn is_percent(value: f64) -> bool {
    (0.0..=1e6).contains(&value)
}
