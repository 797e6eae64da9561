//! Reflectance factors as the processing of the Black Lab gonioradiometer writes them: a few lines of
//! text, a line of column names, and a row for each pair of directions with a value for each
//! wavelength.
//!
//! ```text
//! BRF Values
//! Aeroglaze Z307 on aluminium
//! Measurements taken on ...
//! src_z   src_a   view_z  view_a  630.79nm        852.23nm
//!  10.000   0.000  75.000 180.000 0.033376        0.034890
//! ```
//!
//! (The numbers are made up.) `src_z`, `view_z` are zenith angles and `src_a`, `view_a` azimuths of
//! source and view in degrees; wavelengths are in nm. An azimuth is that of the direction as seen from
//! the sample: the model's phi is `view_a` - `src_a`, 0 towards the source and 180 deg on the forward
//! side. The first line names the quantity:
//!
//! | first line | values | conversion |
//! |---|---|---|
//! | `BRF Values` | reflectance factors | f_r = value / pi in 1/sr |
//! | `BRDF Values` | f_r in 1/sr | none |
//!
//! The reflectance factors are relative to a standard, by whose own factors (0/45, traceable to NIST)
//! the processing has already multiplied.
//!
//! Source: the files below `data/raw/blacklab` of github.com/ua-loft/bsdf-tools (University of
//! Arizona LOFT, commit b572b087765c) and that project's own reader, which divides by pi. The sense of
//! the azimuth follows from these files: the specular lobe of a coating is at a difference of 180 deg.

use super::angles::{AngleUnit, TwoDirections};
use super::conversion::{Kind, LeftOut, Quantity};
use super::error::ReadError;
use super::number::{Field, is_angle, micrometres};
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use super::text::{Text, first_words, words};
use crate::scan::{Convention, Format, Measurement, Measurements, Metadata};

const ANGLES: [&str; 4] = ["src_z", "src_a", "view_z", "view_a"];

pub(super) const READER: Reader = Reader {
    format: Format::BlackLab,
    // These files have no extension of their own.
    extensions: &[],
    recognises: |bytes| first_words(bytes).any(|word| word == b"src_z"),
    content: Content::Text(read),
};

/// # Errors
///
/// The text is not such a file, or has no readings above the surface, or `options` set another angular
/// convention.
pub(super) fn read(text: Text<'_>, options: &ReadOptions) -> Result<Measurements, ReadError> {
    let why = "src_a and view_a are azimuths about the normal, and a difference of 0 is the source's side";
    let convention = options.fixed_convention(text.path, Convention::default(), why)?;
    let mut lines = text.checked_lines();
    let header = Header::read(&text, &mut lines)?;
    let mut readings = Vec::new();
    let mut left = LeftOut::default();
    for line in lines {
        let (number, line) = line?;
        if line.trim_ascii().is_empty() {
            continue;
        }
        header.add_row(&text, number, line, &mut readings, &mut left)?;
    }
    if readings.is_empty() {
        let message = "no readings follow the column names";
        return Err(text.line_error(header.number, message));
    }
    let mut conversions: Vec<String> = header.quantity.conversion().into_iter().collect();
    conversions.extend(left.notes());
    Ok(Measurements {
        source: text.path.display().to_string(),
        metadata: header.metadata,
        convention,
        format: Format::BlackLab,
        conversions,
        readings,
        ..Measurements::default()
    })
}

/// The lines before the rows.
struct Header {
    /// The number of the line that names the columns.
    number: u64,
    metadata: Metadata,
    quantity: Quantity,
    /// The name and the wavelength in micrometres of each column after the angles.
    wavelengths: Vec<(String, f64)>,
}

impl Header {
    fn read<'a>(
        text: &Text<'_>,
        lines: &mut impl Iterator<Item = Result<(u64, &'a [u8]), ReadError>>,
    ) -> Result<Self, ReadError> {
        let mut before: Vec<String> = Vec::new();
        for line in lines {
            let (number, line) = line?;
            let names: Vec<&[u8]> = words(line).collect();
            if names.first().is_some_and(|name| *name == b"src_z") {
                return Ok(Self {
                    number,
                    quantity: quantity(text, number, &before)?,
                    metadata: metadata(before),
                    wavelengths: wavelengths(text, number, &names)?,
                });
            }
            before.push(String::from_utf8_lossy(line).trim().to_owned());
        }
        Err(text.error(
            "has no line of column names: expected src_z, src_a, view_z, view_a and wavelengths",
        ))
    }

