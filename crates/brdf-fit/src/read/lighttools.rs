//! LightTools tables of a BSDF: a header with the angles of all blocks, and a block for each incidence.
//!
//! ```text
//! # a comment
//! Symmetry  Asymmetric
//! SpectralContent  Monochrome
//! ScatterAzimuth  3
//! 90  180  270
//! ScatterRadial  2
//! 0  20
//! DataBegin
//! AOI  30
//! POI  0
//! Side  Front
//! Wavelength  550
//! ScatterType  BRDF
//! TIS  0.12
//! 0.10  0.09
//! 0.10  0.11
//! 0.10  0.13
//! AOI  50
//! ...
//! DataEnd
//! ```
//!
//! (The numbers are made up.) `AOI` is the incidence angle and `POI` the plane of incidence, in degrees;
//! `Wavelength` is in nm. `TIS`, the total integrated scatter, is not used; it is followed by the values,
//! f_r in 1/sr: for each azimuth those of all radial angles. Other than in the Zemax format, whose
//! keywords are similar, radial angles are counted from the **normal** and azimuths about it. The source
//! is at the azimuth 90 deg, and the forward side at 270 deg: the model's phi is the azimuth - 90 deg.
//!
//! Of a file with colours (`SpectralContent XYZ`, and `TristimulusValue` in each block), the blocks of
//! `TrisY` are read. Left out and counted are blocks of X and Z, of the back side and of transmission;
//! directions at or beyond 90 deg from the normal; values of exactly 0, as the format has no other mark
//! for a direction that was not measured; equal values at radial angle 0, and at azimuths that differ by
//! 360 deg, which are one direction. Errors are: no block of reflection on the front side; another
//! symmetry than `Asymmetric`, or another plane of incidence than 0, whose azimuths are not documented.
//!
//! Source: `LightToolsBsdfReader` of github.com/KimuraRyo/libbsdf, whose coordinates have the azimuth 0
//! at the source; the format's own documentation is not public.

use super::angles::{AngleUnit, TwoDirections};
use super::conversion::{BEYOND_HORIZON, left_out};
use super::error::ReadError;
use super::number::{Field, is_angle, is_reading, micrometres};
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use super::text::{Text, first_words};
use super::zemax::tokens::Tokens;
use crate::format::counted;
use crate::scan::{Convention, Format, Measurement, Measurements};

pub(super) const READER: Reader = Reader {
    format: Format::LightTools,
    // These files have no extension of their own.
    extensions: &[],
    recognises: has_keywords,
    content: Content::Text(read),
};

/// The azimuth of the source in degrees.
const SOURCE_AZIMUTH: f64 = 90.0;

/// Whether lines of a text begin with the keywords of the header and of a block.
fn has_keywords(bytes: &[u8]) -> bool {
    let has = |keyword: &[u8]| first_words(bytes).any(|word| word == keyword);
    has(b"AOI") && has(b"ScatterAzimuth") && has(b"ScatterRadial")
}

/// # Errors
///
/// The text is not such a file, or has no reflection above the surface, or `options` set another angular
/// convention.
pub(super) fn read(text: Text<'_>, options: &ReadOptions) -> Result<Measurements, ReadError> {
    let why =
        "in LightTools, angles are counted from the normal, with the source at azimuth 90 deg";
    let convention = options.fixed_convention(text.path, Convention::default(), why)?;
    let mut tokens = Tokens::new(text)?;
    let header = Header::read(&mut tokens)?;
    let mut readings = Readings::default();
    while let Some(block) = Block::read(&mut tokens, &header)? {
        readings.add(&block, &header);
    }
    if readings.blocks == 0 {
        let message = format!(
            "has no BRDF of the front side: {} cannot be read because the model describes reflection",
            counted(readings.other_blocks, "block")
        );
        return Err(text.error(message));
    }
    if readings.kept.is_empty() {
        return Err(text.error("has no reading above the surface"));
    }
    Ok(Measurements {
        source: text.path.display().to_string(),
        conversions: readings.conversions(&header),
        metadata: tokens.metadata,
        convention,
        format: Format::LightTools,
        readings: readings.kept,
        ..Measurements::default()
    })
}

