//! Zemax tabular BSDF (`.bsdf`), also called the BSDF data interchange format: a header of
//! keywords, the four lists of angles, and the BRDF in 1/sr for all their combinations.
//!
//! ```text
//! # words
//! Source  Measured
//! Symmetry  PlaneSymmetrical
//! SpectralContent  Monochrome
//! ScatterType  BRDF
//! SampleRotation  1
//! 0
//! AngleOfIncidence  2
//! 10  30
//! ScatterAzimuth  3
//! 0  90  180
//! ScatterRadial  2
//! 0  20
//!
//! Monochrome
//! DataBegin
//! TIS  0.12
//! 0.10  0.09
//! ...
//! DataEnd
//! ```
//!
//! (Numbers made up.) All angles are in degrees. For each sample rotation and in it for each angle
//! of incidence there is a line `TIS`, the total integrated scatter, and then a line for each
//! azimuth with a value for each radial angle. Azimuth and radial angle are those of a spherical
//! system about the **specular** ray: radial 0 is the specular direction, azimuth 0 points from it
//! towards the surface normal, azimuths increase counter-clockwise. In a plane-symmetrical file
//! they end at 180 deg and stand for both sides; the model has that symmetry, so each is read once.
//! The format fixes the sides.
//!
//! What is not a BRDF of an isotropic surface:
//! - `BTDF` is an error.
//! - Of `XYZ` the section `TristimulusY` is read: Y is weighted by the luminous efficiency, so it
//!   is the BRDF for light as the eye weighs it; X and Z are no BRDF of anything.
//! - Rotations of the sample are read as readings of one isotropic sample, and said.
//! - The grid holds directions below the surface: they are left out and counted. So are values of
//!   exactly 0: the format has no other mark for what was not measured, and files use it so.
//! - Radial angle 0 is one direction at all azimuths, and azimuth 0 is that of 360 deg: equal
//!   values there are one reading.
//!
//! The format has no place for a wavelength; a comment `# wavelength_um: 0.63` gives it here, and
//! `# refractive_index: 1.5` that index.
//!
//! Sources: "Zemax Tabular BSDF data file format" of the Zemax knowledge base (article
//! 1500005486801; before, "BSDF Data Interchange File Format Specification" of Radiant Imaging);
//! libbsdf's `ZemaxBsdfReader`, which goes the same way about the keywords and azimuth 0; and the
//! files below `data/processed/zemax` of github.com/ua-loft/bsdf-tools, where for an incidence of
//! 70 deg the values at azimuth 0 reach to radial 140 deg and those at 180 to 10 deg.

use super::text::{BEYOND_HORIZON, Field, Text, comment_of, left_out, words};
use super::{ReadError, ReadOptions};
use crate::scan::RefractiveIndex;
use crate::scan::{Convention, Format};
use crate::scan::{Measurement, Measurements, Metadata};

pub(super) fn read(text: Text<'_>, options: &ReadOptions) -> Result<Measurements, ReadError> {
    let why = "the format counts from the specular ray, and azimuth 0 points to the normal";
    let convention = options.fixed(text.path, Convention::default(), why)?;
    let mut tokens = Tokens::new(text)?;
    let header = Header::read(&mut tokens)?;
    let blocks = header.read_sections(&mut tokens)?;
    let expected = "expected micrometres above 0";
    let wavelength =
        text.said_number(&tokens.metadata, "wavelength_um", expected, |um| um > 0.0)?;
    let mut taken = Taken {
        wavelength_um: wavelength,
        ..Taken::default()
    };
    for block in &blocks {
        taken.add(block, &header);
    }
    if taken.readings.is_empty() {
        return Err(text.error("has no reading above the surface"));
    }
    Ok(Measurements {
        source: text.path.display().to_string(),
        refractive_index: refractive_index(&text, &tokens.metadata)?,
        metadata: tokens.metadata,
        convention,
        format: Format::Zemax,
        conversions: taken.conversions(&header),
        readings: taken.readings,
        ..Measurements::default()
    })
}