    /// Adds the readings of a row, and counts those that are left out.
    fn add_row(
        &self,
        text: &Text<'_>,
        number: u64,
        line: &[u8],
        readings: &mut Vec<Measurement>,
        left: &mut LeftOut,
    ) -> Result<(), ReadError> {
        let fields: Vec<&[u8]> = words(line).collect();
        let (found, expected) = (fields.len(), ANGLES.len() + self.wavelengths.len());
        if found != expected {
            let message = format!("{found} fields: expected {expected}, one for each column");
            return Err(text.line_error(number, message));
        }
        let (angles, values) = fields.split_at(ANGLES.len());
        let mut degrees = [0.0; 4];
        for ((degrees, field), name) in degrees.iter_mut().zip(angles).zip(ANGLES) {
            let field = Field::plain(field);
            *degrees = text.number(number, name, &field, "expected degrees", is_angle)?;
        }
        let [theta_i, phi_i, theta_s, phi_s] = degrees;
        let directions = TwoDirections {
            theta_i,
            phi_i,
            theta_s,
            phi_s,
        };
        let model = directions.in_model(AngleUnit::Degrees);
        for (field, (name, wavelength_um)) in values.iter().zip(&self.wavelengths) {
            let value = text.reading(number, name, &Field::plain(field), None)?;
            let Some((psi, theta, phi)) = model else {
                left.beyond += 1;
                continue;
            };
            let Some(value) = value else {
                left.not_taken += 1;
                continue;
            };
            readings.push(Measurement {
                wavelength_um: Some(*wavelength_um),
                psi,
                theta,
                phi,
                brdf: self.quantity.to_brdf(value, theta),
                sigma: None,
            });
        }
        Ok(())
    }
}

/// The quantity that the first line names.
fn quantity(text: &Text<'_>, header: u64, before: &[String]) -> Result<Quantity, ReadError> {
    let title = before.iter().find(|line| !line.is_empty());
    let mut words = title.map_or("", String::as_str).split_whitespace();
    match words.next() {
        Some("BRF") => Ok(Quantity::of(Kind::ReflectanceFactor)),
        Some("BRDF") => Ok(Quantity::BRDF),
        _ => {
            let message = "the quantity of the values is not given before the column names: expected \
                           a first line \"BRF Values\" or \"BRDF Values\"";
            Err(text.line_error(header, message))
        }
    }
}

/// The lines before the column names: the quantity, the name of the sample, and notes.
fn metadata(before: Vec<String>) -> Metadata {
    let lines = before.into_iter().filter(|line| !line.is_empty());
    let keys = ["values", "sample"]
        .into_iter()
        .chain(std::iter::repeat("note"));
    Metadata(
        keys.zip(lines)
            .map(|(key, line)| (key.to_owned(), line))
            .collect(),
    )
}

