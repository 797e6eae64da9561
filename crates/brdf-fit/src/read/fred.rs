//! Tabulated BSDF of FRED: two lines of keywords, then for each specular direction a line of two angles
//! and a line with angles and a value for each scatter direction.
//!
//! ```text
//! type bsdf_data
//! format angles=deg bsdf=value scale=1
//! 10   0
//! 0    0    0.0312
//! 20   0    0.0398
//! 20   180  0.0291
//! 30   0
//! ...
//! ```
//!
//! (The numbers are made up.) A line of two numbers is the specular direction, polar angle and azimuth, of
//! the readings that follow it; a line of three is polar angle and azimuth of a scatter direction and the
//! BSDF in 1/sr. Both directions are in the same spherical coordinates about the normal, so that a scatter
//! direction with the angles of the specular direction **is** the specular direction: azimuths that are equal
//! are the forward side, and the source is at the opposite azimuth of the specular direction. A negative
//! polar angle is a positive one at the opposite azimuth, as in a scan in the plane of incidence. The format
//! fixes the angular convention.
//!
//! The format has no place for a wavelength. As in [`zemax`](super::zemax), a comment `# wavelength_um: 0.63`
//! gives it, and a comment `# refractive_index: 1.5` the index.
//!
//! Values other than `angles=deg` or `rad`, `bsdf=value` and `scale=1` are errors, because no public document
//! says what they mean. Readings at or beyond the horizon are left out and counted.
//!
//! Sources: "Tabulated BSDF" and "SetTabulatedScatter" of the FRED help (help.photonengr.com, Photon
//! Engineering), by which the angles are "elevation and azimuth of the specular direction" and "of the
//! scatter direction"; the files below `data/processed/fred` of github.com/ua-loft/bsdf-tools and the program
//! there that writes them. The Zemax file of a sample there, on another grid, has the same lobes in these
//! directions.

use super::angles::{AngleUnit, TwoDirections};
use super::comments::{comment_of, key_and_value, number_of_key};
use super::conversion::{BEYOND_HORIZON, left_out};
use super::error::ReadError;
use super::number::{Field, is_angle, is_reading, is_wavelength, parse_number};
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use super::text::{Text, head_lines, quotable, words};
use crate::scan::{Convention, Format, Measurement, Measurements, Metadata};

pub(super) const READER: Reader = Reader {
    format: Format::Fred,
    // These files are called .txt.
    extensions: &[],
    recognises: |bytes| head_lines(bytes).find(is_not_comment).is_some_and(is_type),
    content: Content::Text(read),
};

/// Whether a line is neither blank nor a comment.
fn is_not_comment(line: &&[u8]) -> bool {
    comment_of(line).is_none() && !line.trim_ascii().is_empty()
}

fn is_type(line: &[u8]) -> bool {
    let mut words = words(line);
    let mut is = |expected: &str| {
        words
            .next()
            .is_some_and(|word| word.eq_ignore_ascii_case(expected.as_bytes()))
    };
    is("type") && is("bsdf_data")
}

/// # Errors
///
/// The text is not such a file, or has no readings above the surface, or `options` set another angular
/// convention.
pub(super) fn read(text: Text<'_>, options: &ReadOptions) -> Result<Measurements, ReadError> {
    let why = "azimuths are those of the specular and of the scatter direction, and equal ones are the forward side";
    let convention = options.fixed_convention(text.path, Convention::default(), why)?;
    let mut metadata = Metadata::default();
    let mut lines = Vec::new();
    for line in text.checked_lines() {
        let (number, line) = line?;
        match comment_of(line) {
            Some(comment) => metadata
                .0
                .extend(key_and_value(&String::from_utf8_lossy(comment))),
            None if line.trim_ascii().is_empty() => {}
            None => lines.push((number, line)),
        }
    }
    let mut lines = lines.into_iter();
    check_type(&text, lines.next())?;
    let expected = "expected micrometres above 0";
    let wavelength_um = number_of_key(&text, &metadata, "wavelength_um", expected, is_wavelength)?;
    let mut table = Table {
        unit: angle_unit(&text, lines.next())?,
        wavelength_um,
        specular: None,
        readings: Vec::new(),
        beyond: 0,
    };
    for (number, line) in lines {
        table.add_line(&text, number, line)?;
    }
    if table.readings.is_empty() {
        return Err(text.error("has no reading above the surface"));
    }
    let index = metadata.get("refractive_index").map(str::parse).transpose();
    let index = index.map_err(|error| text.error(format!("refractive_index: {error}")))?;
    let angles = "azimuths of the scatter directions are counted from the specular direction, on the forward side";
    let mut conversions = vec![angles.to_owned()];
    conversions.extend(left_out(table.beyond, BEYOND_HORIZON));
    Ok(Measurements {
        source: text.path.display().to_string(),
        refractive_index: index,
        metadata,
        convention,
        format: Format::Fred,
        conversions,
        readings: table.readings,
        ..Measurements::default()
    })
}

