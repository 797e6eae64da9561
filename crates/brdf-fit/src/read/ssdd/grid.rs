//! The directions of a block: all combinations of its lists of angles.

use std::f64::consts::FRAC_PI_2;

use super::block::Block;
use crate::read::angles::{AngleUnit, TwoDirections};
use crate::read::error::ReadError;
use crate::read::merl::from_half_and_difference;
use crate::read::text::{Text, quotable};
use crate::read::zemax::from_specular;

/// View zenith angles from here on are at the horizon: within the rounding of pi/2, in radians.
const HORIZON: f64 = FRAC_PI_2 - 1e-9;

/// What the lists of angles are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Coordinates {
    Spherical,
    Specular,
    HalfDifference,
}

/// The index in each list, and the angles there in degrees.
type Place = ([usize; 4], [f64; 4]);

/// The grid of directions.
pub(super) struct Grid<'a> {
    coordinates: Coordinates,
    lists: [&'a [f64]; 4],
    /// For each azimuth of the lists 1 and 3, the first one that differs from it by whole turns.
    turns: [Vec<usize>; 2],
}

impl<'a> Grid<'a> {
    /// # Errors
    ///
    /// The parameters are not known, an angle is out of its range, or the specular directions are offset.
    pub(super) fn of(text: &Text<'_>, block: &'a Block) -> Result<Self, ReadError> {
        let error = |message: String| Err(text.line_error(block.line, message));
        let coordinates = match block.parameters.as_str() {
            "spherical_coordinate_system" => Coordinates::Spherical,
            "specular_coordinate_system" => Coordinates::Specular,
            "half_difference_coordinate_system" => Coordinates::HalfDifference,
            other => {
                return error(format!(
                    "PARAM_TYPE \"{}\": expected spherical_coordinate_system, specular_coordinate_system or \
                     half_difference_coordinate_system",
                    quotable(other.as_bytes())
                ));
            }
        };
        let [zenith, source_azimuth, polar, azimuth, offsets] = &block.lists;
        let widest = match coordinates {
            Coordinates::Specular => 180.0,
            Coordinates::Spherical | Coordinates::HalfDifference => 90.0,
        };
        for (name, list, widest) in [
            ("PARAM0_LIST", zenith, 90.0),
            ("PARAM2_LIST", polar, widest),
        ] {
            let outside = list.iter().find(|angle| !(0.0..=widest).contains(*angle));
            if let Some(angle) = outside {
                return error(format!(
                    "{name}: \"{angle}\" is out of range: expected degrees from 0 to {widest}"
                ));
            }
        }
        if offsets.iter().any(|offset| *offset != 0.0) {
            return error(
                "PARAM4_LIST: the specular directions are offset, as for refraction, which the model does not \
                 describe: expected none"
                    .to_owned(),
            );
        }
        Ok(Self {
            coordinates,
            lists: [zenith, source_azimuth, polar, azimuth],
            turns: [first_of_turn(source_azimuth), first_of_turn(azimuth)],
        })
    }

    /// The places of the values, in the order of the file.
    pub(super) fn places(&self) -> impl Iterator<Item = Place> {
        let [zenith, source_azimuth, polar, azimuth] = self.lists;
        let azimuths = azimuth.iter().copied().enumerate();
        azimuths.flat_map(move |(l, azimuth)| {
            let polars = polar.iter().copied().enumerate();
            polars.flat_map(move |(k, polar)| {
                let sources = source_azimuth.iter().copied().enumerate();
                sources.flat_map(move |(j, source)| {
                    let zeniths = zenith.iter().copied().enumerate();
                    zeniths.map(move |(i, zenith)| ([i, j, k, l], [zenith, source, polar, azimuth]))
                })
            })
        })
    }

    /// The place of a value among all.
    pub(super) fn index(&self, [i, j, k, l]: [usize; 4]) -> usize {
        let [zenith, source_azimuth, polar, _] = self.lists.map(<[f64]>::len);
        i + zenith * (j + source_azimuth * (k + polar * l))
    }

    /// Earlier places with the same directions: a whole turn before, and at the first azimuth where the azimuth
    /// has no meaning.
    pub(super) fn earlier(&self, [i, j, k, l]: [usize; 4]) -> impl Iterator<Item = [usize; 4]> {
        let [sources, azimuths] = &self.turns;
        let (first_j, first_l) = (sources.get(j).copied(), azimuths.get(l).copied());
        let at = |list: usize, index: usize| self.lists.get(list).and_then(|list| list.get(index));
        let is_zero = |angle: Option<&f64>| angle == Some(&0.0);
        let half_upright = self.coordinates == Coordinates::HalfDifference && is_zero(at(0, i));
        let at_pole = is_zero(at(2, k)) || half_upright;
        let turn_of_source = first_j
            .filter(|first| *first < j)
            .map(|first| [i, first, k, l]);
        let turn = first_l
            .filter(|first| *first < l)
            .map(|first| [i, j, k, first]);
        let pole = (at_pole && l > 0).then_some([i, j, k, 0]);
        turn_of_source.into_iter().chain(turn).chain(pole)
    }

    /// psi, theta and phi in radians; `None` where a direction is at or beyond the horizon.
    pub(super) fn directions(&self, at: [f64; 4]) -> Option<(f64, f64, f64)> {
        let [zenith, source_azimuth, polar, azimuth] = at;
        let [psi, _, radial, turn] = at.map(f64::to_radians);
        match self.coordinates {
            Coordinates::Spherical => TwoDirections {
                theta_i: zenith,
                phi_i: source_azimuth,
                theta_s: polar,
                phi_s: azimuth,
            }
            .in_model(AngleUnit::Degrees),
            Coordinates::Specular => {
                let (theta, phi) = from_specular(psi, turn, radial);
                (zenith < 90.0 && theta < HORIZON).then_some((psi, theta, phi))
            }
            Coordinates::HalfDifference => {
                let [psi, theta, phi] = from_half_and_difference(psi, radial, turn)?;
                (psi < HORIZON && theta < HORIZON).then_some((psi, theta, phi))
            }
        }
    }

    /// The number of azimuths of the source that are not the same.
    pub(super) fn rotations(&self) -> usize {
        let [sources, _] = &self.turns;
        let first = sources.iter().enumerate().filter(|(j, first)| j == *first);
        first.count()
    }

    /// The sentence that reports the coordinates.
    pub(super) fn in_words(&self) -> &'static str {
        match self.coordinates {
            Coordinates::Spherical => {
                "azimuths are those of source and view: equal ones are the source's side"
            }
            Coordinates::Specular => {
                "scatter angles about the specular ray are converted to view angles"
            }
            Coordinates::HalfDifference => {
                "half and difference angles are converted to view angles"
            }
        }
    }
}

/// For each azimuth in degrees, the index of the first one that differs from it by whole turns.
fn first_of_turn(azimuths: &[f64]) -> Vec<usize> {
    let mut first = std::collections::HashMap::new();
    let azimuths = azimuths.iter().enumerate();
    azimuths
        .map(|(i, azimuth)| {
            let turn = azimuth.rem_euclid(360.0) + 0.0;
            *first.entry(turn.to_bits()).or_insert(i)
        })
        .collect()
}