/// What the keywords before `DataBegin` state.
#[derive(Default)]
struct Header {
    /// Whether there are blocks of tristimulus values.
    xyz: bool,
    azimuths: Vec<f64>,
    radials: Vec<f64>,
}

const KEYS: &str = "Symmetry, SpectralContent, ScatterAzimuth, ScatterRadial or DataBegin";

impl Header {
    fn read(tokens: &mut Tokens<'_>) -> Result<Self, ReadError> {
        let mut header = Self::default();
        loop {
            let key = tokens.next(KEYS)?;
            match key.to_ascii_lowercase().as_slice() {
                // The word of the similar format, which people also write here, means the same.
                b"symmetry" => drop(tokens.choose(&["Asymmetric", "ASymmetrical"])?),
                b"spectralcontent" => {
                    header.xyz = tokens.choose(&["Monochrome", "XYZ"])? == 1;
                }
                b"scatterazimuth" => header.azimuths = tokens.angles("ScatterAzimuth", is_angle)?,
                b"scatterradial" => {
                    let accepts = |radial| (0.0..=180.0).contains(&radial);
                    header.radials = tokens.angles("ScatterRadial", accepts)?;
                }
                b"databegin" => break,
                _ => return Err(tokens.unexpected(key, KEYS)),
            }
        }
        let lists = [
            ("ScatterAzimuth", &header.azimuths),
            ("ScatterRadial", &header.radials),
        ];
        match lists.iter().find(|(_, list)| list.is_empty()) {
            Some((name, _)) => Err(tokens.error(format!("{name} is not given before DataBegin"))),
            None => Ok(header),
        }
    }
}

/// The values of one incidence.
#[derive(Default)]
struct Block {
    psi_deg: f64,
    wavelength_um: Option<f64>,
    is_back: bool,
    is_transmission: bool,
    /// Whether the values are a tristimulus value other than Y.
    is_other_colour: bool,
    /// For each azimuth the values of all radial angles.
    values: Vec<f64>,
}

const BLOCK_KEYS: &str =
    "AOI, POI, Side, Wavelength, ScatterType, TristimulusValue, TIS or DataEnd";

impl Block {
    /// The next block, up to its values; `None` at the end of the file.
    fn read(tokens: &mut Tokens<'_>, header: &Header) -> Result<Option<Self>, ReadError> {
        let mut block = Self::default();
        let mut psi_deg = None;
        let mut colour = None;
        loop {
            if tokens.peek().is_none() && psi_deg.is_none() {
                return Ok(None);
            }
            let key = tokens.next(BLOCK_KEYS)?;
            match key.to_ascii_lowercase().as_slice() {
                b"aoi" => {
                    let accepts = |psi| (0.0..=90.0).contains(&psi);
                    psi_deg = Some(tokens.number("AOI", "expected 0 to 90 deg", accepts)?);
                }
                b"poi" => {
                    let expected = "expected 0, the only plane of incidence that can be read because \
                                    the model is isotropic";
                    tokens.number("POI", expected, |poi| poi == 0.0)?;
                }
                b"side" => block.is_back = tokens.choose(&["Front", "Back"])? == 1,
                b"wavelength" => block.wavelength_um = wavelength(tokens)?,
                b"scattertype" => block.is_transmission = tokens.choose(&["BRDF", "BTDF"])? == 1,
                b"tristimulusvalue" => {
                    colour = Some(tokens.choose(&["TrisX", "TrisY", "TrisZ"])?);
                }
                b"tis" => {
                    tokens.number("TIS", "expected a number", |_| true)?;
                    break;
                }
                b"dataend" => {
                    tokens.end("nothing after DataEnd")?;
                    return Ok(None);
                }
                _ => return Err(tokens.unexpected(key, BLOCK_KEYS)),
            }
        }
        block.psi_deg = psi_deg.ok_or_else(|| {
            tokens.error("AOI is not given before TIS: expected the incidence angle of the block")
        })?;
        if header.xyz && colour.is_none() {
            let message =
                "TristimulusValue is not given before TIS: expected TrisX, TrisY or TrisZ";
            return Err(tokens.error(message));
        }
        block.is_other_colour = colour.is_some_and(|colour| colour != 1);
        block.read_values(tokens, header)?;
        Ok(Some(block))
    }