fn check_type(text: &Text<'_>, line: Option<(u64, &[u8])>) -> Result<(), ReadError> {
    match line {
        Some((_, line)) if is_type(line) => Ok(()),
        Some((number, _)) => Err(text.line_error(number, "expected \"type bsdf_data\"")),
        None => Err(text.error("ends too early: expected \"type bsdf_data\"")),
    }
}

/// The unit of the angles that the line `format` states.
///
/// # Errors
///
/// The line is another, or states a form of the values that is not known.
fn angle_unit(text: &Text<'_>, line: Option<(u64, &[u8])>) -> Result<AngleUnit, ReadError> {
    const EXPECTED: &str = "expected \"format angles=deg bsdf=value scale=1\"";
    let Some((number, line)) = line else {
        return Err(text.error(format!("ends too early: {EXPECTED}")));
    };
    let mut words = words(line);
    let is_format = |word: &[u8]| word.eq_ignore_ascii_case(b"format");
    if !words.next().is_some_and(is_format) {
        return Err(text.line_error(number, EXPECTED));
    }
    let mut unit = None;
    for word in words {
        let lower = String::from_utf8_lossy(word).to_lowercase();
        match lower.split_once('=') {
            Some(("angles", "deg" | "degrees")) => unit = Some(AngleUnit::Degrees),
            Some(("angles", "rad" | "radians")) => unit = Some(AngleUnit::Radians),
            Some(("bsdf", "value")) => {}
            Some(("scale", scale)) if parse_number(scale.as_bytes(), false) == Some(1.0) => {}
            _ => {
                let word = quotable(word);
                let message = format!(
                    "\"{word}\" cannot be read, because its meaning is not known: {EXPECTED}"
                );
                return Err(text.line_error(number, message));
            }
        }
    }
    unit.ok_or_else(|| {
        text.line_error(
            number,
            format!("the unit of the angles is missing: {EXPECTED}"),
        )
    })
}

/// The readings of the lines so far.
struct Table {
    unit: AngleUnit,
    wavelength_um: Option<f64>,
    /// Polar angle and azimuth of the specular direction.
    specular: Option<(f64, f64)>,
    readings: Vec<Measurement>,
    beyond: usize,
}

impl Table {
    fn add_line(&mut self, text: &Text<'_>, number: u64, line: &[u8]) -> Result<(), ReadError> {
        let expected = match self.unit {
            AngleUnit::Degrees => "expected degrees",
            AngleUnit::Radians => "expected radians",
        };
        let angle = |column: &str, word: &[u8]| {
            text.number(number, column, &Field::plain(word), expected, is_angle)
        };
        let words: Vec<&[u8]> = words(line).collect();
        match (words.as_slice(), self.specular) {
            ([theta, phi], _) => {
                self.specular =
                    Some((angle("specular theta", theta)?, angle("specular phi", phi)?));
                Ok(())
            }
            ([theta, phi, value], Some((theta_i, specular_phi))) => {
                let directions = TwoDirections {
                    theta_i,
                    // The source is opposite to the specular direction.
                    phi_i: specular_phi + self.unit.half_turn(),
                    theta_s: angle("theta", theta)?,
                    phi_s: angle("phi", phi)?,
                };
                let value = Field::plain(value);
                let brdf = text.number(
                    number,
                    "bsdf",
                    &value,
                    "expected a value in 1/sr",
                    is_reading,
                )?;
                self.add(directions, brdf);
                Ok(())
            }
            ([_, _, _], None) => {
                let message =
                    "no specular direction before the reading: expected a line of two angles";
                Err(text.line_error(number, message))
            }
            (words, _) => {
                let message = format!(
                    "{} numbers: expected 2 for a specular direction or 3 for a reading",
                    words.len()
                );
                Err(text.line_error(number, message))
            }
        }
    }