fn refractive_index(
    text: &Text<'_>,
    metadata: &Metadata,
) -> Result<Option<RefractiveIndex>, ReadError> {
    let said = metadata.get("refractive_index").map(str::parse);
    said.transpose()
        .map_err(|error| text.error(format!("refractive_index: {error}")))
}

/// The view zenith angle and azimuth of the model, in radians, for scatter coordinates about the
/// specular ray; all in radians. A zenith angle of pi/2 or more is below the surface.
pub(crate) fn from_specular(psi: f64, azimuth: f64, radial: f64) -> (f64, f64) {
    let (sin_psi, cos_psi) = psi.sin_cos();
    // Along the specular ray, and across it towards the normal and out of the plane.
    let (across, along) = radial.sin_cos();
    let (out, towards_normal) = (across * azimuth.sin(), across * azimuth.cos());
    let x = towards_normal * cos_psi - along * sin_psi;
    let z = towards_normal * sin_psi + along * cos_psi;
    (x.hypot(out).atan2(z), out.atan2(x))
}

/// The words of a file with their lines, without the comments.
struct Tokens<'a> {
    text: Text<'a>,
    words: std::iter::Peekable<std::vec::IntoIter<(u64, &'a [u8])>>,
    metadata: Metadata,
    /// The line of the last one.
    line: u64,
}

impl<'a> Tokens<'a> {
    fn new(text: Text<'a>) -> Result<Self, ReadError> {
        let mut found = Vec::new();
        let mut metadata = Metadata::default();
        for line in text.checked_lines() {
            let (number, line) = line?;
            match comment_of(line) {
                Some(comment) => {
                    let comment = String::from_utf8_lossy(comment);
                    metadata.0.extend(super::text::key_and_value(&comment));
                }
                None => found.extend(words(line).map(|word| (number, word))),
            }
        }
        Ok(Self {
            text,
            words: found.into_iter().peekable(),
            metadata,
            line: 0,
        })
    }

    fn next(&mut self, expected: &str) -> Result<&'a [u8], ReadError> {
        match self.words.next() {
            Some((line, word)) => {
                self.line = line;
                Ok(word)
            }
            None => Err(self
                .text
                .error(format!("ends too early: expected {expected}"))),
        }
    }

    fn word(&mut self, expected: &str) -> Result<String, ReadError> {
        let word = self.next(expected)?;
        Ok(String::from_utf8_lossy(word).into_owned())
    }

    /// A word that can be no other.
    fn the(&mut self, expected: &'static str) -> Result<(), ReadError> {
        let word = self.next(expected)?;
        if word.eq_ignore_ascii_case(expected.as_bytes()) {
            return Ok(());
        }
        Err(self.unexpected(word, expected))
    }

    fn number(
        &mut self,
        name: &str,
        expected: &str,
        accepts: fn(f64) -> bool,
    ) -> Result<f64, ReadError> {
        let word = self.next(name)?;
        self.text
            .number(self.line, name, &Field::plain(word), expected, accepts)
    }

    /// A count and as many angles; as many are kept as stand there, whatever the count.
    fn angles(
        &mut self,
        name: &'static str,
        accepts: fn(f64) -> bool,
    ) -> Result<Vec<f64>, ReadError> {
        let word = self.next(name)?;
        let count = std::str::from_utf8(word)
            .ok()
            .and_then(|word| word.parse::<u64>().ok());
        let Some(count) = count.filter(|&count| count > 0) else {
            let message = "is not a number of angles: expected 1 or more".to_owned();
            return Err(self.text.value_error(self.line, name, word, message));
        };
        let mut angles = Vec::new();
        for _ in 0..count {
            angles.push(self.number(name, "expected degrees", accepts)?);
        }
        Ok(angles)
    }

    fn unexpected(&self, word: &[u8], expected: &str) -> ReadError {
        let word = super::text::shown(word);
        self.text
            .line_error(self.line, format!("\"{word}\": expected {expected}"))
    }
}

