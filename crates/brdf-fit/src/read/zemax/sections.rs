//! The header of keywords, and the sections of values for the angles that it lists.

use super::tokens::Tokens;
use crate::read::error::ReadError;

const KEYS: &str = "Source, Symmetry, SpectralContent, ScatterType, SampleRotation, \
                    AngleOfIncidence, ScatterAzimuth, ScatterRadial, Monochrome or TristimulusX";

/// The keywords before the values. Angles are in degrees.
#[derive(Default)]
pub(super) struct Header {
    /// Whether the values are the tristimulus values X, Y and Z.
    pub(super) xyz: bool,
    pub(super) rotations: Vec<f64>,
    incidences: Vec<f64>,
    pub(super) azimuths: Vec<f64>,
    pub(super) radials: Vec<f64>,
}

/// The values of one incidence: for each azimuth those of all radial angles.
pub(super) struct Block {
    pub(super) psi_deg: f64,
    pub(super) values: Vec<Option<f64>>,
}

impl Header {
    /// Reads up to the keyword that begins the first section.
    ///
    /// # Errors
    ///
    /// A keyword or its value is not valid, or a list of angles is missing.
    pub(super) fn read(tokens: &mut Tokens<'_>) -> Result<Self, ReadError> {
        let mut header = Self::default();
        while !tokens.peek().is_some_and(begins_section) {
            header.read_key(tokens)?;
        }
        let lists = [
            ("AngleOfIncidence", &header.incidences),
            ("ScatterAzimuth", &header.azimuths),
            ("ScatterRadial", &header.radials),
        ];
        if let Some((name, _)) = lists.iter().find(|(_, list)| list.is_empty()) {
            let message = format!("has no {name} before its values");
            return Err(tokens.text.error(message));
        }
        Ok(header)
    }

    fn read_key(&mut self, tokens: &mut Tokens<'_>) -> Result<(), ReadError> {
        let key = tokens.next(KEYS)?;
        let any = |_| true;
        match key.to_ascii_lowercase().as_slice() {
            b"source" => drop(tokens.next("a source such as Measured")?),
            b"symmetry" => {
                tokens.choose(&["PlaneSymmetrical", "ASymmetrical", "ASymmetrical4D"])?;
            }
            b"spectralcontent" => self.xyz = tokens.choose(&["Monochrome", "XYZ"])? == 1,
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

    /// Reads all sections, and returns the blocks of `Monochrome` or of `TristimulusY`.
    ///
    /// # Errors
    ///
    /// A section is missing or not complete, or text follows the last one.
    pub(super) fn read_sections(&self, tokens: &mut Tokens<'_>) -> Result<Vec<Block>, ReadError> {
        let names: &[&'static str] = if self.xyz {
            &["TristimulusX", "TristimulusY", "TristimulusZ"]
        } else {
            &["Monochrome"]
        };
        let mut kept = Vec::new();
        for &name in names {
            tokens.keyword(name)?;
            let blocks = self.read_section(tokens)?;
            if name != "TristimulusX" && name != "TristimulusZ" {
                kept = blocks;
            }
        }
        tokens.end("nothing after the last DataEnd")?;
        Ok(kept)
    }

    fn read_section(&self, tokens: &mut Tokens<'_>) -> Result<Vec<Block>, ReadError> {
        tokens.keyword("DataBegin")?;
        let mut blocks = Vec::new();
        for _ in 0..self.rotations.len().max(1) {
            for &psi_deg in &self.incidences {
                tokens.keyword("TIS")?;
                tokens.number("TIS", "expected a number", |_| true)?;
                let values = self.read_values(tokens)?;
                blocks.push(Block { psi_deg, values });
            }
        }
        tokens.keyword("DataEnd")?;
        Ok(blocks)
    }

    /// Memory is allocated for the values in the file, not for the counts of the header, which may
    /// be any.
    fn read_values(&self, tokens: &mut Tokens<'_>) -> Result<Vec<Option<f64>>, ReadError> {
        let mut values = Vec::new();
        for _ in &self.azimuths {
            for _ in &self.radials {
                values.push(tokens.reading("BRDF")?);
            }
        }
        Ok(values)
    }
}

fn begins_section(word: &[u8]) -> bool {
    let word = word.to_ascii_lowercase();
    word == b"monochrome" || word.starts_with(b"tristimulus")
}

fn check_scatter_type(tokens: &mut Tokens<'_>) -> Result<(), ReadError> {
    match tokens.choose(&["BRDF", "BTDF"])? {
        0 => Ok(()),
        _ => Err(tokens.error("ScatterType BTDF: the model describes reflection, expected BRDF")),
    }
}