fn wavelengths(
    text: &Text<'_>,
    number: u64,
    names: &[&[u8]],
) -> Result<Vec<(String, f64)>, ReadError> {
    let (angles, labels) = names.split_at(ANGLES.len().min(names.len()));
    let as_named = |(name, expected): (&&[u8], &str)| *name == expected.as_bytes();
    if !angles.iter().zip(ANGLES).all(as_named) || labels.is_empty() {
        let message = "expected the columns src_z, src_a, view_z, view_a and at least one \
                       wavelength such as 630.79nm";
        return Err(text.line_error(number, message));
    }
    let wavelength = |label: &&[u8]| {
        let name = String::from_utf8_lossy(label).into_owned();
        let wavelength_um = micrometres(label.strip_suffix(b"nm").unwrap_or(label));
        let found = wavelength_um.map(|um| (name, um));
        found.ok_or_else(|| {
            let message = "is not a wavelength: expected one such as 630.79nm";
            text.value_error(number, "wavelength", label, message)
        })
    };
    labels.iter().map(wavelength).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;
    use std::path::Path;

    use super::*;
    use crate::scan::Side;

    const TWO: &str = "BRF Values\nTest paint\nMeasurements taken on a day\n\
        src_z\tsrc_a\tview_z\tview_a\t630.79nm\t852.23nm\n\
        \x20 0.000\t  0.000\t 45.000\t  0.000\t0.10\t0.20\n\
        \x2010.000\t  0.000\t 75.000\t180.000\t0.30\t0.40\n";

    fn read_with(content: &str, options: &ReadOptions) -> Result<Measurements, ReadError> {
        read(Text::new(Path::new("a.txt"), content.as_bytes())?, options)
    }

    fn error(content: &str) -> String {
        let read = read_with(content, &ReadOptions::default());
        read.unwrap_err().to_string()
    }

    #[test]
    fn reflectance_factors_are_divided_by_pi_at_each_wavelength() {
        let scan = read_with(TWO, &ReadOptions::default()).unwrap();
        let readings = scan.readings();
        assert_eq!(readings.len(), 4);
        assert_eq!(readings[0].wavelength_um, Some(0.630_79));
        assert_eq!(readings[3].wavelength_um, Some(0.852_23));
        assert_eq!(readings[3].brdf, 0.4 / PI);
        assert_eq!(scan.metadata.get("sample"), Some("Test paint"));
        assert!(scan.conversions[0].contains("divided by pi"), "{scan:?}");
    }

    #[test]
    fn opposite_azimuths_are_the_forward_side() {
        let scan = read_with(TWO, &ReadOptions::default()).unwrap();
        let reading = scan.readings()[2];
        assert_eq!(reading.psi, 10_f64.to_radians());
        assert_eq!(reading.in_plane_theta(), Some(-75_f64.to_radians()));
    }

    #[test]
    fn readings_that_were_not_taken_or_lie_beyond_the_horizon_are_counted() {
        let more = format!("{TWO}20 0 90 180 1 1\n95 0 20 180 1 1\n5 0 6 0 nan 0.1\n");
        let scan = read_with(&more, &ReadOptions::default()).unwrap();
        assert_eq!(scan.readings().len(), 5);
        assert!(
            scan.conversions[1].starts_with("1 reading not taken"),
            "{scan:?}"
        );
        assert!(scan.conversions[2].starts_with("4 readings at or beyond 90 deg"));
    }

    #[test]
    fn errors_name_line_column_and_value() {
        let row = |row: &str| error(&format!("{TWO}{row}\n"));
        assert_eq!(
            row("1 2 3 4 5"),
            "a.txt, line 7: 5 fields: expected 6, one for each column"
        );
        assert!(row("1 2 x 4 5 6").contains("line 7, column view_z: \"x\" is not a number"));
        assert!(row("1 2 3 4 5 inf").contains("column 852.23nm: \"inf\" is not a finite number"));
        let sentinel = row("1 2 3 4 5 -999");
        assert!(
            sentinel.contains("\"-999\" looks like a reading that was not taken"),
            "{sentinel}"
        );
        assert!(error("BRF Values\nsrc_z src_a\n").contains("line 2: expected the columns"));
        assert!(error("src_z src_a view_z view_a 5nm\n").contains("\"BRF Values\""));
        assert!(error("BRF\nsrc_z src_a view_z view_a x\n").contains("such as 630.79nm"));
        assert!(error("BRF\nsrc_z src_a view_z view_a 5nm\n").contains("no readings"));
        assert!(error("BRF\n").contains("no line of column names"));
    }

    #[test]
    fn the_angular_convention_cannot_be_chosen() {
        let forward = ReadOptions {
            phi_zero: Some(Side::Forward),
            ..ReadOptions::default()
        };
        let error = read_with(TWO, &forward).unwrap_err().to_string();
        assert!(
            error.contains("the angular convention cannot be chosen"),
            "{error}"
        );
        let source = ReadOptions {
            phi_zero: Some(Side::Source),
            ..ReadOptions::default()
        };
        assert!(read_with(TWO, &source).is_ok());
    }
}