/// What stands before the values.
#[derive(Default)]
struct Header {
    xyz: bool,
    rotations: Vec<f64>,
    incidences: Vec<f64>,
    azimuths: Vec<f64>,
    radials: Vec<f64>,
}

/// The values of one incidence, azimuth by azimuth.
struct Block {
    psi_deg: f64,
    values: Vec<f64>,
}

impl Header {
    /// Up to the word that begins the first section.
    fn read(tokens: &mut Tokens<'_>) -> Result<Self, ReadError> {
        let mut header = Self::default();
        while !tokens
            .words
            .peek()
            .is_some_and(|(_, word)| begins_section(word))
        {
            header.read_key(tokens)?;
        }
        let lists = [
            ("AngleOfIncidence", &header.incidences),
            ("ScatterAzimuth", &header.azimuths),
            ("ScatterRadial", &header.radials),
        ];
        if let Some((name, _)) = lists.iter().find(|(_, list)| list.is_empty()) {
            return Err(tokens
                .text
                .error(format!("has no {name} before its values")));
        }
        Ok(header)
    }

    fn read_key(&mut self, tokens: &mut Tokens<'_>) -> Result<(), ReadError> {
        const KEYS: &str = "Source, Symmetry, SpectralContent, ScatterType, SampleRotation, \
            AngleOfIncidence, ScatterAzimuth, ScatterRadial, Monochrome or TristimulusX";
        let key = tokens.next(KEYS)?;
        let any = |_| true;
        match key.to_ascii_lowercase().as_slice() {
            b"source" => drop(tokens.word("a source such as Measured")?),
            b"symmetry" => choose(
                tokens,
                &["PlaneSymmetrical", "ASymmetrical", "ASymmetrical4D"],
            )
            .map(drop)?,
            b"spectralcontent" => self.xyz = choose(tokens, &["Monochrome", "XYZ"])? == 1,
            b"scattertype" => check_scatter_type(tokens)?,
            b"samplerotation" => self.rotations = tokens.angles("SampleRotation", any)?,
            b"angleofincidence" => {
                let accepts = |psi| (0.0..=90.0).contains(&psi);
                self.incidences = tokens.angles("AngleOfIncidence", accepts)?;
            }
            b"scatterazimuth" => self.azimuths = tokens.angles("ScatterAzimuth", any)?,
            b"scatterradial" => {
                let accepts = |radial| (0.0..=180.0).contains(&radial);
                self.radials = tokens.angles("ScatterRadial", accepts)?;
            }
            _ => return Err(tokens.unexpected(key, KEYS)),
        }
        Ok(())
    }

    /// The blocks of the section that is read.
    fn read_sections(&self, tokens: &mut Tokens<'_>) -> Result<Vec<Block>, ReadError> {
        let names: &[&'static str] = if self.xyz {
            &["TristimulusX", "TristimulusY", "TristimulusZ"]
        } else {
            &["Monochrome"]
        };
        let mut kept = Vec::new();
        for &name in names {
            tokens.the(name)?;
            let blocks = self.read_section(tokens)?;
            if name != "TristimulusX" && name != "TristimulusZ" {
                kept = blocks;
            }
        }
        match tokens.words.next() {
            None => Ok(kept),
            Some((line, word)) => {
                tokens.line = line;
                Err(tokens.unexpected(word, "nothing after the last DataEnd"))
            }
        }
    }

    fn read_section(&self, tokens: &mut Tokens<'_>) -> Result<Vec<Block>, ReadError> {
        tokens.the("DataBegin")?;
        let mut blocks = Vec::new();
        for _ in 0..self.rotations.len().max(1) {
            for &psi_deg in &self.incidences {
                tokens.the("TIS")?;
                tokens.number("TIS", "expected a number", |_| true)?;
                let values = self.read_values(tokens)?;
                blocks.push(Block { psi_deg, values });
            }
        }
        tokens.the("DataEnd")?;
        Ok(blocks)
    }