    fn add(&mut self, directions: TwoDirections, brdf: f64) {
        let Some((psi, theta, phi)) = directions.in_model(self.unit) else {
            self.beyond += 1;
            return;
        };
        self.readings.push(Measurement {
            wavelength_um: self.wavelength_um,
            psi,
            theta,
            phi,
            brdf,
            sigma: None,
        });
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use proptest::prelude::*;

    use super::*;
    use crate::scan::Side;

    const TWO: &str = "# sample: Test paint\n# wavelength_um: 0.65\ntype bsdf_data\n\
        format angles=deg bsdf=value scale=1\n10\t0\n0\t0\t0.10\n20\t0\t0.11\n20\t180\t0.12\n90\t0\t0.5\n\
        30 90\n30 90 0.2\n-40 90 0.3\n";

    fn read_with(content: &str, options: &ReadOptions) -> Result<Measurements, ReadError> {
        read(Text::new(Path::new("a.txt"), content.as_bytes())?, options)
    }

    fn error(content: &str) -> String {
        let read = read_with(content, &ReadOptions::default());
        read.unwrap_err().to_string()
    }

    #[test]
    fn azimuths_are_counted_from_the_specular_direction() {
        let scan = read_with(TWO, &ReadOptions::default()).unwrap();
        let readings = scan.readings().iter();
        let found: Vec<_> = readings
            .map(|r| {
                let in_plane = r.in_plane_theta().unwrap().to_degrees().round();
                (r.psi.to_degrees().round(), in_plane, r.brdf)
            })
            .collect();
        // In the plane of incidence, the source's side is positive.
        let expected = [
            (10.0, 0.0, 0.10),
            (10.0, -20.0, 0.11),
            (10.0, 20.0, 0.12),
            (30.0, -30.0, 0.2),
            (30.0, 40.0, 0.3),
        ];
        assert_eq!(found, expected);
        assert_eq!(scan.wavelengths(), [Some(0.65)]);
        assert_eq!(scan.metadata.get("sample"), Some("Test paint"));
        assert_eq!(scan.format, Format::Fred);
        assert_eq!(
            scan.conversions[1],
            "1 reading at or beyond 90 deg from the normal is left out"
        );
    }

    #[test]
    fn angles_may_be_in_radians() {
        let text =
            "type bsdf_data\nformat bsdf=value scale=1.0 angles=rad\n0.5 0\n0.5 0 0.2\n1.6 0 1\n";
        let scan = read_with(text, &ReadOptions::default()).unwrap();
        assert_eq!(scan.readings().len(), 1);
        assert_eq!(scan.readings()[0].psi, 0.5);
        assert_eq!(scan.readings()[0].in_plane_theta(), Some(-0.5));
    }

    #[test]
    fn errors_name_line_and_value() {
        let with = |from: &str, to: &str| error(&TWO.replacen(from, to, 1));
        assert_eq!(
            with("scale=1", "scale=2"),
            "a.txt, line 4: \"scale=2\" cannot be read, because its meaning is not known: expected \
             \"format angles=deg bsdf=value scale=1\""
        );
        assert!(with("bsdf=value", "bsdf=log").contains("line 4: \"bsdf=log\" cannot be read"));
        assert!(with("angles=deg", "").contains("line 4: the unit of the angles is missing"));
        assert!(with("format", "forma").contains("line 4: expected \"format angles=deg"));
        assert!(with("type", "kind").contains("line 3: expected \"type bsdf_data\""));
        assert!(with("10\t0\n", "").contains("line 5: no specular direction before the reading"));
        assert!(with("0.11", "x").contains("line 7, column bsdf: \"x\" is not a number"));
        assert!(
            with("0.11", "nan").contains("line 7, column bsdf: \"nan\" is not a finite number")
        );
        assert!(
            with("20\t0", "y\t0")
                .contains("line 7, column theta: \"y\" is not a number: expected degrees")
        );
        assert!(with("0.11", "0.11 5").contains("line 7: 4 numbers: expected 2"));
        assert!(
            with("wavelength_um: 0.65", "wavelength_um: red").contains("wavelength_um: \"red\"")
        );
        assert!(error("type bsdf_data\n").contains("ends too early: expected \"format"));
        let none = "type bsdf_data\nformat angles=deg\n10 0\n95 0 1\n";
        assert!(error(none).contains("has no reading above the surface"));
    }

    #[test]
    fn the_format_is_known_by_its_first_line() {
        assert!((READER.recognises)(TWO.as_bytes()));
        assert!((READER.recognises)(b"\n Type  BSDF_Data\n"));
        assert!(!(READER.recognises)(b"psi_deg\ntype bsdf_data\n"));
        assert!(!(READER.recognises)(b"type bsdf\n"));
    }

    #[test]
    fn the_angular_convention_cannot_be_chosen() {
        let options = ReadOptions {
            phi_zero: Some(Side::Forward),
            ..ReadOptions::default()
        };
        let error = read_with(TWO, &options).unwrap_err().to_string();
        assert!(
            error.contains("the angular convention cannot be chosen"),
            "{error}"
        );
    }

    proptest! {
        #[test]
        fn any_lines_are_read_or_refused(lines in "([0-9.e \t\n-]|nan|inf|#){0,200}") {
            let text = format!("type bsdf_data\nformat angles=deg bsdf=value scale=1\n10 0\n{lines}");
            if let Ok(scan) = read_with(&text, &ReadOptions::default()) {
                for reading in scan.readings() {
                    reading.validated().unwrap();
                }
            }
        }

        #[test]
        fn the_specular_direction_is_the_mirror_direction(
            theta in 1.0..89.0_f64,
            phi in -360.0..360.0_f64,
        ) {
            let text = format!(
                "type bsdf_data\nformat angles=deg bsdf=value scale=1\n{theta} {phi}\n{theta} {phi} 1\n"
            );
            let scan = read_with(&text, &ReadOptions::default()).unwrap();
            let reading = scan.readings()[0];
            prop_assert!((reading.in_plane_theta().unwrap() + reading.psi).abs() < 1e-12);
        }
    }
}