    /// Memory is allocated for the values in the file, not for the counts of the header.
    fn read_values(&mut self, tokens: &mut Tokens<'_>, header: &Header) -> Result<(), ReadError> {
        for _ in &header.azimuths {
            for _ in &header.radials {
                let value = tokens.number("BRDF", "expected a value in 1/sr", is_reading)?;
                self.values.push(value);
            }
        }
        Ok(())
    }
}

/// The wavelength in micrometres; `None` for 0, which stands for none.
fn wavelength(tokens: &mut Tokens<'_>) -> Result<Option<f64>, ReadError> {
    let word = tokens.next("a wavelength in nm")?;
    let is_zero = super::number::parse_number(Field::plain(word).text, false) == Some(0.0);
    match micrometres(word) {
        Some(um) => Ok(Some(um)),
        None if is_zero => Ok(None),
        None => Err(tokens.unexpected(word, "a wavelength in nm")),
    }
}

/// The readings of a file, with the numbers of values and blocks that are left out.
#[derive(Default)]
struct Readings {
    kept: Vec<Measurement>,
    blocks: usize,
    other_blocks: usize,
    other_colours: usize,
    beyond: usize,
    zeros: usize,
    repeated: usize,
}

impl Readings {
    fn add(&mut self, block: &Block, header: &Header) {
        if block.is_back || block.is_transmission {
            self.other_blocks += 1;
            return;
        }
        if block.is_other_colour {
            self.other_colours += 1;
            return;
        }
        self.blocks += 1;
        let mut values = block.values.iter();
        let first = block.values.first();
        for (i, &azimuth) in header.azimuths.iter().enumerate() {
            let turn = |degrees: f64| degrees.rem_euclid(360.0);
            let is_first_again = i > 0
                && header
                    .azimuths
                    .first()
                    .is_some_and(|first| turn(*first) == turn(azimuth));
            for (j, (&radial, value)) in header.radials.iter().zip(&mut values).enumerate() {
                let before = match (radial == 0.0 && i > 0, is_first_again) {
                    (true, _) => first,
                    (false, true) => block.values.get(j),
                    (false, false) => None,
                };
                if before == Some(value) {
                    self.repeated += 1;
                } else {
                    self.add_value(block, azimuth, radial, *value);
                }
            }
        }
    }

    fn add_value(&mut self, block: &Block, azimuth: f64, radial: f64, value: f64) {
        let directions = TwoDirections {
            theta_i: block.psi_deg,
            phi_i: SOURCE_AZIMUTH,
            theta_s: radial,
            phi_s: azimuth,
        };
        match directions.in_model(AngleUnit::Degrees) {
            None => self.beyond += 1,
            Some(_) if value == 0.0 => self.zeros += 1,
            Some((psi, theta, phi)) => self.kept.push(Measurement {
                wavelength_um: block.wavelength_um,
                psi,
                theta,
                phi,
                brdf: value,
                sigma: None,
            }),
        }
    }