    /// Not reserved ahead: the counts of the header may claim anything.
    fn read_values(&self, tokens: &mut Tokens<'_>) -> Result<Vec<f64>, ReadError> {
        let mut values = Vec::new();
        for _ in &self.azimuths {
            for _ in &self.radials {
                values.push(tokens.number("BRDF", "expected a value in 1/sr", |_| true)?);
            }
        }
        Ok(values)
    }
}

fn begins_section(word: &[u8]) -> bool {
    let word = word.to_ascii_lowercase();
    word == b"monochrome" || word.starts_with(b"tristimulus")
}

/// Which of the words stands there.
fn choose(tokens: &mut Tokens<'_>, words: &[&str]) -> Result<usize, ReadError> {
    let expected = words.join(" or ");
    let word = tokens.next(&expected)?;
    let found = words
        .iter()
        .position(|known| word.eq_ignore_ascii_case(known.as_bytes()));
    found.ok_or_else(|| tokens.unexpected(word, &expected))
}

fn check_scatter_type(tokens: &mut Tokens<'_>) -> Result<(), ReadError> {
    if choose(tokens, &["BRDF", "BTDF"])? == 0 {
        return Ok(());
    }
    let message = "ScatterType BTDF: the model is of reflection, expected BRDF";
    Err(tokens.text.line_error(tokens.line, message))
}

/// What was taken of the values, and what was left.
#[derive(Default)]
struct Taken {
    wavelength_um: Option<f64>,
    readings: Vec<Measurement>,
    below: usize,
    zeros: usize,
    again: usize,
}

impl Taken {
    fn add(&mut self, block: &Block, header: &Header) {
        let mut values = block.values.iter();
        let first = block.values.first().copied();
        for (i, &azimuth_deg) in header.azimuths.iter().enumerate() {
            let repeats =
                |radial_deg: f64, value: f64| radial_deg == 0.0 && i > 0 && Some(value) == first;
            let turn = azimuth_deg.rem_euclid(360.0);
            let same = header.azimuths[..i]
                .iter()
                .position(|a| a.rem_euclid(360.0) == turn);
            for (j, (&radial_deg, &value)) in header.radials.iter().zip(&mut values).enumerate() {
                let before = same.and_then(|k| block.values.get(k * header.radials.len() + j));
                if repeats(radial_deg, value) || before == Some(&value) {
                    self.again += 1;
                } else {
                    self.add_value(block.psi_deg, azimuth_deg, radial_deg, value);
                }
            }
        }
    }

    fn add_value(&mut self, psi_deg: f64, azimuth_deg: f64, radial_deg: f64, value: f64) {
        let psi = psi_deg.to_radians();
        let (theta, phi) = from_specular(psi, azimuth_deg.to_radians(), radial_deg.to_radians());
        let reading = Measurement {
            wavelength_um: self.wavelength_um,
            psi,
            theta,
            phi,
            brdf: value,
            sigma: None,
        };
        let horizon = std::f64::consts::FRAC_PI_2 - 1e-9;
        if psi_deg >= 90.0 || theta >= horizon {
            self.below += 1;
        } else if value == 0.0 {
            self.zeros += 1;
        } else {
            self.readings.push(reading);
        }
    }

    fn conversions(&self, header: &Header) -> Vec<String> {
        let mut said =
            vec!["scatter angles about the specular ray are turned to view angles".to_owned()];
        if header.xyz {
            said.push(
                "Y of X, Y and Z is read: the BRDF weighted by luminous efficiency".to_owned(),
            );
        }
        let rotations = header.rotations.len();
        if rotations > 1 {
            said.push(format!(
                "{rotations} rotations of the sample are read as one isotropic sample"
            ));
        }
        said.extend(left_out(self.below, BEYOND_HORIZON));
        said.extend(left_out(
            self.zeros,
            "of exactly 0, the format's mark for not measured,",
        ));
        said.extend(left_out(
            self.again,
            "that repeat one of the same direction",
        ));
        said
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, TAU};
    use std::path::Path;

