//! When to stop: the tolerance is kept, or what is left is the misfit of the model, or the model fails.

use std::fmt;

use super::list::error_percent;
use super::setting::Setting;
use super::state::State;

/// Further readings change the error where they lower it by more than this fraction.
pub(super) const WORTHWHILE: f64 = 0.05;

/// Fewer readings say nothing about the errors.
const FEWEST: usize = 6;

/// A region stands out where its mean square error is this many times that of all readings.
const STANDS_OUT: f64 = 1.5;

/// The fewest readings of a region that stands out.
const FEWEST_IN_REGION: usize = 2;

/// The model fails beyond this misfit of ln f_r: that of the measured paints, anodised surfaces and diffusers is at
/// most 0.17 and within this limit for choices of six of their readings; that of mirrors and of coatings with a narrow
/// peak is 0.34 and more.
const LARGEST_MISFIT: f64 = 0.28;

/// Whether further readings are worth their time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Advice {
    /// Further readings lower the error.
    Continue,
    /// The error over the scene, predicted and cross-validated, is within the tolerance, and two further readings
    /// would not change it.
    Enough,
    /// The error, predicted or cross-validated, is above the tolerance, and no readings of the instrument would lower
    /// it: the model misses the surface, most of all in a region.
    Misfit(Region),
    /// The model does not follow the readings, so that no prediction of it holds.
    Fails {
        /// The root mean square of ln(measured/model).
        misfit: f64,
        /// Where it is largest.
        region: Region,
    },
}

/// A part of the directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Region {
    /// Within 15 deg of the source.
    Retro,
    /// Within 15 deg of the mirror direction.
    Mirror,
    /// Incidence or view beyond 65 deg.
    Grazing,
    /// More than 15 deg of azimuth out of the plane of incidence.
    OutOfPlane,
    /// No part more than another.
    Everywhere,
}

impl Region {
    const PARTS: [Self; 4] = [Self::Retro, Self::Mirror, Self::Grazing, Self::OutOfPlane];

    /// Whether a setting is in the region.
    pub(super) fn contains(self, setting: &Setting) -> bool {
        let near = 15_f64.to_radians();
        let grazing = 65_f64.to_radians();
        match self {
            Self::Retro => setting.from_source() < near,
            Self::Mirror => setting.from_mirror() < near,
            Self::Grazing => setting.psi > grazing || setting.theta.abs() > grazing,
            Self::OutOfPlane => setting.phi.sin().abs() > near.sin(),
            Self::Everywhere => true,
        }
    }

    /// The region where the model misses the readings most.
    pub(super) fn worst(state: &State) -> Self {
        let residuals = state.residuals();
        let mean = |region: Self| {
            let own = state.readings.iter().zip(&residuals);
            let squares: Vec<f64> = own
                .filter(|(reading, _)| region.contains(&reading.site.setting))
                .map(|(_, residual)| residual * residual)
                .collect();
            let enough = squares.len() >= FEWEST_IN_REGION;
            enough.then(|| squares.iter().sum::<f64>() / squares.len() as f64)
        };
        let all = mean(Self::Everywhere).unwrap_or(0.0);
        let parts = Self::PARTS
            .into_iter()
            .filter_map(|part| Some((part, mean(part)?)));
        let worst = parts.max_by(|a, b| a.1.total_cmp(&b.1));
        worst
            .filter(|(_, square)| *square > STANDS_OUT * all)
            .map_or(Self::Everywhere, |(part, _)| part)
    }
}

impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Retro => "the direction of the source (retroreflection)",
            Self::Mirror => "the mirror direction",
            Self::Grazing => "grazing angles (beyond 65 deg)",
            Self::OutOfPlane => "views outside the plane of incidence",
            Self::Everywhere => "no direction more than others",
        })
    }
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Continue => f.write_str("further readings lower the error"),
            Self::Enough => f.write_str(
                "enough: the error is within the tolerance, and two further readings would hardly change it",
            ),
            Self::Misfit(Region::Everywhere) => f.write_str(
                "more readings of this kind will not help: what is left is the misfit of the model, no direction more \
                 than others",
            ),
            Self::Misfit(region) => write!(
                f,
                "more readings of this kind will not help: what is left is the misfit of the model, most of all at {region}"
            ),
            Self::Fails { misfit, region } => write!(
                f,
                "the model fails for this surface: it misses the readings by {} rms, {}, so that its predictions do not \
                 hold; look at the fit, and choose another model, or measure a table",
                error_percent(*misfit),
                match region {
                    Region::Everywhere => "in no direction more than in others".to_owned(),
                    region => format!("most of all at {region}"),
                }
            ),
        }
    }
}

impl Advice {
    /// From the predicted errors: now, after two more readings, and the smallest that readings of the instrument leave.
    /// `validated` is the cross-validated error.
    pub(super) fn new(
        state: &State,
        validated: Option<f64>,
        now: f64,
        after_two: f64,
        limit: f64,
        tolerance: f64,
    ) -> Self {
        if state.readings.len() < FEWEST {
            return Self::Continue;
        }
        let is_within = now.max(validated.unwrap_or(f64::INFINITY)) <= tolerance;
        let is_unchanged = |later: f64| later > (1.0 - WORTHWHILE) * now;
        let misfit = state.misfit();
        if is_within && is_unchanged(after_two) {
            Self::Enough
        } else if !is_within && misfit > LARGEST_MISFIT {
            let region = Region::worst(state);
            Self::Fails { misfit, region }
        } else if !is_within && is_unchanged(limit) {
            Self::Misfit(Region::worst(state))
        } else {
            Self::Continue
        }
    }
}