    /// The sentences that report what was converted and what was left out.
    fn conversions(&self, header: &Header) -> Vec<String> {
        let azimuth = "azimuths are counted from that of the source, 90 deg";
        let mut conversions = vec![azimuth.to_owned()];
        if header.xyz {
            conversions.push(format!(
                "of X, Y and Z, Y is read: the BRDF weighted by the luminous efficiency; {} of X and Z \
                 left out",
                counted(self.other_colours, "block")
            ));
        }
        if self.other_blocks > 0 {
            conversions.push(format!(
                "{} of the back side or of transmission not read",
                counted(self.other_blocks, "block")
            ));
        }
        conversions.extend(left_out(self.beyond, BEYOND_HORIZON));
        let zeros = "of exactly 0, the format's mark for a value that was not measured,";
        conversions.extend(left_out(self.zeros, zeros));
        let repeated = "that repeat the value of the same direction";
        conversions.extend(left_out(self.repeated, repeated));
        conversions
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use proptest::prelude::*;

    use super::*;
    use crate::scan::Side;

    const SMALL: &str = "# sample: Test paint\nSymmetry Asymmetric\nSpectralContent Monochrome\n\
        ScatterAzimuth 3\n90 180 270\nScatterRadial 3\n0 20 90\nDataBegin\n\
        AOI 30\nPOI 0\nSide Front\nWavelength 550\nScatterType BRDF\nTIS 0.1\n\
        0.10 0.11 0.12\n0.10 0.13 0.14\n0.10 0.15 0.16\n\
        AOI 50\nPOI 0\nSide Front\nWavelength 550\nScatterType BRDF\nTIS 0.1\n\
        0.20 0.21 0\n0.20 0 0.24\n0.25 0.26 0.27\nDataEnd\n";

    fn read_with(content: &str, options: &ReadOptions) -> Result<Measurements, ReadError> {
        read(Text::new(Path::new("a.txt"), content.as_bytes())?, options)
    }

    fn scan(content: &str) -> Measurements {
        read_with(content, &ReadOptions::default()).unwrap()
    }

    fn error(content: &str) -> String {
        let read = read_with(content, &ReadOptions::default());
        read.unwrap_err().to_string()
    }

    #[test]
    fn the_source_is_at_the_azimuth_of_90_deg() {
        let scan = scan(SMALL);
        let found: Vec<_> = scan
            .readings()
            .iter()
            .map(|r| {
                let degrees = |radians: f64| radians.to_degrees().round();
                (degrees(r.psi), degrees(r.theta), degrees(r.phi), r.brdf)
            })
            .collect();
        let expected = [
            (30.0, 0.0, 0.0, 0.10),
            (30.0, 20.0, 0.0, 0.11),
            (30.0, 20.0, 90.0, 0.13),
            (30.0, 20.0, 180.0, 0.15),
            (50.0, 0.0, 0.0, 0.20),
            (50.0, 20.0, 0.0, 0.21),
            (50.0, 0.0, 180.0, 0.25),
            (50.0, 20.0, 180.0, 0.26),
        ];
        assert_eq!(found, expected);
        assert_eq!(scan.wavelengths(), [Some(0.55)]);
        assert_eq!(scan.metadata.get("sample"), Some("Test paint"));
        let said = scan.conversions.join("; ");
        assert!(said.contains("6 readings at or beyond 90 deg"), "{said}");
        assert!(said.contains("1 reading of exactly 0"), "{said}");
        assert!(said.contains("3 readings that repeat"), "{said}");
    }

    #[test]
    fn of_several_parts_the_reflection_of_y_is_read() {
        let parts = SMALL
            .replacen("TIS 0.1\n0.10", "TristimulusValue TrisY\nTIS 0.1\n0.10", 1)
            .replacen("TIS 0.1\n0.20", "TristimulusValue TrisZ\nTIS 0.1\n0.20", 1)
            .replace("Monochrome", "XYZ");
        let scan_of_y = scan(&parts);
        assert_eq!(scan_of_y.readings().len(), 4);
        let said = scan_of_y.conversions.join("; ");
        assert!(said.contains("of X, Y and Z, Y is read"), "{said}");
        assert!(said.contains("1 block of X and Z left out"), "{said}");
        let both = SMALL.replacen("BRDF", "BTDF", 1);
        let said = scan(&both).conversions.join("; ");
        assert!(
            said.contains("1 block of the back side or of transmission not read"),
            "{said}"
        );
        let none = SMALL.replace("Front", "Back");
        assert!(
            error(&none).contains("has no BRDF of the front side: 2 blocks cannot be read because")
        );
        // The word of the similar format.
        assert_eq!(
            scan(&SMALL.replace("Asymmetric", "ASymmetrical"))
                .readings()
                .len(),
            8
        );
    }

    #[test]
    fn errors_name_line_and_word() {
        let with = |from: &str, to: &str| error(&SMALL.replacen(from, to, 1));
        assert_eq!(
            with("Asymmetric", "Axial"),
            "a.txt, line 2: \"Axial\": expected Asymmetric or ASymmetrical"
        );
        assert!(with("Symmetry", "Source").contains("line 2: \"Source\": expected Symmetry, Spec"));
        assert!(
            with("ScatterAzimuth 3", "ScatterAzimuth -3").contains("column ScatterAzimuth: \"-3\"")
        );
        assert!(
            with("ScatterRadial 3\n0 20 90\n", "").contains("line 6: ScatterRadial is not given")
        );
        assert!(with("AOI 30", "AOI 130").contains("line 9, column AOI: \"130\" is out of range"));
        assert!(with("AOI 30\n", "").contains("line 13: AOI is not given before TIS"));
        assert!(with("POI 0", "POI 45").contains("line 10, column POI: \"45\" is out of range"));
        assert!(with("Front", "Top").contains("line 11: \"Top\": expected Front or Back"));
        assert!(with("550", "red").contains("line 12: \"red\": expected a wavelength in nm"));
        assert!(with("0.13", "x").contains("line 16, column BRDF: \"x\" is not a number"));
        assert!(with("0.13 ", "").contains("line 18, column BRDF: \"AOI\" is not a number"));
        assert!(with("DataEnd", "DataEnd 5").contains("\"5\": expected nothing after DataEnd"));
        assert!(with("0.27\nDataEnd", "").contains("ends too early: expected BRDF"));
    }

    #[test]
    fn files_of_the_similar_format_and_tables_are_not_recognised() {
        assert!(has_keywords(SMALL.as_bytes()));
        for other in [
            "Source Measured\nSymmetry PlaneSymmetrical\nAngleOfIncidence 1\n10\nScatterAzimuth 2\n0 180\n\
             ScatterRadial 2\n0 10\n",
            "AOI theta_r brdf\n10 20 0.1\n",
        ] {
            assert!(!has_keywords(other.as_bytes()));
        }
    }

    #[test]
    fn the_angular_convention_cannot_be_chosen() {
        let options = ReadOptions {
            phi_zero: Some(Side::Forward),
            ..ReadOptions::default()
        };
        let error = read_with(SMALL, &options).unwrap_err().to_string();
        assert!(
            error.contains("with the source at azimuth 90 deg"),
            "{error}"
        );
    }

    #[test]
    fn a_large_count_allocates_no_memory() {
        let claims = SMALL.replace("ScatterRadial 3", "ScatterRadial 18446744073709551615");
        assert!(error(&claims).contains("column ScatterRadial: \"DataBegin\" is not a number"));
    }

    proptest! {
        #[test]
        fn damaged_files_give_an_error_or_readings_in_the_domain(
            at in any::<proptest::sample::Index>(),
            length in 0..30_usize,
            by in "[0-9. \nA-Z-]{0,6}",
        ) {
            let mut text = SMALL.to_owned();
            let from = at.index(text.len());
            text.replace_range(from..(from + length).min(text.len()), &by);
            if let Ok(scan) = read_with(&text, &ReadOptions::default()) {
                for reading in scan.readings() {
                    reading.validated().unwrap();
                }
            }
        }
    }
}