    use proptest::prelude::*;

    use super::*;
    use crate::scan::Side;

    const SMALL: &str = "# sample: Test paint\n# wavelength_um: 0.65\nSource\tMeasured\n\
        Symmetry\tPlaneSymmetrical\nSpectralContent\tMonochrome\nScatterType\tBRDF\n\
        SampleRotation\t1\n0\nAngleOfIncidence\t2\n10\t30\nScatterAzimuth\t2\n0\t180\n\
        ScatterRadial\t3\n0\t30\t70\n\nMonochrome\nDataBegin\n\
        TIS\t0.1\n0.10 0.11 0.12\n0.10 0.13 0.14\nTIS\t0.1\n0.20 0.21 0\n0.20 0.23 0.24\nDataEnd\n";

    fn read_with(content: &str, options: &ReadOptions) -> Result<Measurements, ReadError> {
        read(Text::new(Path::new("a.bsdf"), content.as_bytes())?, options)
    }

    fn scan(content: &str) -> Measurements {
        read_with(content, &ReadOptions::default()).unwrap()
    }

    fn error(content: &str) -> String {
        let read = read_with(content, &ReadOptions::default());
        read.unwrap_err().to_string()
    }

    #[test]
    fn angles_about_the_specular_ray_are_turned_to_views() {
        let scan = scan(SMALL);
        let found: Vec<_> = scan
            .readings()
            .iter()
            .map(|r| {
                (
                    r.psi.to_degrees().round(),
                    r.in_plane_theta().unwrap().to_degrees().round(),
                    r.brdf,
                )
            })
            .collect();
        // Azimuth 0 goes towards the normal and past it to the source, 180 deg to grazing.
        let expected = [
            (10.0, -10.0, 0.10),
            (10.0, 20.0, 0.11),
            (10.0, 60.0, 0.12),
            (10.0, -40.0, 0.13),
            (10.0, -80.0, 0.14),
            (30.0, -30.0, 0.20),
            (30.0, 0.0, 0.21),
            (30.0, -60.0, 0.23),
        ];
        assert_eq!(found, expected);
        assert_eq!(scan.wavelengths(), [Some(0.65)]);
        assert_eq!(scan.metadata.get("sample"), Some("Test paint"));
    }

    #[test]
    fn what_is_left_out_is_counted() {
        let said = scan(SMALL).conversions.join("; ");
        assert!(
            said.contains("1 reading at or beyond 90 deg from the normal is left out"),
            "{said}"
        );
        assert!(said.contains("1 reading of exactly 0"), "{said}");
        assert!(
            said.contains("2 readings that repeat one of the same direction"),
            "{said}"
        );
    }

    #[test]
    fn y_is_read_of_xyz() {
        let (head, section) = SMALL.split_once("Monochrome\nDataBegin").unwrap();
        let section = format!("DataBegin{section}");
        let xyz = format!(
            "{}TristimulusX\n{section}\nTristimulusY\n{}TristimulusZ\n{section}",
            head.replace("Monochrome", "XYZ"),
            section.replace("0.11", "0.77"),
        );
        let scan = scan(&xyz);
        assert_eq!(scan.readings()[1].brdf, 0.77);
        assert!(scan.conversions[1].contains("Y of X, Y and Z"));
    }

    #[test]
    fn rotations_are_read_as_one_surface() {
        let block = "TIS 0.1\n1 2\n1 3\n1 2\n";
        let text = format!(
            "Symmetry Asymmetrical4D\nSampleRotation 2\n0 90\nAngleOfIncidence 1\n10\n\
             ScatterAzimuth 3\n0 180 360\nScatterRadial 2\n0 10\nMonochrome\nDataBegin\n{block}{block}DataEnd\n"
        );
        let scan = scan(&text);
        assert_eq!(scan.readings().len(), 2 * 3);
        let said = scan.conversions.join("; ");
        assert!(said.contains("2 rotations of the sample"), "{said}");
        assert!(said.contains("6 readings that repeat one"), "{said}");
    }

