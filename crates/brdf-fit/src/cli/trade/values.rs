//! The values that options of `brdf trade` take.

use std::str::FromStr;

use brdf_core::published::{PUBLISHED, PublishedSample};
use brdf_core::scene::Coordinates;
use brdf_core::{AnyBrdf, ThreeParameterBrdf};
use clap::ValueEnum;

/// The value of `--coordinates`.
#[derive(Clone, Copy, ValueEnum)]
pub(super) enum CoordinatesArgument {
    /// The cosines of the angles of a direction pair
    Cosines,
    /// The angles psi, theta and phi
    Angles,
    /// Two unit vectors
    Directions,
}

impl From<CoordinatesArgument> for Coordinates {
    fn from(coordinates: CoordinatesArgument) -> Self {
        match coordinates {
            CoordinatesArgument::Cosines => Self::Cosines,
            CoordinatesArgument::Angles => Self::Angles,
            CoordinatesArgument::Directions => Self::Directions,
        }
    }
}

/// A row of Table 1.
#[derive(Clone)]
pub(super) struct Row {
    pub(super) name: String,
    pub(super) brdf: AnyBrdf,
}

impl FromStr for Row {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let name = |row: &PublishedSample| format!("{} {}", row.sample, row.wavelength_um);
        let words: Vec<&str> = text.split_whitespace().collect();
        let row = PUBLISHED.iter().find(|row| name(row) == words.join(" "));
        let row = row.ok_or_else(|| {
            let names: Vec<String> = PUBLISHED
                .iter()
                .map(|row| format!("\"{}\"", name(row)))
                .collect();
            format!("expected one of {}", names.join(", "))
        })?;
        let brdf = ThreeParameterBrdf::new(row.parameters, row.n).map_err(|e| e.to_string())?;
        Ok(Self {
            name: format!("Table 1, {} {} um", row.sample, row.wavelength_um),
            brdf: AnyBrdf::Paper(brdf),
        })
    }
}
