//! The options that describe the directions of a scene.

use std::str::FromStr;

use brdf_core::scene::{Azimuth, Domain, DomainError};
use clap::Args;

/// The directions of a scene.
#[derive(Args)]
pub(super) struct SceneArguments {
    /// Incidence angles psi of the scene, in degrees, as FROM:TO or as a single angle
    #[arg(
        long,
        value_name = "RANGE",
        default_value = "0:85",
        allow_hyphen_values = true
    )]
    incidence: Range,

    /// Magnitudes of the view angle theta of the scene, in degrees, as FROM:TO or as a single angle
    #[arg(
        long,
        value_name = "RANGE",
        default_value = "0:85",
        allow_hyphen_values = true
    )]
    view: Range,

    /// Restrict the view directions of the scene to the plane of incidence
    #[arg(long)]
    in_plane: bool,
}

impl SceneArguments {
    /// The directions.
    pub(super) fn domain(&self) -> Result<Domain, DomainError> {
        let azimuth = if self.in_plane {
            Azimuth::InPlane
        } else {
            Azimuth::Full
        };
        let (incidence, view) = (self.incidence, self.view);
        Domain::new(
            (incidence.from, incidence.to),
            (view.from, view.to),
            azimuth,
        )
    }
}

/// A range of angles, in radians.
#[derive(Clone, Copy)]
struct Range {
    from: f64,
    to: f64,
}

impl FromStr for Range {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let degrees = |text: &str| {
            let angle: f64 = text.parse().ok()?;
            (0.0..90.0).contains(&angle).then(|| angle.to_radians())
        };
        let (from, to) = text.split_once(':').unwrap_or((text, text));
        match (degrees(from), degrees(to)) {
            (Some(from), Some(to)) if from <= to => Ok(Self { from, to }),
            _ => Err("expected degrees from 0 to below 90, as FROM:TO".to_owned()),
        }
    }
}

/// A positive number.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && f64::is_finite(number) => Ok(number),
        _ => Err("expected a number above 0".to_owned()),
    }
}