    #[test]
    fn errors_name_line_and_word() {
        let with = |from: &str, to: &str| error(&SMALL.replacen(from, to, 1));
        assert_eq!(
            with("\tBRDF", "\tBTDF"),
            "a.bsdf, line 6: ScatterType BTDF: the model is of reflection, expected BRDF"
        );
        assert!(with("Source", "Origin").contains("line 3: \"Origin\": expected Source, Symmetry"));
        assert!(
            with("PlaneSymmetrical", "Round").contains("\"Round\": expected PlaneSymmetrical or")
        );
        assert!(
            with("ScatterRadial\t3", "ScatterRadial\t-3")
                .contains("line 13, column ScatterRadial: \"-3\"")
        );
        assert!(
            with("ScatterRadial\t3", "ScatterRadial\t2")
                .contains("line 14: \"70\": expected Source")
        );
        assert!(with("0.13", "x").contains("line 20, column BRDF: \"x\" is not a number"));
        assert!(with("0.13", "").contains("line 21, column BRDF: \"TIS\" is not a number"));
        assert!(with("DataEnd\n", "").contains("ends too early: expected DataEnd"));
        assert!(with("DataEnd", "DataEnd 5").contains("line 24: \"5\": expected nothing after"));
        assert!(error("Symmetry ASymmetrical\nMonochrome\n").contains("has no AngleOfIncidence"));
    }

    #[test]
    fn a_count_allocates_nothing() {
        let claims = SMALL.replace("ScatterRadial\t3", "ScatterRadial\t18446744073709551615");
        assert!(error(&claims).contains("column ScatterRadial: \"Monochrome\" is not a number"));
    }

    #[test]
    fn its_sides_cannot_be_chosen() {
        let options = ReadOptions {
            theta_positive: Some(Side::Forward),
            ..ReadOptions::default()
        };
        let error = read_with(SMALL, &options).unwrap_err().to_string();
        assert!(
            error.contains("its sides cannot be chosen: the format counts from"),
            "{error}"
        );
    }

    proptest! {
        // The spherical triangle of normal, specular ray and view, instead of vectors.
        #[test]
        fn directions_agree_with_spherical_trigonometry(
            psi in 0.01..1.5_f64,
            azimuth in 0.0..TAU,
            radial in 0.01..3.1_f64,
        ) {
            let (theta, phi) = from_specular(psi, azimuth, radial);
            let cos_theta = psi.cos() * radial.cos() + psi.sin() * radial.sin() * azimuth.cos();
            prop_assert!((theta.cos() - cos_theta).abs() < 1e-14);
            // The angle at the normal between the specular ray and the view.
            let adjacent = radial.cos() - psi.cos() * cos_theta;
            let turn = adjacent / psi.sin();
            let sine = radial.sin() * azimuth.sin();
            // phi counts from the source, which is opposite to the specular ray.
            prop_assert!((theta.sin() * phi.cos() + turn).abs() < 1e-12 / psi.sin());
            prop_assert!((theta.sin() * phi.sin() - sine).abs() < 1e-14);
        }

        #[test]
        fn radial_is_the_angle_from_the_specular_ray(
            psi in 0.0..FRAC_PI_2,
            azimuth in 0.0..TAU,
            radial in 0.0..3.1_f64,
        ) {
            let (theta, phi) = from_specular(psi, azimuth, radial);
            let cosine = -psi.sin() * theta.sin() * phi.cos() + psi.cos() * theta.cos();
            prop_assert!((cosine - radial.cos()).abs() < 1e-14);
        }
    }
}
